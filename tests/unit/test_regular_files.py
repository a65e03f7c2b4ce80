"""Files that are read whole, large ones into room that is made for them."""

import pytest

from motionedit import regular_files
from motionedit.core.compiled import room
from motionedit.regular_files import read_file

LARGE = bytes(range(256)) * (1 << 14) + b"end"


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(LARGE)
    return path


def test_a_large_file_is_read_into_the_room_that_is_made_for_it(file):
    asked = []
    assert read_file(file, room=lambda count: asked.append(count) or room(count)) == LARGE
    assert read_file(file) == LARGE
    assert read_file(file, most=3, room=room) == LARGE[:3]
    assert asked == [len(LARGE)]


@pytest.mark.parametrize("change", [-5, 7])
def test_a_file_that_was_longer_or_shorter_when_it_was_looked_at_is_read_as_it_is(file, change, monkeypatch):
    class Status:
        st_mode, st_size = file.stat().st_mode, len(LARGE) + change

    monkeypatch.setattr(regular_files.os, "fstat", lambda _: Status)
    assert read_file(file, room=room) == LARGE
