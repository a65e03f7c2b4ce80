"""One edit of one clip: made by the package, measured from outside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.trials.edits import EDITS, STRICT
from studies.trials.kinematics import read_take
from studies.trials.measures import Measured, measured

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from studies.lab import Lab
    from studies.trials.bodies import Body
    from studies.trials.edits import Edit

# Millimetres up to which a constraint counts as met without the one below it.
_MET = 0.1


@dataclass(frozen=True)
class Trial:
    """An edit of a clip, what it came to, and what is measured of it.

    Attributes
    ----------
    status : str
        What the package says of it, and whether it `warned`.
    strict : float or None
        How far adding a `com` below moves a constraint that is met without it, millimetres; None: not asked.
    errors : dict
        What is left of each constraint with a length, millimetres.
    """

    clip: str
    edit: str
    status: str
    warned: bool
    measured: Measured
    strict: float | None
    errors: dict[str, float]

    @property
    def is_quiet(self) -> bool:
        """Whether the package says that all is well."""
        return self.status == "ok" and not self.warned


def trial(lab: Lab, body: Body, edit: str) -> Trial:
    """Return a trial; lengths are scaled to a leg of 0.85 m."""
    constraints = EDITS[edit](body)
    made = lab.edit_prioritized(body.path, {"constraints": constraints})
    errors = {name: float(values.max()) for name, values in _errors(body, made.record).items()}
    strict = strictness(lab, body, constraints, made.record) if edit in STRICT else None
    found = measured(body, read_take(made.path))
    return Trial(body.name, edit, made.record["status"], bool(made.warnings), found, strict, errors)


def strictness(lab: Lab, body: Body, constraints: Edit, record: dict[str, Any]) -> float | None:
    """Return how far the `com` below moves, at any frame, a constraint that is met there without it, millimetres."""
    above = [constraint for constraint in constraints if constraint["type"] != "com"]
    if len(above) == len(constraints):
        return None
    alone = _errors(body, lab.edit_prioritized(body.path, {"constraints": above}).record)
    below = _errors(body, record)
    return max(float(np.where(alone[name] < _MET, below[name] - alone[name], 0.0).max()) for name in alone)


def _errors(body: Body, record: dict[str, Any]) -> dict[str, FloatArray]:
    """Return what is left of each constraint with a length, millimetres frame by frame."""
    return {
        each["name"]: np.array(each["frames"]["error"]) / body.metre * 1e3
        for each in record["constraints"]
        if each["frames"]["error"] is not None
    }
