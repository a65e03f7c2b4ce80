"""The program as such: its help, its version, and the one place where errors become lines."""

import io
import json
import os
import subprocess
import sys

import click
import pytest

from motionedit import __version__
from motionedit.cli import main
from motionedit.cli.boundary import run_guarded
from motionedit.cli.program import COMMANDS
from motionedit.cli.progress import progress_shown
from motionedit.core.compiled import solver_name
from motionedit.errors import ClipError, MotionEditErrors, SpecError

COMMAND_LINE = [sys.executable, "-m", "motionedit"]


def command_of(name):
    return main.get_command(click.Context(main), name)


def test_help_lists_the_commands_in_the_order_of_work(run):
    listed = run("--help").stdout.partition("Commands:")[2].partition("Example")[0].split("\n")
    assert [line.split()[0] for line in listed if line.strip()] == [
        *("normalize", "fit-pca", "edit-pc", "edit-prioritized", "info", "diff", "preview", "check", "schema")
    ]


@pytest.mark.parametrize("name", COMMANDS)
def test_the_line_in_the_list_is_the_first_of_the_commands_help(name):
    assert command_of(name).help.splitlines()[0] == COMMANDS[name]
    assert command_of(name).name == name


@pytest.mark.parametrize("arguments", [[], *([name] for name in COMMANDS)], ids=lambda a: "".join(a) or "motionedit")
def test_each_help_ends_with_an_example_of_the_command(run, arguments):
    result = run(*arguments, "-h")
    assert result.exit_code == 0
    assert result.stdout == run(*arguments, "--help").stdout
    assert max(map(len, result.stdout.splitlines())) <= 80
    *_, heading, example = result.stdout.rstrip("\n").splitlines()
    assert heading.startswith("  Example")
    assert example.strip().startswith(" ".join(["motionedit", *arguments]))


@pytest.mark.parametrize("name", COMMANDS)
def test_each_option_has_a_help_text(name):
    for parameter in command_of(name).params:
        if isinstance(parameter, click.Option) and not parameter.hidden:
            assert parameter.help, parameter.name


def test_the_version(run):
    assert run("--version").stdout == f"motionedit {__version__} ({solver_name()} solver)\n"


def test_without_a_command_the_help_is_shown_as_an_error(run):
    result = run()
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("Usage: motionedit ")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["edit-prio"], "no command 'edit-prio'; did you mean 'edit-prioritized'?"),
        (["zzz"], "no command 'zzz'; one of: normalize, fit-pca, edit-pc"),
        (["--bogus"], "no such option"),  # and it, in words of click's that differ between releases
        (["info"], "missing argument 'CLIPS...'; see 'motionedit info --help'"),
        (["edit-pc", "a.bvh"], "missing option '-m' / '--model'; see 'motionedit edit-pc --help'"),
        (["info", "nope.bvh", "--report", "x.json"], "nope.bvh: no such file or folder"),
        (["info", "nope.bvh", "--at", "3"], "--at and --joint go together"),
        (["normalize", "a.bvh", "-s", "s.yaml", "-o", "x.bvh"], "-o x.bvh: normalize writes several files"),
        (["normalize", "a.bvh", "-s", "s.yaml", "-o", "-"], "-o -: normalize writes several files"),
        (["normalize", "a.bvh", "-s", "none.yaml", "-o", "x"], "error: none.yaml: no such file"),
        (["normalize", "a.bvh", "-s", ".", "-o", "x"], ".: is a folder, not a file"),
        (["fit-pca", "nope", "-o", "x.npz"], "nope: no such folder"),
        (["fit-pca", ".", "-o", "-"], "-o -: fit-pca writes a file"),
        (["fit-pca", ".", "-o", "m.npz", "--set", "components=3"], "--set overrides a key of a spec: give -s too"),
        (["fit-pca", ".", "-o", "s.yaml", "--no-overwrite"], "s.yaml: exists, and --no-overwrite is given"),
        (["edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", "-", "--report", "-"], "-o - and --report - cannot both"),
        (["edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", "x", "-j", "-1"], "'-j' / '--jobs': -1 is below 0"),
        (["edit-pc", "a.bvh", "--skeleton", "b.bvh"], "--skeleton is not supported yet"),
        (["preview", "a.bvh", "-o", "x.html", "--report=x"], "x: no such file"),
        (["preview", "a.bvh", "-o", "x.png", "--report=s.yaml"], "give a name ending in .html"),
        (["diff", "s.yaml", "s.yaml", "--tolerance-angle", "nan"], "nan is below 0"),
        (["info", ""], "an empty name"),
        (["edit-prioritized", "a.bvh", "-s", "s.yaml", "-o", ""], "an empty name"),
        (["schema", "info"], "'info' is not one of"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_faulty_command_line_is_one_line_and_exit_code_2(run, tmp_path, arguments, line):
    (tmp_path / "s.yaml").write_text("")
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("motionedit: error: ")
    assert line in result.stderr
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("error", "code", "lines"),
    [
        (ClipError("short", file="a.bvh", line=3), 1, ["a.bvh:3: short"]),
        (
            MotionEditErrors("two", [SpecError("x", file="s"), MotionEditErrors("", [SpecError("y\n z", file="s")])]),
            2,
            ["s: x", "s: y z"],
        ),
        (PermissionError(13, "Permission denied", "out/a.bvh"), 1, ["out/a.bvh: Permission denied"]),
        (OSError(28, "No space left on device"), 1, ["No space left on device"]),
        (KeyboardInterrupt(), 130, ["interrupted"]),
        (MemoryError(), 1, ["out of memory"]),
        (KeyError("x"), 1, ["unexpected KeyError: 'x'; please report it (-vv shows where)"]),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else "",
)
def test_every_error_is_a_line_and_an_exit_code(capsys, error, code, lines):
    def fail():
        raise error

    assert run_guarded(fail) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert err == "".join(f"motionedit: error: {line}\n" for line in lines)


@pytest.mark.parametrize(("verbose", "traced"), [((), False), (("-v",), False), (("-v", "-v"), True)])
def test_a_fault_of_ours_shows_its_place_only_with_vv(run, monkeypatch, verbose, traced):
    def fail(*_):
        raise KeyError("x")

    monkeypatch.setattr("motionedit.spec.schema_of", fail)
    # Before and after the command's name the option counts the same.
    result = run(*verbose[:1], "schema", "edit-pc", *verbose[1:])
    assert result.exit_code == 1
    assert ("Traceback" in result.stderr) == traced
    assert "motionedit: error: unexpected KeyError: 'x'; please report it" in result.stderr


def test_ctrl_c_is_exit_code_130(run, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("motionedit.spec.schema_of", stop)
    result = run("schema", "edit-pc")
    assert (result.exit_code, result.stderr) == (130, "motionedit: error: interrupted\n")


@pytest.mark.parametrize("name", ["normalize", "fit-pca", "edit-pc", "edit-prioritized"])
def test_the_schema_of_each_spec_is_json(run, name):
    assert json.loads(run("schema", name).stdout)["properties"]["schema"]


@pytest.fixture
def progress(monkeypatch):
    """Return a function that tells what is shown of a run whose clips are all done."""

    def shown(length, *, terminal, verbosity=0):
        stream = io.StringIO()
        stream.isatty = lambda: terminal
        monkeypatch.setattr("sys.stderr", stream)
        with progress_shown(length, verbosity=verbosity) as advance:
            for _ in range(length):
                advance()
        return stream.getvalue()

    return shown


def test_a_bar_moves_only_on_a_terminal_and_for_more_than_one_clip(progress):
    assert "2/2" in progress(2, terminal=True)
    assert progress(1, terminal=True) == progress(2, terminal=False) == ""
    assert progress(200, terminal=True, verbosity=-1) == ""


def test_a_log_has_a_line_for_each_tenth_of_many_clips(progress):
    assert progress(99, terminal=False) == progress(1000, terminal=False, verbosity=-1) == ""
    assert progress(1000, terminal=False).splitlines() == [
        *(f"{100 * n} of 1,000 clips" for n in range(1, 10)),
        "1,000 of 1,000 clips",
    ]
    for length in (100, 101, 437):
        lines = progress(length, terminal=False).splitlines()
        assert [int(line.split()[0]) for line in lines] == [-(-length * n // 10) for n in range(1, 11)]


def test_the_module_is_the_same_program():
    done = subprocess.run([*COMMAND_LINE, "--help"], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("Usage: motionedit [OPTIONS]")


def test_the_shell_completes_commands():
    environment = {
        **os.environ,
        "COMP_WORDS": "motionedit edit",
        "COMP_CWORD": "1",
        "_MOTIONEDIT_COMPLETE": "bash_complete",
    }
    done = subprocess.run(COMMAND_LINE, env=environment, capture_output=True, text=True, check=False)
    assert done.stdout == "plain,edit-pc\nplain,edit-prioritized\n"


def test_a_reader_that_stops_reading_is_no_error():
    # More than a pipe holds, so that writing meets the closed end.
    read_end, write_end = os.pipe()
    os.close(read_end)
    done = subprocess.run([*COMMAND_LINE, "schema", "normalize"], stdout=write_end, stderr=subprocess.PIPE, check=False)
    os.close(write_end)
    assert done.stderr == b""
    assert done.returncode == 1


def test_blas_has_one_thread_whatever_the_environment_says():
    code = """
import os, sys, motionedit.cli
try:
    motionedit.cli.main(["--version"])
except SystemExit:
    print([os.environ[name] for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")])
"""
    environment = {**os.environ, "OMP_NUM_THREADS": "8"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.endswith("['1', '1', '1']\n")
