"""Groups of frames: where the same constraints are active, frames are one problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.solver import HingeColumns, Problem
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import IntArray
    from motionedit.core.body.hinges import Hinge


@dataclass(frozen=True, eq=False)
class Group:
    """Frames at which the same constraints are active, which are solved together.

    Attributes
    ----------
    frames : shape (n,)
    levels : shape (L,)
        Where the problem's layers stand among those of the whole edit.
    problem : Problem
    """

    frames: IntArray
    levels: IntArray
    problem: Problem


def hinge_columns(hinges: Sequence[Hinge], joints: IntArray) -> HingeColumns:
    """Return the hinges among the columns, which are `joints`."""
    here = [hinge for hinge in hinges if hinge.joint in set(map(int, joints))]
    return HingeColumns(
        places=np.searchsorted(joints, np.array([hinge.joint for hinge in here], dtype=np.intp)),
        axes=np.array([hinge.axis for hinge in here]).reshape(-1, 3),
        limits=np.array([hinge.limits for hinge in here]).reshape(-1, 2),
    )


def spans_of(frames: IntArray) -> list[IntArray]:
    """Return frames cut where they do not follow each other."""
    return np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1)
