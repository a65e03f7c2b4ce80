"""Names of any letters can be printed, whatever the encoding of the terminal, the pipe or the system."""

import errno
import io
import os
import subprocess
import sys

import pytest

from motionedit.cli.boundary import run_guarded
from motionedit.cli.streams import take_every_letter

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
