"""Which swings to make: random ones for tests and benchmarks, and the ten that ship."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from data.generator.golf import Swing, Timing
from data.generator.styles import PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Sequence

# Where the ball lies on average, and its spread on the ground, cm.
BALL = (4.0, 64.0)
BALL_SPREAD = (5.8, 5.8)
# The ten that ship: group of style by clip, and the seed of all the rest, chosen so that the balls lie well apart and
# neither they nor the durations go with the styles.
GROUPS = (0, 1, 2, 0, 2, 1, 0, 1, 2, 0)
SEED = 1372
SHIPPED_RATE = 25.0


def random_swing(
    rng: np.random.Generator,
    *,
    group: int | None = None,
    ball: tuple[float, float] | None = None,
    timing: Timing | None = None,
    noise: float = 1.0,
    on_frame: float | None = SHIPPED_RATE,
) -> Swing:
    """Return a swing whose style, ball, timing and noise are drawn independently of one another.

    Parameters
    ----------
    rng : seeded generator
        The same number of values is drawn whatever is given, so that what is given changes nothing else.
    group : 0, 1 or 2, the style; ball : (x, z) in cm; timing
        Drawn where they are None.
    noise : scale of the noise
    on_frame : Hz, or None
        The hit falls on a frame of this rate; None leaves it between frames.
    """
    drawn_group = int(rng.integers(3))
    mixture = rng.dirichlet((1.0, 1.0, 1.0))
    drawn_ball = np.clip(rng.standard_normal(2), -1.8, 1.8) * BALL_SPREAD + BALL
    drawn_timing = _random_timing(rng, on_frame)
    person = rng.standard_normal(len(PARAMETERS))
    seed = int(rng.integers(2**31))
    weights = 0.88 * np.eye(3)[drawn_group if group is None else group] + 0.12 * mixture
    return Swing(
        ball=(float(drawn_ball[0]), float(drawn_ball[1])) if ball is None else ball,
        timing=drawn_timing if timing is None else timing,
        style=(float(weights[0]), float(weights[1]), float(weights[2])),
        seed=seed,
        noise=noise,
        person=person,
    )


def random_swings(rng: np.random.Generator, count: int, *, noise: float = 1.0) -> list[Swing]:
    """Return `count` swings, every style in turn."""
    return [random_swing(rng, group=i % 3, noise=noise) for i in range(count)]


def shipped_swings(*, noise: float = 1.0) -> list[Swing]:
    """Return the swings of data/golf, in the order of their names."""
    return swings_of(GROUPS, seed=SEED, noise=noise)


def swings_of(groups: Sequence[int], *, seed: int, noise: float = 1.0) -> list[Swing]:
    """Return one swing for each style in `groups`; balls are rounded to a millimetre, as they are published."""
    rng = np.random.default_rng(seed)
    swings = []
    for group in groups:
        swing = random_swing(rng, group=group, noise=noise)
        ball = (round(swing.ball[0], 1) + 0.0, round(swing.ball[1], 1))
        swings.append(Swing(ball, swing.timing, swing.style, swing.seed, noise, swing.person))
    return swings


def _random_timing(rng: np.random.Generator, on_frame: float | None) -> Timing:
    # One tempo for the whole swing, and a little freedom for each of its parts.
    tempo = rng.uniform(0.90, 1.11)
    parts = np.array([2.02, 1.16, 0.56, 0.96, 0.56]) * tempo * rng.uniform(0.96, 1.04, 5)
    wait, back, down, through, hold = (float(part) for part in parts)
    hit = wait + back + down
    if on_frame is not None:
        shift = round(hit * on_frame) / on_frame - hit
        wait, hit = wait + shift, hit + shift
    end = hit + through + hold
    return Timing(wait, wait + back, hit, hit + through, round(end * SHIPPED_RATE) / SHIPPED_RATE)
