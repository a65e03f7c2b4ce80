"""Constraints on one task: equals agree where their ramps overlap, and a more important one overrules the others."""

import numpy as np
import pytest
from person import BODY, edited, end, held, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.measure import Measure
from motionedit.core.priorities.agreeing import agreed, led_by_others, overruled
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.kinds import Aim, CenterOfMass, Distance, Orientation, Pose, Position
from motionedit.core.priorities.settings import LayeredSettings
from motionedit.core.priorities.targets import errors_of
from motionedit.core.priorities.trajectories.lengths import LengthPoint
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 80
MOTION = swaying(FRAMES)
# The ramps of both take 14 frames: from 26, to 50.
SPANS = (30, 36), (40, 46)
EASE = 14
SHIFTS = np.array([[0.1, 0.1, 0.1], [-0.05, 0.1, 0.15]])
TURNS = rot.exp(np.array([[0.3, 0.2, 0.0], [0.0, -0.2, 0.3]]))
PLACES = np.array([[0.5, 1.5, 2.0], [-0.5, 1.8, 2.0]])


def two(kind, points, **more):
    """Return a constraint for each of the points."""
    return [
        kind(name=f"{kind.type}-{k}", points=(point,), ease_in=EASE, ease_out=EASE, **more)
        for k, point in enumerate(points)
    ]


def points(*, shifts=(None, None), turns=(None, None), places=(None, None)):
    rows = zip(SPANS, places, shifts, turns, strict=True)
    return [ControlPoint("during", *span, place, shift, turn=turn) for span, place, shift, turn in rows]


def constraints_of(kind):
    """Return two constraints of a kind that want other things of the same."""
    if kind is CenterOfMass:
        return two(kind, points(shifts=0.3 * SHIFTS), relative_to="world")
    if kind is Distance:
        spans = [LengthPoint("during", *span, length=each) for span, each in zip(SPANS, (0.5, 0.4), strict=True)]
        return two(kind, spans, effector=end("RightHand"), to=end("LeftHand"))
    given = {
        Position: {"shifts": SHIFTS},
        Pose: {"shifts": SHIFTS, "turns": TURNS},
        Orientation: {"turns": TURNS},
        Aim: {"places": PLACES},
    }[kind]
    return two(kind, points(**given), effector=end("Head" if kind is Aim else "RightHand"))


def left_of(constraints):
    """Return what an edit leaves of constraints, their ramps too, metres or radians: the largest of each."""
    done = edited(MOTION, constraints, LayeredSettings())
    errors = errors_of(done.asked, done.motion)
    return [max(part.max() for part in (each.positions, each.angles) if part is not None) for each in errors]


@pytest.mark.parametrize("kind", [Position, Pose, Orientation, Aim, CenterOfMass, Distance])
def test_both_are_met_in_their_points_and_where_their_ramps_overlap(kind):
    assert max(left_of(constraints_of(kind))) < 1e-4


def test_their_points_are_met_as_they_were_asked_for():
    after, before = (path(each, "RightHand") for each in (edited(MOTION, constraints_of(Position)).motion, MOTION))
    for (first, last), shift in zip(SPANS, SHIFTS, strict=True):
        moved = (after - before)[first : last + 1]
        np.testing.assert_allclose(moved, np.broadcast_to(shift, moved.shape), atol=1e-5)


def test_the_way_from_one_to_the_other_is_smooth():
    after, before = (path(each, "RightHand") for each in (edited(MOTION, constraints_of(Position)).motion, MOTION))
    steps = np.linalg.norm(np.diff(after - before, axis=0), axis=1)
    # From shift to shift in four frames: 17 cm.
    apart = np.linalg.norm(SHIFTS[1] - SHIFTS[0])
    assert steps[36:40].max() < 0.45 * apart
    assert np.delete(steps, slice(36, 40)).max() < 0.15 * apart


def test_the_heavier_has_more_to_say_on_the_way():
    def middle(weight):
        one, other = constraints_of(Position)
        heavy = type(one)(**{**vars(one), "weight": weight})
        moved = path(edited(MOTION, [heavy, other]).motion, "RightHand")[38] - path(MOTION, "RightHand")[38]
        return np.linalg.norm(moved - SHIFTS[0])

    assert middle(3.0) < 0.5 * middle(1.0)


@pytest.mark.parametrize(
    "other",
    [
        {"effector": end("LeftHand")},
        {"effector": end("RightHand", (0.0, 0.1, 0.0))},
        {"points": points(shifts=SHIFTS)[:1]},
    ],
)
def test_those_that_ask_for_another_task_or_contradict_each_other_keep_their_targets(other):
    one, second = constraints_of(Position)
    given = [one, type(second)(**{**vars(second), **other})]
    targets = prepare(MOTION, given, BODY, LayeredSettings())[0].asked.targets
    assert all(a is b for a, b in zip(agreed(given, targets, FRAMES), targets, strict=True))


def test_those_that_last_the_whole_clip_keep_their_targets():
    given = [held("RightHand", FRAMES), constraints_of(Position)[0]]
    targets = prepare(MOTION, given, BODY, LayeredSettings())[0].asked.targets
    assert all(a is b for a, b in zip(agreed(given, targets, FRAMES), targets, strict=True))


def with_priorities(*priorities, **more):
    """Return constraints that want a hand in two places, of these priorities."""
    pairs = zip(constraints_of(Position), priorities, strict=True)
    return [type(each)(**{**vars(each), "priority": priority, **more}) for each, priority in pairs]


@pytest.mark.parametrize("priorities", [(2, 1), (1, 2)])
def test_the_less_important_is_not_solved_for_where_the_other_is_active(priorities):
    given = with_priorities(*priorities)
    targets = prepare(MOTION, given, BODY, LayeredSettings())[0].asked.targets
    without = overruled(given, targets, FRAMES)
    lower, higher = np.argsort(priorities)
    assert not without[:, higher].any()
    both = np.zeros(FRAMES, dtype=bool)
    both[max(each.first for each in targets) : min(each.last for each in targets) + 1] = True
    np.testing.assert_array_equal(without[:, lower], both)


def test_the_less_important_asks_for_the_way_of_the_other_in_its_ramp():
    done = edited(MOTION, with_priorities(1, 2), LayeredSettings())
    errors = errors_of(done.asked, done.motion)
    assert errors[1].positions.max() < 1e-4
    left, (_, stop) = errors[0], SPANS[0]
    assert left.positions[: 26 - left.first].max() < 1e-4
    # The ramp of the other begins at 26: it has the last frames of its points, but not what comes after them.
    assert left.positions[stop - left.first] > 0.01
    assert left.positions[stop + 1 - left.first :].max() < 1e-4


@pytest.mark.compiled
@pytest.mark.parametrize("priorities", [(2, 1), (1, 1)])
def test_what_is_missed_of_one_is_no_error_of_another_that_has_its_ramp_there(priorities):
    high, near = with_priorities(*priorities)
    # Three metres up, under a pelvis that stays: out of reach.
    far = ControlPoint("during", *SPANS[0], shift=np.array([0.0, 3.0, 0.0]))
    near = type(near)(**{**vars(near), "points": (ControlPoint("during", 56, 62, shift=SHIFTS[1]),), "ease_in": 26})
    given = [type(high)(**{**vars(high), "points": (far,)}), near, held("Hips", FRAMES, priority=3)]
    done = edited(MOTION, given, LayeredSettings())
    missed, met, _ = done.errors
    assert missed.positions[SPANS[0][0] - missed.first] > 0.5
    np.testing.assert_allclose(met.positions, 0.0, atol=1e-4)
    # In its ramp over the other it is wanted where it is, after that where it asks to be.
    hand = path(done.motion, "RightHand")
    np.testing.assert_allclose(met.places, hand[met.first : met.first + len(met.places)], atol=1e-4)


def pose_of(one):
    return Pose(**{key: value for key, value in vars(one).items() if key in Pose.__dataclass_fields__})


def along_the_ground(one):
    return type(one)(**{**vars(one), "measure": Measure(counted=(0, 2))})


@pytest.mark.parametrize("other", [lambda one: one, pose_of, along_the_ground])
def test_a_ramp_is_led_by_others_where_these_are_active_and_no_further(other):
    high, low = with_priorities(2, 1)
    high = other(high)
    targets = prepare(MOTION, [high, low], BODY, LayeredSettings())[0].asked.targets
    led = led_by_others([high, low], targets, FRAMES)
    assert not led[:, 0].any()
    # Up to its points, and after them to where the other's ramp ends; its own goes on.
    assert np.flatnonzero(led[:, 1]).tolist() == [*range(26, SPANS[1][0]), *range(SPANS[1][1] + 1, 51)]
    assert targets[1].last > 51


def test_a_center_of_mass_is_led_by_one_along_other_axes():
    low, high = constraints_of(CenterOfMass)
    high = CenterOfMass(**{**vars(along_the_ground(high)), "priority": 2})
    targets = prepare(MOTION, [low, high], BODY, LayeredSettings())[0].asked.targets
    led = led_by_others([low, high], targets, FRAMES)
    assert led[SPANS[0][1] + 1, 0]
    assert not led[:, 1].any()


def test_a_place_leads_no_turn():
    place, turn = constraints_of(Position)[0], constraints_of(Orientation)[1]
    targets = prepare(MOTION, [place, turn], BODY, LayeredSettings())[0].asked.targets
    assert not led_by_others([place, turn], targets, FRAMES).any()


def test_an_aim_that_is_overruled_does_not_throw_the_body_about():
    # From one's distance and the other's a body could be found that looks at both.
    given = [type(each)(**{**vars(each), "priority": k}) for k, each in enumerate(constraints_of(Aim))]
    change = rot.log(rot.between(MOTION.rotations, edited(MOTION, given, LayeredSettings()).motion.rotations))
    steps = np.degrees(np.linalg.norm(np.diff(change, axis=0), axis=-1))
    assert steps.max() < 5.0


@pytest.mark.parametrize("bound", ["at_least", "at_most"])
def test_a_bound_on_one_side_is_about_nothing_that_another_could_agree_to(bound):
    point = LengthPoint("during", 3, 9, length=0.5, bound=bound)
    assert Distance(name="d", effector=end("RightHand"), to=end("LeftHand"), points=(point,)).about is None
