"""Sessions against their golden files; `make golden` writes them anew."""

import json

import numpy as np
import pytest
from write import EDITS, HERE, JOINTS, golf_session, prioritized_session


def golden(name):
    return json.loads((HERE / f"{name}.json").read_text(encoding="utf-8"))


def test_the_golf_session_comes_to_the_golden_figures(tmp_path):
    expected, ours = golden("golf"), golf_session(tmp_path)
    assert ours["about"] == expected["about"]
    assert ours["iterations"] == expected["iterations"]
    for key, tolerance in (
        ("explained_variance", 1e-5),
        ("coefficients_swing04", 1e-4),
        ("alpha_after", 1e-3),
        ("club_head_after", 2e-3),
        ("left_out", 1e-4),
        ("club_head_after_map", 2e-3),
    ):
        np.testing.assert_allclose(ours[key], expected[key], atol=tolerance, err_msg=key)


# Long by numpy, which the others hold to the same figures.
LONG = {"stairs": pytest.mark.compiled}


@pytest.mark.parametrize("name", [pytest.param(name, marks=LONG.get(name, ())) for name in EDITS])
def test_an_edit_by_constraints_comes_to_the_golden_figures(name):
    expected, ours = golden(name), prioritized_session(name)
    for key in ("about", "status", "constraints"):
        assert ours[key] == expected[key]
    for key in ("error_max", *JOINTS):
        np.testing.assert_allclose(
            np.array(ours[key], dtype=float), np.array(expected[key], dtype=float), rtol=0.0, atol=2e-3, err_msg=key
        )


def test_every_golden_file_is_compared():
    assert {path.stem for path in HERE.glob("*.json")} == {"golf", *EDITS}
