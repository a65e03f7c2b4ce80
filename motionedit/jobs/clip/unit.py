"""Which unit makes a leg of a clip as long as legs are, and whether what a spec gives is in it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from motionedit.core.units import STANDARD_LEG
from motionedit.spec.values import UNITS

if TYPE_CHECKING:
    from motionedit.spec.values import Unit

# Metres of a grown human's leg; outside of them the unit is a guess, and that is said.
_SHORTEST_HUMAN, _LONGEST_HUMAN = 0.6, 1.15
# Metres between which a leg is a person's, small or large, or a creature's: else the unit is a slip.
_SHORTEST_LEG, _LONGEST_LEG = 0.3, 1.5

# Legs: nothing is meant to be missed by more.
_FAR = 3.0


def likely_unit(leg_length: float) -> dict[str, Any] | None:
    """Return the unit that makes a leg nearest 0.85 m, by ratio; None where there is no length.

    Its `name`, the `leg` in metres, and whether that is `likely`: a human's.
    """
    if leg_length <= 0.0:
        return None
    name = min(UNITS, key=lambda unit: abs(math.log(leg_length * UNITS[unit] / STANDARD_LEG)))
    leg = leg_length * UNITS[name]
    return {"name": name, "leg": leg, "likely": _SHORTEST_HUMAN <= leg <= _LONGEST_HUMAN}


def unit_doubts(leg_length: float, unit: Unit | None) -> list[str]:
    """Return a line for the user where a leg (clip units) has no length of legs in this unit, else none."""
    if unit is None or leg_length <= 0.0 or _SHORTEST_LEG <= leg_length * unit.metres <= _LONGEST_LEG:
        return []
    return [f"a leg is {leg_length * unit.metres:.3g} m long where the unit is {unit.name}: is that the clip's unit?"]


def far_miss_words(off: float, leg_length: float) -> str:
    """Return what to add to a goal that is missed by many legs, else an empty text; clip units."""
    if leg_length <= 0.0 or off <= _FAR * leg_length:
        return ""
    return f"; {off / leg_length:.3g} legs, and a leg of this clip is {leg_length:.4g} long: is it in the clip's unit?"
