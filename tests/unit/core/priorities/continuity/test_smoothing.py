"""How often a solution is passed over: three times, and more where its change steps."""

from itertools import accumulate, islice, repeat

import numpy as np
import pytest
from person import BODY, held, held_feet, swaying

from motionedit.core.priorities.continuity import smoothing
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.frames import solve_from_input
from motionedit.core.priorities.settings import LayeredSettings, Passes

FRAMES = 40
MOTION = swaying(FRAMES)


def passes_where(monkeypatch, steps, *, on_the_way):
    """Return in how many passes ramps are led where the largest steps, pass by pass, are these."""
    asked = [*held_feet(FRAMES), held("RightHand", FRAMES, (0.1, 0.1, 0.1), priority=4)]
    run, _ = prepare(MOTION, asked, BODY, LayeredSettings())
    led, steps, real = [], iter(steps), smoothing._led

    def count(*arguments):
        led.append(arguments)
        return real(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(smoothing, "steps_at", lambda *_, **__: np.full(FRAMES, next(steps)))
        patch.setattr(smoothing, "_led", count)
        smoothing.in_passes(run, solve_from_input(run), Passes(), aimed=(lambda _: run) if on_the_way else None)
    return len(led)


@pytest.mark.parametrize(
    ("steps", "to_the_end", "on_the_way"),
    [
        (repeat(0.0), 1, 1),
        ([0.5, 0.4, 0.0], 3, 3),
        # They help, and go on helping.
        (accumulate(repeat(0.8), lambda a, b: a * b), 9, 4),
        # They hardly help, or do so once in three times.
        (repeat(0.5), 4, 4),
        ([0.5, 0.5, 0.5, 0.4, 0.4, 0.4, 0.3, 0.3, 0.3], 9, 4),
        ([0.5, 0.5, 0.5, 0.4, 0.4, 0.4, 0.4], 7, 4),
    ],
)
def test_steps_get_more_passes_while_these_help(monkeypatch, steps, to_the_end, on_the_way):
    steps = list(islice(steps, 12))
    for count, aimed in ((to_the_end, False), (on_the_way, True)):
        assert passes_where(monkeypatch, steps, on_the_way=aimed) == count
