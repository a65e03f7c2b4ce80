"""What a model's own rules and its left-out error make of the default solver of edit-pc."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.core.pca.left_out import LeftOut
from motionedit.jobs.edit_pc.solver import chosen_solver
from motionedit.spec.load import load_spec

GOLF = Path(__file__).resolve().parents[3] / "data" / "golf"
GOAL = {"effector": "RightHand", "at": 3, "shift": [1, 0, 0]}


@pytest.fixture(scope="module")
def model():
    return motionedit.fit_pca(motionedit.normalize([GOLF / f"swing{n:02d}.bvh" for n in range(1, 6)], {})).model


def solver(model, align, **spec):
    rules = model.rules | {"align": {"heading": True, "position": True, "at": None} | align}
    loaded = load_spec({"goals": [GOAL], **spec}, "edit-pc")
    return chosen_solver(loaded.model, replace(model, rules=rules), bound=None, feet=())


def test_clips_laid_over_each_other_by_the_hips_are_so_at_the_goals(model):
    found = solver(model, {"by": "hips"})
    assert found.heading
    assert found.position


def test_clips_laid_over_each_other_by_the_feet_stay_so(model):
    found = solver(model, {"by": "feet"})
    assert not found.heading
    assert not found.position


def test_what_was_not_taken_out_by_normalize_is_not_taken_out_at_the_goals(model):
    found = solver(model, {"by": "hips", "heading": False})
    assert not found.heading
    assert found.position


def explaining_all_but(model, left):
    """Return a model that leaves this share of its own clips unexplained."""
    one = np.ones(len(model.clips))
    return replace(model, components=replace(model.components, left_out=LeftOut(one, left * one)))


@pytest.mark.parametrize(("left", "share"), [(0.4, 0.85 * 0.4**2), (0.5, 0.85 * 0.5**2), (0.1, 0.05), (0.9, 0.3)])
def test_of_what_both_ends_leave_unexplained_most_may_leave_the_components(model, left, share):
    assert solver(explaining_all_but(model, left), {"by": "hips"}).share == pytest.approx(share)


def test_components_are_believed_as_much_as_they_explain(model):
    for left in (0.4, 0.5):
        found = solver(explaining_all_but(model, left), {"by": "hips"})
        assert found.believed == pytest.approx(1.0 - left**3)
    assert solver(model, {"by": "hips"}, residual_share=0).believed == 1.0
    assert solver(model, {"by": "hips"}, residual_share=0.9).believed == 0.0
