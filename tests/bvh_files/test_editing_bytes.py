"""An edit replaces the numbers it touched inside the file's own bytes; everything else stays as it was."""

import re
from dataclasses import replace

import numpy as np
import pytest
from small_clip import HIERARCHY, TEXT, with_text

from motionedit.core import rotations as rot
from motionedit.core.bvh import edited_bytes, edited_pieces, parse_clip, splice
from motionedit.errors import BvhError

NUMBER = re.compile(rb"[-+.0-9eE]+")


def read(data, **options):
    return parse_clip(data, label="walk.bvh", **options)


def frames(clip, joints=2, *, on=()):
    mask = np.zeros((len(clip.motion), joints), dtype=bool)
    for cell in on:
        mask[cell] = True
    return mask


def turned(clip, degrees=1.0):
    """Return the clip's motion with every joint turned a little about x."""
    turn = rot.about_axis(0, np.radians(degrees))
    return replace(clip.motion, rotations=rot.multiply(turn, clip.motion.rotations))


def test_nothing_touched_gives_the_same_bytes_even_where_the_row_count_is_wrong():
    for data in (TEXT.encode(), with_text("Frames: 3", "Frames: 7")):
        clip = read(data, lenient=True)
        nothing = frames(clip)
        assert edited_bytes(clip, turned(clip), touched=nothing, moved=nothing[:, :1]) == data


def test_only_the_touched_values_change_their_text():
    clip = read(TEXT.encode())
    written = edited_bytes(clip, clip.motion, touched=frames(clip, on=[(1, 1)]))
    assert written == with_text("11 -21 31 4 5 6", "11 -21 31 4.000000 5.000000 6.000000")


def test_moved_joints_change_their_position_channels_alone():
    clip = read(TEXT.encode())
    moved = replace(clip.motion, translations=clip.motion.translations + 0.25)
    written = edited_bytes(clip, moved, touched=frames(clip), moved=frames(clip, 1, on=[(0, 0)]))
    assert written == with_text("\n1 2 3 10.5", "\n1.250000 2.250000 3.250000 10.5")


ODD = (
    "MOTION\r\nFrames: 3\r\nFrame Time: 0.04\n"
    "\t1 2  3\t10.5 -20.25 30 4 5 6   \n\n1.5 2 3 11 -21 31 4 5 6\r"
    "  2 2 3 12" + " " * 30 + "-22.125 32 4 \v5 6\t"
)


@pytest.mark.parametrize(
    "data", [TEXT.encode(), b"\xef\xbb\xbf" + (HIERARCHY + ODD).encode(), (HIERARCHY + ODD).encode()]
)
@pytest.mark.parametrize("joints", [(0,), (1,), (0, 1)])
def test_gaps_endings_and_everything_that_is_no_touched_number_stay(data, joints):
    clip = read(data)
    touched = frames(clip, on=[(slice(None), joint) for joint in joints])
    written = edited_bytes(clip, turned(clip), touched=touched)
    assert NUMBER.sub(b"#", written) == NUMBER.sub(b"#", data)
    again = read(written)
    for joint in range(2):
        wanted = turned(clip) if joint in joints else clip.motion
        off = rot.angle_between(again.motion.rotations[:, joint], wanted.rotations[:, joint])
        assert np.degrees(off).max() < 2e-6
    old = [word for joint in {0, 1} - set(joints) for word in data.split()[-9 + (3, 6)[joint] :][:3]]
    assert all(word in written.split() for word in old)


def test_decimals_are_the_most_among_the_rows_and_at_least_six():
    clip = read(TEXT.encode())
    assert b" 4.000000 " in edited_bytes(clip, clip.motion, touched=frames(clip, on=[(0, 1)]))
    for longest, decimals in (("-22.1234567890", 10), ("-22e-9", 9), ("2.5E-3", 6), ("1." + "0" * 40, 17)):
        clip = read(with_text("-22.125", longest))
        written = edited_bytes(clip, clip.motion, touched=frames(clip, on=[(0, 1)]))
        # The last of 17 decimals is below the rounding of an angle there and back.
        text = re.search(rb" ((?:4\.0|3\.9)\d*) ", written)[1]
        assert len(text) == len("4.") + decimals
        assert abs(float(text) - 4.0) < 1e-14


def test_numbers_are_never_in_science_and_never_minus_zero():
    clip = read(with_text("4 5 6", "-1e-9 -0.0 1e-7"))
    written = edited_bytes(clip, clip.motion, touched=frames(clip, on=[(0, 1)]))
    assert b" -0.000000001 0.000000000 0.000000100\n" in written
    clip = read(with_text("1 2 3", "-1 2 3"))
    tiny = replace(clip.motion, translations=np.full((3, 1, 3), -4e-7))
    written = edited_bytes(clip, tiny, touched=frames(clip), moved=frames(clip, 1, on=[(0, 0)]))
    assert b"\n0.000000 0.000000 0.000000 10.5" in written


def test_huge_values_are_written_out():
    clip = read(TEXT.encode())
    far = replace(clip.motion, translations=np.full((3, 1, 3), -1.5e20))
    written = edited_bytes(clip, far, touched=frames(clip), moved=frames(clip, 1, on=[(0, 0)]))
    assert b"\n-150000000000000000000.000000 " in written
    np.testing.assert_array_equal(read(written).motion.translations[0, 0], -1.5e20)


def test_a_wrong_frame_count_is_put_right_where_something_changed():
    clip = read(with_text("Frames: 3", "Frames:  1000"), lenient=True)
    written = edited_bytes(clip, clip.motion, touched=frames(clip, on=[(0, 1)]))
    assert b"Frames:  3\n" in written
    assert read(written).warnings == ()


@pytest.mark.parametrize("frame", [0, 1])
def test_a_cut_off_row_goes_where_something_changed(frame):
    clip = read(TEXT[: TEXT.index("-22.125")].replace("\n2 2", "\n  2 2").encode(), lenient=True)
    written = edited_bytes(clip, clip.motion, touched=frames(clip, on=[(frame, 1)]))
    assert written.endswith((b"4 5 6\n", b"6.000000\n"))
    assert len(read(written).motion) == 2


def test_values_that_are_not_finite_are_not_written():
    clip = read(TEXT.encode())
    broken = replace(clip.motion, translations=np.full((3, 1, 3), np.nan))
    with pytest.raises(BvhError, match=r"^walk\.bvh: the edit gives values at frame 2 that are not finite"):
        edited_bytes(clip, broken, touched=frames(clip), moved=frames(clip, 1, on=[(2, 0)]))


def test_long_words_near_the_header_keep_their_text():
    long = "0" * 900 + "4"
    clip = read(with_text("\n1 2 3", f"\n1 {long} 3"))
    written = edited_bytes(clip, clip.motion, touched=frames(clip, on=[(0, 1)]))
    assert f"\n1 {long} 3 10.5 -20.25 30 4.000000 ".encode() in written


def test_a_long_clip_is_edited_in_segments_to_the_same_bytes(monkeypatch):
    rng = np.random.default_rng(5)
    rows = np.cumsum(rng.normal(scale=12.0, size=(400, 9)), axis=0)
    text = "\n".join(" ".join(f"{value:.6f}" for value in row) for row in rows)
    data = (HIERARCHY + f"MOTION\nFrames: 400\nFrame Time: 0.01\n{text}\n").encode()
    clip = read(data)
    touched = np.ones((400, 2), dtype=bool)
    touched[:30, 0] = touched[390:, 1] = touched[200:210] = False
    whole = edited_bytes(clip, turned(clip), touched=touched, moved=touched[:, :1])
    monkeypatch.setattr(splice, "SEGMENT", 64)
    assert edited_bytes(clip, turned(clip), touched=touched, moved=touched[:, :1]) == whole
    assert whole != data


def test_an_edit_in_pieces_is_the_edit_and_no_piece_is_long(monkeypatch):
    monkeypatch.setattr(splice, "BLOCK_BYTES", 300)
    monkeypatch.setattr(splice, "SEGMENT", 40)
    row = TEXT.encode().splitlines()[-1]
    data = TEXT.encode().replace(b"Frames: 3", b"Frames: 203") + b"\n".join([row] * 200) + b"\n"
    clip = read(data)
    assert len(clip.motion) == 203
    touched = frames(clip, on=[(frame, 1) for frame in range(3, 203)])
    pieces = list(edited_pieces(clip, turned(clip), touched=touched))
    assert b"".join(pieces) == edited_bytes(clip, turned(clip), touched=touched)
    assert len(pieces) > 20
    assert max(map(len, pieces)) < 600


def test_an_angle_beyond_sense_in_one_frame_changes_no_other():
    data = TEXT.splitlines()
    row = next(i for i, line in enumerate(data) if line.startswith("Frame Time")) + 1
    words = data[row].split()
    words[4] = "3e50"
    clip = read("\n".join([*data[:row], " ".join(words), *data[row + 1 :], ""]).encode())
    edit = turned(clip)
    after = read(edited_bytes(clip, edit, touched=frames(clip, on=[1, 2]), moved=frames(clip)[:, :1]))
    assert np.abs(after.values[1:]).max() < 1000.0
    np.testing.assert_allclose(rot.angle_between(after.motion.rotations[1:], edit.rotations[1:]), 0.0, atol=1e-5)
