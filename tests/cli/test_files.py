"""A name never stands for half a file, and what killed runs leave goes away."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from motionedit.jobs.batch import files
from motionedit.jobs.batch.files import atomic_write, clean_leftovers, identity, place

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


@pytest.fixture
def without_locks(monkeypatch):
    """Windows, as far as it can be had here: no locks, and no file that is open can be removed or replaced."""
    opened = []
    usual = {name: getattr(Path, name) for name in ("open", "replace", "unlink")}

    def open_(self, *arguments, **options):
        stream = usual["open"](self, *arguments, **options)
        opened.append((self, stream))
        return stream

    def refuse(*paths):
        if any(one in paths and not stream.closed for one, stream in opened):
            raise PermissionError(13, "The process cannot access the file because it is being used by another process")

    def replace(self, target):
        refuse(self, Path(target))
        return usual["replace"](self, target)

    def unlink(self, **options):
        refuse(self)
        return usual["unlink"](self, **options)

    monkeypatch.setattr(files, "fcntl", None)
    for name, function in (("open", open_), ("replace", replace), ("unlink", unlink)):
        monkeypatch.setattr(Path, name, function)


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


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="the system has no such signal")
def test_what_a_killed_run_left_is_hidden_no_clip_and_removed_by_the_next(tmp_path, stuck_writer):
    stuck_writer.send_signal(signal.SIGKILL)
    stuck_writer.wait()
    (left,) = names_in(tmp_path)
    assert left.startswith(".")
    assert not left.endswith(".bvh")
    clean_leftovers([tmp_path])
    assert names_in(tmp_path) == []


@pytest.mark.skipif(files.fcntl is None, reason="without locks a file is closed before it is renamed")
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


@pytest.mark.usefixtures("without_locks")
def test_without_locks_a_file_is_written_and_what_a_killed_run_left_goes(tmp_path):
    atomic_write(tmp_path / "walk.bvh", b"new")
    (tmp_path / ".walk.bvh.1.motionedit-partial").touch()
    clean_leftovers([tmp_path])
    assert names_in(tmp_path) == ["walk.bvh"]
    assert (tmp_path / "walk.bvh").read_bytes() == b"new"


@pytest.mark.usefixtures("without_locks")
def test_without_locks_the_temporary_file_of_a_living_run_stays(tmp_path):
    left = tmp_path / ".walk.bvh.1.motionedit-partial"
    with left.open("wb"):
        clean_leftovers([tmp_path])
        assert left.exists()


@pytest.mark.usefixtures("without_locks")
def test_a_file_that_another_program_has_open_is_replaced_once_it_lets_go(tmp_path, monkeypatch):
    target = tmp_path / "walk.bvh"
    target.write_bytes(b"old")
    scanner = target.open("rb")
    monkeypatch.setattr(files.time, "sleep", lambda _: scanner.close())
    atomic_write(target, b"new")
    assert target.read_bytes() == b"new"


@pytest.mark.usefixtures("without_locks")
def test_a_file_that_another_program_keeps_open_stays_as_it_is(tmp_path, monkeypatch):
    target = tmp_path / "walk.bvh"
    target.write_bytes(b"old")
    monkeypatch.setattr(files, "_SECONDS_TO_REPLACE", 0.1)
    with target.open("rb"), pytest.raises(PermissionError):
        atomic_write(target, b"new")
    assert target.read_bytes() == b"old"
    assert names_in(tmp_path) == ["walk.bvh"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
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


def test_where_files_have_no_numbers_their_places_tell_them_apart(tmp_path, monkeypatch):
    for name in ("walk.bvh", "kick.bvh"):
        (tmp_path / name).write_bytes(b"")
    monkeypatch.setattr(Path, "stat", lambda _: os.stat_result([0] * 10))
    assert identity(tmp_path / "walk.bvh") == identity(tmp_path / "." / "walk.bvh") != identity(tmp_path / "kick.bvh")


@pytest.mark.parametrize(("system", "same"), [("linux", False), ("win32", True), ("darwin", True)])
def test_capitals_make_another_place_only_where_the_system_says_so(monkeypatch, system, same):
    monkeypatch.setattr(files.sys, "platform", system)
    assert (place(Path("out/Walk.bvh")) == place(Path("out/walk.bvh"))) == same


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_many_places_are_those_of_each_by_itself(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "deep/er").mkdir(parents=True)
    (tmp_path / "walk.bvh").write_bytes(b"")
    (tmp_path / "deep/link.bvh").symlink_to(tmp_path / "walk.bvh")
    (tmp_path / "folder").symlink_to(tmp_path / "deep")
    (tmp_path / "deep/nowhere.bvh").symlink_to("none/at/all.bvh")
    names = "walk.bvh", "deep/link.bvh", "folder/link.bvh", "folder/er/new.bvh", "folder", "folder/..", ".", "/"
    places = files.Places()
    for name in (*names, "deep/nowhere.bvh", "folder/er/..", "none/new.bvh", *names):
        assert places.of(Path(name)) == place(Path(name))
        assert places.identity(Path(name)) == files.identity(Path(name))


@pytest.mark.skipif(files.fcntl is None, reason="without locks nothing is taken for a leftover while it is open")
def test_a_file_that_another_run_takes_for_a_leftover_before_it_is_locked_is_begun_again(tmp_path, monkeypatch):
    usual, taken = files.fcntl.flock, []

    def flock(stream, how):
        if not taken:
            taken.append(Path(stream.name))
            taken[0].unlink()
        usual(stream, how)

    monkeypatch.setattr(files.fcntl, "flock", flock)
    atomic_write(tmp_path / "walk.bvh", b"whole")
    assert taken
    assert (tmp_path / "walk.bvh").read_bytes() == b"whole"
    assert names_in(tmp_path) == ["walk.bvh"]


@pytest.mark.skipif(sys.platform == "win32", reason="the system has no such modes")
def test_a_file_that_is_replaced_keeps_its_mode(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_bytes(b"old")
    path.chmod(0o640)
    atomic_write(path, b"new")
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no such pipes")
def test_a_pipe_that_nobody_reads_is_an_error_and_no_reason_to_wait(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="No such device"):
        atomic_write(tmp_path / "pipe", b"")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no such pipes")
def test_pipes_and_devices_in_place_of_files_are_refused_in_words(run, clip, copy_spec):
    os.mkfifo("pipe.bvh")
    Path("out").mkdir()
    os.mkfifo("out/.x.motionedit-partial")  # a leftover that is none
    Path("pc.yaml").write_text("schema: motionedit/edit-pc/v1\ngoals: []\n")
    walk = clip()
    for arguments in (
        ("info", "pipe.bvh"),
        ("info", "/dev/zero"),
        ("edit-prioritized", walk, "-s", "pipe.bvh", "-o", "out"),
        ("edit-prioritized", walk, "pipe.bvh", "-s", copy_spec, "-o", "out"),
        ("edit-pc", walk, "-s", "pc.yaml", "-m", "pipe.bvh", "-o", "out"),
        ("preview", walk, "--report", "pipe.bvh", "-o", "p.html"),
    ):
        result = run(*arguments)
        assert result.exit_code in (1, 2), arguments
        assert "a pipe or a device, not a file" in result.stderr
