"""Constraints for some frames only, of bodies that others move all along: they come and go without a jump."""

import numpy as np
import pytest
from prioritized_edits import WALK

import motionedit
from motionedit.core.body.steps import change_steps

FRAMES = [60, 80]
LAST = 144
LIFTED = [{"type": "footplants", "height": 25.0, "priority": 10}]
ASIDE = [
    {"type": "footplants", "at": "path", "priority": 10},
    {"type": "position", "effector": "Hips", "points": [{"at": 0}, {"at": LAST, "shift": [60.0, 0.0, 0.0]}]},
]
RAISED = {"points": [{"during": [0, LAST], "shift": [0.0, 20.0, 0.0]}]}
ANKLES = [{"type": "position", "effector": ["LeftFoot", "RightFoot"], "priority": 10, **RAISED}]
RIDES = {"points": [{"during": FRAMES, "shift": [0.0, 3.0, 0.0]}], "priority": 5, "tolerance": "off"}


@pytest.mark.parametrize("solver", ["compiled", "numpy"])
@pytest.mark.parametrize("moves", [LIFTED, ASIDE], ids=["lifted", "aside"])
@pytest.mark.parametrize(
    "windowed",
    [
        {"type": "position", "effector": "Head", **RIDES},
        {"type": "com", **RIDES},
    ],
    ids=["position", "com"],
)
def test_what_comes_and_goes_where_feet_move_the_body_does_so_smoothly(edit, monkeypatch, moves, windowed, solver):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", solver)
    assert _largest_step(edit, moves, [windowed]) < 5.0


def test_a_center_of_mass_that_comes_and_goes_over_feet_that_others_move_goes_with_them_once(edit):
    com = {"type": "com", "support": ["LeftFoot", "RightFoot"], **RIDES}
    assert _largest_step(edit, ANKLES, [com]) < 5.0


def test_a_center_of_mass_goes_smoothly_with_feet_that_constraints_move_at_times(edit):
    hand = {
        "type": "position",
        "effector": "LeftHand",
        "points": [{"during": [90, 105], "shift": [9.0, -30.0, -9.0]}],
    }
    hips = {"type": "position", "effector": "Hips", "points": [{"during": [100, 120], "shift": [-3.0, 0.0, 14.0]}]}
    com = {"type": "com", "priority": 2, "points": [{"during": FRAMES, "shift": [-7.0, -4.0, 17.0]}]}
    assert _largest_step(edit, [], [{**hand, "priority": 2}, hips, com]) < 5.0


def _largest_step(edit, moves, windowed):
    """Return the largest step, degrees, in what constraints change of a walk that others move."""
    without = motionedit.read(edit(moves).path if moves else WALK).motion
    changed = motionedit.read(edit([*moves, *windowed]).path).motion
    return float(np.max(change_steps(without, changed, first=0).degrees))
