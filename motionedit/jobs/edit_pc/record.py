"""What the report says of an edit in coefficient space: its goals, its status, how far it went from the database."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.jobs.clip.edit_record import EditRecord, worst_status
from motionedit.jobs.clip.effector_record import effector_record
from motionedit.jobs.edit_pc.goals import ClipGoal, goal_place, goal_record, is_met
from motionedit.jobs.edit_pc.solver import largest_norm

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.pca.model import MotionModel

# A met goal whose coefficients lie further out than this times the database's largest norm is reported `far`.
FAR = 1.75


def edit_record(
    model: MotionModel,
    projection: Projection,
    edit: CoefficientEdit,
    goals: Sequence[ClipGoal],
    *,
    poses: WorldPoses,
    bound: float | None,
) -> EditRecord:
    """Return what is to be said of an edit; `poses` are the edited motion's, `bound` the solver's."""
    skeleton = edit.motion.skeleton
    records = [
        goal_record(goal, poses)
        | {"effector": effector_record(goal.request.effector, skeleton), "target": goal_place(goal, poses)}
        for goal in goals
    ]
    before = float(model.mahalanobis(projection.coefficients))
    after = float(model.mahalanobis(edit.coefficients))
    largest = largest_norm(model)
    # By a prior the change itself is measured; without one all that is known is where the coefficients end.
    status = _mark(records, edit.reasons, is_far=(after if edit.norm is None else edit.norm) > FAR * largest)
    solutions = [change.solution for change in edit.changes]
    record = {
        "goals": records,
        "iterations": sum(solution.iterations for solution in solutions),
        "stopped": next((s.reason for s in solutions if s.reason != "converged"), "converged"),
        "history": [error / model.space.scale for solution in solutions for error in solution.history],
        "alpha": {"before": projection.coefficients, "after": edit.coefficients},
        "mahalanobis": {"before": before, "after": after, "bound": bound, "database_max": largest},
        "change": edit.norm,
        "nearest": {
            "before": _nearest(model, projection.coefficients),
            "after": _nearest(model, edit.coefficients),
        },
    }
    missed = [_missed(each, edit.reasons[i]) for i, each in enumerate(records) if each["status"] != "ok"]
    far = [] if status != "far" else ["met, but far from what the database does: look at it before you use it"]
    message = "; ".join((*missed, *far)) or None
    return EditRecord(status, message, (*missed, *far, *_crowding(model, goals)), record)


def _mark(records: Sequence[dict[str, Any]], reasons: Mapping[int, str], *, is_far: bool) -> str:
    """Set each goal's status, and return the clip's."""
    for i, record in enumerate(records):
        if not is_met(record):
            record["status"] = "unreachable" if reasons[i] in {"bound", "stalled"} else "out_of_tolerance"
    missed = worst_status(*(record["status"] for record in records))
    return "far" if missed == "ok" and records and is_far else missed


def _nearest(model: MotionModel, coefficients: FloatArray) -> str:
    """Return the clip of the database whose coefficients are nearest, in the metric of the motions themselves."""
    distances = np.linalg.norm(model.components.coefficients - coefficients, axis=1)
    return model.clips[int(np.argmin(distances))].name


def _crowding(model: MotionModel, goals: Sequence[ClipGoal]) -> list[str]:
    """Return a warning where goals ask for more numbers than half the components can give freely."""
    rows = sum(
        (len(goal.request.measure.counted) if goal.request.position is not None else 0)
        + (3 if goal.request.rotation is not None else 0)
        for goal in goals
    )
    count = len(model.components.explained_variance)
    if rows > count:
        return [f"{rows} numbers are asked for and {count} components can move: a weighted compromise"]
    if 2 * rows > count:
        return [f"{rows} numbers are asked for and {count} components can move: that may bend the style"]
    return []


_WHY = {
    "bound": "out of reach of the database's motions",
    "stalled": "out of reach of the database's motions",
    "gave way": "it gave way to goals of higher priority",
    "iterations": "the iterations ran out",
    "converged": "the solver's own tolerance is wider",
}


def _missed(record: dict[str, Any], reason: str) -> str:
    parts = []
    if record["error_max"] is not None:
        parts.append(f"{record['error_max']:.4g} from its goal at frame {record['frame']}")
    if record["error_angle_max"] is not None:
        parts.append(f"turned {record['error_angle_max']:.4g} degrees from its goal at frame {record['frame']}")
    limits = [
        f"{record['tolerance']:.3g}" if record["tolerance"] is not None else "",
        f"{record['tolerance_angle']:.3g} degrees" if record["tolerance_angle"] is not None else "",
    ]
    return f"{record['name']}: {' and '.join(parts)} (tolerance {', '.join(filter(None, limits))}): {_WHY[reason]}"


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
