"""Feet kept on the walk that skates: every plant in one place, by the legs alone, near to the truth."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.core.body.bends import find_bends
from motionedit.core.body.contacts import Plant, sole_tracks
from motionedit.core.body.quality import jerk_rms
from motionedit.core.feet.goals import ground_under
from motionedit.core.feet.keep import onto_stances, within_legs
from motionedit.core.feet.knees import eased_ways, knee_of
from motionedit.core.feet.legs import LegGoal, legs_onto
from motionedit.core.feet.pelvis import drop_needed, smooth_cover
from motionedit.core.feet.reach import CALMS_ANOTHER, CALMS_OWN
from motionedit.core.feet.stance import feet_of, foot_path, stance_of
from motionedit.core.kinematics import forward, shifted
from motionedit.jobs.clip.facts import facts_of

DATA = Path(__file__).parents[4] / "data"


@cache
def facts(name):
    return facts_of(motionedit.read(DATA / name))


def keep_feet(motion, mine, theirs):
    """Return a motion of a clip with feet that stand where another version of the clip has them, or it itself."""
    poses, own = forward(motion), motion is theirs.clip.motion
    stances = []
    for foot in feet_of(mine.anatomy):
        here = [plant for plant in theirs.phases if plant.foot == foot.side]
        stances.append((foot, stance_of(foot_path(theirs.poses, foot), here)))
    held = within_legs(stances, poses, mine.anatomy, up=mine.up)
    ground, calms = ground_under(mine.anatomy, mine.up), CALMS_OWN if own else CALMS_ANOTHER
    return onto_stances(motion, poses, held, mine.anatomy, ground, travel=mine.travel, first=mine.first, calms=calms)


def kept(name, reference=None):
    return keep_feet(facts(name).clip.motion, facts(name), facts(reference or name))


def raised(name, share):
    """Return the clip of a name with its body raised by a share of a leg."""
    clip = facts(name)
    way = np.tile(share * clip.anatomy.leg_length * clip.up, (len(clip.clip.motion), 1))
    return shifted(clip.clip.motion, way, clip.travel, poses=clip.poses)


def kept_raised(name, share):
    """Return such a clip with its feet kept where they were."""
    clip = facts(name)
    return keep_feet(raised(name, share), clip, clip)


def drift(motion, of, plants=None):
    tracks = sole_tracks(forward(motion), of.anatomy)
    return max(np.ptp(tracks[p.start : p.stop + 1, p.point], axis=0).max() for p in plants or of.phases)


@pytest.mark.parametrize("name", ["walk.bvh", "walk-skating.bvh", "kick.bvh"])
def test_every_plant_is_one_place_and_the_motion_stays_smooth(name):
    clip, found = facts(name), kept(name).motion
    assert drift(clip.clip.motion, clip) > 0.01
    assert drift(found, clip) < 1e-9
    jerks = [jerk_rms(forward(m).positions, frame_time=m.frame_time) for m in (found, clip.clip.motion)]
    assert jerks[0] < 1.1 * jerks[1]


@pytest.mark.parametrize("frame", [24, 60, 96, 132])
def test_feet_are_kept_alike_wherever_in_the_room_they_go(frame):
    name = "walk-skating.bvh"
    clip = facts(name)
    hips = clip.poses.positions[frame, clip.travel] - 0.5 * clip.anatomy.leg_length * clip.up
    motion = shifted(clip.clip.motion, np.tile(-hips, (len(clip.clip.motion), 1)), clip.travel, poses=clip.poses)
    there = facts_of(clip.clip.with_motion(motion))
    moved = keep_feet(motion, there, there).motion
    np.testing.assert_allclose(moved.rotations, kept(name).motion.rotations, atol=1e-9)


def test_nothing_but_legs_moves():
    clip, found = facts("walk-skating.bvh"), kept("walk-skating.bvh")
    legs = [j for leg in clip.anatomy.legs for j in (leg.thigh, leg.knee, leg.ankle)]
    others = np.setdiff1d(np.arange(len(clip.clip.motion.skeleton)), legs)
    assert np.array_equal(found.motion.rotations[:, others], clip.clip.motion.rotations[:, others])
    assert np.abs(found.motion.translations - clip.clip.motion.translations).max() == found.lowered.max() < 0.5


def test_the_walk_that_skates_comes_nearer_to_its_truth():
    truth = forward(facts("walk.bvh").clip.motion).positions

    def apart(motion):
        return np.sqrt(((forward(motion).positions - truth) ** 2).sum(axis=-1).mean())

    assert apart(kept("walk-skating.bvh").motion) < 0.7 * apart(facts("walk-skating.bvh").clip.motion)


def test_plants_stand_where_the_reference_has_them():
    clip, found = facts("walk.bvh"), kept("walk-skating.bvh", "walk.bvh").motion
    tracks, theirs = (sole_tracks(forward(m), clip.anatomy) for m in (found, clip.clip.motion))
    for plant in clip.phases:
        span = slice(plant.start, plant.stop + 1)
        way = tracks[span, plant.point].mean(axis=0) - theirs[span, plant.point].mean(axis=0)
        assert np.linalg.norm(way) < 0.1


def test_legs_go_where_they_are_told_and_a_far_place_straightens_them():
    clip = facts("walk.bvh")
    motion, poses = clip.clip.motion, clip.poses
    bends = {bend.joint: bend for bend in find_bends(motion.skeleton, poses, clip.anatomy, first=0)}
    leg = clip.anatomy.legs[0]
    knee = knee_of(motion.skeleton, poses, leg, bends[leg.knee])
    near = 0.9 * poses.positions[:, leg.ankle] + 0.1 * poses.positions[:, leg.thigh]
    turns = poses.rotations[:, leg.knee]
    after = forward(legs_onto(motion, poses, [LegGoal(leg, knee, near, turns)]))
    assert after.positions[:, leg.ankle] == pytest.approx(near, abs=1e-9)
    assert np.abs(np.sum(after.rotations[:, leg.ankle] * turns, axis=1)) == pytest.approx(1.0)
    far = poses.positions[:, leg.thigh] - [0.0, 500.0, 0.0]
    after = forward(legs_onto(motion, poses, [LegGoal(leg, knee, far, turns)]))
    hip, knee, ankle = (after.positions[:, j] for j in (leg.thigh, leg.knee, leg.ankle))
    bones = np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1)
    assert np.linalg.norm(ankle - hip, axis=1) == pytest.approx(bones, rel=1e-6)


def test_a_pelvis_comes_down_as_far_as_a_leg_asks_and_smoothly():
    hip, ankle = np.array([[0.0, 1.0, 0.0]] * 60), np.array([[0.3, 0.0, 0.0]] * 60)
    up = np.array([0.0, 1.0, 0.0])
    reach = np.where(np.arange(60) == 30, 0.99, 1.2)
    needed = drop_needed(hip, ankle, reach, up)
    assert np.flatnonzero(needed).tolist() == [30]
    assert np.hypot(0.3, 1.0 - needed[30]) == pytest.approx(0.99)
    cover = smooth_cover(needed, 1.0 / 60.0)
    assert (cover >= needed - 1e-12).all()
    assert np.abs(np.diff(cover)).max() < 0.15 * needed[30]
    assert cover[0] == cover[-1] == 0.0


def test_a_pelvis_comes_down_by_two_percent_of_a_leg_before_a_heel_is_let_go():
    clip = facts("walk.bvh")
    found = kept_raised("walk.bvh", 0.02)
    assert found.lowered.max() == pytest.approx(0.02 * clip.anatomy.leg_length, rel=0.01)
    assert drift(found.motion, clip) < 1e-9
    found = kept_raised("walk.bvh", 0.03)
    assert found.lowered.max() < 0.02 * clip.anatomy.leg_length
    assert drift(found.motion, clip, [plant for plant in clip.phases if plant.part == "heel"]) > 1.0
    assert drift(found.motion, clip, [plant for plant in clip.phases if plant.part == "toe"]) < 1e-9


def test_a_heel_that_stands_leaves_its_knee_five_degrees():
    clip = facts("walk-skating.bvh")
    poses = forward(kept_raised("walk-skating.bvh", 0.01).motion)
    bends = {bend.joint: bend for bend in find_bends(clip.clip.motion.skeleton, clip.poses, clip.anatomy, first=0)}
    for leg, side in zip(clip.anatomy.legs, ("left", "right"), strict=True):
        least = np.degrees(
            min(
                knee_of(clip.clip.motion.skeleton, poses, leg, bends[leg.knee])
                .angle[plant.start : plant.stop + 1]
                .min()
                for plant in clip.phases
                if plant.part == "heel" and plant.foot == side
            )
        )
        assert least == pytest.approx(5.0, abs=1e-6)


def test_a_heel_that_stands_alone_keeps_its_toe_on_the_floor():
    clip = facts("walk.bvh")
    # The foot rolls off: its heel, held where it is on average, would push the toe down.
    plants = [Plant("left", "heel", clip.anatomy.legs[0].ankle, 0, 33, 39, 0.0)]
    stances = [(foot, stance_of(foot_path(clip.poses, foot), plants)) for foot in feet_of(clip.anatomy)[:1]]
    toe = next(i for i, point in enumerate(clip.anatomy.sole_points) if (point.foot, point.part) == ("left", "toe"))
    floor = float(sole_tracks(clip.poses, clip.anatomy)[33:40, toe, 1].min())
    deepest = []
    for height in (None, floor):
        ground = ground_under(clip.anatomy, clip.up, floor=height)
        found = onto_stances(clip.clip.motion, clip.poses, stances, clip.anatomy, ground, travel=0, first=0).motion
        deepest.append(sole_tracks(forward(found), clip.anatomy)[33:40, toe, 1].min() - floor)
    assert deepest[0] < -0.5
    assert deepest[1] == pytest.approx(0.0, abs=1e-9)


def test_a_knee_that_is_nearly_straight_eases_off_its_plant_without_a_shake_or_a_flip():
    clip = facts("walk.bvh")
    motion, poses = clip.clip.motion, clip.poses
    bends = {bend.joint: bend for bend in find_bends(motion.skeleton, poses, clip.anatomy, first=0)}
    leg = clip.anatomy.legs[0]
    own = knee_of(motion.skeleton, poses, leg, bends[leg.knee])
    # A leg that comes through straight, bent back by up to 4 degrees, and stands bent by 8 at first.
    angle = np.radians(np.linspace(12.0, -4.0, len(motion)))
    knee = replace(
        own, angle=angle, fixed=np.full_like(angle, own.fixed[0]), turning=np.full_like(angle, own.turning[0])
    )
    known = np.arange(len(motion)) < 20
    down = np.array([[0.0, -1.0, 0.0]])
    hip = np.zeros((len(motion), 3))
    before = down * knee.way(angle)[:, None]
    ankle = np.where(known[:, None], down * knee.way(np.full_like(angle, np.radians(8.0)))[:, None], before)
    back = np.zeros(len(motion), dtype=bool)
    ways, bent_back = eased_ways(knee, hip, before, ankle, known=known, back=back, frame_time=motion.frame_time)
    found = np.degrees(np.where(bent_back, -1.0, 1.0) * knee.bent(ways))
    assert found[:20] == pytest.approx(8.0, abs=1e-6)
    assert found[-1] == pytest.approx(-4.0, abs=0.01)
    assert np.abs(np.diff(found)).max() < 1.0
