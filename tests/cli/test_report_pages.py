"""Reports and tables: rounded, ordered, readable."""

import json

import numpy as np
import pytest

from motionedit.report.record import plain, report_bytes
from motionedit.report.table import count_line, number, results_table, text_table


def test_numbers_are_rounded_and_what_is_not_finite_is_null():
    assert plain(0.1 + 0.2) == 0.3
    assert plain([1 / 3, float("nan"), float("inf"), -0.0, True, None, 7]) == [
        0.333333333,
        None,
        None,
        0.0,
        True,
        None,
        7,
    ]
    assert str(plain(-0.0)) == "0.0"


def test_arrays_and_keys_become_plain():
    assert plain({1: np.array([1.5, 2.0]), "b": (np.float64(0.25), np.int64(3))}) == {"1": [1.5, 2.0], "b": [0.25, 3]}


def test_a_report_is_utf8_whatever_its_names_are():
    data = report_bytes("info", [{"clip": "größe.bvh"}, {"clip": "\udcff.bvh"}])
    assert "größe.bvh" in data.decode()
    assert json.loads(data)["clips"][1] == {"clip": "?.bvh"}


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, ""), (3, "3"), (0.0, "0"), (12.34567, "12.35"), (10183.4, "10183"), (3.2e-6, "3e-06"), ("x", "x")],
)
def test_a_number_in_a_table_is_short(value, text):
    assert number(value) == text


def test_columns_line_up_and_empty_ones_are_left_out():
    assert text_table(("clip", "error", "none", "n"), [("a.bvh", 1.5, None, 3), ("long.bvh", 10.25, None, 12)]) == (
        "clip      error   n\na.bvh       1.5   3\nlong.bvh  10.25  12"
    )


def test_letters_that_are_two_columns_wide_count_as_two_and_marks_over_letters_as_none():
    names = ("左手", "hand", "ﾃ e\u0301 😀")
    table = text_table(("joint", "n"), [(name, n) for n, name in enumerate(names)])
    assert table.split("\n")[1:] == ["左手    0", "hand    1", "ﾃ e\u0301 😀  2"]


def record(name, status="ok", **more):
    return {"clip": name, "output": None, "status": status, "message": None, **more}


def goal(name, **more):
    return {"name": name, "priority": 1, "error_max": 0.5, "frame": 3, "status": "ok", "gave_way_to": [], **more}


def test_the_results_show_the_worst_goal_against_its_tolerance_and_the_side_effects():
    goals = [
        goal("left", priority=2, tolerance=0.1),
        goal("right", error_max=1.8, tolerance=1.0, frame=58, status="out_of_tolerance", gave_way_to=["left"]),
    ]
    metrics = {
        "before": {"foot_slide_max": 1.25, "jerk_rms": 100.0, "step_max": 7.5},
        "after": {"foot_slide_max": 1.5, "jerk_rms": 104.0, "step_max": 0.5},
    }
    records = [record("a.bvh", constraints=goals, metrics=metrics, unit="cm")]
    assert results_table(records, [0.123]).splitlines() == [
        "clip   status  worst goal  error (cm)  tolerance  frame  foot slide     jerk  step  seconds",
        "a.bvh  ok      right              1.8          1     58  1.25 -> 1.5  1.04 x  0.5°     0.12",
    ]
    assert results_table(records, [0.1], verbosity=1).splitlines()[-3:] == [
        "a.bvh  priority  error (cm)  tolerance  frame  status            gave way to",
        "left          2         0.5        0.1      3  ok",
        "right         1         1.8          1     58  out_of_tolerance  left",
    ]


@pytest.mark.parametrize(
    ("goals", "shown"),
    [
        # The larger share of its tolerance is the worse, whichever number is larger.
        ([goal("a", error_max=0.5, tolerance=1.0), goal("b", error_max=0.4, tolerance=0.1)], ["b", "0.4", "0.1"]),
        ([goal("a", tolerance=1.0), goal("b", error_max=9.0, tolerance=None, strict=False)], ["a", "0.5", "1"]),
        ([goal("b", error_max=9.0, tolerance=None, strict=False)], ["b", "9", "off"]),
        ([goal("a", error_max=None, error_angle_max=2.5, tolerance_angle=0.1)], ["a", "2.5°", "0.1°"]),
        ([goal("a", error_max=None, error_angle_max=2.5, tolerance_angle=None)], ["a", "2.5°", "off"]),
        ([goal("a", tolerance=1.0, error_angle_max=2.5, tolerance_angle=0.1)], ["a", "2.5°", "0.1°"]),
        ([goal("a", tolerance=1.0, error_angle_max=0.01, tolerance_angle=0.1)], ["a", "0.5", "1"]),
    ],
)
def test_the_worst_goal_is_that_with_the_largest_share_of_its_tolerance(goals, shown):
    assert results_table([record("a.bvh", constraints=goals)], [0.1]).splitlines()[1].split()[2:5] == shown


def test_the_unit_is_told_where_all_clips_have_the_same():
    records = [record("a.bvh", goals=[goal("x")], unit="cm"), record("b.bvh", goals=[goal("x")], unit="m")]
    assert "error (cm)" in results_table(records[:1], [0.1])
    assert "error (" not in results_table(records, [0.1, 0.1])
    assert "error (cm)" in results_table([records[0], record("c.bvh", "failed")], [0.1, 0.1])


def test_of_many_clips_only_those_that_are_not_ok_get_a_row():
    records = [record(f"{n}.bvh", "failed" if n == 7 else "ok") for n in range(200)]
    assert results_table(records, [0.1] * 200).splitlines() == [
        "clip   status",
        "7.bvh  failed",
    ]
    assert count_line([each["status"] for each in records]) == "200 clips: 199 ok, 1 failed"
    assert len(results_table(records, [0.1] * 200, verbosity=1).splitlines()) == 201


def test_a_list_of_numbers_stands_on_one_line_and_a_key_on_its_own():
    text = report_bytes("info", [{"a": [1.0, 2.5], "b": {}, "c": [], "d": [[1], [2]]}]).decode()
    assert text.partition('"clips": [\n')[2] == (
        '    {\n      "a": [1.0, 2.5],\n      "b": {},\n      "c": [],\n'
        '      "d": [\n        [1],\n        [2]\n      ]\n    }\n  ]\n}\n'
    )
    assert json.loads(text)["clips"] == [{"a": [1.0, 2.5], "b": {}, "c": [], "d": [[1], [2]]}]
