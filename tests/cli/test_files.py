"""A name never stands for half a file, and what killed runs leave goes away."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from motionedit.jobs.batch.files import atomic_write, clean_leftovers, identity

STUCK_WRITER = """
import sys, time
from pathlib import Path
from motionedit.jobs.batch.files import atomic_write
def stuck(self, target):
    print("written", flush=True)
    time.sleep(60)
Path.replace = stuck
atomic_write(Path(sys.argv[1]), b"half")
"""


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def stuck_writer(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-c", STUCK_WRITER, str(tmp_path / "walk.bvh")], stdout=subprocess.PIPE, text=True
    )
    process.stdout.readline()
    yield process
    process.kill()
    process.wait()
    process.stdout.close()


def test_a_write_makes_the_folders_and_leaves_only_the_file(tmp_path):
    atomic_write(tmp_path / "a/b/walk.bvh", b"new")
    assert (tmp_path / "a/b/walk.bvh").read_bytes() == b"new"
    assert names_in(tmp_path / "a/b") == ["walk.bvh"]


def test_a_file_is_written_in_pieces_and_pieces_that_end_in_an_error_leave_the_old_one(tmp_path):
    target = tmp_path / "walk.bvh"
    atomic_write(target, iter([b"one ", memoryview(b"two")]))
    assert target.read_bytes() == b"one two"

    def broken():
        yield b"half"
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        atomic_write(target, broken())
    assert target.read_bytes() == b"one two"
    assert names_in(tmp_path) == ["walk.bvh"]


def test_a_written_file_has_the_permissions_of_any_new_file(tmp_path):
    (tmp_path / "plain").write_bytes(b"")
    atomic_write(tmp_path / "walk.bvh", b"")
    assert (tmp_path / "walk.bvh").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(28, "No space left on device")])
def test_a_write_that_stops_keeps_the_old_file_and_no_other(tmp_path, monkeypatch, error):
    target = tmp_path / "walk.bvh"
    target.write_bytes(b"old")

    def stop(*_):
        raise error

    monkeypatch.setattr(Path, "replace", stop)
    with pytest.raises((KeyboardInterrupt, OSError)):
        atomic_write(target, b"new")
    assert target.read_bytes() == b"old"
    assert names_in(tmp_path) == ["walk.bvh"]


def test_what_a_killed_run_left_is_hidden_no_clip_and_removed_by_the_next(tmp_path, stuck_writer):
    stuck_writer.send_signal(signal.SIGKILL)
    stuck_writer.wait()
    (left,) = names_in(tmp_path)
    assert left.startswith(".")
    assert not left.endswith(".bvh")
    clean_leftovers([tmp_path])
    assert names_in(tmp_path) == []


def test_the_temporary_file_of_a_living_run_stays(tmp_path, stuck_writer):
    (left,) = names_in(tmp_path)
    clean_leftovers([tmp_path])
    assert names_in(tmp_path) == [left]
    assert stuck_writer.poll() is None


def test_cleaning_touches_nothing_else_and_minds_no_missing_folder(tmp_path):
    names = [".hidden", "walk.bvh", "x.motionedit-partial"]
    for name in names:
        (tmp_path / name).write_bytes(b"")
    clean_leftovers([tmp_path, tmp_path / "nowhere"])
    assert names_in(tmp_path) == names


def test_a_pipe_is_written_to_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    atomic_write(pipe, b"report")
    assert os.read(reader, 100) == b"report"
    os.close(reader)


def test_one_file_is_the_same_by_every_name(tmp_path, monkeypatch):
    (tmp_path / "walk.bvh").write_bytes(b"")
    (tmp_path / "link.bvh").symlink_to("walk.bvh")
    (tmp_path / "hard.bvh").hardlink_to(tmp_path / "walk.bvh")
    monkeypatch.chdir(tmp_path)
    names = ["walk.bvh", "./walk.bvh", f"../{tmp_path.name}/walk.bvh", "link.bvh", "hard.bvh"]
    assert len({identity(Path(name)) for name in names}) == 1
    assert identity(Path("new.bvh")) == identity(tmp_path / "new.bvh") != identity(Path("walk.bvh"))
