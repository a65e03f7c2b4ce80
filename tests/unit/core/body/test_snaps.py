"""Knees and elbows that an edit snaps: what a viewer sees of how their bending changes."""

from types import SimpleNamespace

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.body.bends import Bend
from motionedit.core.body.snaps import SNAP, pace_changes, snaps

AXIS, DOWN = np.array([1.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0])


def bend_of(angles):
    return Bend(1, AXIS, np.zeros(len(angles), dtype=np.bool_), DOWN, DOWN, angles, (angles.min(), angles.max()))


def motion_of(angles, frame_time):
    q = np.stack((np.tile(rot.IDENTITY, (len(angles), 1)), rot.exp(angles[:, None] * AXIS)), axis=1)
    return SimpleNamespace(rotations=q, frame_time=frame_time)


def bouncing(frame_time, pace):
    """Return angles that come to 10 degrees at 1 s and go back, both at a pace, degrees a second."""
    seconds = np.arange(0.0, 2.0 + 0.5 * frame_time, frame_time)
    return np.radians(10.0 + pace * np.abs(seconds - 1.0))


def found(angles, own, *, frame_time, first=0, touched=(True, True)):
    bends = [bend_of(own[first:])]
    return snaps(motion_of(angles, frame_time), bends, first=first, touched=np.array(touched))


@pytest.mark.parametrize("rate", [60.0, 120.0, 240.0])
def test_a_bounce_counts_by_how_the_pace_changes_at_any_rate(rate):
    changes = pace_changes(bouncing(1.0 / rate, 120.0), 1.0 / rate)
    assert int(np.argmax(changes)) == rate
    assert changes.max() == pytest.approx(2.0 * 120.0 / 60.0)


def test_a_knee_that_bounces_snaps_and_one_that_slows_down_does_not():
    calm = np.full(121, 0.3)
    (snap,) = found(bouncing(1.0 / 60.0, 120.0), calm, frame_time=1.0 / 60.0)
    assert (snap.joint, snap.frame, snap.most) == (1, 60, SNAP)
    assert snap.degrees == pytest.approx(4.0)
    slow = 0.3 + 0.3 * np.cos(np.linspace(0.0, 8.0, 121))
    assert found(slow, calm, frame_time=1.0 / 60.0) == []
    assert found(bouncing(1.0 / 60.0, 89.0), calm, frame_time=1.0 / 60.0) == []


def test_what_the_input_does_by_itself_and_what_no_edit_turned_is_not_told():
    own = bouncing(1.0 / 60.0, 100.0)
    assert found(bouncing(1.0 / 60.0, 195.0), own, frame_time=1.0 / 60.0) == []
    assert len(found(bouncing(1.0 / 60.0, 205.0), own, frame_time=1.0 / 60.0)) == 1
    assert found(bouncing(1.0 / 60.0, 205.0), own, frame_time=1.0 / 60.0, touched=(True, False)) == []


def test_a_rest_pose_is_left_out_and_short_clips_have_no_pace():
    angles = np.full(40, 0.3)
    angles[0] = 2.0
    assert found(angles, angles, frame_time=1.0 / 60.0, first=1) == []
    assert not pace_changes(np.array([0.0, 1.0, 0.0, 1.0]), 1.0 / 120.0).any()
