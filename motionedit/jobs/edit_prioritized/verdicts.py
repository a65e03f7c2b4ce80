"""How near each constraint of an edit by priorities came, and why one is missed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.settings import LayeredSettings, PaperFilter
from motionedit.core.priorities.solver.problem import order_of_layers
from motionedit.dataclass import dataclass
from motionedit.jobs.edit_prioritized.rest_pose import begins_within, rest_pose_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.blame import Blames
    from motionedit.core.priorities.edit import PrioritizedEdit
    from motionedit.core.priorities.kinds.constraint import Constraint, ConstraintErrors
    from motionedit.jobs.edit_prioritized.constraints import ClipConstraint

# Errors over tolerance are told apart to this: below it is rounding, and the worst frame would be any.
_DIGITS = 6
# Seconds after a rest pose within which goals give way to it: paths are blended over 0.3 s, and passes reach as far.
_FELT = 0.6
_OUT_OF_REACH = "out of reach of the joints it recruits"
_FILTERED = "the low-pass on the root moved it (smoothing: paper)"
_SMOOTHED = "within reach at that frame by itself, but not along a smooth path"


@dataclass(frozen=True, eq=False)
class Measured:
    """A constraint and its errors: lengths (n,) in clip units, angles (n,) in degrees, from frame `first` on.

    `excess` (n,) is the larger of both over their tolerances: above 1 the constraint is missed there. It is `largest`
    at frame `worst`. `places` (n, 3) is where the effector is wanted in the world, clip units.
    """

    each: ClipConstraint
    first: int
    lengths: FloatArray | None
    angles: FloatArray | None
    excess: FloatArray
    largest: float
    worst: int
    places: FloatArray | None

    @property
    def last(self) -> int:
        """Its last frame."""
        return self.first + len(self.excess) - 1

    @property
    def missed(self) -> bool:
        """Whether it is missed at any frame."""
        return self.largest > 1.0


@dataclass(frozen=True)
class Verdict:
    """A constraint's `status`, the names of those that it gave way to, and the `reason` in words."""

    status: str
    gave_way_to: tuple[str, ...] = ()
    reason: str = ""


def measured(each: ClipConstraint, errors: ConstraintErrors, scale: float) -> Measured:
    """Return a constraint and its errors, `scale` normalised metres per clip unit."""
    lengths = None if errors.positions is None else errors.positions / scale
    angles = None if errors.angles is None else np.degrees(errors.angles)
    over = [
        values / limit
        for values, limit in ((lengths, each.tolerance), (angles, each.angle_tolerance))
        if values is not None
    ]
    places = None if errors.places is None else errors.places / scale
    excess = over[0] if len(over) == 1 else np.max(over, axis=0)
    worst, largest = errors.first + first_worst(excess), float(np.maximum.reduce(excess))
    return Measured(each, errors.first, lengths, angles, excess, largest, worst, places)


def first_worst(excess: FloatArray) -> int:
    """Return the first of the frames with the largest error over tolerance."""
    return int(excess.round(_DIGITS).argmax())


def verdict(
    i: int, one: Measured, edit: PrioritizedEdit, settings: LayeredSettings, blames: Blames, *, scale: float
) -> Verdict:
    """Return whether constraint `i` is met, what it gave way to, and why it is missed; `blames` are those of the edit.

    Those are named without which it would be nearer; where there are none it is out of reach.
    """
    if not one.missed:
        return Verdict("ok")
    names: list[str] = []
    if isinstance(settings.smoothing, PaperFilter) and settings.smoothing.count == 1:
        # No solve came after the filter, so nobody's priority is to blame.
        reason = _FILTERED
    else:
        blame = blames.of(i, one.worst)
        priority = edit.asked.constraints[i].priority
        blamed = [edit.asked.constraints[k] for k in blame.by]
        names, above = [each.name for each in blamed], [each for each in blamed if each.priority > priority]
        if above:
            levels = order_of_layers([each.priority for each in above])
            which = f"priority {levels[0]}" if len(levels) == 1 else f"priorities {', '.join(map(str, levels))}"
            reason = f"{which} above left no freedom{_ramp_over(edit.asked.constraints[i], above, edit, one.worst)}"
        else:
            alone = measured(one.each, blame.left, scale)
            reason = _reason(i, one, names, edit, settings, is_met_alone=not alone.missed)
    status = "unreachable" if reason == _OUT_OF_REACH else "out_of_tolerance"
    reason += _rest_pose(i, one, edit, reason)
    return Verdict("ok" if one.each.may_give_way else status, tuple(names), reason)


def _ramp_over(missed: Constraint, above: Sequence[Constraint], edit: PrioritizedEdit, frame: int) -> str:
    """Return which of those above asks for the same, and is but in a ramp at a frame; or an empty text."""
    count = len(edit.motion)
    for each in above:
        if each.about is not None and each.about == missed.about and each.share(count)[frame] < 1.0:
            first, last = each.active(count)
            eases = f"in from frame {first} on" if frame < each.points[0].start else f"out until frame {last}"
            return f": {each.name} eases {eases}"
    return ""


def _rest_pose(i: int, one: Measured, edit: PrioritizedEdit, reason: str) -> str:
    """Return that a constraint is missed as it begins within the rest pose, or an empty text."""
    first = edit.asked.body.first
    since = (one.worst - first) * edit.motion.frame_time
    in_the_way = since < 0.0 if reason == _OUT_OF_REACH else reason == _SMOOTHED and since < _FELT
    if not in_the_way or not begins_within(edit.asked.constraints[i], first):
        return ""
    return f"; its points begin within {rest_pose_words(first)}: begin at frame {first}"


def _reason(
    i: int,
    one: Measured,
    beside: Sequence[str],
    edit: PrioritizedEdit,
    settings: LayeredSettings,
    *,
    is_met_alone: bool,
) -> str:
    """Return why a constraint is missed that none above it is to blame for; those `beside` it are.

    `is_met_alone` tells whether it is met where its worst frame is solved by itself.
    """
    movers = [edit.asked.constraints[breach.lower] for breach in edit.breaches if breach.higher == i]
    if settings.recruiting_rule == "ignore" and movers:
        return f"{min(movers, key=lambda mover: mover.priority).name} moves it by joints it does not recruit"
    if beside:
        return f"shared by weight with {', '.join(beside)}, of the same priority"
    if isinstance(settings.smoothing, PaperFilter) and settings.smoothing.count and edit.recruits[i].root:
        return _FILTERED
    if not edit.converged[one.first : one.last + 1][one.excess > 1.0].any():
        return "the iterations ran out"
    return _SMOOTHED if is_met_alone else _OUT_OF_REACH
