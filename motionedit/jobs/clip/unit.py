"""Whether the unit that a spec gives makes a leg of the clip as long as legs are."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from motionedit.spec.values import Unit

# Metres between which a leg is a person's, small or large, or a creature's: else the unit is a slip.
_SHORTEST_LEG, _LONGEST_LEG = 0.3, 1.5


def unit_doubts(leg_length: float, unit: Unit | None) -> list[str]:
    """Return a line for the user where a leg (clip units) has no length of legs in this unit, else none."""
    if unit is None or leg_length <= 0.0 or _SHORTEST_LEG <= leg_length * unit.metres <= _LONGEST_LEG:
        return []
    return [f"a leg is {leg_length * unit.metres:.3g} m long where the unit is {unit.name}: is that the clip's unit?"]
