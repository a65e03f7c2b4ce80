"""What the report says of an edit by priorities: how near each constraint came, and what it gave way to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import median
from motionedit.core.priorities.blame import Blames
from motionedit.core.priorities.solver.problem import order_of_layers
from motionedit.jobs.clip.edit_record import EditRecord, worst_status
from motionedit.jobs.clip.effector_record import effector_record
from motionedit.jobs.clip.unit import far_miss_words
from motionedit.jobs.edit_prioritized.recruits import recruited_names
from motionedit.jobs.edit_prioritized.verdicts import Measured, Verdict, first_worst, measured, verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.priorities.edit import PrioritizedEdit
    from motionedit.core.priorities.settings import LayeredSettings
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_prioritized.constraints import ClipConstraint

# What has no points, asks to stay as it was, and is not counted by --strict is worth a warning from so many tolerances
# on: 1 cm, 1 degree.
FAR_OFF = 10.0


def edit_record(
    edit: PrioritizedEdit,
    constraints: Sequence[ClipConstraint],
    facts: ClipFacts,
    *,
    scale: float,
    settings: LayeredSettings,
    rough: Sequence[str] = (),
) -> EditRecord:
    """Return what is to be said of an edit.

    Parameters
    ----------
    scale : float
        Normalised metres per clip unit.
    settings : LayeredSettings
        Those of the edit.
    rough : sequence of str
        Why a viewer would see it, as `rough_lines`.
    """
    every = [measured(each, errors, scale) for each, errors in zip(constraints, edit.errors, strict=True)]
    records, warnings, missed, statuses = [], [], [], ["rough" if rough else "ok"]
    blames = Blames(edit.asked)
    for i, one in enumerate(every):
        found = verdict(i, one, edit, settings, blames, scale=scale)
        about = _about(one, facts, scale) | {"recruited": recruited_names(edit.recruits[i], facts)}
        records.append(_record(one, found) | about | _frames(one))
        if found.status == "ok":
            continue
        off = 0.0 if one.lengths is None else float(one.lengths.max())
        line = f"{_missed_by(one)}: {found.reason}{far_miss_words(off, facts.anatomy.leg_length)}"
        if one.each.counts:
            statuses.append(found.status)
            missed.append(line)
        if one.each.counts or one.each.constraint.points or one.largest > FAR_OFF:
            warnings.append(line)
    solved = edit.iterations[edit.iterations > 0]
    record = {
        "constraints": records,
        "layers": _layers(edit, every),
        "iterations": {
            "median": float(median(solved.astype(np.float64))) if len(solved) else 0.0,
            "max": int(solved.max(initial=0)),
        },
        "frames_solved": len(solved),
        "frames_not_converged": int(np.count_nonzero(~edit.converged)),
        "frames": {"iterations": edit.iterations, "stopped": _why_each_stopped(edit)},
    }
    message = "; ".join(missed or rough) or None
    return EditRecord(worst_status(*statuses), message, (*warnings, *rough), record)


def _why_each_stopped(edit: PrioritizedEdit) -> list[str]:
    """Return for every frame ``untouched``, ``converged``, or ``iterations`` where these ran out."""
    # Objects, so that all frames share three words: texts of their own take more memory than the motion.
    words = np.array(["iterations", "converged", "untouched"], dtype=object)
    why: list[str] = words[np.where(edit.iterations > 0, edit.converged.astype(np.intp), 2)].tolist()
    return why


def _record(one: Measured, found: Verdict) -> dict[str, Any]:
    each, lengths, angles = one.each, one.lengths, one.angles
    limits = not each.may_give_way
    return {
        "name": each.constraint.name,
        "type": each.constraint.type,
        "priority": each.constraint.priority,
        "error_max": None if lengths is None else float(np.maximum.reduce(lengths)),
        "error_rms": None if lengths is None else math.sqrt(np.add.reduce(lengths * lengths) / len(lengths)),
        "error_angle_max": None if angles is None else float(np.maximum.reduce(angles)),
        "frame": one.worst,
        "tolerance": each.tolerance if limits and lengths is not None else None,
        "tolerance_angle": each.angle_tolerance if limits and angles is not None else None,
        "status": found.status,
        "gave_way_to": found.gave_way_to,
        "strict": each.counts,
        "first_frame": one.first,
        "last_frame": one.last,
    }


def _about(one: Measured, facts: ClipFacts, scale: float) -> dict[str, Any]:
    """Return what a constraint is about: its effector, and the frames of its points."""
    constraint, skeleton = one.each.constraint, facts.clip.motion.skeleton
    return {
        "effector": None if constraint.at is None else effector_record(constraint.at, skeleton, scale=scale),
        "points": [{"mode": point.mode, "first": point.start, "last": point.stop} for point in constraint.points],
    }


def _frames(one: Measured) -> dict[str, Any]:
    """Return what is told frame by frame, from the first one on."""
    return {"frames": {"error": one.lengths, "error_angle": one.angles, "target": one.places}}


def _layers(edit: PrioritizedEdit, measured: Sequence[Measured]) -> list[dict[str, Any]]:
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


def _missed_by(one: Measured) -> str:
    """Return ``right-toe: 1.8 from its goal at frame 58 (tolerance 0.5)``, with the parts that are missed."""
    parts, limits = [], []
    each = one.each
    for values, limit, words, unit in (
        (one.lengths, each.tolerance, "{:.4g} from its goal", ""),
        (one.angles, each.angle_tolerance, "turned {:.4g} degrees from its goal", " degrees"),
    ):
        if values is not None and values.max() > limit:
            parts.append(f"{words.format(values.max())} at frame {one.first + first_worst(values / limit)}")
            limits.append(f"{limit:.4g}{unit}")
    return f"{each.constraint.name}: {' and '.join(parts)} (tolerance {', '.join(limits)})"
