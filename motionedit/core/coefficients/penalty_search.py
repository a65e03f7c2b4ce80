"""The search for the penalty at which a penalised solution's norm meets its bound."""

from __future__ import annotations

import math

_FIRST_PENALTY = 1e2
_LEAST_PENALTY = 1e-12
_MOST_TRIES = 60
# Penalties this near each other, relative, lead to different norms only where the norm jumps over the bound.
_STALL = 1e-6


class PenaltySearch:
    """Which penalty to try next: a tenth of the last until the norm is outside, then one between the nearest two.

    Between them log(norm) over log(penalty) is taken for a straight line (regula falsi in its Illinois form), and
    every third time the interval is halved, since the norm may jump.

    Attributes
    ----------
    penalty : float
        The one to try.
    ended : bool
        Nothing is left to try: the norm stays inside, or it jumps over the bound.
    """

    def __init__(self, norm: float) -> None:
        self.penalty = _FIRST_PENALTY
        self.ended = False
        self._wanted = math.log(norm)
        self._tries = self._between = 0
        # log(penalty) and how far log(norm) is from what is wanted, of the nearest tries inside and outside.
        self._nearest: dict[bool, tuple[float, float]] = {}
        self._last: bool | None = None

    def tried(self, norm: float, *, within: bool) -> None:
        """Take note of the norm that the penalty led to, and choose the next one."""
        self._tries += 1
        self._nearest[within] = (math.log(self.penalty), math.log(max(norm, 1e-300)) - self._wanted)
        if len(self._nearest) < 2:
            self.penalty *= 0.1 if within else 10.0
            self.ended = self.penalty < _LEAST_PENALTY
            return
        if self._last == within:
            # The same end moved twice: the other one is weighed less, or it would stay for ever.
            at, miss = self._nearest[not within]
            self._nearest[not within] = (at, 0.5 * miss)
        self._last = within
        self._between += 1
        (a, miss_a), (b, miss_b) = self._nearest[True], self._nearest[False]
        share = 0.5 if self._between % 3 == 0 else miss_a / (miss_a - miss_b)
        self.penalty = math.exp(a + share * (b - a))
        self.ended = abs(a - b) < _STALL or self._tries >= _MOST_TRIES
