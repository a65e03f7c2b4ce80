"""The golf swings' generator: styles and balls vary apart, pairs differ by what is asked, in any number."""

from dataclasses import replace

import numpy as np
import pytest
from places import CLUB_HEAD, club_head

from data.generator.golf import BALL_HEIGHT, SwingModel, make_swing, with_ball
from data.generator.measures import Track, swing_measures
from data.generator.players import BALL, GROUPS, random_swing, random_swings, shipped_swings
from data.generator.styles import KEYS, STYLES
from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.slerp import slerp


def accelerations(motion):
    """Return the angular accelerations of all joints, rad/s^2, shape (F - 2, J)."""
    steps = rot.log(rot.multiply(rot.conjugate(motion.rotations[:-1]), motion.rotations[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=-1) / motion.frame_time**2


# -- the files -----------------------------------------------------------------------------------------------------


def test_durations_balls_and_styles_vary_apart_from_each_other():
    swings = shipped_swings()
    frames = np.array([round(s.timing.end * 25.0) + 1 for s in swings])
    balls = np.array([s.ball for s in swings])
    assert frames.min() >= 118
    assert frames.max() <= 146
    assert np.ptp(frames) >= 20
    assert 130 <= frames.mean() <= 134
    assert (balls.std(axis=0) > 4.5).all()
    columns = np.column_stack((balls, frames, [s.timing.hit / s.timing.end for s in swings]))
    styles = np.eye(3)[list(GROUPS)]
    together = np.corrcoef(np.column_stack((columns, styles)).T)
    assert np.abs(together[:4, :4] - np.eye(4)).max() < 0.45
    assert np.abs(together[:4, 4:]).max() < 0.45


def test_the_styles_form_three_groups_that_can_be_told_apart(swings, hits):
    keys = ("shoulders turned, top", "hands over shoulders' height, top", "hips turned, top")
    rows = np.array([[swing_measures(m, hit=hits[n])[k] for k in keys] for n, m in swings.items()])
    middles = np.array([rows[np.array(GROUPS) == g].mean(axis=0) for g in range(3)])
    nearest = np.linalg.norm(rows[:, None] - middles, axis=-1).argmin(axis=1)
    assert nearest.tolist() == list(GROUPS)


def components(motions, hits):
    """Return the database's motion vectors (M, D) on one timeline, and what turns a row back into a club head."""
    frames = round(np.mean([len(m) - 1 for m in motions])) + 1
    key = round(np.mean([h / (len(m) - 1) for m, h in zip(motions, hits, strict=True)]) * (frames - 1))
    rotations, roots = [], []
    for motion, hit in zip(motions, hits, strict=True):
        at = np.interp(np.arange(frames), [0, key, frames - 1], [0, hit, len(motion) - 1])
        i = np.minimum(at.astype(int), len(motion) - 2)
        u = np.repeat((at - i)[:, None], len(motion.skeleton), axis=1)
        rotations.append(slerp(motion.rotations[i], motion.rotations[i + 1], u))
        root = motion.translations[:, 0]
        roots.append(root[i] * (1.0 - u[:, :1]) + root[i + 1] * u[:, :1])
    q = np.array(rotations)
    every = q.reshape(-1, *q.shape[2:])
    reference = rot.mean_of_products(np.einsum("fja,fjb->jab", every, every))
    v = rot.log(rot.multiply(rot.conjugate(reference), q)).reshape(len(motions), frames, -1)
    assert np.abs(np.diff(v, axis=1)).max() < 2.0, "a track that winds round needs unwrapping"
    rows = np.concatenate((np.array(roots) / 100.0, v), axis=2)

    def head(row):
        pose = row.reshape(frames, -1)[key]
        turned = rot.multiply(reference, rot.exp(pose[3:].reshape(-1, 3)))[None]
        motion = replace(motions[0], rotations=turned, translations=100.0 * pose[None, None, :3])
        return club_head(motion, kinematics.forward(motion))[0]

    return rows.reshape(len(motions), -1), head


def test_components_past_the_sixth_carry_a_percent_each_and_nine_swings_foretell_the_tenth(swings, hits):
    rows, head = components(list(swings.values()), list(hits.values()))
    spread = np.linalg.svd(rows - rows.mean(axis=0), compute_uv=False) ** 2
    assert (spread[6:9] / spread.sum() > 0.01).all()
    assert spread[:2].sum() / spread.sum() > 0.6
    errors = []
    for i, row in enumerate(rows):
        others = np.delete(rows, i, axis=0)
        mean = others.mean(axis=0)
        basis = np.linalg.svd(others - mean, full_matrices=False)[2][:8]
        errors.append(np.linalg.norm(head(mean + basis.T @ (basis @ (row - mean))) - head(row)))
    assert np.mean(errors) < 2.5


@pytest.mark.parametrize("step", [(3.0, 0.0), (0.0, 3.0)])
def test_another_ball_moves_the_whole_swing_smoothly_and_nearly_linearly(step):
    swing = shipped_swings(noise=0.0)[0]
    balls = [tuple(np.array(swing.ball) + side * np.array(step)) for side in (-1.0, 0.0, 1.0)]
    rows = [make_swing(with_ball(swing, ball)).rotations for ball in balls]
    there = rot.log(rot.multiply(rot.conjugate(rows[1]), rows[2]))
    back = rot.log(rot.multiply(rot.conjugate(rows[1]), rows[0]))
    before = slice(0, round(swing.timing.hit * 25.0))
    assert np.linalg.norm(there[before], axis=(1, 2)).min() > 0.05
    assert np.linalg.norm(there + back) < 0.35 * np.linalg.norm(there - back)


def test_a_pair_differs_by_the_ball_alone():
    swing = random_swing(np.random.default_rng(11))
    other = with_ball(swing, (swing.ball[0] + 10.0, swing.ball[1]))
    assert replace(other, ball=swing.ball, person=swing.person).timing == swing.timing
    a, b = make_swing(swing), make_swing(other)
    hit = round(swing.timing.hit * 25.0)
    moved = club_head(b, kinematics.forward(b))[hit] - club_head(a, kinematics.forward(a))[hit]
    assert np.allclose(moved, [10.0, 0.0, 0.0], atol=1e-3)
    assert np.array_equal(make_swing(with_ball(other, swing.ball)).rotations, a.rotations)


def test_what_is_given_changes_nothing_else_that_is_drawn():
    free = random_swing(np.random.default_rng(4))
    held = random_swing(np.random.default_rng(4), ball=BALL)
    assert held.ball == BALL
    assert held.timing == free.timing
    assert held.style == free.style
    assert np.array_equal(held.person, free.person)


def test_swings_made_on_the_fly_are_sound():
    for swing in random_swings(np.random.default_rng(8), 24):
        motion = make_swing(swing)
        poses = kinematics.forward(motion)
        head = club_head(motion, poses)
        hit = round(swing.timing.hit * 25.0)
        assert np.linalg.norm(head[hit] - [swing.ball[0], BALL_HEIGHT, swing.ball[1]]) < 1e-3
        assert head[:, 1].min() > 0.5
        # More than a radian between frames would count as a defect of a capture.
        assert rot.angle_between(motion.rotations[:-1], motion.rotations[1:]).max() < 0.95
        track = Track(motion)
        assert min(track.knee(s).min() for s in ("Left", "Right")) > 5.0
        assert min(track.elbow(s).min() for s in ("Left", "Right")) > 8.0


def test_a_hit_may_fall_between_frames():
    swing = random_swing(np.random.default_rng(3), on_frame=None)
    fraction = swing.timing.hit * 25.0 % 1.0
    assert 0.01 < fraction < 0.99
    poses = SwingModel(swing).figure(np.array([swing.timing.hit]))
    head = poses.positions["Club"] + rot.rotate(poses.rotations["Club"], CLUB_HEAD)
    assert np.allclose(head[0], [swing.ball[0], BALL_HEIGHT, swing.ball[1]], atol=1e-3)


def test_a_ball_out_of_reach_is_refused():
    with pytest.raises(ValueError, match="no swing reaches"):
        make_swing(with_ball(shipped_swings()[0], (400.0, 64.0)))


def test_without_noise_a_faster_rate_samples_the_same_swing():
    swing = shipped_swings(noise=0.0)[2]
    slow, fast = make_swing(swing), make_swing(swing, rate=100.0)
    assert np.allclose(slow.rotations, fast.rotations[::4], atol=1e-12)
    assert accelerations(fast).max() < 1000.0


def test_every_style_says_a_value_for_every_key():
    assert {len(values) for style in STYLES for values in style.values()} == {len(KEYS)}


# -- walk and kick -------------------------------------------------------------------------------------------------
