"""Ctrl-C: exit code 130, one line, no half file, no process left."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_ctrl_c_ends_the_run_at_once_and_leaves_nothing_half_written(clip, copy_spec, tmp_path, jobs):
    clip("in/a.bvh")
    clip("in/c.bvh")
    # A clip that never comes: opening a pipe to write waits until the program has come to reading it.
    os.mkfifo(tmp_path / "in/b.bvh")
    process = subprocess.Popen(
        [sys.executable, "-m", "motionedit", "edit-prioritized", "in", "-s", copy_spec, "-o", "out", "-j", jobs],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell's background job ignores Ctrl-C, and so would what it starts.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509  no threads here
    )
    with (tmp_path / "in/b.bvh").open("wb"):
        # As a terminal does: to every process of the run.
        os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert (out, err) == ("", "motionedit: error: interrupted\n")
    assert {path.name for path in (tmp_path / "out").glob("*")} <= {"a.bvh", "c.bvh"}
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


def test_a_killed_worker_is_one_line_and_the_clips_that_were_done_stay(clip, copy_spec, tmp_path):
    clip("in/a.bvh")
    os.mkfifo(tmp_path / "in/b.bvh")
    process = subprocess.Popen(
        [sys.executable, "-m", "motionedit", "edit-prioritized", "in", "-s", copy_spec, "-o", "out", "-j", "2"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with (tmp_path / "in/b.bvh").open("wb"):
        for worker in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
            os.kill(int(worker), signal.SIGKILL)
        out, err = process.communicate(timeout=20)
    assert process.returncode == 1
    assert "in/b.bvh: its worker process was killed" in err
    assert "Traceback" not in err
    assert set(out.split()) <= {"out/a.bvh"}
