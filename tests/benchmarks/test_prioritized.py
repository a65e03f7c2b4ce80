"""The cases that the layered solver's speed is measured on can be made, and solved."""

from benchmarks.prioritized import reaching


def test_the_reaching_clip_is_an_edit_that_is_solved(tmp_path):
    walk = reaching(tmp_path)
    assert [each.name for each in walk.constraints[-2:]] == ["hand", "balance"]
    assert walk.solve(1)().state.left.max() < 1e-4
