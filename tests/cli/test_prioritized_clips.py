"""edit-prioritized on clips of other bodies, units and channels, behind a rest pose, and written in pieces."""

import os
import weakref

import numpy as np
import pytest
from channels import motion_from_channels
from prioritized_edits import ARM_ONLY, FEET_AS_CAPTURED, RAISED, WALK, hand, rows

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.bvh.file_bytes import FileBytes
from motionedit.core.motion import Motion
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.jobs.clip import facts as clip_facts
from motionedit.jobs.edit_prioritized import job as edit_prioritized
from studies.lab import effector_path, joint_positions


def test_a_leg_of_an_odd_length_questions_the_unit(edit):
    assert edit([FEET_AS_CAPTURED, RAISED], unit="m").warnings == [
        "motionedit: warning: a leg is 86.5 m long where the unit is m: is that the clip's unit?"
    ]


@pytest.mark.parametrize(("up", "asks"), [(400.0, 1), (200.0, 0)])
def test_a_goal_that_is_many_legs_away_asks_for_its_unit(edit, up, asks):
    lines = edit([FEET_AS_CAPTURED, hand({"hold": [60, 70], "shift": [0, up, 0]})]).warnings
    assert sum("is it in the clip's unit?" in line for line in lines) == asks


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


def test_a_long_file_is_not_held_and_its_other_bytes_are_read_again(edit, monkeypatch):
    held = edit([FEET_AS_CAPTURED, RAISED]).path.read_bytes()
    read, kept = [], FileBytes.between
    monkeypatch.setattr(FileBytes, "between", lambda file, *span: (read.append(file._data), kept(file, *span))[1])
    monkeypatch.setattr(edit_prioritized, "_LONG", 0)
    assert edit([FEET_AS_CAPTURED, RAISED]).path.read_bytes() == held
    assert read
    assert set(read) == {None}


def test_a_long_file_that_is_changed_meanwhile_fails_and_nothing_is_written(run, edit, monkeypatch, tmp_path):
    assert edit([FEET_AS_CAPTURED, RAISED]).result.exit_code == 0  # writes the spec, too
    path, let_go = tmp_path / "walk.bvh", FileBytes.let_go
    path.write_bytes(WALK.read_bytes())

    def let_go_and_change(file, source):
        let_go(file, source)
        source.write_bytes(WALK.read_bytes()[::-1])
        os.utime(source, ns=(1, 1))

    monkeypatch.setattr(FileBytes, "let_go", let_go_and_change)
    monkeypatch.setattr(edit_prioritized, "_LONG", 0)
    failed = run("edit-prioritized", path, "-s", next(tmp_path.glob("*.yaml")), "-o", "out")
    assert failed.exit_code == 1
    assert "walk.bvh: was changed while it was edited; run again" in failed.stderr
    assert [each.name for each in (tmp_path / "out").iterdir() if each.suffix == ".bvh"] == []


def test_edited_angles_stay_continuous(edit):
    done = edit([FEET_AS_CAPTURED, RAISED])
    steps = np.abs(np.diff(np.array(rows(done.path), dtype=float)[:, 3:], axis=0)).max()
    assert steps < 60.0
    assert np.isfinite(joint_positions(done.path)).all()


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
