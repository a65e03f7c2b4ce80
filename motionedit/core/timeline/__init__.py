"""The timeline of one behaviour: durations, events, time warps, resampling and alignment ([PC] section 5)."""

from math import floor


def round_half_up(value: float) -> int:
    """Return the nearest integer, halves up: the rule of every time in a spec."""
    return floor(value + 0.5)
