"""The contract's own examples load, and editors accept them."""

import dataclasses

import jsonschema
import pytest
import yaml
from contract import EDIT_PC, EDIT_PC_DAMPED, EDIT_PRIORITIZED, EXAMPLES, NORMALIZE

from motionedit.spec import SPEC_COMMANDS, schema_of
from motionedit.spec.constraint_types import ComConstraint, PositionConstraint
from motionedit.spec.fit_pca import FitPcaSpec
from motionedit.spec.values import EffectorSpec, Recruit, Tolerance
from motionedit.spec.yaml_tree import value_from_text


@pytest.mark.parametrize(("command", "text"), EXAMPLES.values(), ids=EXAMPLES)
def test_an_example_loads_and_keeps_its_data(command, text, load):
    loaded = load(text, command, head=False)
    assert loaded.data == value_from_text(text)
    assert list(loaded.data) == list(yaml.safe_load(text))
    assert loaded.files == (loaded.path,)


@pytest.mark.parametrize(("command", "text"), EXAMPLES.values(), ids=EXAMPLES)
def test_an_example_is_valid_under_the_json_schema(command, text):
    validator(command).validate(value_from_text(text))


@pytest.mark.parametrize("command", SPEC_COMMANDS)
def test_every_key_has_a_description(command):
    def undescribed(name, part):
        for key, value in part.get("properties", {}).items():
            if "description" not in value and "$ref" not in value:
                yield f"{name}.{key}"

    schema = schema_of(command)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    found = [*undescribed(command, schema)]
    for name, part in schema["$defs"].items():
        assert "description" in part
        found += undescribed(name, part)
    assert found == []


FORMS = {
    "normalize": [
        "events: {hit: 94}",
        "events: {hit: {frames: hits.csv}}",
        "events: {hit: {frames: 94, target: 71.2%}}",
        "events: {a: 3, b: {detect: {effector: Hand, maximum_of: speed, after: a}}}",
        "frames: 132\nalign: {at: event}\nevents: {hit: {frames: {'001': 3}}}",
    ],
    "fit-pca": ["explained_variance: 0.95", "components: 3\nup: z\nunit: 0.3048", "rotation: exponential"],
    "edit-pc": [
        "goals: []",
        "goals: [{at: 3, effector: A, shift: [0, 1, 2], frame: heading, tolerance: off}]",
        "goals: [{at: 3.76s, effector: [A, {end_site: A}], shift: [0, 1, 2], relative_to: B, weight: 2}]",
        "goals: [{at: hit + 1.5s, effector: {end_site: A, index: 1}, shift: [0, 1e-3, 010], axes: [z]}]",
        "goals: [{at: hit - 10, effector: A, orientation: {quaternion: [2, 0, 0, 0]}, tolerance: 3}]",
        "goals: [{at: 71.2%, effector: A, orientation: {rotation_vector: [0, 0, 90]}, position: [1, 2, 3]}]",
        "goals: [{at: 7, effector: A, shift: [1, 2, 3], tolerance: {position: 0.5}}]",
        "unit: in\ngoals: []\nsolver: {method: damped, max_iterations: null}\nplausibility: off",
        "goals: []\nplausibility: off\nresidual: drop\ntiming: normalized",
    ],
    "edit-prioritized": [
        "constraints: []",
        "constraints: [{type: aim, effector: Head, axis: [0, 0, 1], target: Hand, points: [{at: 3}]}]",
        "constraints: [{type: com, relative_to: world, recruit: {joints: [A, ROOT.position]}, tolerance: 1}]",
        "constraints: [{type: pose, effector: A, tolerance: {angle: 1}, recruit: {levels: 2}, ease_in: 40}]",
        "constraints: []\nhinges: off\nsmoothing: {method: paper, cutoff: 3.0, passes: 2}\ncurve: index",
        "constraints: []\nhinges: [LeftLeg]\nrecruiting_rule: error\nmasses: {}\nattraction: 0",
        "constraints: [{type: distance, effector: [A, B], to: {end_site: C, index: 1}}]",
        "constraints: [{type: distance, effector: A, to: C, points: [{during: [0, 100%], at_least: 2}]}]",
        "constraints: [{type: distance, effector: A, to: C, points: [{at: 1}, {at: 3, distance: 1e-3}], ease_in: 4}]",
        "constraints: [{type: floor}, {type: floor, effector: all, height: -3.5, recruit: {levels: 3}, weight: 2}]",
        "constraints: [{type: floor, effector: [A, {joint: A, offset: [0, 1, 0]}]}, {type: floor, effector: Hand}]",
        "events: {hit: 9}\nconstraints: [{type: position, effector: A, points: [{at: hit, bias: -1}]}]",
    ],
}


@pytest.mark.parametrize(("command", "text"), [(command, text) for command, texts in FORMS.items() for text in texts])
def test_every_legal_form_loads_and_is_valid_under_the_json_schema(command, text, load, tmp_path):
    (tmp_path / "hits.csv").write_text("clip,frame\na,3\n")
    loaded = load(text, command)
    validator(command).validate(loaded.data)


@pytest.mark.parametrize(
    ("command", "text"),
    [
        ("edit-pc", "goals: [{at: 3, effector: A}]"),
        ("edit-pc", "goals: [{at: 3, effector: A, position: [1, 2, 3], shift: [1, 2, 3]}]"),
        ("edit-pc", "goals: [{at: -3, effector: A, position: [1, 2, 3]}]"),
        ("edit-pc", "goals: [{at: '10:20', effector: A, position: [1, 2, 3]}]"),
        ("edit-pc", "goals: []\ncomponets: 3"),
        ("edit-pc", "goals: []\nevents: {hit: {}}"),
        ("edit-prioritized", "constraints: [{type: position, effector: A, axis: [0, 0, 1]}]"),
        ("edit-prioritized", "constraints: [{type: position, effector: A, points: [{position: [1, 2, 3]}]}]"),
        ("edit-prioritized", "constraints: [{type: distance, effector: A}]"),
        ("edit-prioritized", "constraints: [{type: floor, points: [{at: 3}]}]"),
        ("edit-prioritized", "constraints: [{type: distance, effector: A, to: B, points: [{at: 3, distance: 0}]}]"),
        ("normalize", "events: {hit: {detect: null}}"),
    ],
)
def test_the_json_schema_refuses_what_loading_refuses(command, text, messages):
    assert messages(text, command)
    data = {"schema": f"motionedit/{command}/v1"} | value_from_text(text)
    assert not validator(command).is_valid(data)


def validator(command):
    return jsonschema.Draft202012Validator(schema_of(command))


def test_the_prioritized_example_means_what_the_contract_says(load):
    spec = load(EDIT_PRIORITIZED, "edit-prioritized", head=False).model
    names = [constraint.name for constraint in spec.constraints]
    assert names[:3] == ["right-toe-steps", "left-foot-as-captured", "left-foot-as-captured-2"]
    toe, ankle, toe_base, *_, head, floor, grip = spec.constraints
    assert isinstance(toe, PositionConstraint)
    assert toe.points[1].bias == 0.3
    assert toe.met_within == Tolerance(position=0.5)
    assert (toe.ease_in.text, toe.weight, toe.recruit) == ("0.8s", 1.0, Recruit())
    assert [ankle.effector.joint, toe_base.effector.joint] == ["LeftFoot", "LeftToeBase"]
    assert (ankle.keys, ankle.effector_keys) == (("constraints", 1), ("constraints", 1, "effector", 0))
    assert head.keys == ("constraints", 8)
    assert (floor.effector, floor.height, floor.points) == ("feet", 0.0, ())
    assert (grip.to, grip.points[0].bound) == (EffectorSpec("RightHand"), ("distance", 32.0))
    com = spec.constraints[5]
    assert isinstance(com, ComConstraint)
    assert com.axes == (0, 2)
    assert [c.name for c in spec.constraints if c.counts_for_strict] == [
        *("right-toe-steps", "foot-planted", "elbow-near-torso", "forearm-level", "grip"),
    ]
    assert spec.smoothing.pass_count == 3


def test_the_goal_example_means_what_the_contract_says(load):
    spec = load(EDIT_PC, "edit-pc", head=False).model
    (goal,) = spec.goals
    assert goal.effector == EffectorSpec("Club", (0.0, -92.0, 0.0))
    assert (goal.name, goal.position, goal.axes) == ("ball", (12.0, 2.5, 61.0), (0, 1, 2))
    assert goal.met_within == Tolerance(position=0.1)
    assert spec.plausibility_bound == 3.0


def test_the_damped_solver_is_bounded_by_its_iterations_alone(load):
    spec = load(EDIT_PC_DAMPED, "edit-pc", head=False).model
    assert spec.plausibility_bound is None
    assert (spec.solver.damping, spec.solver.damping_unit.metres, spec.solver.max_iterations) == (10, 0.01, 1500)
    assert spec.unit.name == "cm"


def test_the_normalize_example_means_what_the_contract_says(load):
    spec = load(NORMALIZE, "normalize", head=False).model
    hit = spec.events["hit"]
    assert hit.target == "mean"
    assert hit.frames.by_clip == {"swing01": 88, "swing02": 93}
    assert (hit.detect.measure, hit.detect.is_minimum, hit.detect.to) == ("distance", True, (0.0, 0.0, 60.0))
    assert spec.align_event is None


def test_a_model_is_fitted_without_a_spec_by_the_defaults():
    spec = FitPcaSpec()
    assert (spec.components, spec.explained_variance, spec.rotation) == (None, None, "centred")
    assert (spec.root_weight, spec.exclude_joints) == (1.0, ())


@pytest.mark.parametrize(
    ("first", "second", "names"),
    [
        ("", "", ["A", "A-2"]),
        ("name: A-2, ", "", ["A-2", "A"]),
        ("", "name: A, ", ["A-2", "A"]),
        ("name: x, ", "name: y, ", ["x", "y"]),
    ],
)
def test_an_item_without_a_name_takes_its_effectors_numbered_where_taken(first, second, names, load):
    goal = "at: 3, effector: A, shift: [1, 2, 3]"
    spec = load(f"goals:\n  - {{{first}{goal}}}\n  - {{{second}{goal}}}\n").model
    assert [item.name for item in spec.goals] == names


def test_a_spec_of_constraints_gives_its_defaults_to_those_that_say_nothing(load):
    spec = load(
        """
        defaults: {ease_in: 10, weight: 2.0, recruit: {up_to: Spine}}
        constraints:
          - {type: position, effector: A}
          - {type: position, effector: B, weight: 1.0, ease_in: 0.8s, recruit: all}
          - {type: posture, joints: [A]}
        """,
        "edit-prioritized",
    ).model
    first, second, posture = spec.constraints
    assert (first.ease_in.amount, first.weight, first.recruit.joint) == (10, 2.0, "Spine")
    assert (second.ease_in.text, second.weight, second.recruit.kind) == ("0.8s", 1.0, "all")
    assert (posture.name, posture.weight, hasattr(posture, "recruit")) == ("posture", 2.0, False)


def test_a_bare_tolerance_is_an_angle_where_the_goal_is_one(load):
    spec = load(
        """
        goals:
          - {at: 1, effector: A, orientation: {rotation_vector: [0, 0, 1]}, tolerance: 2}
          - {at: 1, effector: B, orientation: {rotation_vector: [0, 0, 1]}, shift: [1, 0, 0], tolerance: 2}
          - {at: 1, effector: C, orientation: {rotation_vector: [0, 0, 1]}, tolerance: {angle: 2}}
          - {at: 1, effector: D, shift: [1, 0, 0], tolerance: off}
        """
    ).model
    found = [dataclasses.astuple(goal.met_within)[:3] for goal in spec.goals]
    assert found == [(None, 2.0, False), (2.0, None, False), (None, 2.0, False), (None, None, True)]
