"""What holds the joints of a solve, hinges and limits of a body, by their places among the columns."""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from motionedit.core.priorities.problem import HingeColumns, LimitColumns
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.points import Columns
    from motionedit.core.priorities.settings import Body


_Told = TypeVar("_Told", HingeColumns, LimitColumns)


@lru_cache(maxsize=2)
def held_columns(body: Body, columns: Columns) -> tuple[HingeColumns, LimitColumns, FloatArray]:
    """Return the hinges among columns, the limits of those that are none, and the mobility of all and of the root."""
    hinges, limits = _of_all_joints(body)
    turns = np.ones(len(columns.joints)) if body.mobility is None else body.mobility[columns.joints]
    return _among(columns, hinges), _among(columns, limits), np.append(turns, body.root_mobility)


def _among(columns: Columns, every: _Told) -> _Told:
    """Return what is told of joints, by their `places`, of those that are columns alone, and by theirs."""
    places = columns.places[every.places]
    kept = places >= 0
    if kept.all():
        return replace(every, places=places)
    told = {each.name: getattr(every, each.name)[kept] for each in fields(every)}
    return type(every)(**{**told, "places": places[kept]})


@lru_cache(maxsize=2)
def _of_all_joints(body: Body) -> tuple[HingeColumns, LimitColumns]:
    """Return the hinges of a body, and the limits of what is none, by joints: their `places` are these."""
    hinges, hinged = body.hinges, {hinge.joint for hinge in body.hinges}
    limits = [limit for limit in body.limits if limit.joint not in hinged]
    return HingeColumns(
        places=np.array([hinge.joint for hinge in hinges], dtype=np.intp),
        axes=np.array([hinge.axis for hinge in hinges]).reshape(-1, 3),
        upper=np.array([hinge.upper for hinge in hinges]).reshape(-1, 3),
        lower=np.array([hinge.lower for hinge in hinges]).reshape(-1, 3),
        limits=np.array([hinge.limits for hinge in hinges]).reshape(-1, 2),
        second=np.array([hinge.is_second for hinge in hinges], dtype=np.bool_),
    ), LimitColumns(
        places=np.array([limit.joint for limit in limits], dtype=np.intp),
        centers=np.array([limit.center for limit in limits]).reshape(-1, 4),
        along=np.array([limit.along for limit in limits]).reshape(-1, 3),
        swing=np.array([limit.swing for limit in limits]),
        twist=np.array([limit.twist for limit in limits]),
    )
