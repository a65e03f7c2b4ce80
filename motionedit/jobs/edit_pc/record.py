"""What the report says of an edit in coefficient space: its goals, its status, how far it went from the database."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass
from motionedit.jobs.clip.edit_record import EditRecord, worst_status
from motionedit.jobs.clip.effector_record import effector_record
from motionedit.jobs.clip.unit import far_miss_words
from motionedit.jobs.edit_pc.goals import ClipGoal, goal_place, goal_record, is_met, numbers_of
from motionedit.jobs.edit_pc.solver import largest_norm, usual_change

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.pca.model import MotionModel

# A met goal is reported `far` where the change is larger than this times what makes of one clip of the database
# another, or, without a prior, where the coefficients lie further out than this times the database's largest norm.
FAR = 1.75


@dataclass(frozen=True)
class Judged:
    """What is known of an edit beside its goals.

    Attributes
    ----------
    bound, share : float or None
        The solver's, None where it has none.
    odd : sequence of str
        What else to warn of.
    rough : sequence of str
        Why a viewer would see the edit, or why the model has nothing to say of the clip.
    """

    bound: float | None
    share: float | None
    odd: Sequence[str] = ()
    rough: Sequence[str] = ()


def edit_record(
    model: MotionModel,
    projection: Projection,
    edit: CoefficientEdit,
    goals: Sequence[ClipGoal],
    *,
    poses: WorldPoses,
    verdicts: Judged,
) -> EditRecord:
    """Return what is to be said of an edit; `poses` are the edited motion's."""
    bound, share, odd, rough = verdicts.bound, verdicts.share, verdicts.odd, verdicts.rough
    skeleton = edit.motion.skeleton
    records = [
        goal_record(goal, poses)
        | {"effector": effector_record(goal.request.effector, skeleton), "target": goal_place(goal.request, poses)}
        for goal in goals
    ]
    before = float(model.mahalanobis(projection.coefficients))
    after = float(model.mahalanobis(edit.coefficients))
    largest = largest_norm(model)
    is_far, met = _is_far(model, edit, goals, after), _mark(records, edit)
    status = worst_status(met, "far" if records and is_far else "ok", "rough" if rough else "ok")
    solutions = [change.solution for change in edit.changes]
    record = {
        "goals": records,
        "iterations": sum(solution.iterations for solution in solutions),
        "stopped": next((s.reason for s in solutions if s.reason != "converged"), "converged"),
        "history": [error / model.space.scale for solution in solutions for error in solution.history],
        "alpha": {"before": projection.coefficients, "after": edit.coefficients},
        "mahalanobis": {
            "before": before,
            "after": after,
            "bound": bound,
            "database_max": largest,
        },
        "change": {
            "norm": edit.norm,
            "bound": None if edit.norm is None else bound,
            "residual_share": share if edit.share is None else edit.share,
        },
        "nearest": {
            "before": _nearest(model, projection.coefficients),
            "after": _nearest(model, edit.coefficients),
        },
    }
    leg = STANDARD_LEG / model.space.scale
    missed = [
        _missed(each, edit.reasons[i], records) + far_miss_words(each["error_max"] or 0.0, leg)
        for i, each in enumerate(records)
        if each["status"] != "ok"
    ]
    far = [_FAR] if met == "ok" and records and is_far else []
    message = "; ".join(missed or (*rough, *far)) or None
    return EditRecord(status, message, (*missed, *far, *rough, *odd, *_crowding(model, goals, edit)), record)


def _is_far(model: MotionModel, edit: CoefficientEdit, goals: Sequence[ClipGoal], after: float) -> bool:
    """Return whether an edit goes further than the database's clips do: by the change itself, where a prior knows it.

    Without a prior all that is known is where the coefficients end, `after`.
    """
    if edit.norm is None:
        return after > FAR * largest_norm(model)
    groups = len(edit.changes)
    asked = max(sum(numbers_of(goals[i].request) for i in change.reasons) for change in edit.changes) if groups else 0
    return edit.norm > FAR * usual_change(model, asked=asked)


def _mark(records: Sequence[dict[str, Any]], edit: CoefficientEdit) -> str:
    """Set each goal's status and whom it gave way to, and return the worst."""
    reasons, rivals = edit.reasons, edit.rivals
    for i, record in enumerate(records):
        if is_met(record):
            continue
        record["status"] = "unreachable" if reasons[i] in {"bound", "stalled", "stood"} else "out_of_tolerance"
        record["gave_way_to"] = [records[k]["name"] for k in rivals.get(i, ())]
    return worst_status(*(record["status"] for record in records))


def _nearest(model: MotionModel, coefficients: FloatArray) -> str:
    """Return the clip of the database whose coefficients are nearest, in the metric of the motions themselves."""
    distances = np.linalg.norm(model.components.coefficients - coefficients, axis=1)
    return model.clips[int(np.argmin(distances))].name


def _crowding(model: MotionModel, goals: Sequence[ClipGoal], edit: CoefficientEdit) -> list[str]:
    """Return a warning where goals ask for more numbers than half the components, if there is no more, give freely."""
    if edit.norm is not None:
        return []
    rows, count = sum(numbers_of(goal.request) for goal in goals), len(model.components.explained_variance)
    if rows > count:
        return [f"{rows} numbers are asked for and {count} components can move: a weighted compromise"]
    if 2 * rows > count:
        return [f"{rows} numbers are asked for and {count} components can move: that may bend the style"]
    return []


_FAR = "met, but far from what the database does: look at it before you use it"
_WHY = {
    "bound": "out of reach of the database's motions",
    "stalled": "out of reach of the database's motions",
    "gave way": "it gave way to goals of higher priority",
    "iterations": "the iterations ran out",
    "stood": "out of reach with feet that stand; feet: off lets them go",
    "converged": "the solver's own tolerance is wider",
}


def _missed(record: dict[str, Any], reason: str, records: Sequence[dict[str, Any]]) -> str:
    parts = []
    if record["error_max"] is not None:
        parts.append(f"{record['error_max']:.4g} from its goal at frame {record['frame']}")
    if record["error_angle_max"] is not None:
        parts.append(f"turned {record['error_angle_max']:.4g} degrees from its goal at frame {record['frame']}")
    limits = [
        f"{record['tolerance']:.4g}" if record["tolerance"] is not None else "",
        f"{record['tolerance_angle']:.4g} degrees" if record["tolerance_angle"] is not None else "",
    ]
    missed = f"{record['name']}: {' and '.join(parts)} (tolerance {', '.join(filter(None, limits))})"
    return f"{missed}: {_gave_way(record, records) if record['gave_way_to'] else _WHY[reason]}"


def _gave_way(record: dict[str, Any], records: Sequence[dict[str, Any]]) -> str:
    """Return what a goal gave way to: what goes before it, and what asks for something else with the same right."""
    rivals = [each for each in records if each["name"] in record["gave_way_to"]]
    above, beside = (
        ", ".join(each["name"] for each in rivals if (each["priority"] > record["priority"]) is higher)
        for higher in (True, False)
    )
    parts = [f"it gave way to {above}" if above else "", f"shared by weight with {beside}" if beside else ""]
    return "; ".join(filter(None, parts))


def goal_line(goal: ClipGoal, poses: WorldPoses) -> str:
    """Return the line that a dry run prints of a goal; `poses` are the input's."""
    request = goal.request
    record = goal_record(goal, poses)
    asked = []
    if record["error_max"] is not None:
        asked.append(f"{record['error_max']:.4g} away")
    if record["error_angle_max"] is not None:
        asked.append(f"{record['error_angle_max']:.4g} degrees away")
    return f"{goal.name}: frame {request.frame}, {' and '.join(asked)}, weight {request.weight:g}"
