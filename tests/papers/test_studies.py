"""The studies behind docs/papers.md run, on a few clips and goals, and show the papers' trends."""

import re
from pathlib import Path

import pytest

from studies.lab import Lab
from studies.paper import run
from studies.paper.page import shown_tables, with_tables
from studies.paper.study import Study, Table

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "papers.md").read_text(encoding="utf-8")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
# In a second each; the others, and most trends with them, take longer.
QUICK = ("pose-space", "strokes", "balance", "stairs")
ALL = [pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow) for name in run.STUDIES]


@pytest.fixture(scope="session")
def quick(tmp_path_factory):
    """Return what a study finds in a few clips; each study runs once."""
    study, found = Study(Lab(tmp_path_factory.mktemp("studies")), quick=True), {}

    def findings(name):
        if name not in found:
            found[name] = run.STUDIES[name](study)
        return found[name]

    return findings


def column(findings, table, heading):
    """Return the first number of each cell of a column, by the first two cells of its row."""
    rows = next(t for t in findings.tables if t.name == table).rows
    at = rows[0].index(heading)
    return {row[:2]: float(NUMBER.search(row[at])[0]) for row in rows[1:] if NUMBER.search(row[at])}


@pytest.mark.parametrize("name", ALL)
def test_a_study_finds_tables_and_pictures_of_one_shape(name, quick):
    found = quick(name)
    assert all(len(set(map(len, table.rows))) == 1 and len(table.rows) > 1 for table in found.tables)
    for figure in found.pictures.values():
        png = run.png_bytes(figure)
        assert png.startswith(b"\x89PNG")
        assert len(png) < 200_000


def test_a_picture_has_the_same_bytes_each_time(quick):
    (figure,) = quick("stairs").pictures.values()
    assert run.png_bytes(figure) == run.png_bytes(figure)


@pytest.mark.slow
def test_table_1_more_components_take_fewer_iterations(quick):
    counts = {int(key[0]): n for key, n in column(quick("convergence"), "pc-iterations", "swing 10").items()}
    assert counts[2] > counts[5] > counts[9]


@pytest.mark.slow
def test_section_6_1_without_damping_it_takes_less_than_twelve_iterations_and_far_goals_leave_the_database(quick):
    found = quick("damping")
    iterations, norms = (column(found, "pc-damping", heading) for heading in ("iterations", "norm"))
    assert max(n for (_, solver), n in iterations.items() if solver == "xi = 0") < 12
    assert min(n for (_, solver), n in iterations.items() if solver == "xi = 10") > 100
    far = {solver: norm for (distance, solver), norm in norms.items() if distance == "45"}
    assert far["gauss-newton, bounded"] <= 3.0 < min(far["xi = 0"], far["xi = 10"])


def test_eq_8_meets_the_goal_at_its_frame_and_breaks_the_motion_where_eq_10_does_not(quick):
    found = quick("pose-space")
    poses, motions = (column(found, "pc-pose-space", name) for name in ("eq. (8), poses", "eq. (10), motions"))
    broken = next(key for key in {row[:1] for row in poses} if key[0].startswith("break"))
    assert _of(poses, broken[0]) > 2.0 * _of(motions, broken[0])


def _of(values, name):
    return next(value for key, value in values.items() if key[0] == name)


@pytest.mark.slow
def test_figure_4_normalization_brings_the_hits_together(quick):
    spread = column(quick("normalization"), "pc-normalization", "spread of the hit")
    raw, duration, event = (_of(spread, name) for name in ("as recorded", "one duration", "the hit at one frame"))
    assert raw > duration > event
    assert event < 0.2
    left_out = column(quick("normalization"), "pc-left-out", "at the hit, mean (cm)")
    assert _of(left_out, "duration and hit (the tool)") < 0.5 * _of(left_out, "duration alone")


@pytest.mark.slow
def test_figure_5_more_components_hold_more_and_all_rebuild_the_database(quick):
    found = quick("variance")
    sigma = list(column(found, "pc-variance", "sigma (%)").values())
    assert sigma == sorted(sigma)
    assert sigma[-1] == 100.0
    assert list(column(found, "pc-variance", "in it: hit").values())[-1] == 0.0


@pytest.mark.slow
def test_figure_6_edits_of_up_to_ten_centimetres_stay_near_the_players_own_swing(quick):
    rows = next(table for table in quick("style").tables if table.name == "pc-clusters").rows
    nearer = [row[rows[0].index("nearer to the truth")] for row in rows[1:] if row[0] == "1 to 10"]
    assert nearer
    for text in nearer:
        near, total = map(int, text.split(" of "))
        assert near >= 0.8 * total


@pytest.mark.slow
def test_the_prior_comes_nearer_to_an_unseen_swing_than_components_alone(quick):
    whole = {key[0]: value for key, value in column(quick("truth"), "pc-truth", "all joints").items()}
    assert whole["map"] < min(whole["gauss-newton"], whole["no edit"])


@pytest.mark.slow
def test_section_6_2_the_edit_by_coefficients_comes_nearer_to_the_truth_and_constraints_hold_the_feet(quick):
    truth, drift, goal = (
        {key[0]: value for key, value in column(quick("comparison"), "pc-comparison", heading).items()}
        for heading in ("off the truth at the hit", "feet drift (cm)", "goal (mm)")
    )
    assert truth["edit-pc"] < truth["no edit"] < truth["the same, feet and CoM"]
    assert drift["edit-pc"] < 0.01
    assert drift["the same, feet and CoM"] < 0.01 < drift["edit-pc, gauss-newton"]
    assert max(value for name, value in goal.items() if name != "no edit") < 0.1


@pytest.mark.slow
def test_figure_3_without_the_center_of_mass_the_walker_would_fall(quick):
    outside = {k[0]: v for k, v in column(quick("reach-step"), "prio-reach", "CoM outside the feet").items()}
    assert outside["final"] == 0.0
    assert outside["without CoM"] > 5.0


@pytest.mark.slow
def test_figure_4_by_priorities_the_ankle_gets_there_and_by_weights_not_half_way(quick):
    rises = {k[0]: v for k, v in column(quick("reach-step"), "prio-step", "ankle rises").items()}
    assert rises["priorities"] == pytest.approx(28.0 * 85.0 / 86.5, abs=0.1)
    assert rises["weights"] < 0.5 * rises["priorities"]


@pytest.mark.slow
def test_figure_5_by_priorities_the_kick_gives_way_and_by_weights_the_support_foot(quick):
    short, foot = (
        {k[0]: v for k, v in column(quick("karate"), "prio-karate", heading).items()}
        for heading in ("short of the goal", "support foot moves, most")
    )
    assert short["priorities"] > 1.0 > foot["priorities"]
    assert foot["priorities"] == 0.0
    assert foot["weights"] > 0.5
    assert short["weights"] < short["priorities"]


@pytest.mark.slow
def test_figure_6_every_height_within_reach_is_met(quick):
    assert max(column(quick("karate"), "prio-heights", "left").values()) < 0.01


@pytest.mark.slow
def test_the_page_shows_tables_that_there_are_and_quotes_those_that_cannot_be_compared(quick):
    shown = shown_tables(PAGE)
    printed = {table.name: table for name in run.STUDIES for table in quick(name).tables}
    assert set(printed) <= set(shown)
    for name, (text, quoted) in shown.items():
        assert text, name
        assert quoted == (name not in printed or printed[name].quoted), name


def test_a_table_is_put_into_its_block_and_the_rest_of_the_page_stays():
    page = "a\n<!-- make paper: one -->\n```text\nold\n```\nb\n<!-- make paper: two, quoted -->\n```text\n```\n"
    new = with_tables(page, [Table("one", "T", (("a", "b"), ("1", "2"))), Table("three", "T", (("a",), ("1",)))])
    assert new == page.replace("old", "T\n\n  a  b\n  1  2")
    assert shown_tables(new) == {"one": ("T\n\n  a  b\n  1  2", False), "two": ("", True)}


def test_a_study_that_is_not_there_is_an_error(capsys):
    with pytest.raises(SystemExit):
        run.main(["nope"])
    assert "no study nope; there are convergence, pose-space" in capsys.readouterr().err


def test_a_study_is_printed_and_written(tmp_path, capsys, monkeypatch):
    monkeypatch.delenv("MOTIONEDIT_CLIPS", raising=False)
    run.main(["balance", "--quick", "--out", str(tmp_path)])
    assert "Figure 1" in capsys.readouterr().out
    assert (tmp_path / "prio-balance.png").exists()
    assert "## balance\n\n```text\nFigure 1" in (tmp_path / "tables.md").read_text()


@pytest.mark.slow
@pytest.mark.parametrize("name", run.STUDIES)
def test_the_page_shows_what_the_studies_print(name, tmp_path):
    import sys

    sys.path.insert(0, str(ROOT / "docs"))
    import sessions

    shown = shown_tables(PAGE)
    for table in run.STUDIES[name](Study(Lab(tmp_path))).tables:
        if not table.quoted:
            text, _ = shown[table.name]
            assert sessions.same(text.splitlines(), table.text.splitlines()), table.text
