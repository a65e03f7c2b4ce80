"""What holds the joints of a solve, hinges and limits of a body, by their places among the columns."""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.solver.problem import HingeColumns, LimitColumns
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.hinges import Hinge
    from motionedit.core.body.limits import Limits
    from motionedit.core.priorities.settings import Body
    from motionedit.core.priorities.solver.points import Columns


@lru_cache(maxsize=2)
def held_columns(body: Body, columns: Columns) -> tuple[HingeColumns, LimitColumns, FloatArray]:
    """Return the hinges among columns, the limits of those that are none, and the mobility of all and of the root."""
    hinges = _of_all_joints(body.hinges)
    turns = np.ones(len(columns.joints)) if body.mobility is None else body.mobility[columns.joints]
    limits = _limits_among(columns, body.limits, hinged=hinges.places)
    return _hinges_among(columns, hinges), limits, np.append(turns, body.root_mobility)


def _hinges_among(columns: Columns, every: HingeColumns) -> HingeColumns:
    """Return the hinges of joints, which are their `places`, that are columns, and by their places among these."""
    places = columns.places[every.places]
    kept = places >= 0
    if kept.all():
        return replace(every, places=places)
    told = {each.name: getattr(every, each.name)[kept] for each in fields(every)}
    return HingeColumns(**{**told, "places": places[kept]})


def _limits_among(columns: Columns, every: Limits, *, hinged: IntArray) -> LimitColumns:
    """Return the limits of joints that are columns and are not `hinged`."""
    places = columns.places.copy()
    places[hinged] = -1
    places = places[every.joints]
    kept = places >= 0
    which = slice(None) if kept.all() else kept
    arrays = every.centers, every.along, every.swing, every.twist
    return LimitColumns(places[which], *(each[which] for each in arrays))


@lru_cache(maxsize=2)
def _of_all_joints(hinges: tuple[Hinge, ...]) -> HingeColumns:
    """Return hinges by their joints: their `places` are these."""
    return HingeColumns(
        places=np.array([hinge.joint for hinge in hinges], dtype=np.intp),
        axes=np.array([hinge.axis for hinge in hinges]).reshape(-1, 3),
        upper=np.array([hinge.upper for hinge in hinges]).reshape(-1, 3),
        lower=np.array([hinge.lower for hinge in hinges]).reshape(-1, 3),
        limits=np.array([hinge.limits for hinge in hinges]).reshape(-1, 2),
        second=np.array([hinge.is_second for hinge in hinges], dtype=np.bool_),
    )
