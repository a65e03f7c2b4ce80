"""The clips that ship: the generator writes their very bytes, and they move as golfers, walkers and kickers do."""

import os
from pathlib import Path

import numpy as np
import pytest
from places import CLUB_HEAD, club_head, joint

from data.generator.compare import comparison
from data.generator.files import shipped_files
from data.generator.golf import BALL_HEIGHT
from data.generator.grip import IN_HAND, UP_SHAFT
from data.generator.measures import swing_measures
from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.bvh import read_clip


def sliding(path):
    return np.linalg.norm(path - path[0], axis=-1).max()


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
