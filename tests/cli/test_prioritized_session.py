"""edit-prioritized on the walk and the swings of data/: what a spec asks for is in the file that is written."""

import json
import re

import numpy as np
import pytest
from prioritized_edits import ARM_ONLY, DATA, FEET, FEET_AS_CAPTURED, RAISED, WALK, columns_of, hand, rows

from motionedit.core import rotations as rot
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from motionedit.jobs.clip.facts import facts_of
from studies.lab import effector_path


def test_the_hand_reaches_while_feet_and_balance_stay(edit):
    done = edit([FEET_AS_CAPTURED, RAISED, {"type": "com", "priority": 2, "relative_to": "world"}], unit="cm")
    assert done.result.exit_code == 0
    assert done.record["status"] == "ok"
    before, after = (effector_path(path, "LeftHand") for path in (WALK, done.path))
    np.testing.assert_allclose(after[66:73], np.tile(before[66] + [5, 20, 10], (7, 1)), atol=1e-3)
    for joint in FEET:
        np.testing.assert_allclose(effector_path(done.path, joint), effector_path(WALK, joint), atol=1e-3)
    assert done.record["metrics"]["com_shift_max"] < 1e-3
    assert done.record["metrics"]["foot_drift_max"] < 1e-3
    assert not done.warnings


def test_without_the_balance_the_center_of_mass_gives_way(edit):
    assert edit([FEET_AS_CAPTURED, RAISED]).record["metrics"]["com_shift_max"] > 0.1


@pytest.mark.parametrize(("weight", "errors"), [(1, (15.0, 15.0)), (10, (30 / 101, 30 * 100 / 101))])
def test_equal_priorities_share_a_conflict_by_the_squares_of_their_weights(edit, weight, errors):
    low = effector_path(WALK, "LeftHand")[70]
    high = low + np.array([0.0, 30.0, 0.0])
    done = edit(
        [
            hand({"hold": [66, 74], "position": list(low)}, name="a", weight=weight),
            hand({"hold": [66, 74], "position": list(high)}, name="b"),
        ],
        smoothing={"method": "paper", "passes": 0},
    )
    after = effector_path(done.path, "LeftHand")[66:75]
    for goal, error in zip((low, high), errors, strict=True):
        np.testing.assert_allclose(np.linalg.norm(after - goal, axis=1), error, atol=1e-3)
    assert done.record["status"] == "out_of_tolerance"
    assert "shared by weight with b, of the same priority" in done.result.stderr
    assert {name: done.constraint(name)["gave_way_to"] for name in "ab"} == {"a": ["b"], "b": ["a"]}


def test_all_are_named_that_share_with_a_goal(edit):
    shifts = {"up": [0, 12, 0], "down": [0, -12, 0], "aside": [12, 0, 0]}
    done = edit([hand({"during": [66, 72], "shift": shift}, name=name, weight=3) for name, shift in shifts.items()])
    assert done.constraint("aside")["gave_way_to"] == ["up", "down"]
    assert any(line.endswith("shared by weight with up, down, of the same priority") for line in done.warnings)


def test_of_two_goals_of_a_layer_that_give_way_the_one_of_the_larger_weight_is_nearer(edit):
    low = effector_path(WALK, "LeftHand")[70]
    high = low + np.array([0.0, 30.0, 0.0])
    goals = [hand({"hold": [66, 74], "position": list(place)}, name=name) for place, name in ((low, "a"), (high, "b"))]
    found = []
    for weight in (1, 10):
        after = effector_path(edit([{**goals[0], "weight": weight}, goals[1]]).path, "LeftHand")[66:75]
        errors = [np.linalg.norm(after - goal, axis=1) for goal in (low, high)]
        assert (sum(errors) >= 30.0 - 1e-6).all()
        found.append(errors)
    (one, other), (near, far) = found
    assert abs(one.mean() - other.mean()) < 4.0
    assert (near < 5.0).all()
    assert (far > 25.0).all()


def test_a_lower_priority_gives_way_and_the_report_says_to_whom(edit):
    done = edit(
        [
            hand({"during": [66, 72]}, name="stay", priority=3, recruit=ARM_ONLY),
            hand({"during": [66, 72], "shift": [0, 12, 0]}, name="rise", priority=2, tolerance=0.5, recruit=ARM_ONLY),
        ]
    )
    assert done.constraint("stay")["error_max"] < 1e-3
    rise = done.constraint("rise")
    assert rise["error_max"] == pytest.approx(12.0, abs=1e-3)
    assert (rise["status"], rise["gave_way_to"], rise["frame"]) == ("out_of_tolerance", ["stay"], 66)
    assert done.warnings == [
        "motionedit: warning: rise: 12 from its goal at frame 66 (tolerance 0.5): priority 3 above left no freedom"
    ]
    assert done.result.exit_code == 0


@pytest.mark.parametrize(("higher", "eases"), [([76, 80], "in from frame 62 on"), ([42, 50], "out until frame 64")])
def test_it_is_said_whose_ramp_is_over_the_points_of_a_goal(edit, higher, eases):
    done = edit(
        [
            hand({"hold": [60, 66], "shift": [0, 12, 0]}, name="early"),
            hand({"hold": higher, "shift": [5, 0, 10]}, name="late", priority=5),
        ],
        defaults={"ease_in": 14, "ease_out": 14},
    )
    assert done.constraint("early")["gave_way_to"] == ["late"]
    assert any(line.endswith(f"priority 5 above left no freedom: late eases {eases}") for line in done.warnings)


def test_only_the_order_of_priorities_matters(edit):
    balance = {"type": "com", "axes": ["x", "z"]}
    files = []
    for a, b, c in ((10, 2, 15), (2, 1, 3)):
        done = edit([{**FEET_AS_CAPTURED, "priority": a}, {**RAISED, "priority": b}, {**balance, "priority": c}])
        files.append(done.path.read_bytes())
    assert files[0] == files[1] != WALK.read_bytes()


def test_an_arm_alone_leaves_the_text_of_all_other_columns(edit):
    done = edit([{**RAISED, "recruit": ARM_ONLY}], defaults={"ease_in": 6, "ease_out": 6})
    before, after = rows(WALK), rows(done.path)
    changed = {(f, c) for f, row in enumerate(after) for c, text in enumerate(row) if text != before[f][c]}
    assert {c for _, c in changed} <= columns_of(WALK, "LeftArm", "LeftForeArm")
    frames = {f for f, _ in changed}
    assert set(range(61, 78)) <= frames
    # 60 to 78 is active; each of 3 passes reaches 3 sigma further.
    reach = 3 * int(np.ceil(3 * 0.062 * 24))
    assert frames <= set(range(60 - reach, 79 + reach))


def test_what_is_met_already_changes_no_byte(edit):
    done = edit(
        [
            FEET_AS_CAPTURED,
            {"type": "pose", "effector": "LeftHand", "priority": 3},
            {"type": "com", "priority": 2},
            {"type": "posture", "joints": ["Spine", "Spine1"]},
        ]
    )
    assert done.path.read_bytes() == WALK.read_bytes()


def test_orientation_pose_aim_and_posture_hold_in_the_file(edit):
    turned = {"euler": [10, 20, 30], "order": "ZXY"}
    place = list(effector_path(WALK, "RightHand")[70] + [0, 8, 4])
    done = edit(
        [
            FEET_AS_CAPTURED,
            {"type": "orientation", "effector": "LeftHand", "points": [{"hold": [60, 70], "orientation": turned}]},
            {
                "type": "pose",
                "effector": "RightHand",
                "points": [{"hold": [60, 70], "position": place, "orientation": turned}],
            },
            {
                "type": "aim",
                "effector": "Head",
                "axis": [0, 0, 2],
                "recruit": {"joints": ["Neck", "Head"]},
                "points": [{"hold": [60, 70], "position": [50, 170, 500]}],
            },
            {"type": "posture", "joints": ["Spine"], "priority": 9},
        ]
    )
    assert {each["status"] for each in done.record["constraints"]} == {"ok"}
    motion = read_clip(done.path).motion
    poses, names = forward(motion), motion.skeleton.names
    wanted = rot.from_euler(np.radians([30.0, 10.0, 20.0]), (2, 0, 1))
    span = slice(60, 71)
    for joint in ("LeftHand", "RightHand"):
        q = poses.rotations[span, names.index(joint)]
        assert np.degrees(rot.angle_between(q, wanted)).max() < 1e-3
    np.testing.assert_allclose(poses.positions[span, names.index("RightHand")], np.tile(place, (11, 1)), atol=1e-3)
    head = names.index("Head")
    way = np.array([50, 170, 500]) - poses.positions[span, head]
    look = rot.rotate(poses.rotations[span, head], np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(look, way / np.linalg.norm(way, axis=1, keepdims=True), atol=1e-5)
    spine = names.index("Spine")
    np.testing.assert_allclose(motion.rotations[:, spine], read_clip(WALK).motion.rotations[:, spine], atol=1e-6)


def turned_by(path, joint, *, base=None):
    """Return what turns a joint's rotations in the walk into those of an edit, in the world or in a joint's frame."""
    found = []
    for each in (WALK, path):
        motion = read_clip(each).motion
        poses, names = forward(motion), motion.skeleton.names
        q = poses.rotations[:, names.index(joint)]
        found.append(q if base is None else rot.between(poses.rotations[:, names.index(base)], q))
    return found, np.degrees(rot.log(rot.multiply(found[1], rot.conjugate(found[0]))))


def test_a_joint_is_turned_by_so_much_from_where_it_is(edit):
    by = {"rotation_vector": [0, 25, 0]}
    turn = {"type": "orientation", "effector": "Head", "recruit": {"up_to": "Neck"}}
    ride = edit([{**turn, "points": [{"during": [60, 80], "turn": by}]}])
    assert ride.constraint("Head")["error_angle_max"] < 0.01
    np.testing.assert_allclose(turned_by(ride.path, "Head")[1][60:81], np.tile([0, 25, 0], (21, 1)), atol=1e-3)
    hold = edit([{**turn, "points": [{"hold": [60, 80], "turn": by}]}])
    (before, after), _ = turned_by(hold.path, "Head")
    wanted = rot.multiply(rot.exp(np.radians([0.0, 25.0, 0.0])), before[60])
    assert np.degrees(rot.angle_between(after[60:81], wanted)).max() < 1e-3
    instant = edit([{**turn, "points": [{"at": 60, "turn": by}]}])
    np.testing.assert_allclose(turned_by(instant.path, "Head")[1][60], [0, 25, 0], atol=1e-3)


def test_a_turn_is_about_the_axes_of_the_heading_or_of_a_joint(edit):
    by = {"rotation_vector": [20, 0, 0]}
    turn = {"type": "orientation", "effector": "Head", "recruit": {"up_to": "Neck"}}
    points = [{"during": [60, 80], "turn": by}]
    heading = edit([{**turn, "frame": "heading", "points": points}])
    about = turned_by(heading.path, "Head")[1][60:81]
    across = facts_of(read_clip(WALK)).heading_frame().axes[0]
    np.testing.assert_allclose(about, np.tile(20.0 * across, (21, 1)), atol=1e-3)
    inside = edit([{**turn, "relative_to": "Spine1", "points": points}])
    seen = turned_by(inside.path, "Head", base="Spine1")[1][60:81]
    np.testing.assert_allclose(seen, np.tile([20, 0, 0], (21, 1)), atol=1e-3)


@pytest.mark.parametrize("recruit", ["all", {"joints": ["Neck", "Neck1", "Head"]}])
def test_eyes_follow_a_hand_that_moves(edit, recruit):
    eyes = {"type": "aim", "effector": "Head", "axis": [0, 0, 1], "target": "LeftHand", "recruit": recruit}
    done = edit([FEET_AS_CAPTURED, RAISED, {**eyes, "points": [{"hold": [60, 80]}]}])
    assert done.constraint("Head")["error_angle_max"] < 0.01
    motion = read_clip(done.path).motion
    poses, names = forward(motion), motion.skeleton.names
    way = poses.positions[60:81, names.index("LeftHand")] - poses.positions[60:81, names.index("Head")]
    look = rot.rotate(poses.rotations[60:81, names.index("Head")], np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(look, way / np.linalg.norm(way, axis=1, keepdims=True), atol=1e-4)


def test_a_place_in_a_joints_frame_goes_with_the_joint(edit):
    elbow = {
        "type": "position",
        "effector": "RightForeArm",
        "relative_to": "Spine1",
        "priority": 2,
        "recruit": {"up_to": "RightShoulder"},
        "points": [{"hold": [40, 100], "position": [-26, -6, 8]}],
    }
    done = edit([elbow], "--set", "constraints.0.points.0.position.1=-5")
    assert done.record["status"] == "ok"
    motion = read_clip(done.path).motion
    poses, names = forward(motion), motion.skeleton.names
    spine = names.index("Spine1")
    between = (poses.positions[:, names.index("RightForeArm")] - poses.positions[:, spine])[40:101]
    seen = rot.rotate(rot.conjugate(poses.rotations[40:101, spine]), between)
    np.testing.assert_allclose(seen, np.tile([-26, -5, 8], (61, 1)), atol=1e-3)


def test_windows_in_the_world_and_in_the_heading_ask_for_the_same(edit):
    swing = DATA / "golf" / "swing04.bvh"
    heading, path = facts_of(read_clip(swing)).heading_frame(), effector_path(swing, "LeftHand")
    places = path[40] + [0.0, 8.0, 0.0], path[52] + [5.0, 0.0, 5.0]
    files = []
    for frame, given in (("world", places[0]), ("heading", heading.points(places[0]))):
        one = hand({"hold": [40, 44], "position": list(given)}, frame=frame, name="one")
        other = hand({"hold": [52, 55], "position": list(places[1])}, name="other")
        done = edit([one, other], clip=swing, defaults={"ease_in": 10, "ease_out": 10})
        assert max(done.constraint(name)["error_max"] for name in ("one", "other")) < 1e-3
        files.append(effector_path(done.path, "LeftHand"))
    np.testing.assert_allclose(*files, atol=1e-3)


@pytest.mark.parametrize("axes", [["x", "y", "z"], ["y", "z"]])
def test_a_dry_run_says_places_and_shifts_in_the_world(edit, axes):
    swing = DATA / "golf" / "swing04.bvh"
    heading = facts_of(read_clip(swing)).heading_frame()
    place, shift = np.array([20.0, 110.0, 50.0]), np.array([0.0, 5.0, 20.0])
    points = {"at": 40, "position": list(place)}, {"at": 60, "shift": list(shift)}
    done = edit([hand(*points, frame="heading", axes=axes)], "--dry-run", clip=swing)
    told = re.findall(r"(position|shift) (\[.*?\])", done.result.stdout)
    wanted = {"position": heading.world_points(place), "shift": shift @ heading.axes}
    assert {key for key, _ in told} == set(wanted)
    for key, text in told:
        np.testing.assert_allclose(json.loads(text), wanted[key], rtol=1e-3, atol=1e-3)


def test_heading_is_the_characters_own_wherever_it_faces(edit):
    swing = DATA / "golf" / "swing01.bvh"
    heading = facts_of(read_clip(swing)).heading_frame()
    shifted = hand({"at": 60, "shift": [0, 0, 5]}, frame="heading", recruit=ARM_ONLY, priority=1)
    before, after = (effector_path(path, "LeftHand")[60] for path in (swing, edit([shifted], clip=swing).path))
    np.testing.assert_allclose(after - before, 5 * heading.axes[2], atol=1e-3)
    local = heading.points(before) + np.array([2.0, 3.0, 1.0])
    # Without ramps: the arm is straight on the way, and they would be out of its reach.
    at_once = {"ease_in": 0, "ease_out": 0}
    placed = hand({"at": 60, "position": list(local)}, frame="heading", recruit=ARM_ONLY, priority=1, **at_once)
    after = effector_path(edit([placed], clip=swing).path, "LeftHand")[60]
    np.testing.assert_allclose(after, heading.world_points(local), atol=1e-3)
    turned = {
        "type": "orientation",
        "effector": "LeftHand",
        "frame": "heading",
        "points": [{"at": 60, "orientation": {"quaternion": [1, 0, 0, 0]}}],
    }
    motion = read_clip(edit([turned], clip=swing).path).motion
    q = forward(motion).rotations[60, motion.skeleton.names.index("LeftHand")]
    assert np.degrees(rot.angle_between(q, heading.rotation)) < 1e-3


def test_points_may_stand_at_an_event_that_each_clip_has_elsewhere(edit):
    swing = DATA / "golf" / "swing03.bvh"
    rule = {"effector": {"end_site": "Club"}, "minimum_of": "height", "between": ["60%", "85%"]}
    head = {"type": "position", "effector": {"end_site": "Club"}, "points": [{"at": "hit", "shift": [0, 0, 6]}]}
    done = edit([head], clip=swing, events={"hit": {"detect": rule}}, defaults={"ease_in": 8, "ease_out": 8})
    before, after = (effector_path(path, "Club", end_site=True) for path in (swing, done.path))
    moved = np.linalg.norm(after - before, axis=1)
    assert abs(int(np.argmax(moved)) - int(np.argmin(before[70:110, 1])) - 70) <= 1
    assert moved.max() == pytest.approx(6.0, abs=0.01)


def test_a_dry_run_says_what_is_asked_at_each_point(edit):
    turn = {"euler": [0, 9, 0], "order": "ZXY"}
    points = [{"at": 20}, {"hold": [30, 40], "shift": [0, -5, 0.25]}, {"at": 60, "position": [40, 120, 200]}]
    asked = [
        hand(*points),
        {"type": "orientation", "effector": "Head", "points": [{"during": [3, 9], "turn": turn}]},
        {"type": "distance", "effector": "LeftHand", "to": "Head", "points": [{"at": 5, "at_least": 30}]},
    ]
    plan = edit(asked, "--dry-run").result.stdout
    assert "; at 20, hold [30, 40] shift [0, -5, 0.25], at 60 position [40, 120, 200]; recruits" in plan
    assert "; during [3, 9] turn; recruits" in plan
    assert "; at 5 at_least 30; recruits" in plan
