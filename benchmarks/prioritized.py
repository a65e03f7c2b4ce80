"""The edit by prioritized constraints on the reaching clip: all frames at once beside frame by frame."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from clock import Row, best_of

from motionedit.core import ground
from motionedit.core.anatomy import find_anatomy
from motionedit.core.bvh import read_clip
from motionedit.core.center_of_mass import find_masses
from motionedit.core.editing.constraints import Constraint
from motionedit.core.editing.prioritized_edit import Body, LayeredSettings, Passes, edit_by_priorities
from motionedit.core.editing.trajectories import ControlPoint
from motionedit.core.hinges import find_hinges
from motionedit.core.ik import layered_solver
from motionedit.core.kinematics import Effector
from motionedit.core.motion import scaled

if TYPE_CHECKING:
    from motionedit.core.motion import Motion

ROOT = Path(__file__).resolve().parents[1]
LEAST_RATE = 1000.0
LEAST_RATIO = 10.0


def rows() -> list[Row]:
    """Return the table's rows on the layered solver."""
    motion, body, constraints = reaching()
    first, passes = (LayeredSettings(smoothing=Passes(count, 0.062 * motion.frame_rate)) for count in (0, 3))

    def one_by_one() -> object:
        whole, layered_solver.BLOCK = layered_solver.BLOCK, 1
        try:
            return edit_by_priorities(motion, constraints, body, first)
        finally:
            layered_solver.BLOCK = whole

    best = best_of(
        {
            "first": lambda: edit_by_priorities(motion, constraints, body, first),
            "passes": lambda: edit_by_priorities(motion, constraints, body, passes),
            "one by one": one_by_one,
        },
        rounds=4,
    )
    rate, slow = len(motion) / best["first"], len(motion) / best["one by one"]
    met = rate >= LEAST_RATE and rate >= LEAST_RATIO * slow
    return [
        Row(
            "reaching: first solve, all frames together",
            f"{rate:,.0f} frames/s",
            f"{slow:,.0f} frames/s, one by one",
            f"{rate / slow:.1f} x",
            f">= {LEAST_RATE:,.0f}, >= {LEAST_RATIO:g} x",
            "met" if met else "MISSED",
        ),
        Row("reaching: with three passes", f"{len(motion) / best['passes']:,.0f} frames/s"),
    ]


def reaching() -> tuple[Motion, Body, list[Constraint]]:
    """Return the clip of configs/reach.yaml in metres, its body, and constraints like those."""
    clip = read_clip(ROOT / "data" / "walk.bvh")
    anatomy = find_anatomy(clip.motion.skeleton)
    motion = scaled(clip.motion, 0.85 / anatomy.leg_length)
    body = Body(
        find_masses(motion.skeleton, anatomy),
        tuple(find_hinges(motion, anatomy, first=0)),
        ground.travel_joint(motion),
        0,
    )
    here = np.zeros(3)
    feet = [Constraint("position", name, 10, 1.0, Effector(j, here)) for name, j in anatomy.foot_points]
    point = ControlPoint("hold", 66, 72, shift=np.array([0.3, 0.6, 0.2]))
    wrist = motion.skeleton.names.index("LeftHand")
    hand = Constraint("position", "hand", 4, 1.0, Effector(wrist, here), points=(point,), ease_in=16.0, ease_out=16.0)
    return motion, body, [*feet, hand, Constraint("com", "balance", 2, 1.0, Effector(0, here))]
