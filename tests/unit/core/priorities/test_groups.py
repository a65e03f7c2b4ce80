"""Groups of frames: what is active, what gives way a layer below what is met, and weights that only share a layer."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, HARD, edited, end, held, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.priorities.edit import edit_by_priorities, prepare
from motionedit.core.priorities.groups import groups_of
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.plans import frames_together
from motionedit.core.priorities.settings import LayeredSettings

FRAMES = 10
MOTION = swaying(FRAMES)


def asked_of(*constraints, body=BODY):
    return prepare(MOTION, constraints, body, HARD)[0].asked


def weighed(weight, other=None, settings=HARD):
    constraints = [held("RightHand", FRAMES, (0.0, 0.15, 0.0), weight=weight)]
    constraints += [] if other is None else [held("RightHand", FRAMES, (0.0, -0.15, 0.0), weight=other)]
    return edited(MOTION, constraints, settings)


@pytest.mark.parametrize("settings", [HARD, LayeredSettings()])
@pytest.mark.parametrize("weight", [1e-9, 0.3, 1e6])
def test_the_weight_of_a_lone_constraint_changes_no_bit(weight, settings):
    one, other = weighed(1.0, settings=settings), weighed(weight, settings=settings)
    assert one.motion.rotations.tobytes() == other.motion.rotations.tobytes()
    assert one.motion.translations.tobytes() == other.motion.translations.tobytes()
    np.testing.assert_array_equal(one.iterations, other.iterations)


@pytest.mark.parametrize("scale", [2.0**-20, 2.0**20])
def test_only_the_ratios_of_a_layers_weights_count(scale):
    one, other = weighed(4.0, 1.0), weighed(4.0 * scale, scale)
    assert one.motion.rotations.tobytes() == other.motion.rotations.tobytes()


@pytest.mark.parametrize(("weight", "other"), [(1e6, 1.0), (1.0, 1e-6), (3.0, 1.0)])
def test_a_conflict_is_shared_by_the_squares_of_weights_however_large(weight, other):
    near, far = (each.positions for each in weighed(weight, other).errors)
    share = other**2 / (weight**2 + other**2)
    np.testing.assert_allclose(near, 0.3 * share, atol=1e-4)
    np.testing.assert_allclose(far, 0.3 * (1.0 - share), atol=1e-4)


def test_weights_of_other_layers_do_not_count():
    def problems(weight):
        asked = asked_of(held("LeftHand", FRAMES, priority=3, weight=weight), held("Head", FRAMES, weight=2.0))
        return groups_of(asked)[0].problem.layers

    assert [[each.weight for each in layer] for layer in problems(1e6)] == [[1.0], [1.0]]


def test_frames_are_together_where_the_same_is_active_and_what_gives_way_is_a_layer_below():
    whole, part = held("LeftHand", FRAMES), held("RightHand", 4)
    asked = asked_of(whole, part)
    assert [group.frames.tolist() for group in groups_of(asked)] == [[4, 5, 6, 7, 8, 9], [0, 1, 2, 3]]
    soft = np.zeros(FRAMES)
    soft[2:6] = [0.1, 0.2, 0.3, 0.4]
    groups = {tuple(group.frames): group for group in groups_of(replace(asked, softness=(soft, None)))}
    assert set(groups) == {(0, 1), (2, 3), (4, 5), (6, 7, 8, 9)}
    split = groups[2, 3]
    assert split.levels.tolist() == [0, 0]
    assert [len(layer) for layer in split.problem.layers] == [1, 1]
    np.testing.assert_array_equal(split.problem.softness, [[0.0, 0.1], [0.0, 0.2]])
    np.testing.assert_array_equal(groups[4, 5].problem.softness, [[0.3], [0.4]])
    assert [len(layer) for layer in groups[0, 1].problem.layers] == [2]


def test_frames_are_told_apart_by_who_is_active_and_not_by_what_stands_there_alone():
    def together(rows):
        return [(members, frames.tolist()) for members, frames in frames_together(np.array(rows, dtype=np.int8))]

    assert together([[1, 0], [0, 1], [1, 0]]) == [((1,), [1]), ((0,), [0, 2])]
    assert together([[1], [0], [0], [1], [1], [0]]) == [((0,), [0, 3, 4])]  # the same bytes
    assert together([[1, 2], [1, 1]]) == [((0, 1), [1]), ((0, 1), [0])]
    assert together(np.zeros((3, 0))) == []


def test_what_is_asked_of_one_clip_makes_no_plan_for_another():
    whole, part = held("LeftHand", FRAMES, priority=2), held("RightHand", 4)
    for constraints in (
        [whole, part],
        [replace(whole, priority=0), part],
        [replace(whole, weight=3.0, priority=1), part],
    ):
        asked = asked_of(*constraints)
        group = next(group for group in groups_of(asked) if len(group.members) and len(group.frames) == 4)
        order = sorted({each.priority for each in constraints}, reverse=True)
        assert [[constraints[i].priority for (i,) in layer] for layer in group.members] == [
            [priority] * sum(each.priority == priority for each in constraints) for priority in order
        ]
        most = max(each.weight for each in constraints if each.priority == order[0])
        assert [each.weight for each in group.problem.layers[0]] == [
            constraints[i].weight / most for (i,) in group.members[0]
        ]
        joints = frozenset().union(*(each.joints for each in asked.recruits))
        assert frozenset(group.problem.columns.joints.tolist()) == joints


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_constraints_that_share_a_layer_are_as_soft_as_the_softest_whichever_stands_first(order):
    some, others = np.linspace(0.1, 0.3, FRAMES), np.linspace(0.3, 0.1, FRAMES)
    asked = asked_of(held("LeftHand", FRAMES), held("RightHand", FRAMES)).only(order)
    soft = replace(asked, softness=tuple((some, others)[i] for i in order))
    (group,) = groups_of(soft)
    np.testing.assert_array_equal(group.problem.softness[:, 0], np.maximum(some, others))


def test_a_rest_pose_that_does_what_is_asked_is_not_solved_and_one_that_does_not_is():
    rest = MOTION.rotations.copy()
    rest[:2] = rot.IDENTITY
    motion = Motion(MOTION.skeleton, rest, MOTION.translations, MOTION.frame_time)
    body = replace(BODY, first=2)
    asked = prepare(motion, [Position(name="foot", effector=end("LeftFoot"))], body, HARD)[0].asked
    assert [group.frames.tolist() for group in groups_of(asked)] == [list(range(2, FRAMES))]
    raised = edit_by_priorities(motion, [held("LeftHand", FRAMES, (0.0, 0.1, 0.1))], body, HARD)
    assert raised.errors[0].positions.max() < 1e-5
    assert np.linalg.norm(path(raised.motion, "LeftHand")[0] - path(motion, "LeftHand")[0]) > 0.1
