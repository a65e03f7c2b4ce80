"""Rows on another timeline are those of resampling, aligning and solving one after the other, to the bit."""

import numpy as np
import pytest
from channels import motion_from_channels

from motionedit.core import rotations as rot
from motionedit.core.compiled import compiled
from motionedit.core.euler import joint_angles
from motionedit.core.skeleton import Skeleton
from motionedit.core.timeline import sampled_rows as room
from motionedit.core.timeline.alignment import Alignment, aligned
from motionedit.core.timeline.resample import resample
from motionedit.core.timeline.sampled_rows import sampled_rows

ALIGNMENT = Alignment(rot.about_axis(1, np.array(0.7)), np.array([3.0, 0.0, -2.0]))
ZXY, XYZ = ("Zrotation", "Xrotation", "Yrotation"), ("Xrotation", "Yrotation", "Zrotation")


def body(*channels):
    """Return a chain of joints of some channels, each with an OFFSET."""
    count = len(channels)
    return Skeleton(tuple("abcdef"[:count]), np.arange(-1, count - 1), np.full((count, 3), 2.0), channels)


# Two orders, a joint that is moved along two axes, one without channels: all that the loops know.
KNOWN = body(("Yposition", "Xposition", "Zposition", *ZXY), XYZ, (), (*ZXY, "Zposition", "Xposition"), ZXY)
# A root that stands still and turns a joint that travels, and joints of fewer axes.
TRAVELS_BELOW = body(ZXY, ("Xposition", "Yposition", "Zposition", *ZXY), XYZ)
FEW_AXES = body(("Xposition", "Yposition", "Zposition", *ZXY), ("Yrotation",), ("Xrotation", "Zrotation"))


def walk(skeleton, *, frames=50, seed=4):
    values = np.cumsum(np.random.default_rng(seed).normal(scale=8.0, size=(frames, skeleton.channel_count)), axis=0)
    return motion_from_channels(skeleton, values, frame_time=0.02), values


def one_by_one(motion, at, *, travel, start):
    sampled = resample(motion, at, frame_time=0.04)
    return joint_angles(aligned(sampled, ALIGNMENT, travel=travel), start=start)


def places(frames):
    """Return frames and parts of them, in and out of order, the ends twice."""
    return np.array([0.0, 0.0, 0.25, 3.0, 3.999, 17.5, 16.5, frames - 1.5, frames - 1.0, frames - 1.0])


@pytest.fixture
def never_one_by_one(monkeypatch):
    def refuse(*_given, **_named):
        raise AssertionError("not in few loops")

    monkeypatch.setattr(room, "joint_angles", refuse)


@pytest.mark.compiled
@pytest.mark.usefixtures("never_one_by_one")
def test_rows_of_a_root_that_travels_are_made_in_few_loops():
    motion, values = walk(KNOWN)
    expected = one_by_one(motion, places(50), travel=0, start=values[0])
    found = sampled_rows(motion, places(50), ALIGNMENT, travel=0, start=values[0])
    np.testing.assert_array_equal(found, expected, strict=True)
    assert np.isfinite(found).all()


@pytest.mark.compiled
@pytest.mark.usefixtures("never_one_by_one")
def test_rows_are_continuous_from_a_row_that_is_wound_up():
    motion, values = walk(KNOWN, frames=400)
    start = values[0] + np.where(np.arange(KNOWN.channel_count) % 2 == 0, 1080.0, -720.0)
    at = np.linspace(0.0, 399.0, 700)
    expected = one_by_one(motion, at, travel=0, start=start)
    np.testing.assert_array_equal(sampled_rows(motion, at, ALIGNMENT, travel=0, start=start), expected)


@pytest.mark.compiled
@pytest.mark.usefixtures("never_one_by_one")
def test_frames_without_a_way_between_them_and_half_a_turn_apart_are_as_one_by_one():
    motion, values = walk(KNOWN)
    values[3:5] = values[2]
    values[17, -3:] = values[18, -3:] + np.array([180.0, 0.0, 0.0])
    motion = motion_from_channels(KNOWN, values, frame_time=0.02)
    expected = one_by_one(motion, places(50), travel=0, start=values[0])
    np.testing.assert_array_equal(sampled_rows(motion, places(50), ALIGNMENT, travel=0, start=values[0]), expected)


def locked():
    """Return a walk in which a joint stays in gimbal lock for some frames, and its values."""
    _, values = walk(KNOWN)
    middle = KNOWN.columns(3, "rotation")[1]
    values[10:20, middle] = 90.0
    return motion_from_channels(KNOWN, values, frame_time=0.02), values


@pytest.mark.parametrize(("skeleton", "travel"), [(TRAVELS_BELOW, 1), (FEW_AXES, 0), (KNOWN, 0)])
def test_other_bodies_get_their_rows_one_by_one(skeleton, travel):
    motion, values = locked() if skeleton is KNOWN else walk(skeleton)
    at = np.linspace(0.0, 49.0, 61)
    expected = one_by_one(motion, at, travel=travel, start=values[0])
    found = sampled_rows(motion, at, ALIGNMENT, travel=travel, start=values[0])
    np.testing.assert_array_equal(found, expected, strict=True)


def test_a_clip_of_one_frame_stays_that_frame():
    motion, values = walk(KNOWN, frames=1)
    found = sampled_rows(motion, np.zeros(3), ALIGNMENT, travel=0, start=values[0])
    np.testing.assert_array_equal(found, one_by_one(motion, np.zeros(3), travel=0, start=values[0]))


@pytest.mark.compiled
def test_buffers_that_do_not_fit_are_errors_and_no_crash():
    kernel = compiled()
    q, at, t, parts = np.zeros((2, 3, 4)), np.array([1]), np.zeros(1), np.zeros((3, 1, 3))
    joints, rows, columns = np.arange(3), np.zeros((1, 9)), np.arange(9)
    unit, origin = np.zeros(4), np.zeros(3)
    sums, seeds = np.zeros((6, 3, 1)), np.zeros((3, 3))
    calls = [
        ("arc_cosines", (q, 3, at, t, np.zeros((1, 3)), np.zeros((1, 3)))),
        ("arc_parts", (t, 3, parts)),
        ("arc_weights", (t, 3, np.zeros((1, 3)), 0.0, parts)),
        ("sampled_turns", (q, 3, at, t, parts, np.zeros((1, 3, 4)))),
        ("sampled_sums", (q, 3, at, t, parts, unit, joints, 2, 0, 1, sums)),
        ("angle_columns", (sums, 1, 2, 0, 1, 9.0, 1.0, seeds, columns, 9, rows)),
        ("place_columns", (np.zeros((2, 1, 3)), 1, at, t, 0, unit, origin, np.array([0, -1, 8]), 9, rows)),
    ]
    for name, given in calls:
        work = getattr(kernel, name)
        work(*given)
        for k, one in enumerate(given):
            for wrong in (np.zeros(2), np.zeros(0)) if isinstance(one, np.ndarray) else ():
                with pytest.raises(ValueError, match=r"fit|bytes|frames|joints|columns"):
                    work(*given[:k], wrong, *given[k + 1 :])
    wrong_numbers = [
        ("sampled_turns", 2, np.array([2])),
        ("sampled_turns", 2, np.array([-1])),
        ("sampled_turns", 1, 0),
        ("sampled_turns", 1, 5),
        ("sampled_sums", 6, np.array([0, 1, 3])),
        ("sampled_sums", 9, 0),
        ("angle_columns", 8, np.arange(1, 10)),
        ("angle_columns", 8, np.arange(-1, 8)),
        ("angle_columns", 4, 3),
        ("place_columns", 7, np.array([0, -2, 8])),
        ("place_columns", 7, np.array([0, 1, 9])),
    ]
    for name, k, wrong in wrong_numbers:
        given = dict(calls)[name]
        with pytest.raises(ValueError, match=r"."):
            getattr(kernel, name)(*given[:k], wrong, *given[k + 1 :])
