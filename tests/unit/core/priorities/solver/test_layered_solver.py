"""Strict layers over many frames ([PRIO] section 3, METHODS 3.1), on a made-up human."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.hinges import plain_hinge
from motionedit.core.kinematics import Effector
from motionedit.core.priorities.edit import RecruitingError, edit_by_priorities
from motionedit.core.priorities.kinds import Aim, CenterOfMass, Orientation, Pose, Position, Posture
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.settings import Body, LayeredSettings, PaperFilter, Passes
from motionedit.core.priorities.trajectories.positions import ControlPoint

SKELETON = skeleton_of()
NAMES = SKELETON.names
FRAMES = 12
NOW = LayeredSettings(smoothing=Passes(0))
# Frame by frame, and nothing gives way.
HARD = LayeredSettings(smoothing=PaperFilter(0))
MM = 1e-3


def joint(name):
    return NAMES.index(name)


@pytest.fixture
def motion():
    """A person with bent knees and elbows who sways a little."""
    made = standing(SKELETON, FRAMES)
    for name, vector in (
        ("LeftUpLeg", (-0.5, 0.0, 0.0)),
        ("LeftLeg", (0.9, 0.0, 0.0)),
        ("LeftFoot", (-0.4, 0.0, 0.0)),
        ("RightUpLeg", (-0.4, 0.0, 0.0)),
        ("RightLeg", (0.8, 0.0, 0.0)),
        ("RightFoot", (-0.4, 0.0, 0.0)),
        ("RightForeArm", (-0.7, 0.1, 0.0)),
        ("LeftForeArm", (-0.6, 0.0, 0.1)),
    ):
        made = with_rotation(made, name, slice(None), vector)
    return with_rotation(made, "Spine", slice(3, 9), (0.1, 0.2, 0.0))


@pytest.fixture
def body():
    return Body(find_masses(SKELETON, find_anatomy(SKELETON)), (), 0, 0)


def held(name, shift=(0.0, 0.0, 0.0), *, priority=1, weight=1.0, offset=(0.0, 0.0, 0.0), **more):
    """Return a constraint that holds a joint where it is in frame 0, shifted, over the whole clip."""
    point = ControlPoint("hold", 0, FRAMES - 1, None, np.array(shift), None, 0.0, 0.0, 0.0)
    effector = Effector(joint(name), np.array(offset))
    return Position(name=name, priority=priority, weight=weight, effector=effector, points=(point,), **more)


def feet(priority=10):
    names = ("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase")
    return [held(name, priority=priority) for name in names]


def errors(edit):
    return [each.positions.max() / MM for each in edit.errors if each.positions is not None]


def run(motion, constraints, body, settings=NOW):
    return edit_by_priorities(motion, constraints, body, settings)


def test_feasible_layers_are_met(motion, body):
    com = CenterOfMass(name="com")
    edit = run(motion, [*feet(), held("RightHand", (0.1, 0.1, 0.15), priority=4), com], body)
    assert max(errors(edit)) < 0.01
    assert edit.converged.all()
    assert np.median(edit.iterations) <= 8


def balance(priority=1):
    support = tuple(joint(name) for name in ("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase"))
    return CenterOfMass(name="com", priority=priority, support=support)


def furthest(motion, edit, name):
    """Return how far a joint is moved at most (mm)."""
    before, after = (kinematics.forward(each).positions[:, joint(name)] for each in (motion, edit.motion))
    return np.linalg.norm(after - before, axis=1).max() / MM


def test_a_center_of_mass_does_not_chase_feet_that_nothing_holds(motion, body):
    hand, passes = held("RightHand", (0.1, 0.1, 0.15), priority=4), LayeredSettings(smoothing=Passes(3, 1.5))
    alone, balanced = (run(motion, more, body, passes) for more in ([hand], [hand, balance()]))
    assert max(errors(balanced)) < 0.01
    assert furthest(motion, balanced, "LeftFoot") < 1.5 * furthest(motion, alone, "LeftFoot")


def test_every_pass_of_the_paper_asks_for_the_same_center_of_mass(motion, body):
    asked = [held("RightHand", (0.1, 0.1, 0.15), priority=4), balance()]
    edit = run(motion, asked, body, LayeredSettings(smoothing=PaperFilter(2, 3.0)))
    assert max(errors(edit)) < 0.01


def test_a_center_of_mass_goes_with_a_body_that_is_moved(motion, body):
    hips = held("Hips", (0.5, 0.0, 0.0), priority=4)
    edit = run(motion, [hips, balance()], body)
    assert max(errors(edit)) < 0.01
    assert furthest(motion, edit, "LeftFoot") == pytest.approx(furthest(motion, edit, "RightFoot"), abs=100.0)
    bent = rot.angle_between(edit.motion.rotations, motion.rotations).max()
    upright = run(motion, [hips, CenterOfMass(name="com")], body)
    assert bent < 0.5 * rot.angle_between(upright.motion.rotations, motion.rotations).max()


@pytest.mark.parametrize(("priority", "weight"), [(10, 1.0), (2, 3.0)])
def test_a_center_of_mass_goes_with_the_most_important_goal_of_a_foot(motion, body, priority, weight):
    aside = held("RightFoot", (0.3, 0.0, 0.0), priority=priority, weight=weight)
    still, others = held("RightFoot", priority=2), [each for each in feet(1) if each.name != "RightFoot"]
    before = run(motion, [*others, still, balance(-1)], body).errors[-1].places
    for asked in ([aside, still], [still, aside]):
        after = run(motion, [*others, *asked, balance(-1)], body).errors[-1].places
        # A quarter of the way of one of the four points of the support.
        np.testing.assert_allclose(after - before, np.broadcast_to([0.075, 0.0, 0.0], before.shape), atol=1e-9)


def test_an_unreachable_hand_leaves_the_feet_where_they_are(motion, body):
    edit = run(motion, [*feet(), held("RightHand", (3.0, 2.0, 1.0), priority=4)], body)
    *of_feet, of_hand = errors(edit)
    assert max(of_feet) < 1e-3
    assert of_hand > 1000.0


def test_an_unreachable_goal_ends_as_far_off_as_it_is_out_of_reach(motion, body):
    arm = RecruitRule("up_to", joint=joint("RightArm"))
    reach = 0.29 + 0.25
    way = np.array([-1.0, 0.0, 0.0])
    still = with_rotation(motion, "Spine", slice(None), (0.0, 0.0, 0.0))
    shoulder = kinematics.forward(still).positions[0, joint("RightArm")]
    hand = kinematics.forward(still).positions[0, joint("RightHand")]
    goal = shoulder + (reach + 0.1) * way
    asked = [held("RightHand", goal - hand, recruit=arm)]
    assert errors(run(still, asked, body, HARD))[0] == pytest.approx(100.0, abs=0.1)
    # One that gives way is not stretched to its end for it.
    assert 100.0 < errors(run(still, asked, body))[0] < np.linalg.norm(goal - hand) / MM


def test_only_the_order_of_priorities_matters(motion, body):
    def edit(a, b, c):
        constraints = [
            *feet(a),
            held("RightHand", (0.4, 0.5, 0.3), priority=b),
            held("Head", (0.1, -0.1, 0.0), priority=c),
        ]
        return run(motion, constraints, body).motion

    one, other = edit(10, 2, 15), edit(2, 1, 3)
    np.testing.assert_array_equal(one.rotations, other.rotations)
    np.testing.assert_array_equal(one.translations, other.translations)


def test_a_lower_layer_does_not_move_a_met_one(motion, body):
    hand = held("RightHand", (0.1, 0.0, 0.2), priority=4)
    without = kinematics.forward(run(motion, [*feet(), hand], body).motion).positions
    below = held("Head", (0.6, 0.3, -0.9), priority=1)
    with_it = kinematics.forward(run(motion, [*feet(), hand, below], body).motion).positions
    kept = [joint(name) for name in ("LeftFoot", "RightToeBase", "RightHand")]
    assert np.abs(with_it - without)[:, kept].max() / MM < 0.01


@pytest.mark.parametrize(("weight", "near", "far"), [(1.0, 150.0, 150.0), (10.0, 2.97, 297.03)])
def test_equal_priorities_share_a_conflict_by_the_squares_of_their_weights(motion, body, weight, near, far):
    a = held("RightHand", (0.0, 0.15, 0.0), weight=weight)
    b = held("RightHand", (0.0, -0.15, 0.0))
    found = errors(run(motion, [a, b], body, HARD))
    assert found[0] == pytest.approx(near, abs=0.05)
    assert found[1] == pytest.approx(far, abs=0.05)


def test_heel_and_toe_of_one_foot_are_ten_rows_of_twelve_and_no_problem(motion, body):
    edit = run(motion, [*feet(), held("RightHand", (0.1, 0.1, 0.1), priority=1)], body)
    assert set(edit.ranks[:, 0]) == {10}
    assert max(errors(edit)) < 0.01


def test_a_contradiction_inside_a_layer_is_shared_and_the_layer_below_is_met(motion, body):
    constraints = feet()
    constraints[1] = held("LeftToeBase", (0.0, 0.0, 0.01), priority=10)
    edit = run(motion, [*constraints, held("RightHand", (0.1, 0.1, 0.1), priority=1)], body)
    ankle, toe, *rest, hand = errors(edit)
    assert ankle == pytest.approx(toe, rel=0.02)
    assert 4.0 < ankle < 5.5
    assert max(*rest, hand) < 0.05


def test_what_no_layer_asks_for_stays_as_it_was(motion, body):
    arm = RecruitRule("up_to", joint=joint("RightShoulder"))
    edit = run(motion, [held("RightHand", (0.1, 0.0, 0.1), recruit=arm)], body)
    others = [j for j, name in enumerate(NAMES) if name not in {"RightShoulder", "RightArm", "RightForeArm"}]
    np.testing.assert_array_equal(edit.motion.rotations[:, others], motion.rotations[:, others])
    np.testing.assert_array_equal(edit.motion.translations, motion.translations)
    assert not edit.touched[:, others].any()
    assert not edit.moved.any()


def test_the_result_is_the_least_displacement_so_the_start_does_not_matter(motion, body):
    constraints = [*feet(), held("RightHand", (0.1, 0.1, 0.1), priority=1)]
    one = run(motion, constraints, body).motion
    paper = run(motion, constraints, body, LayeredSettings(smoothing=PaperFilter(0))).motion
    assert np.degrees(rot.angle_between(one.rotations, paper.rotations)).max() < 0.05


def test_a_hinge_turns_about_its_axis_alone_and_keeps_its_limits(motion, body):
    knee = joint("RightLeg")
    hinge = plain_hinge(knee, np.array([1.0, 0.0, 0.0]), (0.0, 1.0))
    bent = Body(body.masses, (hinge,), 0, 0)
    leg = RecruitRule("up_to", joint=joint("RightUpLeg"))
    edit = run(motion, [held("RightFoot", (0.02, 0.45, 0.1), recruit=leg)], bent, HARD)
    v = rot.log(edit.motion.rotations[:, knee])
    assert np.abs(v[:, 1:]).max() < 1e-9
    assert v[:, 0].max() <= 1.0 + 1e-9
    assert v[:, 0].max() == pytest.approx(1.0, abs=1e-6)


def test_without_the_recruiting_rule_a_lower_layer_drags_a_higher_one(motion, body):
    leg = RecruitRule("up_to", joint=joint("LeftUpLeg"))
    ankle = held("LeftFoot", priority=10, recruit=leg)
    hand = held("RightHand", (0.5, 0.6, 0.9), priority=1)
    strict = run(motion, [ankle, hand], body)
    assert errors(strict)[0] < 0.01
    assert strict.breaches
    loose = run(motion, [ankle, hand], body, LayeredSettings(smoothing=Passes(0), recruiting_rule="ignore"))
    assert errors(loose)[0] > 1.0
    with pytest.raises(RecruitingError):
        run(motion, [ankle, hand], body, LayeredSettings(recruiting_rule="error"))


def test_orientation_pose_aim_and_posture_are_met(motion, body):
    turned = rot.exp(np.array([0.0, 0.4, 0.0]))
    whole = ControlPoint("hold", 0, FRAMES - 1, None, None, turned, 0.0, 0.0, 0.0)
    still = ControlPoint("hold", 0, FRAMES - 1, None, None, None, 0.0, 0.0, 0.0)
    ahead = ControlPoint("hold", 0, FRAMES - 1, np.array([0.5, 1.5, 3.0]), None, None, 0.0, 0.0, 0.0)
    zero = np.zeros(3)
    constraints = [
        Pose(name="foot", priority=9, effector=Effector(joint("LeftFoot"), zero), points=(still,)),
        Orientation(name="hand", priority=5, effector=Effector(joint("RightHand"), zero), points=(whole,)),
        Aim(name="eyes", priority=4, effector=Effector(joint("Head"), zero), points=(ahead,)),
        Posture(name="neck", priority=1, joints=(joint("LeftArm"),)),
    ]
    edit = run(motion, constraints, body)
    foot, hand, eyes, neck = edit.errors
    assert foot.positions.max() / MM < 0.01
    for each in (foot, hand, eyes, neck):
        assert np.degrees(each.angles.max()) < 0.01


def test_passes_smooth_the_edit_and_keep_the_constraints(motion, body):
    point = ControlPoint("at", 6, 6, None, np.array([0.2, 0.2, 0.2]), None, 0.0, 0.0, 0.0)
    hand = Position(
        name="hand", effector=Effector(joint("RightHand"), np.zeros(3)), points=(point,), ease_in=4, ease_out=4
    )
    edit = run(motion, [*feet(), hand], body, LayeredSettings(smoothing=Passes(3, 1.0)))
    assert max(errors(edit)) < 0.01


def test_frames_far_from_every_interval_are_the_input_bit_for_bit(body):
    long = standing(SKELETON, 60)
    point = ControlPoint("at", 20, 20, None, np.array([0.1, 0.1, 0.1]), None, 0.0, 0.0, 0.0)
    hand = Position(
        name="hand", effector=Effector(joint("RightHand"), np.zeros(3)), points=(point,), ease_in=3, ease_out=3
    )
    edit = run(long, [hand], body, LayeredSettings(smoothing=Passes(2, 1.0)))
    far = [*range(17 - 6), *range(24 + 6, 60)]
    np.testing.assert_array_equal(edit.motion.rotations[far], long.rotations[far])
    assert edit.touched[20].any()
