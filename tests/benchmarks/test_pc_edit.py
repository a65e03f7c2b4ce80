"""What the benchmark of edit-pc times is the solver that its edits use."""

import yaml

from benchmarks.pc_edit import ROOT, _problem
from studies.lab import Lab


def test_the_solver_that_is_timed_is_the_one_that_edits(tmp_path):
    lab = Lab(tmp_path)
    normalize = yaml.safe_load((ROOT / "configs" / "golf-normalize.yaml").read_text(encoding="utf-8"))
    normalize["events"]["hit"]["frames"] = str(ROOT / "data" / "golf" / "events.csv")
    model = lab.model(sorted((ROOT / "data" / "golf").glob("*.bvh"))[:5], normalize)
    layers, settings, found = _problem(lab, model, [0, 0, 2])
    assert [len(layer) for layer in layers] == [1]
    assert set(settings) == {"size", "bound"}
    assert found.reason == "converged"
