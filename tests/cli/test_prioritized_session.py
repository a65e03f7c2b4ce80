"""edit-prioritized on the walk and the swings of data/: what a spec asks for is in the file that is written."""

import json
import re
import weakref
from pathlib import Path

import numpy as np
import pytest
from channels import motion_from_channels

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion, scaled
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.jobs.clip import facts as clip_facts
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.edit_prioritized import job as edit_prioritized
from studies.lab import effector_path, joint_positions

DATA = Path(__file__).resolve().parents[2] / "data"
WALK = DATA / "walk.bvh"
FEET = ("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase")

FEET_AS_CAPTURED = {"name": "feet", "type": "position", "effector": list(FEET), "priority": 10}
ARM_ONLY = {"joints": ["LeftArm", "LeftForeArm"]}


def hand(*points, **more):
    return {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 4, "points": list(points), **more}


RAISED = hand({"hold": [66, 72], "shift": [5, 20, 10]})


class Edited:
    """A run of the command, the file it wrote and the clip's entry in its report."""

    def __init__(self, result, folder):
        self.result, self.path = result, folder / "e.bvh"
        report = folder / "r.json"
        self.record = json.loads(report.read_text())["clips"][0] if report.exists() else None

    def constraint(self, name):
        return next(each for each in self.record["constraints"] if each["name"] == name)

    @property
    def warnings(self):
        return [line for line in self.result.stderr.splitlines() if "warning" in line]

    @property
    def errors(self):
        return [line for line in self.result.stderr.splitlines() if "error:" in line]


@pytest.fixture
def edit(run, tmp_path):
    """Return a runner: constraints, options of the command, and further keys of the spec."""

    def invoke(constraints, *arguments, clip=WALK, **keys):
        spec = {"schema": "motionedit/edit-prioritized/v1", **keys, "constraints": constraints}
        (tmp_path / "s.yaml").write_text(json.dumps(spec, indent=1))
        for name in ("e.bvh", "r.json"):
            (tmp_path / name).unlink(missing_ok=True)
        result = run(
            "edit-prioritized", clip, "-s", "s.yaml", "-o", "e.bvh", "--report", "r.json", *map(str, arguments)
        )
        return Edited(result, tmp_path)

    return invoke


def rows(path):
    """Return the values' text, a list per frame."""
    lines = path.read_text().splitlines()
    return [line.split() for line in lines[lines.index("MOTION") + 3 :]]


def columns_of(path, *joints):
    skeleton = read_clip(path).motion.skeleton
    return {c for name in joints for c in skeleton.columns(skeleton.names.index(name), "rotation")}


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
    assert (np.abs(one - other) < 6.0).all()
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


def test_an_unreachable_hand_warns_and_fails_strict_alone(edit):
    far = hand({"hold": [66, 72], "shift": [0, 300, 0]}, recruit={"up_to": "LeftArm"})
    done = edit([far], "--strict")
    assert done.result.exit_code == 3
    assert done.record["status"] == done.constraint("hand")["status"] == "unreachable"
    assert done.warnings[0].endswith("(tolerance 0.102): out of reach of the joints it recruits")
    assert done.record["message"] == done.warnings[0].removeprefix("motionedit: warning: ")
    assert done.path.exists()
    assert edit([far]).result.exit_code == 0
    off = edit([{**far, "tolerance": "off"}], "--strict")
    assert off.constraint("hand")["status"] == "ok"
    assert not [line for line in off.warnings if "from its goal" in line]
    # How the arm shoots out is another matter.
    assert off.record["status"] in {"ok", "rough"}


def test_what_only_rides_warns_where_it_is_far_off_and_does_not_fail_strict(edit):
    riding = {"name": "ride", "type": "position", "effector": "LeftHand", "priority": 1}
    done = edit([RAISED, riding], "--strict")
    assert done.result.exit_code == 0
    assert done.record["status"] == "ok"
    ride = done.constraint("ride")
    assert (ride["status"], ride["strict"], ride["gave_way_to"]) == ("out_of_tolerance", False, ["hand"])
    assert "warning: ride: " in done.result.stderr
    near = edit([hand({"during": [66, 72], "shift": [0, 0.5, 0]}), riding])
    assert near.constraint("ride")["status"] == "out_of_tolerance"
    assert not near.warnings
    assert edit([RAISED, {**riding, "tolerance": 0.5}], "--strict").result.exit_code == 3


def test_the_report_tells_every_frame(edit):
    record = edit([FEET_AS_CAPTURED, RAISED]).record
    hand = record["constraints"][-1]
    assert len(hand["frames"]["error"]) == hand["last_frame"] - hand["first_frame"] + 1
    assert max(hand["frames"]["error"]) == pytest.approx(hand["error_max"])
    assert len(record["frames"]["iterations"]) == len(record["frames"]["stopped"]) == 145
    assert set(record["frames"]["stopped"]) <= {"converged", "iterations", "untouched"}
    for layer in record["layers"]:
        assert len(layer["frames"]["rank"]) == 145
        assert max(layer["frames"]["rank"]) == layer["rank"]["max"]


def test_the_report_has_the_fixed_keys(edit):
    done = edit([FEET_AS_CAPTURED, RAISED, {"type": "com", "priority": 2}], unit="cm")
    clip = done.record
    assert list(clip)[:4] == ["clip", "output", "status", "message"]
    assert {"unit", "metrics", "constraints", "layers", "iterations", "passes"} <= set(clip)
    assert clip["unit"] == "cm"
    assert [each["name"] for each in clip["constraints"]] == ["feet", "feet-2", "feet-3", "feet-4", "hand", "com"]
    keys = {"name", "priority", "error_max", "error_rms", "error_angle_max", "frame", "status", "gave_way_to"}
    for each in clip["constraints"]:
        assert keys <= set(each)
        assert each["error_angle_max"] is None
    assert [(layer["priority"], layer["rank"]) for layer in clip["layers"]] == [
        (10, {"min": 10, "max": 10}),
        (4, {"min": 3, "max": 3}),
        (2, {"min": 3, "max": 3}),
    ]
    wrist = done.constraint("hand")
    assert wrist["recruited"][-1] == "Hips.position"
    # 0.8 s at 24 Hz is 19.2 frames.
    assert (wrist["first_frame"], wrist["last_frame"]) == (47, 91)


def test_a_dry_run_lists_the_layers_in_solving_order_and_writes_nothing(edit):
    feet = {**FEET_AS_CAPTURED, "effector": ["LeftFoot", "RightFoot"], "recruit": {"levels": 1}}
    wrist = {**RAISED, "recruit": {"joints": ["Hips", "LeftForeArm", "Hips.position"]}}
    com = {"type": "com", "recruit": ARM_ONLY, "support": ["LeftFoot", "RightFoot"], "weight": 2}
    done = edit([wrist, feet, com], "--dry-run", defaults={"ease_in": 5, "ease_out": 5})
    assert done.result.exit_code == 0
    moved = ("Hips", "LeftArm", "LeftForeArm", "Hips.position")
    assert done.result.stdout.splitlines() == [
        f"would write {WALK} -> e.bvh",
        "  layer 1, priority 10",
        "    feet: position of LeftFoot, frames 0 to 144; recruits Hips, LeftLeg, Hips.position",
        "    feet-2: position of RightFoot, frames 0 to 144; recruits Hips, RightLeg, Hips.position",
        "  layer 2, priority 4",
        f"    hand: position of LeftHand, frames 61 to 77; hold [66, 72]; recruits {', '.join(moved)}",
        "  layer 3, priority 1",
        "    com: center of mass over LeftFoot, RightFoot, frames 0 to 144; weight 2; recruits LeftArm, LeftForeArm",
        "  hinges: LeftLeg, RightLeg, LeftForeArm, RightForeArm",
        "  recruiting_rule expand adds LeftArm to hand because com moves them",
        "  recruiting_rule expand adds Hips, Hips.position to feet, feet-2 because hand moves them",
        "would write the report r.json",
    ]
    assert not done.path.exists()


def test_a_key_set_on_the_command_line_reaches_the_edit(edit):
    done = edit([RAISED], "--set", "constraints.hand.points.0.shift=[0, 3, 0]")
    before, after = (effector_path(path, "LeftHand") for path in (WALK, done.path))
    np.testing.assert_allclose(after[66] - before[66], [0, 3, 0], atol=1e-3)


def test_the_same_bytes_for_any_number_of_jobs(run, tmp_path):
    spec = {"schema": "motionedit/edit-prioritized/v1", "constraints": [FEET_AS_CAPTURED, RAISED]}
    (tmp_path / "s.yaml").write_text(json.dumps(spec))
    clips = [DATA / "golf" / f"swing{n:02d}.bvh" for n in (1, 2, 3)]
    for jobs in ("1", "2"):
        result = run(
            *("edit-prioritized", *clips, "-s", "s.yaml", "-o", f"o{jobs}", "-j", jobs, "--report", f"{jobs}.json")
        )
        assert result.exit_code == 0
    for clip in clips:
        assert (tmp_path / "o1" / clip.name).read_bytes() == (tmp_path / "o2" / clip.name).read_bytes()
        assert (tmp_path / "o1" / clip.name).read_bytes() != clip.read_bytes()
    first, second = ((tmp_path / f"{jobs}.json").read_text() for jobs in "12")
    assert first.replace("o1/", "o2/") == second


@pytest.mark.parametrize("factor", [0.01, 10.0, 1 / 2.54])
def test_the_unit_of_the_file_does_not_matter(edit, tmp_path, factor):
    (tmp_path / "same.bvh").write_bytes(new_bytes(read_clip(WALK).motion, decimals=9))
    (tmp_path / "other.bvh").write_bytes(new_bytes(scaled(read_clip(WALK).motion, factor), decimals=9))
    motions = []
    for name, size in (("same", 1.0), ("other", factor)):
        raised = hand({"hold": [66, 72], "shift": [5 * size, 20 * size, 10 * size]})
        done = edit([FEET_AS_CAPTURED, raised, {"type": "com", "priority": 2}], clip=tmp_path / f"{name}.bvh")
        motions.append(read_clip(done.path).motion)
    assert np.degrees(rot.angle_between(motions[0].rotations, motions[1].rotations)).max() < 1e-3
    np.testing.assert_allclose(motions[1].translations / factor, motions[0].translations, atol=1e-4)


def test_masses_given_in_kilograms_move_the_balance(edit):
    com = {"type": "com", "relative_to": "world", "priority": 5, "points": [{"hold": [66, 72], "shift": [3, 0, 0]}]}
    done = edit([FEET_AS_CAPTURED, com], masses={"Head": 5})
    before, after = (effector_path(path, "Head") for path in (WALK, done.path))
    assert (after - before)[66:73, 0].min() > 2.5
    assert done.constraint("com")["status"] == "ok"


def test_the_settings_of_the_spec_reach_the_solver(edit):
    points = [{"at": 60, "shift": [0, 5, 0]}, {"at": 64, "shift": [0, 12, 0]}, {"at": 84}]
    arm = hand(*points, recruit={"up_to": "LeftShoulder"})
    settings = ({}, {"curve": "index"}, {"attraction": 0}, {"smoothing": {"passes": 0}}, {"smoothing": {"sigma": 5}})
    files = {edit([arm], **keys).path.read_bytes() for keys in settings}
    assert len(files) == len(settings)
    lifted = hand({"at": 60, "shift": [0, 5, 0]}, frame="heading", recruit=ARM_ONLY)
    for up, axis in (("y", 1), ("z", 2)):
        moved = effector_path(edit([lifted], up=up).path, "LeftHand") - effector_path(WALK, "LeftHand")
        np.testing.assert_allclose(moved[60], 5.0 * np.eye(3)[axis], atol=1e-3)


def test_the_papers_smoothing_and_curve_are_there(edit):
    constraints = [{**RAISED, "recruit": ARM_ONLY}]
    done = edit(constraints, smoothing={"method": "paper"}, curve="index", attraction=0.5)
    assert done.record["status"] == "ok"
    assert done.record["passes"] == 2
    once = edit(constraints, smoothing={"method": "paper", "passes": 1})
    assert once.record["passes"] == 1


def test_too_few_iterations_are_said_to_have_run_out(edit):
    low = {"smoothing": {"passes": 0}, "solver": {"max_iterations": 1}}
    done = edit([{**RAISED, "recruit": ARM_ONLY}], **low)
    assert done.record["frames_not_converged"] > 0
    assert "the iterations ran out" in done.record["message"]


def test_hinges_keep_to_their_axis_and_may_be_turned_off(edit):
    reach = hand({"hold": [66, 72], "shift": [-12, 25, 5]}, recruit={"up_to": "LeftArm"})

    def off_axis(path):
        """Return how far an elbow turns about anything but its axis, in degrees."""
        elbow = read_clip(WALK).motion.skeleton.names.index("LeftForeArm")
        before, after = (rot.log(read_clip(each).motion.rotations[:, elbow]) for each in (WALK, path))
        axis = np.linalg.eigh(before.T @ before)[1][:, -1]
        return np.degrees(np.linalg.norm(after - np.outer(after @ axis, axis), axis=1).max())

    assert off_axis(edit([reach]).path) < 1e-3
    assert off_axis(edit([reach], hinges="off").path) > 10.0
    listed = edit([reach], hinges=["LeftArm", "LeftForeArm"])
    assert "hinges: LeftArm is no hinge in the input" in listed.warnings[0]


def test_a_breach_of_the_recruiting_rule_is_mended_left_or_refused(edit):
    constraints = [{**FEET_AS_CAPTURED, "recruit": {"up_to": "LHipJoint"}, "effector": ["LeftFoot"]}, RAISED]
    done = edit(constraints)
    assert done.constraint("feet")["status"] == "ok"
    assert "recruiting_rule expand adds Hips, Hips.position to feet because hand moves them" in done.result.stderr
    left = edit(constraints, recruiting_rule="ignore")
    assert "hand moves feet by Hips, Hips.position" in left.warnings[0]
    refused = edit(constraints, recruiting_rule="error")
    assert refused.result.exit_code == 2
    (error,) = refused.errors
    assert error.startswith(f"motionedit: error: s.yaml:{line(refused, 'recruit')}: constraints.0.recruit: in {WALK}: ")
    assert "'feet' does not recruit Hips, Hips.position, by which 'hand' moves it; recruit them, or set" in error


def line(done, key):
    lines = (done.path.parent / "s.yaml").read_text().splitlines()
    return 1 + next(n for n, text in enumerate(lines) if f'"{key}"' in text)


@pytest.mark.parametrize(
    ("constraint", "keys", "place", "message"),
    [
        ({"effector": "LeftHnd"}, {}, "constraints.0.effector", "no joint 'LeftHnd' in"),
        ({"effector": {"end_site": "LeftHand"}}, {}, "constraints.0.effector", "has no end site"),
        ({"relative_to": "Spin1"}, {}, "constraints.0.relative_to", "did you mean 'Spine1'?"),
        ({"recruit": {"up_to": "RightArm"}}, {}, "constraints.0.recruit.up_to", "'RightArm' is not on the way of 'h'"),
        ({"recruit": {"joints": ["LeftArm", "Arm"]}}, {}, "constraints.0.recruit.joints.1", "no joint 'Arm'"),
        ({}, {"defaults": {"recruit": {"up_to": "Head"}}}, "defaults.recruit.up_to", "'Head' is not on the way"),
        ({"points": [{"at": 145}]}, {}, "constraints.0.points.0.at", "145 is outside the clip"),
        ({"points": [{"hold": [3, 9]}, {"at": 8}]}, {}, "constraints.0.points.1", "'at 8'"),
        ({"type": "com", "support": ["Foot"]}, {}, "constraints.0.support.0", "no joint 'Foot'"),
        ({"type": "posture", "joints": ["Head", "Hat"]}, {}, "constraints.0.joints.1", "no joint 'Hat'"),
        ({"type": "aim", "axis": [0, 0, 1], "target": "Hat"}, {}, "constraints.0.target", "no joint 'Hat'"),
        ({}, {"masses": {"Hat": 1}}, "masses.Hat", "no joint 'Hat'"),
        ({}, {"masses": {"Head": 0}}, "masses", "not 0 for all joints"),
        ({}, {"events": {"hit": {"frames": {"walk": 200}}}}, "events.hit", "200 is outside"),
    ],
)
def test_what_the_clip_lacks_is_said_in_one_line_with_its_place(edit, constraint, keys, place, message):
    whole = {"name": "h", "type": "position", "effector": "LeftHand", **constraint}
    if whole["type"] in {"com", "posture"}:
        del whole["effector"]
    done = edit([whole], **keys)
    assert done.result.exit_code in {1, 2}
    (error,) = done.errors
    assert f": {place}: " in error
    assert message in error
    assert not done.path.exists()


def test_all_that_a_clip_lacks_is_said_together(edit):
    bad = hand({"at": 900}, effector="Hnd", recruit={"up_to": "Hat"})
    done = edit([bad, {"type": "posture", "joints": ["Hat"]}], masses={"Hat": 1}, hinges=["Knee"])
    assert len(done.errors) == 6


def test_four_effectors_of_one_list_say_a_common_fault_once(edit):
    done = edit([{**FEET_AS_CAPTURED, "points": [{"at": 900}]}])
    assert len(done.errors) == 1
    assert "more clips" not in done.errors[0]


def test_a_clip_that_lacks_a_joint_fails_alone(run, clip, tmp_path):
    clip("in/chain.bvh", frames=100)
    (tmp_path / "in" / "walk.bvh").write_bytes(WALK.read_bytes())
    spec = {"schema": "motionedit/edit-prioritized/v1", "constraints": [{**RAISED, "recruit": ARM_ONLY}]}
    (tmp_path / "s.yaml").write_text(json.dumps(spec))
    result = run("edit-prioritized", "in", "-s", "s.yaml", "-o", "out")
    assert (result.exit_code, result.stdout) == (1, "out/walk.bvh\n")
    assert "no joint 'LeftHand' in in/chain.bvh" in result.stderr


def loose(done):
    return [line.removeprefix("motionedit: warning: ") for line in done.warnings if "no constraint holds it" in line]


def test_a_hand_that_drags_the_body_along_says_of_each_foot_that_no_one_holds_it(edit):
    done = edit([RAISED])
    lines = loose(done)
    assert len(lines) == 2
    for foot, side, line in zip(("left", "right"), ("Left", "Right"), lines, strict=True):
        way, frame = re.fullmatch(
            rf"the {foot} foot moves by (\S+) at frame (\d+) while it is planted, and no constraint holds it", line
        ).groups()
        joints = [side + part for part in ("Foot", "ToeBase")]
        ways = [effector_path(done.path, joint) - effector_path(WALK, joint) for joint in joints]
        there = [float(np.linalg.norm(each[int(frame)])) for each in ways]
        assert any(float(way) == pytest.approx(each, rel=1e-2) for each in there)
    assert not edit([{**FEET_AS_CAPTURED, "priority": 1}, RAISED]).warnings
    assert not edit([{**RAISED, "recruit": ARM_ONLY}]).warnings


def test_one_foot_that_is_held_says_nothing_of_the_other(edit):
    for held, other in (("Left", "right"), ("Right", "left")):
        feet = {**FEET_AS_CAPTURED, "effector": [held + "Foot", held + "ToeBase"]}
        (line,) = loose(edit([feet, RAISED]))
        assert line.startswith(f"the {other} foot moves by ")
    toes = {**FEET_AS_CAPTURED, "effector": ["LeftToeBase", "RightToeBase"]}
    assert not loose(edit([toes, RAISED]))


def test_a_foot_that_is_held_in_other_frames_alone_is_told_of(edit):
    feet = {**FEET_AS_CAPTURED, "points": [{"during": [0, 5]}], "ease_out": 0}
    assert len(loose(edit([feet, RAISED]))) == 2


def test_a_leg_of_an_odd_length_questions_the_unit(edit):
    assert edit([FEET_AS_CAPTURED, RAISED], unit="m").warnings == [
        "motionedit: warning: a leg is 86.5 m long where the unit is m: is that the clip's unit?"
    ]


def test_a_rest_pose_in_front_keeps_its_text(edit, tmp_path):
    motion = read_clip(WALK).motion
    rest = np.tile(rot.IDENTITY, (2, len(motion.skeleton), 1))
    longer = Motion(
        motion.skeleton,
        np.concatenate((rest, motion.rotations)),
        np.concatenate((motion.translations[[0, 0]], motion.translations)),
        motion.frame_time,
    )
    path = tmp_path / "rest.bvh"
    path.write_bytes(new_bytes(longer))
    early = hand({"during": [2, 12], "shift": [0, 8, 0]}, recruit=ARM_ONLY)
    done = edit([FEET_AS_CAPTURED, early], clip=path, defaults={"ease_in": 0, "ease_out": 4})
    assert done.record["status"] == "ok"
    # The edit begins at once after the rest pose; smoothing it over time must not reach back into that.
    assert rows(done.path)[:2] == rows(path)[:2]
    assert rows(done.path)[2] != rows(path)[2]


@pytest.mark.filterwarnings("ignore:Importing PyGLM:PendingDeprecationWarning")  # bvhio's own affair
def test_verify_reads_the_edit_back_with_another_reader(edit):
    done = edit([FEET_AS_CAPTURED, RAISED], "--verify")
    assert done.result.exit_code == 0
    assert done.record["verify"]["distance"] < 0.09


def test_edited_angles_stay_continuous(edit):
    done = edit([FEET_AS_CAPTURED, RAISED])
    steps = np.abs(np.diff(np.array(rows(done.path), dtype=float)[:, 3:], axis=0)).max()
    assert steps < 60.0
    assert np.isfinite(joint_positions(done.path)).all()


def test_the_papers_filter_is_named_where_it_leaves_an_error(edit):
    # One pass is the filter alone, without the solve that makes good what it moved.
    done = edit([FEET_AS_CAPTURED, {**RAISED, "tolerance": 0.1}], smoothing={"method": "paper", "passes": 1})
    missed = [line for line in done.warnings if "the low-pass on the root moved it (smoothing: paper)" in line]
    assert missed
    held = edit(
        [hand({"at": 70, "shift": [40, 20, 90]}, recruit={"joints": ["Hips.position"]})], smoothing={"method": "paper"}
    )
    assert "the low-pass on the root moved it" in held.record["message"]
    far = hand({"hold": [66, 72], "shift": [0, 300, 0]}, recruit=ARM_ONLY)
    assert edit([far], smoothing={"method": "paper"}).record["status"] == "unreachable"


def crane(path, *, root=(), arm=("Zrotation",), offset=10.0):
    """Write a chain with a joint of one channel: Base, Boom, Hook, 12 frames."""
    names, last = ("Base", "Boom", "Hook"), ("Zrotation", "Xrotation", "Yrotation")
    offsets = np.array([[0.0, 0.0, 0.0], [0.0, offset, 0.0], [offset, 0.0, 0.0]])
    site = EndSite(2, np.array([0.5 * offset, 0.0, 0.0]))
    skeleton = Skeleton(names, np.array([-1, 0, 1]), offsets, (root, arm, last), (site,))
    values = np.linspace(5.0, 30.0, 12)[:, None] * np.ones(skeleton.channel_count)
    path.write_bytes(new_bytes(motion_from_channels(skeleton, values, frame_time=0.1)))
    return path


@pytest.mark.parametrize("root", [(), ("Yposition",)])
def test_a_joint_with_one_channel_turns_about_it_and_a_root_without_all_channels_stays(edit, tmp_path, root):
    path = crane(tmp_path / "crane.bvh", root=root)
    place = list(effector_path(path, "Hook")[6] + np.array([-0.5, 0.2, 3.0]))
    lift = {
        "name": "hook",
        "type": "position",
        "effector": {"end_site": "Hook"},
        "points": [{"at": 6, "shift": [0, 0.5, 0]}],
    }
    done = edit([{**lift, "axes": ["x", "y"]}], clip=path, hinges="off")
    assert done.record["status"] == "ok"
    before, after = (effector_path(each, "Hook", end_site=True)[6] for each in (path, done.path))
    np.testing.assert_allclose((after - before)[:2], [0, 0.5], atol=1e-4)
    # The hook's own place lies on a circle about the boom: out of its plane nothing can be done.
    out = edit([{**lift, "effector": "Hook", "points": [{"at": 6, "position": place}]}], clip=path)
    assert out.record["status"] == "unreachable"
    after = effector_path(out.path, "Hook")[6]
    assert after[2] == pytest.approx(0.0, abs=1e-6)


def test_a_listed_hinge_that_does_not_bend_stays_free_with_a_warning(edit):
    done = edit([{**RAISED, "recruit": ARM_ONLY}], hinges=["LThumb", "LHipJoint"])
    assert "warning: hinges: LHipJoint does not bend in the input" in done.result.stderr


def test_a_body_without_length_is_refused(edit, tmp_path):
    path = crane(tmp_path / "point.bvh", offset=0.0)
    done = edit([{"type": "posture", "joints": ["Boom"]}], clip=path)
    assert done.result.exit_code == 1
    assert "its bones have no length; a body without length cannot be edited" in done.errors[0]


def test_balance_without_feet_keeps_to_the_path_of_the_center_of_mass(edit, tmp_path):
    path = crane(tmp_path / "crane.bvh", arm=("Zrotation", "Xrotation", "Yrotation"))
    done = edit([{"type": "com"}], clip=path)
    assert "no feet found for the support of 'com'" in done.result.stderr
    assert "the skeleton is not a human's" in done.result.stderr
    assert done.path.read_bytes() == path.read_bytes()


def test_the_world_transforms_of_the_input_are_given_back_before_the_edit_is_solved(edit, monkeypatch):
    made, held = [], []
    forward_of_all, solve = kinematics.forward, edit_prioritized.edit_by_priorities

    def noted(motion):
        poses = forward_of_all(motion)
        made.append(weakref.ref(poses))
        return poses

    def solved(*arguments, **named):
        held.extend(each() for each in made)
        return solve(*arguments, **named)

    monkeypatch.setattr(clip_facts.kinematics, "forward", noted)
    monkeypatch.setattr(edit_prioritized, "edit_by_priorities", solved)
    assert edit([RAISED]).result.exit_code == 0
    assert held
    assert held == [None] * len(held)


def test_an_edit_in_pieces_is_verified_and_goes_to_standard_output_whole(edit, run):
    done = edit([FEET_AS_CAPTURED, RAISED], "--verify")
    assert done.record["verify"]["distance"] < 0.01
    shown = run("edit-prioritized", WALK, "-s", "s.yaml", "-o", "-", "-q")
    assert shown.stdout_bytes == done.path.read_bytes()
