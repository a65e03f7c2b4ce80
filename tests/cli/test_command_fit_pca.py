"""What `fit-pca` prints: a row for each component, as long as a table can be read."""

import json

import pytest


@pytest.fixture
def fitted(run, clip, tmp_path):
    """Return a runner of fit-pca on so many small clips: its lines on standard error, and the report."""

    def fit(count, *options):
        for n in range(count):
            clip(f"in/walk{n:02d}.bvh", seed=n)
        (tmp_path / "n.yaml").write_text("schema: motionedit/normalize/v1\n")
        assert run("normalize", "in", "-s", "n.yaml", "-o", "n", "-q").exit_code == 0
        result = run("fit-pca", "n", "-o", "m.npz", "--report", "r.json", *options)
        assert result.exit_code == 0
        return result.stderr.splitlines(), json.loads((tmp_path / "r.json").read_text())

    return fit


def test_every_component_of_a_few_has_its_row(fitted):
    lines, report = fitted(5)
    rows = [line.split() for line in lines if line.split()[0].isdecimal()]
    assert [row[0] for row in rows] == ["1", "2", "3", "4"]
    assert len(report["explained_variance"]) == 4
    assert not [line for line in lines if "more components" in line]


def test_of_many_components_the_first_have_rows_and_a_line_says_what_the_rest_explain(fitted):
    lines, report = fitted(50)
    rows = [line.split() for line in lines if line.split()[0].isdecimal()]
    assert [int(row[0]) for row in rows] == list(range(1, 41))
    rest = 100.0 * sum(report["explained_variance_ratio"][40:])
    assert float(rows[-1][-1]) == pytest.approx(100.0 - rest, abs=0.006)
    (note,) = [line for line in lines if "more components" in line]
    assert note.startswith(f"motionedit: 9 more components explain {rest:.3g} % of the variance; -v lists them")


def test_where_components_are_left_out_a_line_says_what_is_beyond_them(fitted, tmp_path):
    (tmp_path / "f.yaml").write_text("schema: motionedit/fit-pca/v1\ncomponents: 2\n")
    lines, report = fitted(5, "-s", "f.yaml")
    beyond = 100.0 * (1.0 - sum(report["explained_variance_ratio"]))
    (note,) = [line for line in lines if "left out in turn" in line]
    assert f"({beyond:.3g} % of the variance is beyond the components kept)" in note
    assert not [line for line in fitted(5)[0] if "beyond the components" in line]


def test_v_lists_every_component(fitted):
    lines, _ = fitted(50, "-v")
    assert len([line for line in lines if line.split()[0].isdecimal()]) == 49
    assert not [line for line in lines if "more components" in line]


@pytest.mark.parametrize("name", ["m.bvh", "m.NPY", "m.json", "out/m.Bvh"])
def test_a_model_gets_no_name_of_another_kind_of_file(fitted, run, tmp_path, name):
    fitted(2)
    result = run("fit-pca", "n", "-o", name)
    ending = name[name.index(".") :]
    message = f"motionedit: error: {name}: a model is written as .npz, not as {ending}; give such a name\n"
    assert (result.exit_code, result.stdout, result.stderr) == (2, "", message)
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize("name", ["m", "m.NPZ", "golf.v1", "golf-1.0"])
def test_a_model_may_have_any_other_name(fitted, run, tmp_path, name):
    fitted(2)
    assert run("fit-pca", "n", "-o", name, "-q").exit_code == 0
    assert (tmp_path / name).exists()
