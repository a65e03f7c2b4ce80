"""Straight limbs bend where something would be missed, and nowhere else."""

import numpy as np
import pytest
from human import BONES, skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.center_of_mass import find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.hinges import find_hinges, plain_hinge
from motionedit.core.kinematics import Effector, forward
from motionedit.core.priorities.edit import edit_by_priorities
from motionedit.core.priorities.kinds import Orientation, Position
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.settings import Body, LayeredSettings, Passes
from motionedit.core.priorities.trajectories.positions import ControlPoint

# Thighs hang on the hips: hip joints between them would let the hips down without a knee.
SKELETON = skeleton_of(
    [
        (name, "Hips" if parent in ("LHipJoint", "RHipJoint") else parent, offset)
        for name, parent, offset in BONES
        if "HipJoint" not in name
    ]
)
INDEX = SKELETON.names.index
FRAMES = 60
HERE = np.zeros(3)


def edited(motion, constraints, *, hinges=(), bends=True, passes=0):
    anatomy = find_anatomy(SKELETON)
    found = find_bends(SKELETON, forward(motion), anatomy, first=0) if bends else ()
    body = Body(find_masses(SKELETON, anatomy), tuple(hinges), 0, 0, found)
    return edit_by_priorities(motion, constraints, body, LayeredSettings(smoothing=Passes(passes)))


def wanted(name, shift, *, priority=1, first=30, last=34, **more):
    point = ControlPoint("hold", first, last, None, np.array(shift, dtype=float))
    return Position(name=name, priority=priority, effector=Effector(INDEX(name), HERE), points=(point,), **more)


def feet(priority=9):
    made = []
    for side in ("Left", "Right"):
        effector = Effector(INDEX(f"{side}Foot"), HERE)
        made += [
            Position(name=f"{side} place", priority=priority, effector=effector),
            Orientation(name=f"{side} turn", priority=priority, effector=effector),
        ]
    return made


@pytest.fixture(params=["compiled", "numpy"])
def solver(request, monkeypatch):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", request.param if request.param == "numpy" else "")


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("passes", [0, 3])
def test_the_hips_go_down_on_straight_legs_whose_feet_are_held(passes):
    motion = standing(SKELETON, 160)
    edit = edited(motion, [wanted("Hips", (0.0, -0.12, 0.0), first=130, last=134), *feet()], passes=passes)
    before, after = forward(motion).positions, forward(edit.motion).positions
    assert max(errors.positions.max() for errors in edit.errors if errors.positions is not None) < 1e-6
    assert after[132, INDEX("Hips"), 1] - before[132, INDEX("Hips"), 1] == pytest.approx(-0.12, abs=1e-6)
    for side in ("Left", "Right"):
        assert after[132, INDEX(f"{side}Leg"), 2] > 0.05, "a knee goes forward"
    # A jump is smoothed over 0.6 s more than the passes' own reach, and no farther.
    np.testing.assert_array_equal(edit.motion.rotations[:30], motion.rotations[:30])


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize(("down", "ease", "first", "last"), [(0.05, 32, 40, 60), (0.2, 24, 30, 45)])
def test_hips_that_ease_down_slowly_do_so_where_feet_are_met_a_little_less_well(down, ease, first, last):
    goal = wanted("Hips", (0.0, -down, 0.0), first=first, last=last, ease_in=ease, ease_out=ease)
    edit = edited(standing(SKELETON, 160), [goal, *feet()])
    assert max(errors.positions.max() for errors in edit.errors if errors.positions is not None) < 1e-5


@pytest.mark.usefixtures("solver")
def test_the_hips_go_down_on_knees_that_a_capture_has_past_straight_all_along():
    motion = standing(SKELETON, FRAMES)
    for side in ("Left", "Right"):
        motion = with_rotation(motion, f"{side}Leg", slice(None), (-0.08, 0.0, 0.0))
    hinges = find_hinges(find_bends(SKELETON, forward(motion), find_anatomy(SKELETON), first=0))
    edit = edited(motion, [wanted("Hips", (0.0, -0.12, 0.0)), *feet()], hinges=hinges)
    assert max(errors.positions.max() for errors in edit.errors if errors.positions is not None) < 1e-6
    for side in ("Left", "Right"):
        assert rot.log(edit.motion.rotations[32, INDEX(f"{side}Leg")])[0] > 0.5, "the shank goes back"


def test_without_knowing_its_knees_a_body_stays_where_it_is():
    edit = edited(standing(SKELETON, FRAMES), [wanted("Hips", (0.0, -0.12, 0.0)), *feet()], bends=False)
    assert edit.errors[0].positions.max() == pytest.approx(0.12, abs=1e-6)


@pytest.mark.usefixtures("solver")
def test_a_straight_arm_moves_toward_its_shoulder():
    rule = RecruitRule("up_to", joint=INDEX("LeftArm"))
    motion = standing(SKELETON, FRAMES)
    edit = edited(motion, [wanted("LeftHand", (0.0, 0.1, 0.0), recruit=rule)])
    assert edit.errors[0].positions.max() < 1e-6


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("turned", [0.0, 8.0, 10.0])
def test_an_arm_that_gives_way_to_its_other_side_bends_to_its_own(turned):
    # It gives way, but bends by 60 elsewhere: back, within its limits, the hand comes hardly nearer.
    rule = RecruitRule("up_to", joint=INDEX("LeftArm"))
    motion = with_rotation(standing(SKELETON, FRAMES), "LeftForeArm", slice(None), np.radians([turned, 0.0, 0.0]))
    motion = with_rotation(motion, "LeftForeArm", slice(0, 4), np.radians([-60.0, 0.0, 0.0]))
    hinges = find_hinges(find_bends(SKELETON, forward(motion), find_anatomy(SKELETON), first=0))
    edit = edited(motion, [wanted("LeftHand", (0.0, 0.1, 0.0), recruit=rule)], hinges=hinges)
    assert edit.errors[0].positions.max() < 1e-6
    assert rot.log(edit.motion.rotations[32, INDEX("LeftForeArm")])[0] < -0.5


def test_a_limb_that_cannot_help_keeps_what_it_had():
    # Along the arm and away from the body: out of reach, bent or not.
    rule = RecruitRule("up_to", joint=INDEX("LeftArm"))
    motion = standing(SKELETON, FRAMES)
    constraint = wanted("LeftHand", (0.0, -0.2, 0.0), recruit=rule)
    plain, bent = (edited(motion, [constraint], bends=bends) for bends in (False, True))
    np.testing.assert_array_equal(plain.motion.rotations, bent.motion.rotations)


def test_a_straight_limb_that_misses_nothing_stays_straight():
    motion = with_rotation(standing(SKELETON, FRAMES), "LeftUpLeg", slice(None), (-0.2, 0.0, 0.0))
    rule = RecruitRule("up_to", joint=INDEX("RightArm"))
    edit = edited(motion, [*feet(), wanted("RightHand", (0.0, 0.01, 0.02), recruit=rule)])
    assert edit.errors[-1].positions.max() < 1e-6
    knees = [INDEX("LeftLeg"), INDEX("RightLeg")]
    np.testing.assert_allclose(edit.motion.rotations[:, knees], motion.rotations[:, knees], atol=1e-15)


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_straight_hinge_bends_about_its_own_axis(sign):
    axis = sign * np.array([1.0, 0.0, 0.0])
    hinges = [plain_hinge(INDEX(f"{side}Leg"), axis, (-3.0, 3.0)) for side in ("Left", "Right")]
    motion = standing(SKELETON, FRAMES)
    edit = edited(motion, [wanted("Hips", (0.0, -0.1, 0.0)), *feet()], hinges=hinges)
    assert edit.errors[0].positions.max() < 1e-6
    off = edit.motion.rotations[:, INDEX("LeftLeg"), 2:]
    assert np.abs(off).max() < 1e-9
    assert forward(edit.motion).positions[32, INDEX("LeftLeg"), 2] > 0.05
