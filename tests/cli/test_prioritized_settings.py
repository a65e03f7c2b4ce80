"""edit-prioritized: the keys of a spec beside its constraints reach the solver, for any unit and number of jobs."""

import json

import numpy as np
import pytest
from prioritized_edits import ARM_ONLY, DATA, FEET_AS_CAPTURED, RAISED, WALK, hand

from motionedit.core import rotations as rot
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.motion import scaled
from motionedit.spec import schema_of
from studies.lab import effector_path


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
    found = done.path.read_bytes()
    assert edit([FEET_AS_CAPTURED, com], masses={"Head": 5, "Hips": 0, "LeftArm": 0}).path.read_bytes() == found
    described = schema_of("edit-prioritized")["properties"]["masses"]["description"]
    assert "a joint that is not listed weighs nothing" in described


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
    assert error.startswith(
        f"motionedit: error: s.yaml:{refused.line_of('recruit')}: constraints.0.recruit: in {WALK}: "
    )
    assert "'feet' does not recruit Hips, Hips.position, by which 'hand' moves it; recruit them, or set" in error
