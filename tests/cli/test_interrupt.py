"""Ctrl-C: exit code 130, one line, no half file, no process left."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import motionedit

# The program, whose work on b.bvh says that it has begun and does not end.
STUCK = """
import sys, time
from motionedit.__main__ import main
from motionedit.jobs.edit_prioritized.job import EditByPriorities
usual = EditByPriorities.__call__
def stuck(self, clip, task):
    if task.relative == "b.bvh":
        open("begun", "wb").close()
        time.sleep(60)
    return usual(self, clip, task)
EditByPriorities.__call__ = stuck
main()
"""


@pytest.fixture
def stuck(clip, copy_spec, tmp_path):
    """Return a function that starts the program on three clips and waits until it works on the second."""
    for name in "abc":
        clip(f"in/{name}.bvh")

    def start(jobs, *more):
        process = subprocess.Popen(
            [sys.executable, "-c", STUCK, "edit-prioritized", "in", "-s", copy_spec, "-o", "out", "-j", jobs, *more],
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            # A shell's background job ignores Ctrl-C, and so would what it starts.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509  no threads here
        )
        while not (tmp_path / "begun").exists():
            assert process.poll() is None
        return process

    return start


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_ctrl_c_ends_the_run_at_once_and_leaves_nothing_half_written(stuck, tmp_path, jobs):
    process = stuck(jobs)
    # As a terminal does: to every process of the run.
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 130
    # By two workers b.bvh may be begun before a.bvh is done; c.bvh does not count before b.bvh does.
    come = "1" if jobs == "1" else "[01]"
    assert re.fullmatch(f"motionedit: error: interrupted after {come} of 3 clips: go on with --update\n", err)
    assert out == ""
    assert {path.name for path in (tmp_path / "out").glob("[!.]*")} <= {"a.bvh", "c.bvh"}
    assert not list((tmp_path / "out").glob(".*-partial"))
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


def test_what_an_earlier_run_made_counts_as_come(stuck, run, copy_spec, tmp_path):
    (tmp_path / "in/b.bvh").rename(tmp_path / "b.bvh")
    assert run("edit-prioritized", "in", "-s", copy_spec, "-o", "out").exit_code == 0
    (tmp_path / "b.bvh").rename(tmp_path / "in/b.bvh")
    process = stuck("1", "--update")
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=20)
    message = "motionedit: error: interrupted after 2 of 3 clips: go on with --update\n"
    assert (process.returncode, err) == (130, message)


def test_a_dry_run_is_nothing_to_go_on_with(stuck):
    process = stuck("1", "--dry-run")
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (130, "motionedit: error: interrupted after 1 of 3 clips\n")


def test_a_killed_worker_is_one_line(stuck):
    process = stuck("2")
    workers = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    assert len(workers) == 2
    for worker in workers:
        os.kill(int(worker), signal.SIGKILL)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 1
    assert "in/b.bvh: its worker process was killed" in err
    assert "Traceback" not in err
    assert set(out.split()) <= {"out/a.bvh", "out/c.bvh"}


def test_ctrl_c_while_modules_are_loaded_is_one_line_too():
    code = """
import os, signal, sys
class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "click":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupting())
signal.signal(signal.SIGINT, signal.default_int_handler)
from motionedit.__main__ import main
main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=20, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "motionedit: error: interrupted\n")


def test_next_to_nothing_is_loaded_before_ctrl_c_can_be_answered():
    root = Path(motionedit.__file__).parents[1]
    code = f"import sys\nsys.path.insert(0, {str(root)!r})\nbefore = set(sys.modules)\nimport motionedit.__main__\n"
    code += "print(*set(sys.modules) - before)"
    # Without what packages of the environment load at its start.
    done = subprocess.run([sys.executable, "-S", "-c", code], capture_output=True, text=True, check=True)
    named = {name.partition(".")[0] for name in done.stdout.split()}
    assert named <= {"motionedit", "importlib", "warnings", "__future__"}
