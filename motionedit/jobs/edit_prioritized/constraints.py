"""The constraints of an edit-prioritized spec in a clip, with what counts as met; clips alike are asked the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.again import LastFew, Same
from motionedit.dataclass import dataclass
from motionedit.jobs.clip.edit_record import DEFAULT_ANGLE_TOLERANCE, DEFAULT_TOLERANCE
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.edit_prioritized.resolver import Resolver
from motionedit.spec.plants import PLANTS

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping, Sequence

    from motionedit.core.arrays import BoolArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec


@dataclass(frozen=True, eq=False)
class ClipConstraint:
    """A constraint in one clip.

    Attributes
    ----------
    constraint : Constraint
        In normalised metres.
    tolerance, angle_tolerance : float
        What counts as met: clip units, degrees; the defaults where the spec says nothing, or ``off``.
    may_give_way : bool
        Its tolerance is ``off``: nobody minds where it is missed.
    counts : bool
        `--strict` fails where it is missed.
    """

    constraint: Constraint
    tolerance: float
    angle_tolerance: float
    may_give_way: bool
    counts: bool


def clip_constraints(
    loaded: LoadedSpec[EditPrioritizedSpec],
    facts: ClipFacts,
    events: Mapping[str, float],
    *,
    scale: float,
    faults: Faults,
    relative: str = "",
) -> list[ClipConstraint]:
    """Return the spec's constraints in a clip; what the clip lacks goes to `faults`.

    Parameters
    ----------
    events : mapping
        Frame of each event that the spec names.
    scale : float
        Normalised metres per clip unit.
    relative : str
        What files call the clip: its path below the given folder, or its name.
    """
    key = _what_tells(loaded, facts, events, scale=scale)
    known = None if key is None else _KNOWN.get(key)
    if known is not None:
        return [*known]
    found: list[ClipConstraint] = []
    is_whole = True
    for spec in loaded.model.constraints:
        own = Faults()
        constraints = Resolver(loaded, facts, events, scale, own, relative).constraints(spec)
        for error in own.errors:
            faults.add(error)
        is_whole = is_whole and not own.errors
        met = spec.met_within
        found += [
            ClipConstraint(
                constraint=constraint,
                tolerance=DEFAULT_TOLERANCE / scale if met.position is None else met.position,
                angle_tolerance=DEFAULT_ANGLE_TOLERANCE if met.angle is None else met.angle,
                may_give_way=met.off,
                counts=spec.counts_for_strict,
            )
            for constraint in constraints
        ]
    if key is not None and is_whole:
        _KNOWN.keep(key, tuple(found))
    return found


def placed_at(constraints: Sequence[Constraint], motion: Motion, joint: int) -> BoolArray:
    """Return the frames of a motion at which constraints place a joint or what hangs on it, shape (F,)."""
    placed = np.zeros(len(motion), dtype=np.bool_)
    for each in constraints:
        if each.places_effector and each.at is not None and joint in motion.skeleton.chain(each.at.joint):
            first, last = each.active(len(motion))
            placed[first : last + 1] = True
    return placed


# The clips of a folder mostly share their skeleton: of those the same is asked.
_KNOWN: LastFew[tuple[ClipConstraint, ...]] = LastFew(4)


def _what_tells(
    loaded: LoadedSpec[EditPrioritizedSpec], facts: ClipFacts, events: Mapping[str, float], *, scale: float
) -> tuple[Hashable, ...] | None:
    """Return all that makes a clip's constraints what they are; None where it is the clip itself.

    That is a heading, and plants that a table gives by the names of clips.
    """
    same = Same(loaded)
    if _by_the_clip(same, loaded):
        return None
    motion, given = facts.clip.motion, (facts.travel, facts.first, facts.up.tobytes(), facts.anatomy)
    return (same, motion.skeleton, len(motion), motion.frame_time, scale, *given, *events.items())


def _by_the_clip(same: Same, loaded: LoadedSpec[EditPrioritizedSpec]) -> bool:
    known = _BY_THE_CLIP.get(same)
    if known is not None:
        return known
    values = [own for spec in loaded.model.constraints for own in spec.own_values()]
    headed = any(own.key == "frame" and own.value == "heading" for own in values)
    listed_by_clip = any(own.kind is PLANTS and own.value is not None and own.value.rows is not None for own in values)
    return _BY_THE_CLIP.keep(same, headed or listed_by_clip)


_BY_THE_CLIP: LastFew[bool] = LastFew(4)
