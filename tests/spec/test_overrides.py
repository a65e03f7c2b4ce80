"""`--set KEY=VALUE`: paths, values by the same rules, faults that name the option."""

import pytest
from contract import EDIT_PRIORITIZED

TEXT = """
goals:
  - {name: ball, at: hit, effector: {joint: Club, offset: [0, -92, 0]}, shift: [-8, 0, 0]}
  - {at: 3, effector: RightHand, shift: [0, 0, 1]}
  - {at: 3, effector: {joint: Head}, shift: [0, 0, 1]}
events:
  hit: {frames: {swing.01: 3}}
"""


def test_a_list_item_is_named_by_its_name_its_effector_or_its_index(load):
    loaded = load(
        TEXT,
        "edit-pc",
        "goals.ball.shift=[1, 2, 3]",
        "goals.RightHand.weight=2",
        "goals.2.at=71.2%",
        "goals.Head.weight=5",
    )
    ball, hand, head = loaded.model.goals
    assert (ball.shift, hand.weight, head.at.percent, head.weight) == ((1.0, 2.0, 3.0), 2.0, 71.2, 5.0)


def test_a_goal_is_named_without_its_list_where_its_name_is_no_key(load):
    loaded = load(TEXT, "edit-pc", "ball.weight=3", "Head.weight=5")
    assert [goal.weight for goal in loaded.model.goals] == [3.0, 1.0, 5.0]
    assert load(TEXT.replace("name: ball", "name: solver"), "edit-pc", "solver.method=damped", "unit=cm").model.unit


def test_the_overrides_are_in_the_data_for_reports_and_the_keys_keep_their_order(load):
    loaded = load(TEXT, "edit-pc", "goals.0.shift=[1, 2, 3]", "unit=cm")
    assert loaded.data["goals"][0]["shift"] == [1, 2, 3]
    assert list(loaded.data["goals"][0]) == ["name", "at", "effector", "shift"]
    assert list(loaded.data) == ["schema", "goals", "events", "unit"]


def test_a_missing_key_is_made_with_the_mappings_above_it(load):
    loaded = load(TEXT, "edit-pc", "solver.method=damped", "unit=cm", "solver.max_iterations=null")
    assert loaded.model.solver.method == "damped"
    assert loaded.model.solver.max_iterations is None
    assert loaded.data["solver"] == {"method": "damped", "max_iterations": None}


def test_a_key_that_holds_dots_is_found(load):
    text = TEXT.replace("{swing.01: 3}", "{swing: 1, swing.01: 3}")
    loaded = load(text, "edit-pc", "events.hit.frames.swing.01=7")
    assert loaded.model.events["hit"].frames.by_clip == {"swing": 1, "swing.01": 7}


def test_values_are_read_by_the_rules_of_the_file(load):
    loaded = load(
        TEXT, "edit-pc", "goals.0.weight=1e-3", "plausibility=off", "goals.0.name=on", "goals.1.effector={end_site: A}"
    )
    assert loaded.model.goals[0].weight == 0.001
    assert loaded.model.plausibility_bound is None
    assert loaded.model.goals[0].name == "on"
    assert loaded.model.goals[1].effector.end_site


def test_a_value_may_hold_an_equals_sign(load):
    assert load(TEXT, "edit-pc", "goals.0.name=a=b").model.goals[0].name == "a=b"


def test_a_whole_item_may_be_replaced(load):
    loaded = load(TEXT, "edit-pc", "goals=[]")
    assert loaded.model.goals == ()


def test_the_last_of_two_overrides_holds(load):
    assert load(TEXT, "edit-pc", "goals.0.weight=2", "goals.0.weight=3").model.goals[0].weight == 3.0


def test_the_file_is_not_touched_by_an_override_of_a_shared_anchor(load):
    text = "goals:\n  - &g {at: 3, effector: A, shift: [0, 0, 1]}\n  - *g\n"
    loaded = load(text, "edit-pc", "goals.0.shift=[9, 9, 9]")
    assert [goal.shift for goal in loaded.model.goals] == [(9.0, 9.0, 9.0), (0.0, 0.0, 1.0)]


ITEMS = "the items are 0 to 2; by name: ball, RightHand, Head"
KEYS = "name, effector, at, position, shift, orientation, turn, frame, relative_to, axes, weight, priority, tolerance"
NINES = "9" * 5000
DEEP = "a" + ".a" * 5000


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("goals.ball.shift", "5", "must be three numbers [x, y, z], not 5"),
        ("goals.ball.shift", "[1, a, 2]", "1: must be a number, not 'a'"),
        ("goals.ball.effector", "{joint: 5}", "joint: must be a joint's name, not 5; put quotes around it"),
        ("goals.ball.colour", "red", f"unknown key; the keys here are {KEYS}"),
        ("gaols.ball.shift", "5", "unknown key; did you mean 'goals'?"),
        ("goals.bal.shift", "5", f"no item 'bal' in goals; did you mean 'ball'? {ITEMS}"),
        ("goals.7.shift", "5", f"no item '7' in goals; {ITEMS}"),
        ("goals.-1.shift", "5", f"no item '-1' in goals; {ITEMS}"),
        (f"goals.{NINES}.at", "5", f"no item '{NINES}' in goals; {ITEMS}"),
        ("goals.0.at.x", "5", "goals.0.at is one value; it has no key 'x'"),
        ("", "5", "must be KEY=VALUE, such as goals.0.weight=2"),
        ("components", "", "needs a value: a whole number at least 1"),
        ("components", "[", "not valid YAML: a value that is not there"),
        ("components", "10:20", "must be a whole number, not '10:20'"),
        ("components", "{a: 1, a: 2}", "given twice, on lines 1 and 1; keep one"),
        (DEEP, "1", "is a path of more than 50 keys"),
        ("schema", "motionedit/fit-pca/v1", "this is a spec of fit-pca; edit-pc wants motionedit/edit-pc/v1"),
    ],
    ids=lambda text: text[:30],
)
def test_a_fault_names_the_option(path, value, expected, messages):
    assert messages(TEXT, "edit-pc", f"{path}={value}") == [f"--set {path}: {expected}"]


def test_an_option_without_a_value_is_answered_with_its_form(messages):
    found = messages(TEXT, "edit-pc", "components")
    assert found == ["--set components: must be KEY=VALUE, such as goals.0.weight=2"]


def test_faults_of_the_options_come_before_those_of_the_file(messages):
    found = messages(TEXT + "residual: none\n", "edit-pc", "components=0", "timing=slow")
    assert found == [
        "--set components: must be at least 1, not 0",
        "--set timing: must be original or normalized, not 'slow'",
        "spec.yaml:9: residual: must be keep or drop, not 'none'",
    ]


def test_an_empty_list_has_no_items_to_name(messages):
    assert messages("goals: []", "edit-pc", "goals.0.at=3") == ["--set goals.0.at: no item '0': goals is empty"]


def test_a_constraint_of_the_contract_is_named_by_its_name(load):
    loaded = load(EDIT_PRIORITIZED, "edit-prioritized", "constraints.eyes.points.0.position=[1, 2, 3]", head=False)
    (eyes,) = [item for item in loaded.model.constraints if item.name == "eyes"]
    assert eyes.points[0].position == (1.0, 2.0, 3.0)
