"""The clips that ship: the generator writes their very bytes, and they move as golfers, walkers and kickers do."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from data.generator.compare import comparison
from data.generator.files import shipped_files
from data.generator.golf import BALL_HEIGHT, SwingModel, make_swing, with_ball
from data.generator.grip import IN_HAND, UP_SHAFT
from data.generator.kick import make_kick
from data.generator.measures import Track, kick_measures, swing_measures, walk_measures
from data.generator.players import BALL, GROUPS, random_swing, random_swings, shipped_swings
from data.generator.styles import KEYS, STYLES
from data.generator.walk import make_walk
from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.bvh import read_clip

CLUB_HEAD = np.array([0.0, -92.0, 0.0])


@pytest.fixture(scope="module")
def folder(pytestconfig):
    return pytestconfig.rootpath / "data"


@pytest.fixture(scope="module")
def hits(folder):
    rows = (folder / "golf" / "events.csv").read_text().splitlines()
    assert rows[0] == "clip,frame"
    return {name: int(frame) for name, frame in (row.split(",") for row in rows[1:])}


@pytest.fixture(scope="module")
def balls(folder):
    rows = [row.split("\t") for row in (folder / "golf" / "balls.tsv").read_text().splitlines()[1:]]
    return {row[0]: np.array(row[2:], dtype=float) for row in rows}


@pytest.fixture(scope="module")
def swings(folder):
    return {path.stem: read_clip(path).motion for path in sorted((folder / "golf").glob("*.bvh"))}


@pytest.fixture(scope="module")
def walk(folder):
    return read_clip(folder / "walk.bvh").motion


@pytest.fixture(scope="module")
def kick(folder):
    return read_clip(folder / "kick.bvh").motion


def joint(motion, poses, name):
    return poses.positions[:, motion.skeleton.names.index(name)]


def club_head(motion, poses):
    club = motion.skeleton.names.index("Club")
    return kinematics.effector_positions(poses, kinematics.Effector(club, CLUB_HEAD))


def sliding(path):
    return np.linalg.norm(path - path[0], axis=-1).max()


def accelerations(motion):
    """Return the angular accelerations of all joints, rad/s^2, shape (F - 2, J)."""
    steps = rot.log(rot.multiply(rot.conjugate(motion.rotations[:-1]), motion.rotations[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=-1) / motion.frame_time**2


# -- the files -----------------------------------------------------------------------------------------------------


def test_the_generator_writes_the_bytes_that_ship(folder):
    files = dict(shipped_files())
    assert {str(p.relative_to(folder)) for p in folder.rglob("*.bvh")} == {n for n in files if n.endswith(".bvh")}
    for name, content in files.items():
        assert (folder / name).read_bytes() == content, name


def test_no_clip_is_larger_than_200_kilobytes(folder):
    assert max(path.stat().st_size for path in folder.rglob("*.bvh")) < 200_000


def test_a_golfer_has_30_joints_and_93_channels_and_the_club_comes_last(swings):
    for motion in swings.values():
        skeleton = motion.skeleton
        assert (len(skeleton), skeleton.channel_count, skeleton.names[-1]) == (30, 93, "Club")
        assert skeleton.names[skeleton.parents[-1]] == "RightHand"
        assert [e.offset.tolist() for e in skeleton.end_sites if e.joint == 29] == [CLUB_HEAD.tolist()]
        assert motion.frame_rate == 25.0


def test_walk_and_kick_have_31_joints_and_96_channels(walk, kick):
    for motion in (walk, kick):
        assert (len(motion.skeleton), motion.skeleton.channel_count) == (31, 96)
    assert (len(walk), walk.frame_rate) == (145, pytest.approx(24.0))


def test_angles_are_continuous_and_no_joint_comes_near_gimbal_lock(folder):
    for path in folder.rglob("*.bvh"):
        values = read_clip(path).values[:, 3:]
        assert np.abs(np.diff(values, axis=0)).max() < 60.0, path
        assert np.abs(values[:, 1::3]).max() < 86.0, path


# -- golf ----------------------------------------------------------------------------------------------------------


def test_the_club_meets_the_ball_at_the_hit(swings, hits, balls):
    for name, motion in swings.items():
        head = club_head(motion, kinematics.forward(motion))
        assert np.linalg.norm(head[hits[name]] - balls[name]) < 1e-3
        assert balls[name][1] == BALL_HEIGHT


def test_the_hit_is_the_lowest_point_of_the_second_half_and_the_address_is_lower(swings, hits):
    for name, motion in swings.items():
        height = club_head(motion, kinematics.forward(motion))[:, 1]
        half = len(motion) // 2
        assert half + np.argmin(height[half:]) == hits[name]
        assert np.argmin(height) < half
        assert height.min() > 0.5


def test_both_hands_hold_the_club_all_the_time(swings):
    for motion in swings.values():
        poses = kinematics.forward(motion)
        names = motion.skeleton.names
        club = names.index("Club")
        for side, on_club in (("Left", UP_SHAFT), ("Right", np.zeros(3))):
            hand = kinematics.Effector(names.index(f"{side}Hand"), IN_HAND[side])
            held = kinematics.effector_positions(poses, kinematics.Effector(club, on_club))
            assert np.abs(kinematics.effector_positions(poses, hand) - held).max() < 1e-3


def test_the_feet_stay_planted_and_the_trailing_heel_rises_after_the_hit_about_its_toe(swings, hits):
    for name, motion in swings.items():
        poses = kinematics.forward(motion)
        for point in ("LeftFoot", "LeftToeBase", "RightToeBase"):
            assert sliding(joint(motion, poses, point)) < 0.05
        heel = joint(motion, poses, "RightFoot")
        assert sliding(heel[: hits[name] + 1]) < 0.05
        assert heel[-1, 1] - heel[0, 1] > 5.0


def test_the_feet_stand_alike_in_all_swings(swings):
    stands = [joint(m, kinematics.forward(m), "RightToeBase")[0] for m in swings.values()]
    assert np.ptp(stands, axis=0).max() < 0.01


def test_swings_keep_a_golfers_measures(swings, hits):
    for name, motion in swings.items():
        m = swing_measures(motion, hit=hits[name])
        assert 1.5 < m["backswing / downswing"] < 2.5
        assert 250.0 < m["fastest hands, cm/s"] < 450.0
        assert m["shoulders turned, top"] < m["hips turned, top"] - 30.0
        assert m["hips lead shoulders at the hit"] > 15.0
        assert m["hips turned, finish"] > 60.0
        assert m["shoulders turned, finish"] > 105.0
        assert m["hips toward target, finish"] > 10.0
        assert m["head moved until the hit, most"] < 9.0
        assert m["left elbow, hit"] < 25.0


def test_the_head_looks_at_the_ball_until_the_hit(swings, hits, balls):
    for name, motion in swings.items():
        poses = kinematics.forward(motion)
        head = motion.skeleton.names.index("Head")
        gaze = rot.rotate(poses.rotations[:, head], np.array([0.0, 0.0, 1.0]))
        toward = balls[name] - poses.positions[:, head] - np.array([0.0, 8.0, 0.0])
        cosine = np.sum(gaze * toward, axis=-1) / np.linalg.norm(toward, axis=-1)
        assert np.degrees(np.arccos(cosine[: hits[name] + 1])).max() < 40.0
        assert gaze[-1, 0] > 0.8


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
        rotations.append(rot.slerp(motion.rotations[i], motion.rotations[i + 1], u))
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


def test_knees_and_elbows_are_hinges(swings, walk, kick):
    for motion in (*swings.values(), walk, kick):
        for name in ("LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"):
            v = rot.log(motion.rotations[:, motion.skeleton.names.index(name)])
            energy = np.linalg.eigvalsh(v.T @ v)
            assert energy[:2].sum() / energy.sum() < 1e-6


# -- the README ----------------------------------------------------------------------------------------------------


def test_the_readme_names_every_ball(folder, balls):
    text = (folder / "README.md").read_text()
    for name, ball in balls.items():
        assert f"| {name} |" in text
        assert ", ".join(f"{value:.1f}" for value in ball) in text


def test_the_readmes_code_runs_and_its_table_is_what_the_command_prints(folder):
    text = (folder / "README.md").read_text()
    code = text.split("```python\n")[1].split("```")[0].replace("rng, 100,", "rng, 2,")
    scope = {}
    exec(code, scope)  # noqa: S102  the code is our own
    assert len(scope["database"]) == 2
    clips = os.environ.get("MOTIONEDIT_CLIPS")
    if not clips:
        pytest.skip("MOTIONEDIT_CLIPS names no folder of real clips")
    assert comparison(Path(clips)) in text
