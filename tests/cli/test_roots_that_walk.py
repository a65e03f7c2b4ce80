"""A root that walks the floor and turns with the body, its hips below it: the same motion is edited as without it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.core import rotations as rot
from motionedit.core.bvh import new_bytes
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion

WALK = Path(__file__).resolve().parents[2] / "data" / "walk.bvh"
SWINGS = WALK.parent / "golf"
ROOT_CHANNELS = ("Xposition", "Yposition", "Zposition", "Zrotation", "Yrotation", "Xrotation")
HAND = {
    "type": "position",
    "effector": "LeftHand",
    "priority": 4,
    "points": [{"hold": [60, 75], "shift": [10, 20, 25]}],
}
FEET = {"type": "footplants", "priority": 10}
LEFT = {"euler": [0, 30, 0], "order": "ZYX"}
ASIDE = {"type": "position", "effector": "Hips"}
EDITS = {
    "reach": [FEET, HAND, {"type": "com", "priority": 2}],
    "turned": [FEET, {"type": "orientation", "effector": "Hips", "points": [{"at": 60, "turn": LEFT}]}],
    "aside": [
        {**FEET, "at": "path"},
        {
            "type": "position",
            "effector": "Hips",
            "points": [{"at": 0}, {"at": 72, "shift": [25, 0, 0]}, {"at": "100%"}],
        },
    ],
}


def on_a_root(motion):
    """Return a motion below a root that goes along the floor under its hips, turned by as much as they are."""
    skeleton, hips = motion.skeleton, motion.translations[:, 0]
    own = replace(
        skeleton,
        names=("root", *skeleton.names),
        parents=np.concatenate(([-1], skeleton.parents + 1)),
        offsets=np.concatenate((np.zeros((1, 3)), skeleton.offsets)),
        channels=(ROOT_CHANNELS, *skeleton.channels),
        end_sites=tuple(replace(site, joint=site.joint + 1) for site in skeleton.end_sites),
    )
    ahead = rot.rotate(motion.rotations[:, 0], np.array([0.0, 0.0, 1.0]))
    turns = rot.about_axis(1, np.arctan2(ahead[:, 0], ahead[:, 2]))
    below = rot.multiply(rot.conjugate(turns), motion.rotations[:, 0])
    rotations = np.concatenate((np.stack((turns, below), axis=1), motion.rotations[:, 1:]), axis=1)
    translations = np.stack((hips * [1.0, 0.0, 1.0], hips * [0.0, 1.0, 0.0]), axis=1)
    return Motion(own, rotations, translations, motion.frame_time)


@pytest.fixture(scope="module")
def clips(tmp_path_factory):
    folder, motion = tmp_path_factory.mktemp("roots"), motionedit.read(WALK).motion
    for name, each in (("plain.bvh", motion), ("rooted.bvh", on_a_root(motion))):
        (folder / name).write_bytes(new_bytes(each, decimals=10))
    return folder


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_is_the_one_of_the_same_body_without_it(clips, name):
    spec = {"unit": "cm", "constraints": EDITS[name]}
    plain, rooted = (motionedit.edit_prioritized(clips / each, spec) for each in ("plain.bvh", "rooted.bvh"))
    assert rooted.report["status"] == plain.report["status"] == "ok"
    one, other = (forward(each.clip.motion).positions for each in (plain, rooted))
    np.testing.assert_allclose(other[:, 1:], one, atol=0.03)
    if name == "turned":
        # The hips turn and the floor's root does not tilt.
        tilt = rot.rotate(rooted.clip.motion.rotations[:, 0], np.array([0.0, 1.0, 0.0]))[:, 1]
        assert np.degrees(np.arccos(np.minimum(tilt, 1.0))).max() < 0.5


@pytest.mark.parametrize("joint", ["root", "Hips"])
def test_a_root_turns_where_it_alone_is_asked_to(clips, joint):
    turn = {"type": "orientation", "effector": joint, "points": [{"at": 60, "turn": LEFT}]}
    edit = motionedit.edit_prioritized(
        clips / "rooted.bvh", {"constraints": [{**turn, "recruit": {"joints": ["root"]}}]}
    )
    assert edit.report["status"] == "ok"
    assert edit.report["constraints"][0]["error_angle_max"] < 0.01


def test_strokes_are_learnt_and_edited_as_those_of_the_same_body_without_it(tmp_path):
    swings = [SWINGS / f"swing{number:02d}.bvh" for number in range(1, 6)]
    ball = {"at": 80, "effector": {"end_site": "Club"}, "shift": [0, 0, 8]}
    head = {"at": 60, "effector": "Head", "shift": [0, -4, 0]}
    paths = []
    for turned in (lambda motion: motion, on_a_root):
        folder = tmp_path / turned.__name__
        folder.mkdir()
        for swing in swings:
            (folder / swing.name).write_bytes(new_bytes(turned(motionedit.read(swing).motion), decimals=10))
        model = motionedit.fit_pca(motionedit.normalize(folder, {}))
        edit = motionedit.edit_pc(folder / "swing04.bvh", model, {"goals": [ball, head], "plausibility": "off"})
        paths.append(forward(edit.clip.motion).positions)
    np.testing.assert_allclose(paths[1][:, 1:], paths[0], atol=0.1)
