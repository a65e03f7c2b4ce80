"""The bytes of a file that are let go of are read again, or refused where the file was changed."""

import copy
import os
import sys

import pytest

from motionedit.core.bvh import file_bytes
from motionedit.core.bvh.file_bytes import FileBytes
from motionedit.errors import BvhError

DATA = bytes(range(256)) * 40


@pytest.fixture
def let_go(tmp_path, monkeypatch):
    monkeypatch.setattr(file_bytes, "_READ_AT_ONCE", 1000)
    path = tmp_path / "clip.bvh"
    path.write_bytes(DATA)
    file = FileBytes(DATA)
    file.let_go(path)
    assert file._data is None
    return file, path


def test_bytes_that_were_let_go_of_are_the_same_ones(let_go):
    file, _ = let_go
    assert len(file) == len(DATA)
    assert file.whole() == DATA
    assert bytes(file.between(7, 4321)) == DATA[7:4321]
    assert [len(piece) for piece in file.pieces(10, 2500)] == [1000, 1000, 490]
    assert b"".join(file.pieces(10, 2500)) == DATA[10:2500]
    assert list(file.pieces(5, 5)) == []


@pytest.mark.skipif(sys.platform == "win32", reason="Windows replaces no file that is open")
def test_a_file_that_is_removed_or_replaced_meanwhile_is_still_read(let_go, tmp_path):
    file, path = let_go
    (tmp_path / "new").write_bytes(b"another")
    (tmp_path / "new").replace(path)
    assert file.whole() == DATA


@pytest.mark.parametrize("content", [DATA[::-1], DATA[:-1]])
def test_a_file_that_is_changed_meanwhile_is_refused(let_go, content):
    file, path = let_go
    path.write_bytes(content)
    os.utime(path, ns=(1, 1))
    with pytest.raises(BvhError, match=r"clip\.bvh: was changed while it was edited"):
        file.whole()


@pytest.mark.parametrize("content", [DATA[::-1], DATA[:-1], DATA + b"1", None])
def test_what_a_file_has_no_more_is_held_on(tmp_path, content):
    path = tmp_path / "clip.bvh"
    if content is not None:
        path.write_bytes(content)
    file = FileBytes(DATA)
    file.let_go(path)
    assert file._data is DATA
    assert file.whole() is DATA
    assert b"".join(file.pieces(3, 99)) == bytes(file.between(3, 99)) == DATA[3:99]


def test_a_copy_such_as_another_process_gets_holds_all_bytes(let_go):
    file, _ = let_go
    assert copy.deepcopy(file)._data == DATA
