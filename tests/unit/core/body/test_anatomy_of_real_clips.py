"""Anatomy, axes, rest poses, plants and hinges of real clips, read from the folder that MOTIONEDIT_CLIPS names."""

import os
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from motionedit.core.body.anatomy import find_anatomy
from motionedit.core.body.contacts import find_plants
from motionedit.core.body.ground import axis_name, find_up, heading_frame, rest_pose_frames, travel_joint
from motionedit.core.body.hinges import find_hinges
from motionedit.core.body.quality import find_defects
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward

FOLDER = Path(os.environ.get("MOTIONEDIT_CLIPS", ""))
pytestmark = pytest.mark.skipif(
    "MOTIONEDIT_CLIPS" not in os.environ, reason="MOTIONEDIT_CLIPS names no folder of real clips"
)
FILES = sorted(FOLDER.rglob("*.bvh")) if "MOTIONEDIT_CLIPS" in os.environ else []
NOT_HUMAN = ("full_precision", "rotation_first", "test_simple", "sinusoidal")

# What joints are called without their side and prefix, the surest name first.
CALLED = {
    "thigh": ("upperleg01", "thigh", "upleg", "hip"),
    "knee": ("lowerleg01", "calf", "loleg", "lowleg", "knee", "leg"),
    "ankle": ("foot", "ankle"),
    "toe": ("toebase", "toes", "toe", "bale", "toe2-1"),
    "shoulder": ("upperarm01", "upperarm", "uparm", "arm", "shoulder"),
    "elbow": ("lowerarm01", "forearm", "loarm", "lowarm", "elbow"),
    "wrist": ("wrist", "hand"),
    "head": ("head", "atlas"),
}


def part_of(name):
    name = name.casefold().removeprefix("mixamorig:").removeprefix("cc_base_").removeprefix("j_")
    return re.sub(r"left|right|^[lr]_|_[lr]$|\.[lr]$", "", name)


def side_of(name):
    name = name.casefold().removeprefix("mixamorig:").removeprefix("cc_base_").removeprefix("j_")
    found = re.search(r"left|right|^[lr]_|_[lr]$|\.[lr]$", name)
    return None if found is None else found[0].strip("_.")[0]


def expected(names, part):
    """Return the names of a part by the first of its words that the skeleton uses: left and right, or one, or none."""
    for word in CALLED[part]:
        found = [name for name in names if part_of(name) == word]
        if found:
            return sorted(found, key=lambda name: side_of(name) or "")
    return []


def load(file):
    motion = read_clip(file, lenient=True).motion
    return motion, find_anatomy(motion.skeleton)


def different_skeletons():
    seen = set()
    for file in FILES:
        motion, anatomy = load(file)
        key = motion.skeleton.names, motion.skeleton.offsets.tobytes()
        if key not in seen:
            seen.add(key)
            yield file, motion.skeleton, anatomy


def found_parts(skeleton, anatomy):
    def pair(limbs, part):
        joints = [getattr(limb, part) for limb in limbs or ()]
        return [skeleton.names[j] for j in joints if j is not None]

    parts = {part: pair(anatomy.legs, part) for part in ("thigh", "knee", "ankle", "toe")}
    parts |= {part: pair(anatomy.arms, part) for part in ("shoulder", "elbow", "wrist")}
    return parts | {"head": [] if anatomy.head is None else [skeleton.names[anatomy.head]]}


def test_every_skeleton_has_the_joints_that_its_names_say():
    wrong = []
    for file, skeleton, anatomy in different_skeletons():
        found = found_parts(skeleton, anatomy)
        left = "  ".join(f"{names[0] if names else '-':>20}" for names in found.values())
        print(f"{file.stem[-36:]:36} {len(skeleton):4} joints, leg {anatomy.leg_length:8.3f}  {left}")  # noqa: T201
        if any(word in file.name for word in NOT_HUMAN):
            assert anatomy.legs is None
            assert anatomy.warnings
            continue
        assert anatomy.warnings == ()
        wrong += [
            (file.name, part, names, expected(skeleton.names, part))
            for part, names in found.items()
            if names != expected(skeleton.names, part)
        ]
    assert wrong == []


def test_frames_of_a_rest_pose_are_where_the_takes_have_one():
    for file in FILES:
        motion, anatomy = load(file)
        with_one = re.search(r"cmu_12_01|cmu_13_|cmu_07_(0[3-9]|1[0-2])|npybvh", file.name) is not None
        assert rest_pose_frames(motion, anatomy) == int(with_one), file.name


def test_up_is_the_axis_that_the_programs_use():
    z_up = ("bvh_test1", "AnimatedDrawings", "BVHFiles", "makehuman")
    for file in FILES:
        motion, anatomy = load(file)
        up = axis_name(find_up(motion, forward(motion), anatomy))
        assert up == ("z" if any(word in file.name for word in z_up) else "y"), file.name


def test_toes_point_forward():
    for file in FILES:
        motion, anatomy = load(file)
        # One of them turns somersaults.
        if anatomy.legs is None or anatomy.legs[0].toe is None or "BVHFiles" in file.name:
            continue
        poses = forward(motion)
        up = find_up(motion, poses, anatomy)
        ahead = []
        for frame in range(0, len(motion), max(1, len(motion) // 20)):
            heading = heading_frame(poses, anatomy, up=up, frame=frame, travel=travel_joint(motion))
            toes = sum(poses.positions[frame, leg.toe] - poses.positions[frame, leg.ankle] for leg in anatomy.legs)
            ahead.append(toes @ heading.axes[2] / np.linalg.norm(toes))
        assert np.median(ahead) > 0.5, file.name


def walks():
    return [file for file in FILES if re.search(r"cmu_07_\d+_walk|cmu_12_01_walk|av_8walk", file.name)]


def test_the_feet_of_walks_are_planted_in_turn_for_sane_times():
    for file in walks():
        motion, anatomy = load(file)
        poses = forward(motion)
        first = rest_pose_frames(motion, anatomy)
        plants = find_plants(motion, poses, anatomy, up=find_up(motion, poses, anatomy), first=first)
        toes = [plant for plant in plants if plant.joint in {leg.toe for leg in anatomy.legs}]
        feet = [plant.foot for plant in toes]
        assert len(feet) >= 4, file.name
        assert all(a != b for a, b in pairwise(feet)), (file.name, feet)
        # The first and the last may be cut by the clip's ends.
        whole = [plant.frames * motion.frame_time for plant in toes[1:-1]]
        assert 0.3 < min(whole) <= max(whole) < 0.9, (file.name, whole)


def test_knees_of_cmu_are_hinges_and_those_of_free_ball_joints_are_not():
    for file in FILES:
        motion, anatomy = load(file)
        hinges = find_hinges(motion, anatomy, first=rest_pose_frames(motion, anatomy))
        knees = [leg.knee for leg in anatomy.legs or ()]
        if re.match(r"cmu_(63|13|12|131|02|03|07)_", file.name):
            assert [hinge.joint for hinge in hinges][:2] == knees, file.name
            assert all(abs(np.linalg.norm(hinge.axis) - 1.0) < 1e-12 for hinge in hinges)
        if "smash" in str(file) or "serve" in str(file):
            assert hinges == [], file.name


def test_the_thumb_of_the_golfer_flips():
    (file,) = [file for file in FILES if file.name == "cmu_63_01.bvh"]
    motion, _ = load(file)
    (defect,) = find_defects(motion)
    assert motion.skeleton.names[defect.joint] == "LThumb"
    assert defect.flips == len(defect.frames) == 5
    assert np.degrees(defect.angle) > 179.0
