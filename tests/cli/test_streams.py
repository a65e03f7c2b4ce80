"""Names of any letters can be printed, whatever the encoding of the terminal, the pipe or the system."""

import errno
import io
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree as ET

import pytest

from motionedit.cli.boundary import run_guarded
from motionedit.cli.streams import take_every_letter
from motionedit.jobs.batch import one_clip

NAMES = ("Hips", "LeftHüfte→")


def info(path, *, encoding):
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    command = [sys.executable, "-m", "motionedit", "info", path]
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    return done.returncode, done.stdout.decode(encoding), done.stderr


@pytest.mark.parametrize(("encoding", "shown"), [("utf-8", "LeftHüfte→"), ("cp1252", "LeftHüfte\\u2192")])
def test_a_letter_that_the_output_lacks_is_its_number_and_no_error(clip, encoding, shown):
    code, out, err = info(clip(names=NAMES), encoding=encoding)
    assert (code, err) == (0, b"")
    assert shown in out


def test_windows_writes_utf_8_to_pipes_and_files(monkeypatch):
    streams = {name: io.TextIOWrapper(io.BytesIO(), encoding="cp1252") for name in ("stdout", "stderr")}
    monkeypatch.setattr(sys, "platform", "win32")
    for name, stream in streams.items():
        monkeypatch.setattr(sys, name, stream)
    take_every_letter()
    assert [stream.encoding for stream in streams.values()] == ["utf-8", "utf-8"]


def test_what_somebody_chose_for_letters_that_lack_stays(monkeypatch):
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii", errors="replace"))
    monkeypatch.setattr(sys, "stderr", None)
    take_every_letter()
    assert sys.stdout.errors == "replace"


@pytest.mark.parametrize(
    ("system", "path", "silent"), [("win32", None, True), ("win32", "a.bvh", False), ("linux", None, False)]
)
def test_a_reader_that_stops_reading_is_no_error_on_windows_either(monkeypatch, capsys, system, path, silent):
    def write():
        raise OSError(errno.EINVAL, "Invalid argument", path)

    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(sys, "stdout", sys.stdout)
    assert run_guarded(write) == 1
    assert (capsys.readouterr().err == "") == silent
    assert (sys.stdout is None) == silent


REPORTED = "preview in out --report r.json -o q.html"
ODD = {"escape": b"\x1b[31mred.bvh", "dash": b"-v.bvh", "bytes": b"\xff\xfe.bvh", "dollar": b"$x$.bvh"}


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text there")
@pytest.mark.parametrize("name", ODD.values(), ids=ODD)
def test_a_clip_of_any_name_is_worked_on_and_its_name_steers_no_terminal(run, clip, copy_spec, name):
    odd = os.fsdecode(name)
    clip("in/walk.bvh").rename(Path("in") / odd)
    result = run("edit-prioritized", "in", "-s", copy_spec, "-o", "out", "--preview", "--report", "r.json")
    assert result.exit_code == 0, result.stderr
    assert os.fsencode("out/" + odd) in result.stdout_bytes
    assert "\x1b" not in result.stderr
    for more in ("info in", "diff in out", "preview in -o p.html", "preview in -o p.svg", REPORTED):
        again = run(*more.split())
        assert again.exit_code == 0, again.stderr
        assert "\x1b" not in again.output
    json.loads(Path("r.json").read_text("utf-8"))
    ET.parse("p.svg")  # noqa: S314  our own file


@pytest.mark.skipif(sys.platform == "win32", reason="the system takes no such name")
def test_a_line_break_in_a_name_is_refused_since_files_are_listed_one_a_line(run, clip, copy_spec):
    clip("in/a\nb.bvh")
    result = run("edit-prioritized", "in", "-s", copy_spec, "-o", "out")
    assert result.exit_code == 2
    assert "in/a b.bvh: a line break in its name" in result.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")
@pytest.mark.parametrize(
    ("arguments", "redirect", "message"),
    [
        (["-o", "out", "--report", "/dev/full"], "", "/dev/full: cannot be written: No space left on device"),
        (["-o", "-"], "> /dev/full", "standard output: cannot be written: No space left on device"),
        (["-o", "out"], ">&-", "standard output: is closed"),
    ],
)
def test_what_cannot_be_written_is_named(clip, copy_spec, tmp_path, arguments, redirect, message):
    words = [sys.executable, "-m", "motionedit", "edit-prioritized", str(clip()), "-s", str(copy_spec), *arguments]
    line = f"{shlex.join(words)} -q {redirect}"
    done = subprocess.run(["sh", "-c", line], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, f"motionedit: error: {message}\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")
@pytest.mark.parametrize("name", ["p.html", "p.svg", "p.png"])
def test_a_picture_that_the_disk_has_no_room_for_is_named(run, clip, name):
    pytest.importorskip("matplotlib")
    Path(name).symlink_to("/dev/full")
    result = run("preview", clip(), "-o", name)
    said = f"motionedit: error: {name}: cannot be written: No space left on device\n"
    assert (result.exit_code, result.stderr) == (1, said)


def test_a_closed_standard_input_is_said(run, copy_spec, monkeypatch):
    monkeypatch.setattr(one_clip, "sys", SimpleNamespace(stdin=None))
    result = run("edit-prioritized", "-", "-s", copy_spec, "-o", "o.bvh")
    assert (result.exit_code, "<stdin>: standard input is closed" in result.stderr) == (1, True)
