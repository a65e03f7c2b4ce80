"""A clip with another motion: what differs is written anew, all other bytes stay, and nothing is lost silently."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest
from small_clip import HIERARCHY, ROWS, TEXT, with_text

from motionedit.core import rotations as rot
from motionedit.core.bvh import other_motion, parse_clip
from motionedit.core.bvh import read as reading
from motionedit.errors import BvhError, ClipError


@pytest.fixture
def clip():
    return parse_clip(TEXT.encode(), label="walk.bvh")


def moved(motion, frame, by):
    translations = motion.translations.copy()
    translations[frame] += by
    return replace(motion, translations=translations)


def turned(motion, frame, joint, degrees=1.0):
    rotations = np.array(motion.rotations)
    rotations[frame, joint] = rot.multiply(rot.about_axis(0, np.radians(degrees)), rotations[frame, joint])
    return replace(motion, rotations=rotations)


def test_only_the_values_that_differ_change_their_text(clip):
    assert clip.with_motion(moved(clip.motion, 1, 0.25)).text.data == with_text(
        "1.5 2 3 11 -21", "1.750000 2.250000 3.250000 11 -21"
    )
    other = clip.with_motion(turned(clip.motion, 2, 1))
    assert other.text.data.startswith(with_text("2 2 3 12 -22.125 32 4 5 6\n", "2 2 3 12 -22.125 32 "))
    off = rot.angle_between(other.motion.rotations, turned(clip.motion, 2, 1).rotations)
    assert np.degrees(off).max() < 2e-6


def test_label_and_source_stay_and_the_values_are_those_of_the_new_text(clip, tmp_path):
    placed = replace(clip, source=tmp_path / "walk.bvh")
    other = placed.with_motion(moved(clip.motion, 0, 1.0))
    assert (other.label, other.source) == ("walk.bvh", tmp_path / "walk.bvh")
    assert other.values[0, :3].tolist() == [2.0, 3.0, 4.0]
    assert clip.values[0, :3].tolist() == [1.0, 2.0, 3.0]


def test_the_same_motion_is_the_same_clip_however_it_is_spelt(clip):
    negated = replace(clip.motion, rotations=-clip.motion.rotations)
    lists = replace(clip.motion, rotations=clip.motion.rotations.tolist())
    for motion in (clip.motion, copy.deepcopy(clip.motion)):
        assert clip.with_motion(motion).text is clip.text
    for motion in (negated, lists):
        assert clip.with_motion(motion).text is clip.text
        assert clip.with_motion(motion).motion is clip.motion


def test_a_clip_that_is_as_it_was_read_is_neither_read_again_nor_compared(clip, monkeypatch):
    monkeypatch.setattr(reading, "parse_clip", None)
    monkeypatch.setattr(other_motion, "bytes_with_motion", None)
    assert clip.with_motion(clip.motion) is clip


def test_a_motion_that_was_put_in_without_its_text_is_told_from_it(clip):
    stale = replace(clip, motion=moved(clip.motion, 1, 0.25))
    assert b"1.750000 2.250000 3.250000 11 -21" in stale.with_motion(stale.motion).text.data
    assert stale.with_motion(clip.motion).motion is clip.motion


@pytest.mark.parametrize("again", [copy.deepcopy, lambda clip: pickle.loads(pickle.dumps(clip))])  # noqa: S301
def test_a_copy_whose_arrays_were_changed_in_place_is_told_from_its_text(clip, again):
    copied = again(clip)
    assert copied.with_motion(copied.motion) is copied
    copied.motion.translations[1] += 0.25
    assert b"1.750000 2.250000 3.250000 11 -21" in copied.with_motion(copied.motion).text.data


def test_a_frame_time_alone_leaves_all_rows(clip):
    assert clip.with_motion(replace(clip.motion, frame_time=0.02)).text.data == with_text("0.04", "0.02")
    both = clip.with_motion(replace(moved(clip.motion, 1, 0.25), frame_time=0.02))
    assert both.motion.frame_time == 0.02
    assert b"1.750000 2.250000 3.250000 11 -21" in both.text.data


@pytest.mark.parametrize("frames", [1, 2, 5])
def test_any_number_of_frames_takes_the_place_of_the_rows(clip, frames):
    picked = np.arange(frames) % 3
    motion = clip.motion
    other = clip.with_motion(
        replace(motion, rotations=motion.rotations[picked], translations=motion.translations[picked])
    )
    assert other.text.data.startswith(f"{HIERARCHY}MOTION\nFrames: {frames}\n".encode())
    assert other.values == pytest.approx(clip.values[picked], abs=1e-6)


def test_a_clip_that_leniency_accepted_is_put_right_where_it_changes():
    clip = parse_clip(with_text("Frames: 3", "Frames: 7"), label="walk.bvh", lenient=True)
    assert clip.with_motion(clip.motion) is clip
    assert b"Frames: 3\n" in clip.with_motion(moved(clip.motion, 1, 0.25)).text.data


def test_what_the_file_cannot_hold_is_refused():
    joints = HIERARCHY.replace("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 1 Yposition")
    rows = "".join(f"{' '.join(line.split()[:7])}\n" for line in ROWS.splitlines())
    clip = parse_clip(f"{joints}MOTION\nFrames: 3\nFrame Time: 0.04\n{rows}".encode(), label="walk.bvh")
    motion = clip.motion
    refused = {
        "shape (2, 2, 4), not (2, 4)": replace(motion, rotations=motion.rotations[:2, 0]),
        "rotations must have shape (1, 2, 4), not (0, 2, 4)": replace(motion, rotations=motion.rotations[:0]),
        "translations must have shape (2, 2, 3), not (3, 2, 3)": replace(motion, rotations=motion.rotations[:2]),
        "frame_time must be more than 0 s, not nan": replace(motion, frame_time=np.nan),
        "frame_time must be more than 0 s, not 0.0": replace(motion, frame_time=0.0),
        "'Spine', which has no rotation channels": turned(motion, 1, 1),
        "moves 'Spine' along an axis without a position channel": moved(motion, 1, [1.0, 0.0, 0.0]),
        "another skeleton": replace(motion, skeleton=replace(motion.skeleton, offsets=2.0 * motion.skeleton.offsets)),
    }
    for words, other in refused.items():
        with pytest.raises(ClipError) as caught:
            clip.with_motion(other)
        assert words in str(caught.value)
        assert str(caught.value).startswith("walk.bvh: its motion")
    with pytest.raises(BvhError, match="frame 1 that are not finite"):
        clip.with_motion(moved(motion, 1, [0.0, np.nan, 0.0]))
    assert clip.with_motion(moved(motion, 1, [0.0, 1.0, 0.0])).values[1, 6] == clip.values[1, 6] + 1.0
