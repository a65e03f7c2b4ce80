"""The walk and the kick that ship: a walker's and a kicker's measures, feet that stand, no jerks."""

import numpy as np
import pytest
from places import joint

from data.generator.kick import make_kick
from data.generator.measures import kick_measures, walk_measures
from data.generator.walk import make_walk
from motionedit.core import kinematics
from motionedit.core import rotations as rot


def sliding(path):
    return np.linalg.norm(path - path[0], axis=-1).max()


def accelerations(motion):
    """Return the angular accelerations of all joints, rad/s^2, shape (F - 2, J)."""
    steps = rot.log(rot.multiply(rot.conjugate(motion.rotations[:-1]), motion.rotations[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=-1) / motion.frame_time**2


# -- the files -----------------------------------------------------------------------------------------------------


def test_walk_and_kick_have_31_joints_and_96_channels(walk, kick):
    for motion in (walk, kick):
        assert (len(motion.skeleton), motion.skeleton.channel_count) == (31, 96)
    assert (len(walk), walk.frame_rate) == (145, pytest.approx(24.0))


def test_the_walk_keeps_a_walkers_measures(walk):
    m = walk_measures(walk)
    assert 95.0 < m["steps a minute"] < 105.0
    assert 55.0 < m["step length, cm"] < 65.0
    assert 65.0 < m["knee, most (swing)"] < 82.0
    assert 2.0 < m["hips up and down, cm"] < 4.0
    assert m["left arm with right thigh (correlation)"] > 0.7


def test_every_foot_stands_still_between_landing_and_lifting(walk):
    poses = kinematics.forward(walk)
    for side in ("Left", "Right"):
        path = joint(walk, poses, f"{side}ToeBase")
        still = np.linalg.norm(np.diff(path, axis=0), axis=-1) < 0.01
        runs = np.diff(np.flatnonzero(np.diff(np.concatenate(([False], still, [False])))))[::2]
        inner = runs[1:-1]
        assert len(inner) >= 3
        # Half of a stride of 28.8 frames, between the roll over the heel and the toes' leaving.
        assert inner.min() >= 13
        assert path[:, 1].min() > 1.9


def test_walk_and_kick_move_without_jerks():
    assert accelerations(make_walk(frames=577, rate=96.0)).max() < 400.0
    assert accelerations(make_kick(frames=330, rate=120.0)).max() < 600.0


def test_the_supporting_foot_of_the_kick_stays_planted(kick):
    poses = kinematics.forward(kick)
    for point in ("LeftFoot", "LeftToeBase"):
        assert sliding(joint(kick, poses, point)) < 0.05
    assert joint(kick, poses, "RightToeBase")[:, 1].min() > 1.5


def test_the_kick_folds_snaps_and_folds_again(kick):
    m = kick_measures(kick, side="Right")
    assert m["knee folded before"] > 100.0
    assert m["knee at the hit"] < 15.0
    assert m["knee folded again"] > 90.0
    assert m["folded to hit, s"] < 0.3
    assert m["fastest foot, cm/s"] > 600.0
