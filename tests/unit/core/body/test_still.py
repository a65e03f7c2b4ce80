"""Groups and nulls above the joints of a body, at their places: they never turn, and are no knees."""

import numpy as np
import pytest
from human import BONES, ENDS, skeleton_of, split, standing

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.body.stiffness import human_mobility
from motionedit.core.bvh import new_bytes, parse_clip
from motionedit.core.motion import Motion
from motionedit.jobs.clip.facts import facts_of

LIMBS = [f"{side}{part}" for side in ("Left", "Right") for part in ("UpLeg", "Leg", "Foot", "Arm", "ForeArm", "Hand")]


def swaying(rows, ends, *, still=()):
    """Return the facts of a body whose joints all sway but those that are `still`, each by its name."""
    skeleton = skeleton_of(rows, ends)
    motion = standing(skeleton, 40)
    waves = np.sin(np.linspace(0.0, 6.0, 40))[:, None, None]
    ways = np.array([np.sin(np.arange(3) + sum(map(ord, name))) * (name not in still) for name in skeleton.names])
    rotations = rot.exp(0.2 * (1.0 + waves) * ways)
    return facts_of(
        parse_clip(new_bytes(Motion(skeleton, rotations, motion.translations, 0.02), decimals=10), label="body")
    )


def read(facts):
    names, anatomy = facts.bones.names, facts.anatomy
    limbs = [(leg.thigh, leg.knee, leg.ankle) for leg in anatomy.legs]
    limbs += [(arm.shoulder, arm.elbow, arm.wrist) for arm in anatomy.arms]
    return [tuple(names[j] for j in limb) for limb in limbs], names[anatomy.head]


@pytest.mark.parametrize("toes", [True, False])
def test_the_joints_of_a_body_are_those_that_turn(toes):
    rows = [row for row in BONES if toes or "Toe" not in row[0]]
    ends = ENDS if toes else {"LeftFoot": (0.0, -0.06, 0.2), "RightFoot": (0.0, -0.06, 0.2)}
    grouped, groups = rows, []
    for name in (*LIMBS, "Head"):
        groups.append(f"{name}_group")
        grouped = split(grouped, name, groups[-1], 1.0)
    plain, found = swaying(rows, ends), swaying(grouped, ends, still=groups)
    assert read(found) == read(plain)
    assert found.anatomy.leg_length == pytest.approx(plain.anatomy.leg_length)
    for one, other in zip(found.anatomy.sole_points, plain.anatomy.sole_points, strict=True):
        assert (one.foot, one.part, one.offset) == (other.foot, other.part, other.offset)
        assert found.bones.names[one.joint] == plain.bones.names[other.joint]
    for one, other in zip(found.bends, plain.bends, strict=True):
        np.testing.assert_allclose(one.bent, other.bent, atol=1e-6)
        np.testing.assert_allclose(one.axis, other.axis, atol=1e-6)
    centers = [
        center_of_mass(each.poses, find_masses(each.bones, each.anatomy, rotations=each.clip.motion.rotations))
        for each in (plain, found)
    ]
    np.testing.assert_allclose(centers[1], centers[0], atol=1e-6)
    mobility = human_mobility(found.bones, found.anatomy, travel=found.travel)
    assert max(mobility[found.bones.names.index(f"{limb}_group")] for limb in LIMBS) < 0.1


def test_of_two_joints_that_turn_at_one_place_the_upper_one_is_the_limbs():
    rows = split(split(BONES, "LeftLeg", "LeftKnee", 1.0), "RightLeg", "RightKnee", 1.0)
    legs = read(swaying(rows, ENDS))[0][:2]
    assert [leg[1] for leg in legs] == ["LeftKnee", "RightKnee"]
