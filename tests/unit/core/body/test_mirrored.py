"""Bodies whose left is on the right: where toes and knees clearly say so, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest
from human import BONES, ENDS, skeleton_of, standing, with_rotation

from motionedit.core.body.anatomy import NOTHING_GIVEN, GivenBody
from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.ground import axis_vector, heading_frame, stance_frame
from motionedit.core.body.mirrored import as_it_points
from motionedit.core.kinematics import forward

WITHOUT_TOES = [row for row in BONES if "Toe" not in row[0]]
WITHOUT_HEAD = [row for row in BONES if row[0] not in ("Neck", "Head")]
SIDE = {"Left": "Right", "Right": "Left"}


def exchanged(name):
    """Return the name of the other side's joint."""
    for side, other in SIDE.items():
        if name.startswith(side):
            return other + name.removeprefix(side)
    return name


def pointed(motion, given=NOTHING_GIVEN, first=0):
    poses = forward(motion)
    return as_it_points(find_anatomy(motion.skeleton), poses, first=first, given=given), poses


@pytest.mark.parametrize("rename", [str, exchanged])
@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.0, 2.5, 0.0), (1.5, 0.0, 0.3), (np.pi, 0.0, 0.0)])
@pytest.mark.parametrize("bones", [BONES, WITHOUT_HEAD])
def test_left_is_where_the_toes_say_however_the_body_lies(bones, turn, rename):
    motion = with_rotation(standing(skeleton_of(bones, rename=rename)), "Hips", slice(None), turn)
    anatomy, _ = pointed(motion)
    assert anatomy.mirrored == (rename is exchanged)
    assert len(anatomy.warnings) == anatomy.mirrored


def test_its_heading_its_stance_and_the_side_of_its_elbows_are_those_of_the_same_body_under_true_names():
    for motion in (standing(skeleton_of()), standing(skeleton_of(rename=exchanged))):
        anatomy, poses = pointed(motion)
        for frame in (
            heading_frame(poses, anatomy, up=axis_vector("y"), frame=0, travel=0),
            stance_frame(poses, anatomy, up=axis_vector("y"), frame=0),
        ):
            assert frame.degrees == pytest.approx(0.0, abs=1e-9)
        for bend in find_bends(motion.skeleton, poses, anatomy, first=0)[2:]:
            # The hands of hanging arms come to the front about -x.
            np.testing.assert_allclose(bend.axis, [-1.0, 0.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("rename", [str, exchanged])
def test_without_toes_the_knees_say_it_and_straight_ones_say_nothing(rename):
    ends = {name: site for name, site in ENDS.items() if "Toe" not in name}
    motion = standing(skeleton_of(WITHOUT_TOES, ends, rename=rename))
    assert not pointed(motion)[0].mirrored
    for side in SIDE:
        motion = with_rotation(motion, f"{side}UpLeg", slice(None), (-0.3, 0.0, 0.0))
        motion = with_rotation(motion, f"{side}Leg", slice(None), (0.6, 0.0, 0.0))
    assert pointed(motion)[0].mirrored == (rename is exchanged)


def test_the_median_of_what_is_after_a_rest_pose_counts():
    plain = standing(skeleton_of(), frames=9)
    # Feet that are turned back, in some frames.
    for stop, first, mirrored in ((4, 0, False), (6, 0, True), (6, 3, False)):
        motion = plain
        for side in SIDE:
            motion = with_rotation(motion, f"{side}Foot", slice(0, stop), (0.0, np.pi, 0.0))
        assert pointed(motion, first=first)[0].mirrored == mirrored


def test_what_a_user_says_of_legs_holds_and_is_doubted():
    motion = standing(skeleton_of())
    index = motion.skeleton.names.index
    legs = tuple(tuple(index(side + part) for part in ("UpLeg", "Leg", "Foot", "ToeBase")) for side in SIDE)
    for given, warnings in ((legs, 0), (legs[::-1], 1)):
        body = GivenBody(legs=given)
        anatomy = as_it_points(find_anatomy(motion.skeleton, given=body), forward(motion), first=0, given=body)
        assert not anatomy.mirrored
        assert len(anatomy.warnings) == warnings
    assert not as_it_points(replace(anatomy, legs=None), forward(motion), first=0, given=body).mirrored
