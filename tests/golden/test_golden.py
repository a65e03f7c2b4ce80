"""The golf session against the golden file; `make golden` writes it anew."""

import json

import numpy as np
from write import PATH, golf_session


def test_the_golf_session_comes_to_the_golden_figures(tmp_path):
    golden, ours = json.loads(PATH.read_text()), golf_session(tmp_path)
    assert ours["about"] == golden["about"]
    assert ours["iterations"] == golden["iterations"]
    for key, tolerance in (
        ("explained_variance", 1e-5),
        ("coefficients_swing04", 1e-4),
        ("alpha_after", 1e-3),
        ("club_head_after", 2e-3),
    ):
        np.testing.assert_allclose(ours[key], golden[key], atol=tolerance, err_msg=key)
