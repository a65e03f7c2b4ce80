"""Reports say where every effector was wanted: these places agree with the errors and with the files written."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.jobs.clip.facts import facts_of
from motionedit.report.record import plain
from studies.lab import Lab

DATA = Path(__file__).resolve().parents[2] / "data"
WALK = DATA / "walk.bvh"
LIFT = {"type": "position", "effector": "LeftHand", "priority": 4, "tolerance": "off"}


@pytest.fixture
def edit(tmp_path):
    """Return a function from constraints to the edited clip and the report's entries, one for each constraint."""

    def invoke(*constraints, **keys):
        named = [{"name": f"c{i}", **each} for i, each in enumerate(constraints)]
        done = Lab(tmp_path).edit_prioritized(WALK, {**keys, "constraints": named})
        return read_clip(done.path), plain(done.record)["constraints"]

    return invoke


def path_of(clip, effector):
    joint = clip.motion.skeleton.names.index(effector["joint"])
    return effector_positions(forward(clip.motion), Effector(joint, np.array(effector["offset"])))


@pytest.mark.parametrize(
    "more",
    [
        {"points": [{"hold": [66, 72], "position": [58, 150, 322]}]},
        {"points": [{"hold": [66, 72], "position": [900, 150, 322]}]},
        {"points": [{"at": 60, "shift": [0, 30, 500]}], "axes": ["y", "z"]},
        {"points": [{"during": [50, 70], "shift": [30, 0, 300]}], "frame": "heading", "axes": ["x"]},
        {"points": [{"hold": [50, 70], "position": [90, 0, 0]}], "relative_to": "Spine1"},
        {"points": [{"hold": [50, 70], "position": [90, 0, 0]}], "relative_to": "Spine1", "axes": ["x", "y"]},
        {"points": [{"at": 60, "shift": [0, 300, 0]}], "effector": {"joint": "LeftHand", "offset": [0, 9, 4]}},
    ],
    ids=["met", "missed", "axes", "heading", "joint", "joint and axes", "offset"],
)
def test_the_effector_is_as_far_from_its_target_as_the_error_says(edit, more):
    clip, (record,) = edit({**LIFT, **more}, smoothing={"method": "passes", "passes": 0})
    first, frames = record["first_frame"], record["frames"]
    away = np.linalg.norm(
        path_of(clip, record["effector"])[first : record["last_frame"] + 1] - frames["target"], axis=1
    )
    np.testing.assert_allclose(away, frames["error"], atol=2e-5)
    assert max(frames["error"]) == pytest.approx(record["error_max"])


def test_a_hold_is_wanted_where_the_spec_says_and_its_frames_are_told(edit):
    _, (record,) = edit({**LIFT, "points": [{"hold": [66, 72], "position": [58, 150, 322]}, {"at": 80}]})
    assert record["points"] == [
        {"mode": "hold", "first": 66, "last": 72},
        {"mode": "at", "first": 80, "last": 80},
    ]
    assert record["effector"] == {"joint": "LeftHand", "offset": [0.0, 0.0, 0.0]}
    held = record["frames"]["target"][66 - record["first_frame"] : 73 - record["first_frame"]]
    np.testing.assert_allclose(held, [[58, 150, 322]] * 7, atol=1e-6)


def test_along_axes_that_are_free_the_target_is_where_the_effector_is(edit):
    clip, (record,) = edit({**LIFT, "points": [{"at": 60, "shift": [0, 30, 500]}], "axes": ["y"]})
    span = slice(record["first_frame"], record["last_frame"] + 1)
    path, target = path_of(clip, record["effector"])[span], np.array(record["frames"]["target"])
    np.testing.assert_allclose(target[:, [0, 2]], path[:, [0, 2]], atol=1e-5)
    np.testing.assert_allclose(np.abs(target[:, 1] - path[:, 1]), record["frames"]["error"], atol=1e-5)


@pytest.mark.parametrize("frame", ["world", "heading"])
def test_balance_that_is_met_is_wanted_where_the_center_of_mass_is(edit, frame):
    clip, (record,) = edit({"type": "com", "priority": 3, "frame": frame, "points": [{"at": 60, "shift": [3, 0, 1]}]})
    facts = facts_of(clip)
    path = center_of_mass(facts.poses, find_masses(clip.motion.skeleton, facts.anatomy))
    assert record["error_max"] < 0.01
    span = slice(record["first_frame"], record["last_frame"] + 1)
    np.testing.assert_allclose(record["frames"]["target"], path[span], atol=0.011)


def test_what_has_no_place_has_no_target(edit):
    turned = {"points": [{"hold": [40, 60], "orientation": {"euler": [0, 0, -35], "order": "ZXY"}}]}
    _, (forearm, head) = edit(
        {"type": "orientation", "effector": "RightForeArm", "priority": 2, **turned},
        {"type": "posture", "joints": ["Head"], "priority": 1},
    )
    assert (forearm["frames"]["target"], head["frames"]["target"], head["effector"]) == (None, None, None)


def test_an_aim_has_the_point_that_is_looked_at_and_balance_its_own(edit):
    _, (eyes, balance) = edit(
        {"type": "aim", "effector": "Head", "axis": [0, 0, 1], "priority": 1,
         "points": [{"hold": [40, 60], "position": [300, 160, 400]}]},
        {"type": "com", "priority": 3, "axes": ["x", "z"]},
    )  # fmt: skip
    np.testing.assert_allclose(eyes["frames"]["target"][50 - eyes["first_frame"]], [300, 160, 400], atol=1e-6)
    assert balance["effector"] is None
    assert len(balance["frames"]["target"]) == len(balance["frames"]["error"])


@pytest.mark.parametrize(
    "goal",
    [
        {"shift": [-8.0, 0.0, 3.0]},
        {"shift": [400.0, 0.0, 0.0], "axes": ["x"]},
        {"shift": [-8.0, 0.0, 3.0], "frame": "heading", "axes": ["x", "z"]},
        {"position": [0.0, -200.0, 40.0], "relative_to": "Spine1", "axes": ["y"]},
    ],
    ids=["world", "axis", "heading", "joint"],
)
def test_a_goal_of_edit_pc_is_as_far_as_its_error_says(golf, goal):
    done = golf.edit(golf.swings[3], goal={**goal, "tolerance": "off"})
    (record,) = plain(done.record)["goals"]
    reached = path_of(read_clip(done.path), record["effector"])[record["frame"]]
    assert np.linalg.norm(reached - record["target"]) == pytest.approx(record["error_max"], abs=2e-5)


def test_a_goal_that_only_turns_has_no_target(golf):
    done = golf.edit(golf.swings[3], goal={"orientation": {"euler": [0, 0, 10], "order": "ZXY"}})
    assert plain(done.record)["goals"][0]["target"] is None
