"""What edits make of the golf swings' bodies: joints turned, hands on the club, elbows, headings, units."""

import json

import numpy as np
import pytest
from golf_edits import HITS, edit_spec

from motionedit.core import kinematics, rotations
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.motion import Motion
from motionedit.core.skeleton import EndSite
from motionedit.dataclass import replace
from studies.lab import effector_path
from studies.paper.study import GOLF


def test_what_is_misread_of_a_body_is_said_of_an_edit(golf, tmp_path):
    swings = []
    for swing in golf.swings[:3]:
        motion = read_clip(swing).motion
        mirrored, places = motion.rotations.copy(), motion.translations.copy()
        mirrored[..., [2, 3]] *= -1.0  # in x, and no name with it
        places[..., 0] *= -1.0
        skeleton = replace(motion.skeleton, offsets=motion.skeleton.offsets * [-1.0, 1.0, 1.0])
        swings.append(tmp_path / swing.name)
        swings[-1].write_bytes(new_bytes(Motion(skeleton, mirrored, places, motion.frame_time)))
    edit = golf.edit(swings[0], [0, 0, 1], model=golf.lab.model(swings, GOLF))
    assert any("what is taken for left is on the right" in line for line in edit.warnings)
    assert not any("on the right" in line for line in golf.edit(golf.swings[0], [0, 0, 1]).warnings)


def test_a_goal_turns_a_joint_by_so_much_from_where_it_is(golf):
    swing, hit = golf.swings[3], HITS["swing04"]
    found = []
    edit = golf.edit(swing, goal={"effector": "RightHand", "turn": {"rotation_vector": [0, 12, 0]}})
    for path in (swing, edit.path):
        motion = read_clip(path).motion
        found.append(kinematics.forward(motion).rotations[hit, motion.skeleton.names.index("RightHand")])
    turn = np.degrees(rotations.log(rotations.multiply(found[1], rotations.conjugate(found[0]))))
    np.testing.assert_allclose(turn, [0, 12, 0], atol=0.01)


def slips(golf, clip, **spec):
    """Return by how much the left hand moves on the right hand's grip, cm, shape (F,), and the edit's record."""
    edit = golf.edit(clip, [0, 0, 10], **spec)
    places = []
    for path in (clip, edit.path):
        motion = read_clip(path).motion
        poses, names = kinematics.forward(motion), motion.skeleton.names
        left, right = names.index("LeftHand"), names.index("RightHand")
        apart = poses.positions[:, left] - poses.positions[:, right]
        places.append(rotations.unrotate(poses.rotations[:, right], apart))
    return np.linalg.norm(places[1] - places[0], axis=1), edit.record


def test_both_hands_stay_on_the_club_unless_they_are_let_go(golf):
    for swing in golf.swings:
        slipped, record = slips(golf, swing)
        assert slipped.max() < 3.0
        assert np.median(slipped) < 1e-3
        assert record["status"] in ("ok", "rough")
        last = len(read_clip(swing).motion) - 1
        assert record["hands"]["grips"] == [{"first_frame": 0, "last_frame": last}]
        assert record["hands"]["apart_max"] == pytest.approx(slipped.max(), abs=1e-3)
    slipped, record = slips(golf, golf.swings[9], hands="off")
    assert slipped.max() > 20.0
    assert record["hands"] is None


@pytest.mark.parametrize(("swing", "shift"), [("swing04", [0, 10, 0]), ("swing10", [-10, 0, 0])])
def test_elbows_are_not_bent_back_and_the_hand_goes_where_it_shall(run, golf, data, tmp_path, swing, shift):
    goal = {"at": "hit", "effector": "RightHand", "shift": shift}
    found = {}
    for hinges in ("off", "auto"):
        spec = edit_spec(tmp_path / "e.yaml", goals=[goal], hands="off", hinges=hinges)
        clip = data / f"{swing}.bvh"
        run("edit-pc", clip, "-m", golf.model, "-s", spec, "-o", f"{hinges}.bvh", "--report", "r.json")
        found[hinges] = json.loads((tmp_path / "r.json").read_text())["clips"][0]
        before, after = (effector_path(p, "RightHand")[HITS[swing]] for p in (clip, tmp_path / f"{hinges}.bvh"))
        np.testing.assert_allclose(after - before, shift, atol=0.01)
    assert found["off"]["status"] == "rough"
    assert "RightForeArm: bent back by" in found["off"]["message"]
    assert found["auto"]["status"] == "ok"


def test_shifts_in_the_heading_frame_are_the_characters_own(run, golf, data, tmp_path):
    spec = edit_spec(tmp_path / "e.yaml")
    run(
        *("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", spec, "-o", "h.bvh"),
        *("--set", "goals.ball.frame=heading", "--set", "goals.ball.shift=[0, 0, 5]"),
    )
    before, after = (
        effector_path(p, "Club", end_site=True)[HITS["swing01"]] for p in (data / "swing01.bvh", tmp_path / "h.bvh")
    )
    assert np.linalg.norm(after - before) == pytest.approx(5.0, abs=1e-3)
    info = run("info", data / "swing01.bvh", "--report", "i.json")
    assert info.exit_code == 0
    heading = np.radians(json.loads((tmp_path / "i.json").read_text())["clips"][0]["heading"])
    np.testing.assert_allclose(after - before, 5.0 * np.array([np.sin(heading), 0.0, np.cos(heading)]), atol=1e-2)


def test_in_metres_the_same_edit_comes_out(run, configs, data, tmp_path):
    for name, scale in (("cm", 1.0), ("m", 0.01)):
        for n in range(1, 5):
            clip = read_clip(data / f"swing{n:02d}.bvh")
            motion = clip.motion
            text = clip_scaled(clip, scale)
            path = tmp_path / name / f"swing{n:02d}.bvh"
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(text)
            assert len(motion)
        run("normalize", name, "-s", configs / "golf-normalize.yaml", "-o", f"n-{name}")
        run("fit-pca", f"n-{name}", "-o", f"{name}.npz")
        spec = edit_spec(tmp_path / f"{name}.yaml", unit=name)
        result = run(
            *("edit-pc", f"{name}/swing01.bvh", "-m", f"{name}.npz", "-s", spec, "-o", f"{name}.bvh"),
            *("--set", f"goals.ball.shift=[0, 0, {2 * scale}]"),
        )
        assert result.exit_code == 0
    a, b = (read_clip(tmp_path / f"{name}.bvh").motion.rotations for name in ("cm", "m"))
    assert np.degrees(rotations.angle_between(a, b)).max() < 1e-3


def clip_scaled(clip, scale):
    skeleton = clip.motion.skeleton
    scaled = replace(
        skeleton,
        offsets=skeleton.offsets * scale,
        end_sites=tuple(EndSite(site.joint, site.offset * scale) for site in skeleton.end_sites),
    )
    motion = Motion(scaled, clip.motion.rotations, clip.motion.translations * scale, clip.motion.frame_time)
    return new_bytes(motion, decimals=9)
