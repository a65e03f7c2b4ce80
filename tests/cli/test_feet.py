"""Feet from the command line: held, re-placed, put on a floor."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.core import rotations as rot
from motionedit.core.body.contacts import sole_tracks
from motionedit.core.kinematics import forward
from motionedit.jobs.clip.facts import facts_of

DATA = Path(__file__).parents[2] / "data"
WALK, SKATING = DATA / "walk.bvh", DATA / "walk-skating.bvh"
FEET = {"name": "feet", "type": "footplants", "priority": 10}


@pytest.fixture
def edit(run, tmp_path):
    """Return an editor: constraints and options in, what was written and its record out."""

    def invoke(constraints, *arguments, clip=SKATING, code=0):
        spec = {"schema": "motionedit/edit-prioritized/v1", "constraints": constraints}
        (tmp_path / "s.yaml").write_text(json.dumps(spec, indent=1))
        done = run("edit-prioritized", clip, "-s", "s.yaml", "-o", "e.bvh", "--report", "r.json", *map(str, arguments))
        assert done.exit_code == code, done.stderr
        if code:
            return done.stderr
        return facts_of(motionedit.read(tmp_path / "e.bvh")), json.loads((tmp_path / "r.json").read_text())["clips"][0]

    return invoke


def drift(after, plants):
    tracks = sole_tracks(forward(after.clip.motion), after.anatomy)
    return max(np.ptp(tracks[p.start : p.stop + 1, p.point], axis=0).max() for p in plants)


def test_three_lines_hold_the_feet_in_the_written_file(edit):
    after, record = edit([{"type": "footplants"}])
    assert drift(after, facts_of(motionedit.read(SKATING)).phases) < 0.001
    assert record["metrics"]["before"]["foot_sliding_share"] == 1.0
    assert record["metrics"]["after"]["foot_sliding_share"] == 0.0
    assert record["metrics"]["after"]["foot_drift_max"] < 1e-5
    assert [each["name"] for each in record["constraints"]] == ["footplants", "footplants-2"]
    assert record["status"] == "ok"


def test_a_hand_that_reaches_leaves_the_feet_alone(edit):
    hand = {"type": "position", "effector": "RightHand", "priority": 4}
    after, record = edit([FEET, {**hand, "points": [{"hold": [60, 90], "shift": [0, 20, 25]}]}])
    assert drift(after, facts_of(motionedit.read(SKATING)).phases) < 0.01
    assert record["constraints"][2]["error_max"] < 0.01


def test_a_foot_in_the_air_goes_where_another_constraint_puts_it(edit):
    before = facts_of(motionedit.read(WALK))
    left = [plant for plant in before.phases if plant.foot == "left"]
    gap = next((a.stop, b.start) for a, b in pairwise(left) if b.start - a.stop > 8)
    middle = sum(gap) // 2
    kick = {"type": "position", "effector": "LeftFoot", "priority": 5, "ease_in": 2, "ease_out": 2}
    after, record = edit([FEET, {**kick, "points": [{"at": middle, "shift": [0, 8, 0]}]}], clip=WALK)
    assert drift(after, before.phases) < 0.01
    assert record["constraints"][-1]["error_max"] < 0.01
    # As docs/feet.md has it: the foot is left to the kick between two stretches.
    assert [each["name"] for each in record["constraints"]] == ["feet", "feet-stretch-2", "feet-2", "LeftFoot"]


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_a_clip_of_few_frames_stands_as_it_is_told_to(edit, tmp_path, frames):
    walk = motionedit.read(WALK)
    short = motionedit.write(walk.with_motion(walk.motion.at(slice(frames))), tmp_path / "short.bvh")
    lower = {"type": "position", "effector": "Hips", "points": [{"during": [0, "100%"], "shift": [0, -8, 0]}]}
    after, record = edit([FEET | {"plants": {"LeftFoot": [[0, 0]]}}, lower], clip=short)
    assert record["constraints"][0]["status"] == "ok"
    before, now = (forward(each.motion).positions[0] for each in (walk, after.clip))
    ankle, hips = (walk.motion.skeleton.names.index(name) for name in ("LeftFoot", "Hips"))
    assert np.linalg.norm(now[ankle] - before[ankle]) < 0.001
    assert now[hips][1] == pytest.approx(before[hips][1] - 8.0, abs=0.001)


def test_plants_stand_where_the_reference_has_them(edit):
    after, _ = edit([FEET], "--reference", WALK)
    truth = facts_of(motionedit.read(WALK))
    mine, theirs = (sole_tracks(forward(each.clip.motion), truth.anatomy) for each in (after, truth))
    for plant in truth.phases:
        span = slice(plant.start, plant.stop + 1)
        assert np.linalg.norm((mine[span, plant.point] - theirs[span, plant.point]).mean(axis=0)) < 0.1


def test_a_reference_that_is_none_is_refused(edit, tmp_path):
    assert "--reference: there is no clip or folder nowhere" in edit([FEET], "--reference", "nowhere", code=2)
    assert "its reference" in edit([FEET], "--reference", DATA / "kick.bvh", code=1)
    (tmp_path / "empty").mkdir()
    assert "has no reference" in edit([FEET], "--reference", tmp_path / "empty", code=1)


def test_plants_go_with_the_path_as_a_whole(edit):
    way = {"type": "position", "effector": "Hips", "priority": 5}
    points = [{"during": ["0%", "100%"], "shift": [20, 0, 0]}]
    after, record = edit([{**FEET, "at": "path"}, {**way, "points": points}], clip=WALK)
    before = facts_of(motionedit.read(WALK))
    assert drift(after, before.phases) < 0.01
    moved = forward(after.clip.motion).positions - before.poses.positions
    assert np.median(moved[..., 0]) == pytest.approx(20.0)
    assert np.abs(moved - [20.0, 0.0, 0.0]).max() < 2.0
    assert record["metrics"]["after"]["jerk_rms"] < 1.15 * record["metrics"]["before"]["jerk_rms"]


def moved_aside(edit, *ways):
    """Return how far the joints go, shape (F, J, 3), where the root is asked to go and the feet follow the path."""
    way = {"type": "position", "effector": "Hips", "priority": 5}
    after, record = edit([{**FEET, "at": "path"}, *({**way, **each} for each in ways)], clip=WALK)
    before = facts_of(motionedit.read(WALK))
    assert drift(after, before.phases) < 0.01
    assert record["status"] == "ok"
    return after.poses.positions - before.poses.positions


ASIDE = {"points": [{"during": ["0%", "100%"], "shift": [20, -6, 10]}]}


@pytest.mark.parametrize(
    ("more", "shift"),
    [
        ({"axes": ["x", "z"]}, [20.0, 0.0, 10.0]),
        ({"axes": ["x"]}, [20.0, 0.0, 0.0]),
        # The walk goes along +z: left is +x.
        ({"axes": ["z"], "frame": "heading"}, [0.0, 0.0, 10.0]),
        ({"axes": ["x", "z"], "effector": {"joint": "Hips", "offset": [0, 10, 5]}}, [20.0, 0.0, 10.0]),
    ],
)
def test_plants_follow_the_axes_that_count_and_points_of_the_root(edit, more, shift):
    moved = moved_aside(edit, {**ASIDE, **more})
    assert np.median(moved, axis=(0, 1)) == pytest.approx(shift, abs=0.5)
    assert np.abs(moved - shift).max() < 2.0


def test_axes_of_several_positions_add_up_and_the_same_axis_is_taken_once(edit):
    one, other = {**ASIDE, "axes": ["x"]}, {**ASIDE, "axes": ["z"]}
    assert np.abs(moved_aside(edit, one, other) - [20.0, 0.0, 10.0]).max() < 2.0
    assert np.abs(moved_aside(edit, one, one, other) - [20.0, 0.0, 10.0]).max() < 2.0


@pytest.mark.parametrize(
    "other",
    [
        {"type": "position", "effector": "Spine", "points": [{"at": 72, "shift": [5, 0, 0]}]},
        {"type": "com", "points": [{"at": 72, "shift": [5, 0, 0]}]},
        {"type": "orientation", "effector": "Hips"},
    ],
)
def test_where_nothing_takes_the_root_along_a_warning_says_that_the_path_follows_nothing(run, tmp_path, other):
    for at in ("path", "input"):
        spec = {"schema": "motionedit/edit-prioritized/v1", "constraints": [{**FEET, "at": at}, other]}
        (tmp_path / "s.yaml").write_text(json.dumps(spec))
        done = run("edit-prioritized", WALK, "-s", "s.yaml", "-o", f"{at}.bvh")
        told = [line for line in done.stderr.splitlines() if "at: path follows nothing" in line]
        assert len(told) == (at == "path")
        assert all("ask for a position of Hips" in line for line in told)


def test_a_body_turns_about_the_point_of_the_root_that_is_asked_to_go_somewhere(edit):
    # A point half a metre ahead of the hips goes around a bend: as a rigid body, hips and feet go with it.
    before = facts_of(motionedit.read(WALK))
    hips, offset = before.travel, np.array([0.0, 0.0, 50.0])
    point = before.poses.positions[:, hips] + rot.rotate(before.poses.rotations[:, hips], offset)
    angle = np.radians(40.0)
    turn = np.array([[np.cos(angle), 0.0, np.sin(angle)], [0.0, 1.0, 0.0], [-np.sin(angle), 0.0, np.cos(angle)]])
    shifts = (point - point[0]) @ (turn - np.eye(3)).T
    points = [{"at": frame, "shift": shifts[frame].tolist()} for frame in range(0, 145, 12)]
    way = {"type": "position", "effector": {"joint": "Hips", "offset": offset.tolist()}, "priority": 5}
    after, _ = edit([{**FEET, "at": "path"}, {**way, "points": points}], clip=WALK)
    rigid = (before.poses.positions - point[0]) @ turn.T + point[0]
    # The ends of a path leave and meet the input's own direction.
    off = np.linalg.norm(after.poses.positions - rigid, axis=2)[24:-24]
    assert np.median(off) < 3.0
    assert off.max() < 20.0


def test_feet_and_body_turn_with_a_path_that_turns(edit):
    before = facts_of(motionedit.read(WALK))
    places = before.poses.positions[:, before.travel]
    angle, way = np.radians(40.0), {"type": "position", "effector": "Hips", "priority": 5}
    turn = np.array([[np.cos(angle), 0.0, np.sin(angle)], [0.0, 1.0, 0.0], [-np.sin(angle), 0.0, np.cos(angle)]])
    shifts = {frame: turn @ (places[frame] - places[0]) - (places[frame] - places[0]) for frame in range(0, 145, 12)}
    points = [{"at": frame, "shift": shift.tolist()} for frame, shift in shifts.items()]
    after, record = edit([{**FEET, "at": "path"}, {**way, "points": points}], clip=WALK)
    assert record["status"] == "ok"
    assert drift(after, before.phases) < 0.01
    assert record["metrics"]["after"]["jerk_rms"] < 1.15 * record["metrics"]["before"]["jerk_rms"]
    names = before.clip.motion.skeleton.names
    for start, stop in (("LeftFoot", "LeftToeBase"), ("RightFoot", "RightToeBase"), ("RightUpLeg", "LeftUpLeg")):
        joints = [names.index(stop), names.index(start)]
        ways = [np.subtract(*np.moveaxis(each.poses.positions[:, joints], 1, 0)) for each in (before, after)]
        one, other = (way[:, 2] + 1j * way[:, 0] for way in ways)
        turned = np.degrees(np.angle(one.conj() * other))[12:-12]
        assert np.percentile(turned, [10, 50, 90]) == pytest.approx(40.0, abs=3.0)


def test_a_foot_on_a_longer_way_stands_where_its_leg_holds_it_to_the_end(edit):
    way = {"type": "position", "effector": "Hips", "priority": 5}
    points = [{"at": 0}, {"at": "100%", "shift": [0, 0, 80]}]
    feet = {**FEET, "at": "path", "plants": {"LeftFoot": [[24, 35]]}}
    after, record = edit([feet, {**way, "points": points}], clip=WALK)
    assert record["status"] == "ok"
    ankle = after.clip.motion.skeleton.names.index("LeftFoot")
    assert np.ptp(forward(after.clip.motion).positions[24:36, ankle], axis=0).max() < 1e-3


def test_feet_stand_on_a_height_and_nothing_of_them_goes_below(edit):
    after, record = edit([{**FEET, "height": 5}, {"type": "floor", "height": 5, "priority": 9}], clip=WALK)
    tracks = sole_tracks(forward(after.clip.motion), after.anatomy)[..., 1]
    assert tracks.min() > 5.0 - 1e-3
    for plant in facts_of(motionedit.read(WALK)).phases:
        if plant.part == "toe":
            assert tracks[plant.start : plant.stop + 1, plant.point] == pytest.approx(5.0, abs=1e-3)
    assert record["metrics"]["after"]["foot_drift_max"] < 1e-5


@pytest.mark.parametrize("points", ["RightHand", ["Head", "LeftHand"]])
def test_a_table_under_the_hands_is_no_ground_of_the_feet(edit, points):
    ankles = [leg.ankle for leg in facts_of(motionedit.read(WALK)).anatomy.legs]
    alone, _ = edit([FEET], clip=WALK)
    after, record = edit([FEET, {"type": "floor", "effector": points, "height": 60, "priority": 9}], clip=WALK)
    assert np.abs(after.poses.positions[:, ankles] - alone.poses.positions[:, ankles]).max() < 0.01
    assert record["status"] == "ok"


def test_a_body_that_is_far_below_its_floor_is_lifted_as_a_whole(edit):
    after, record = edit([{"type": "floor", "effector": "all", "height": 1000}], clip=WALK)
    assert record["status"] == "ok"
    assert after.poses.positions[..., 1].min() > 1000.0 - 1e-3
    before = motionedit.read(WALK).motion
    assert np.abs(after.clip.motion.rotations - before.rotations).max() < 0.01


def test_a_floor_that_no_pose_reaches_over_what_goes_first_is_refused(edit):
    floor = {"type": "floor", "effector": "all", "height": 1000, "priority": 9}
    assert "nothing of it reaches so far" in edit([FEET, floor], clip=WALK, code=2)


def test_plants_of_a_file_or_the_spec_are_taken(edit, tmp_path):
    after, _ = edit([{**FEET, "feet": ["LeftFoot"], "plants": {"LeftFoot": [[24, 30]]}}])
    ankle = after.clip.motion.skeleton.names.index("LeftFoot")
    assert np.ptp(forward(after.clip.motion).positions[24:31, ankle], axis=0).max() < 1e-3
    (tmp_path / "p.csv").write_text("clip,foot,part,first,last\nwalk-skating,left,foot,24,30\nother,left,toe,1,2\n")
    again, _ = edit([{**FEET, "plants": "p.csv"}])
    assert np.ptp(forward(again.clip.motion).positions[24:31, ankle], axis=0).max() < 1e-3


def test_a_heel_that_a_leg_cannot_hold_is_named(edit):
    _, record = edit([{**FEET, "plants": {"LeftFoot": [[24, 38]]}}], clip=WALK)
    assert record["status"] == "rough"
    assert "the left heel is not held at frames 36-38: the leg is too short there" in record["message"]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("clip,foot\n", "p.csv:1: the first line must be clip,foot,part,first,last"),
        ("clip,foot,part,first,last\na,left,nail,1,2\n", "p.csv:2: part must be heel, toe or foot (both), not 'nail'"),
        ("clip,foot,part,first,last\na,left,toe,9,2\n", "p.csv:2: ends at 2, before it begins at 9"),
    ],
)
def test_a_table_of_plants_that_is_none_is_refused(edit, tmp_path, table, message):
    (tmp_path / "p.csv").write_text(table)
    assert message in edit([{**FEET, "plants": "p.csv"}], code=2)


def test_where_no_foot_stands_nothing_is_done(run, tmp_path):
    text = WALK.read_text().splitlines()
    at = next(i for i, line in enumerate(text) if line.startswith("Frames:"))
    short = [*text[:at], "Frames: 1", *text[at + 1 : at + 3]]
    (tmp_path / "short.bvh").write_text("\n".join(short) + "\n")
    (tmp_path / "s.yaml").write_text("schema: motionedit/edit-prioritized/v1\nconstraints: [{type: footplants}]\n")
    done = run("edit-prioritized", "short.bvh", "-s", "s.yaml", "-o", "e.bvh")
    assert done.exit_code == 0
    assert "no foot stands in it" in done.stderr
    assert (tmp_path / "e.bvh").read_bytes() == (tmp_path / "short.bvh").read_bytes()


def test_a_body_without_legs_has_no_feet(edit, clip):
    path = clip("stick.bvh")
    message = edit([FEET], clip=path, code=2)
    assert "no feet found" in message


def test_more_plants_than_frames_are_refused_at_once(run, tmp_path):
    plants = ", ".join(["[2, 3]"] * 3000)
    feet = f"{{type: footplants, plants: {{LeftFoot: [{plants}]}}}}"
    (tmp_path / "s.yaml").write_text(f"schema: motionedit/edit-prioritized/v1\nconstraints: [{feet}]\n")
    result = run("edit-prioritized", DATA / "walk.bvh", "-s", "s.yaml", "-o", "out.bvh")
    assert result.exit_code == 2
    assert "constraints.0.plants: 'LeftFoot' has 3000 plants of its heel, more than" in result.stderr
