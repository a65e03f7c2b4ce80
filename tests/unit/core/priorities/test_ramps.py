"""Ramps: where constraints ease in and out within the clip, and how they are led to where the edit has their tasks."""

import numpy as np
import pytest
from person import BODY, end, held_feet, path, swaying

from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.kinds import Aim, Position
from motionedit.core.priorities.ramps import apart, ends_in, led_frames, led_to, ramps_of
from motionedit.core.priorities.settings import LayeredSettings
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.priorities.trajectories.positions import ControlPoint
from motionedit.dataclass import replace

FRAMES = 80
MOTION = swaying(FRAMES)
HAND = len(held_feet(FRAMES))


def asked_of(first, last, ease=12):
    point = ControlPoint("during", first, last, None, np.array([0.0, 0.2, 0.1]))
    hand = Position(name="hand", priority=4, effector=end("RightHand"), points=(point,), ease_in=ease, ease_out=ease)
    return prepare(MOTION, [*held_feet(FRAMES), hand], BODY, LayeredSettings())[0].asked


def frames_of(ramp):
    return list(np.flatnonzero(ramp.left))


def test_a_ramp_is_what_is_left_of_an_ease_up_to_its_point():
    before, after = ramps_of(asked_of(34, 44), HAND)
    assert (frames_of(before), before.outside) == (list(range(22, 34)), 21)
    assert (frames_of(after), after.outside) == (list(range(45, 57)), 57)
    # It begins with all of it, but for what the ease has at its first frame.
    assert before.left[22] == after.left[56] == 1.0
    np.testing.assert_allclose(before.left[22:34], after.left[45:57][::-1])


@pytest.mark.parametrize(
    ("first", "last", "outsides"), [(12, 20, [33]), (13, 20, [0, 33]), (60, 67, [47]), (60, 66, [47, 79])]
)
def test_a_ramp_that_the_clips_end_cuts_is_none(first, last, outsides):
    found = [ramp.outside for ramp in ramps_of(asked_of(first, last), HAND)]
    assert found == outsides


def test_a_constraint_without_points_or_without_an_ease_has_no_ramps():
    assert ramps_of(asked_of(34, 44), 0) == ()
    assert ramps_of(asked_of(34, 44, ease=0), HAND) == ()


def test_ramps_are_led_to_where_they_end_and_points_are_left():
    asked = asked_of(34, 44)
    ends = ends_in(asked, MOTION)
    assert all(each is targets for each, targets in zip(led_to(asked, ends), asked.targets, strict=True))
    assert not led_frames(asked, ends, ends).any()
    (before, after), shift = ends[HAND], np.array([0.0, 0.01, 0.0])
    moved = (*ends[:HAND], (Targets(before.first, before.last, before.positions + shift), after))
    led, own = led_to(asked, moved)[HAND], asked.targets[HAND]
    np.testing.assert_allclose(led.positions[0], own.positions[0] + shift)
    np.testing.assert_array_equal(led.positions[12:], own.positions[12:])
    assert list(np.flatnonzero(led_frames(asked, ends, moved))) == list(range(22, 34))


def test_what_is_looked_at_ends_a_ramp_as_far_away_as_it_is_beside_it():
    going = np.linspace(0.0, 4.0, FRAMES)[:, None, None] * np.array([0.0, 0.0, 1.0])
    walk, lamp = replace(MOTION, translations=MOTION.translations + going), np.array([2.0, 1.5, 1.0])
    point = ControlPoint("hold", 34, 44, lamp, None)
    look = Aim(name="look", effector=end("Head"), points=(point,), ease_in=12, ease_out=12)
    asked = prepare(walk, [look], BODY, LayeredSettings())[0].asked
    eyes, ramps = path(walk, "Head"), ramps_of(asked, 0)
    assert [ramp.outside for ramp in ramps] == [21, 57]
    for ramp, ends in zip(ramps, ends_in(asked, walk)[0], strict=True):
        far = np.linalg.norm(lamp - eyes[ramp.outside])
        for targets in (ramp.end, ends):
            assert np.linalg.norm(targets.positions[0] - eyes[ramp.outside]) == pytest.approx(far, rel=0.05)


def test_how_far_tasks_are_apart_is_the_most_of_any_of_their_parts():
    place, turn = path(MOTION, "RightHand")[:1], np.array([[0.8, 0.6, 0.0, 0.0]])
    one, other = Targets(0, 0, place, turn), Targets(0, 0, place + np.array([0.0, -0.2, 0.1]), turn)
    assert apart(one, one) == 0.0
    assert apart(one, other) == pytest.approx(0.2)
    assert apart(one, Targets(0, 0, place)) == 0.0
