"""What the report says of an edit by priorities: how near each constraint came, and what it gave way to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import median
from motionedit.core.priorities.problem import order_of_layers
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter
from motionedit.dataclass import dataclass
from motionedit.jobs.clip.edit_record import EditRecord
from motionedit.jobs.clip.effector_record import effector_record
from motionedit.jobs.edit_prioritized.recruits import recruited_names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.edit import PrioritizedEdit
    from motionedit.core.priorities.kinds.constraint import ConstraintErrors
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_prioritized.constraints import ClipConstraint

# A constraint that --strict does not count is worth a warning from so many tolerances on: 1 cm, 1 degree.
FAR_OFF = 10.0
# Errors over tolerance are told apart to this: below it is rounding, and the worst frame would be any.
_DIGITS = 6
_OUT_OF_REACH = "out of reach of the joints it recruits"
_FILTERED = "the low-pass on the root moved it (smoothing: paper)"


@dataclass(frozen=True, eq=False)
class _Measured:
    """A constraint and its errors: lengths (n,) in clip units, angles (n,) in degrees, from frame `first` on.

    `excess` (n,) is the larger of both over their tolerances: above 1 the constraint is missed there. `places` (n, 3)
    is where the effector is wanted in the world, clip units.
    """

    each: ClipConstraint
    first: int
    lengths: FloatArray | None
    angles: FloatArray | None
    excess: FloatArray
    places: FloatArray | None

    @property
    def last(self) -> int:
        return self.first + len(self.excess) - 1

    @property
    def worst(self) -> int:
        return self.first + _first_worst(self.excess)

    @property
    def missed(self) -> bool:
        return bool(self.excess.max() > 1.0)

    def is_active(self, frame: int) -> bool:
        return self.first <= frame <= self.last

    def is_missed(self, frame: int) -> bool:
        return bool(self.excess[frame - self.first] > 1.0)


def edit_record(
    edit: PrioritizedEdit,
    constraints: Sequence[ClipConstraint],
    facts: ClipFacts,
    *,
    scale: float,
    settings: LayeredSettings,
) -> EditRecord:
    """Return what is to be said of an edit.

    Parameters
    ----------
    scale : float
        Normalised metres per clip unit.
    settings : LayeredSettings
        Those of the edit.
    """
    measured = [_measured(each, errors, scale) for each, errors in zip(constraints, edit.errors, strict=True)]
    records, warnings, missed, statuses = [], [], [], set()
    for i, one in enumerate(measured):
        status, gave_way_to, reason = _verdict(i, measured, edit, settings)
        about = _about(one, facts, scale) | {"recruited": recruited_names(edit.recruits[i], facts)}
        records.append(_record(one, status, gave_way_to) | about | _frames(one))
        if status == "ok":
            continue
        line = f"{_missed_by(one)}: {reason}"
        if one.each.counts:
            statuses.add(status)
            missed.append(line)
        if one.each.counts or one.excess.max() > FAR_OFF:
            warnings.append(line)
    status = next((worst for worst in ("unreachable", "out_of_tolerance") if worst in statuses), "ok")
    solved = edit.iterations[edit.iterations > 0]
    record = {
        "constraints": records,
        "layers": _layers(edit, measured),
        "iterations": {
            "median": float(median(solved.astype(np.float64))) if len(solved) else 0.0,
            "max": int(solved.max(initial=0)),
        },
        "frames_solved": len(solved),
        "frames_not_converged": int(np.count_nonzero(~edit.converged)),
        "frames": {"iterations": edit.iterations, "stopped": _why_each_stopped(edit)},
    }
    return EditRecord(status, "; ".join(missed) or None, tuple(warnings), record)


def _why_each_stopped(edit: PrioritizedEdit) -> list[str]:
    """Return for every frame ``untouched``, ``converged``, or ``iterations`` where these ran out."""
    # Objects, so that all frames share three words: texts of their own take more memory than the motion.
    words = np.array(["iterations", "converged", "untouched"], dtype=object)
    why: list[str] = words[np.where(edit.iterations > 0, edit.converged.astype(np.intp), 2)].tolist()
    return why


def _measured(each: ClipConstraint, errors: ConstraintErrors, scale: float) -> _Measured:
    lengths = None if errors.positions is None else errors.positions / scale
    angles = None if errors.angles is None else np.degrees(errors.angles)
    over = [
        values / limit
        for values, limit in ((lengths, each.tolerance), (angles, each.angle_tolerance))
        if values is not None
    ]
    places = None if errors.places is None else errors.places / scale
    return _Measured(each, errors.first, lengths, angles, np.max(over, axis=0), places)


def _first_worst(excess: FloatArray) -> int:
    return int(np.argmax(np.round(excess, _DIGITS)))


def _verdict(
    i: int, measured: Sequence[_Measured], edit: PrioritizedEdit, settings: LayeredSettings
) -> tuple[str, list[str], str]:
    """Return a constraint's status, the names of those it gave way to, and why it is missed."""
    one = measured[i]
    if not one.missed:
        return "ok", [], ""
    rivals = _rivals(i, measured, edit)
    above = [other for other in rivals if other.each.constraint.priority > one.each.constraint.priority]
    names = [other.each.constraint.name for other in above if not other.is_missed(one.worst)]
    if isinstance(settings.smoothing, PaperFilter) and settings.smoothing.count == 1:
        # No solve came after the filter, so nobody's priority is to blame.
        reason, names = _FILTERED, []
    elif above:
        levels = order_of_layers([other.each.constraint.priority for other in above])
        which = f"priority {levels[0]}" if len(levels) == 1 else f"priorities {', '.join(map(str, levels))}"
        reason = f"{which} above left no freedom"
    else:
        reason = _reason(i, measured, [other for other in rivals if other.is_missed(one.worst)], edit, settings)
    status = "unreachable" if reason == _OUT_OF_REACH else "out_of_tolerance"
    return "ok" if one.each.may_give_way else status, names, reason


def _rivals(i: int, measured: Sequence[_Measured], edit: PrioritizedEdit) -> list[_Measured]:
    """Return the constraints of the same or a higher priority that, at the worst frame, move the same joints."""
    one, mine = measured[i], edit.recruits[i]
    return [
        other
        for other, theirs in zip(measured, edit.recruits, strict=True)
        if other is not one
        and other.each.constraint.priority >= one.each.constraint.priority
        and other.is_active(one.worst)
        and ((theirs.joints & mine.joints) or (theirs.root and mine.root))
    ]


def _reason(
    i: int,
    measured: Sequence[_Measured],
    beside: Sequence[_Measured],
    edit: PrioritizedEdit,
    settings: LayeredSettings,
) -> str:
    """Return why a constraint is missed that has none above it; `beside` it are missed ones of its own priority."""
    one = measured[i]
    movers = [measured[breach.lower].each.constraint for breach in edit.breaches if breach.higher == i]
    if settings.recruiting_rule == "ignore" and movers:
        return f"{min(movers, key=lambda mover: mover.priority).name} moves it by joints it does not recruit"
    if beside:
        return f"shared by weight with {beside[0].each.constraint.name}, of the same priority"
    if isinstance(settings.smoothing, PaperFilter) and settings.smoothing.count and edit.recruits[i].root:
        return _FILTERED
    if not edit.converged[one.first : one.last + 1][one.excess > 1.0].any():
        return "the iterations ran out"
    return _OUT_OF_REACH


def _record(one: _Measured, status: str, gave_way_to: list[str]) -> dict[str, Any]:
    each, lengths, angles = one.each, one.lengths, one.angles
    limits = not each.may_give_way
    return {
        "name": each.constraint.name,
        "type": each.constraint.type,
        "priority": each.constraint.priority,
        "error_max": None if lengths is None else float(lengths.max()),
        "error_rms": None if lengths is None else float(np.sqrt(np.mean(lengths**2))),
        "error_angle_max": None if angles is None else float(angles.max()),
        "frame": one.worst,
        "tolerance": each.tolerance if limits and lengths is not None else None,
        "tolerance_angle": each.angle_tolerance if limits and angles is not None else None,
        "status": status,
        "gave_way_to": gave_way_to,
        "strict": each.counts,
        "first_frame": one.first,
        "last_frame": one.last,
    }


def _about(one: _Measured, facts: ClipFacts, scale: float) -> dict[str, Any]:
    """Return what a constraint is about: its effector, and the frames of its points."""
    constraint, skeleton = one.each.constraint, facts.clip.motion.skeleton
    return {
        "effector": None if constraint.at is None else effector_record(constraint.at, skeleton, scale=scale),
        "points": [{"mode": point.mode, "first": point.start, "last": point.stop} for point in constraint.points],
    }


def _frames(one: _Measured) -> dict[str, Any]:
    """Return what is told frame by frame, from the first one on."""
    return {"frames": {"error": one.lengths, "error_angle": one.angles, "target": one.places}}


def _layers(edit: PrioritizedEdit, measured: Sequence[_Measured]) -> list[dict[str, Any]]:
    """Return each layer's members and the range of its independent rows over the frames at which it is active."""
    layers = []
    for level, priority in enumerate(order_of_layers([one.each.constraint.priority for one in measured])):
        members = [one for one in measured if one.each.constraint.priority == priority]
        active = np.zeros(len(edit.ranks), dtype=np.bool_)
        for one in members:
            active[one.first : one.last + 1] = True
        ranks = edit.ranks[active, level]
        layers.append(
            {
                "priority": priority,
                "constraints": [one.each.constraint.name for one in members],
                "rank": {"min": int(ranks.min()), "max": int(ranks.max())},
                "frames": {"rank": edit.ranks[:, level]},
            }
        )
    return layers


def _missed_by(one: _Measured) -> str:
    """Return ``right-toe: 1.8 from its goal at frame 58 (tolerance 0.5)``, with the parts that are missed."""
    parts, limits = [], []
    each = one.each
    for values, limit, words, unit in (
        (one.lengths, each.tolerance, "{:.4g} from its goal", ""),
        (one.angles, each.angle_tolerance, "turned {:.4g} degrees from its goal", " degrees"),
    ):
        if values is not None and values.max() > limit:
            parts.append(f"{words.format(values.max())} at frame {one.first + _first_worst(values / limit)}")
            limits.append(f"{limit:.3g}{unit}")
    return f"{each.constraint.name}: {' and '.join(parts)} (tolerance {', '.join(limits)})"
