"""The reports of all commands are as their published schema says, and the schema and the pages name every key."""

import copy
import json
import re
from pathlib import Path

import jsonschema
import pytest

from motionedit.core.pca import vectors

ROOT = Path(__file__).resolve().parents[2]
WALK = ROOT / "data" / "walk.bvh"
SCHEMA = json.loads((ROOT / "docs" / "report.schema.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


def faults(report):
    """Return what is wrong with a report, by the schema of its own command."""
    name = f"{report['command'].replace('-', '_')}_report"
    part = jsonschema.Draft202012Validator({**SCHEMA["$defs"][name], "$defs": SCHEMA["$defs"]})
    return [f"{'.'.join(map(str, e.absolute_path))}: {e.message[:200]}" for e in part.iter_errors(report)]


@pytest.fixture
def report(run, tmp_path):
    """Return a runner of command lines with --report, whose report is valid; it returns the report."""

    def invoke(*arguments, exit_code=0):
        result = run(*arguments, "--report", "r.json")
        assert result.exit_code == exit_code, result.stderr
        found = json.loads((tmp_path / "r.json").read_text())
        assert faults(found) == []
        assert VALIDATOR.is_valid(found)
        return found

    return invoke


@pytest.fixture
def bad(tmp_path):
    path = tmp_path / "bad.bvh"
    path.write_text("HIERARCHY\n")
    return path


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_normalize_and_fit_pca(report, golf, bad, tmp_path):
    spec = tmp_path / "n.yaml"
    spec.write_text("schema: motionedit/normalize/v1\nunit: 0.01\nevents: {hit: {detect: {effector: {end_site: Club},"
                    " minimum_of: height, between: [60%, 85%]}}}\n")  # fmt: skip
    found = report("normalize", *golf.swings[:3], bad, "-s", spec, "-o", "n", "--keep-going", "--verify", exit_code=1)
    assert [clip["status"] for clip in found["clips"]] == ["ok", "ok", "ok", "failed"]
    assert report("fit-pca", "n", "-o", "m.npz")["spec"] is None


@pytest.mark.parametrize(
    "keys",
    [
        {"unit": "cm"},
        {"timing": "normalized", "plausibility": "off"},
        {
            "unit": "cm",
            "solver": {"method": "damped", "damping": 10, "damping_unit": "cm", "max_iterations": 3, "tolerance": 1.0},
        },
        {"goals": []},
    ],
    ids=["default", "retimed", "damped", "no goals"],
)
def test_edit_pc(report, golf, bad, tmp_path, keys):
    club = {"at": "hit", "effector": {"end_site": "Club"}}
    goals = [
        {**club, "name": "ball", "shift": [0, 0, 10]},
        {**club, "name": "face", "orientation": {"euler": [0, 0, 10], "order": "ZXY"}, "tolerance": "off"},
        {**club, "name": "far", "shift": [900, 0, 0], "weight": 0.1},
    ]
    spec = golf.spec(tmp_path / "s.yaml", **{"goals": goals, **keys})
    arguments = ("edit-pc", golf.swings[0], bad, "-m", golf.model, "-s", spec, "-o", "out")
    found = report(*arguments, "--verify", exit_code=1)
    assert {clip["status"] for clip in found["clips"]} > {"failed"}


@pytest.mark.parametrize("name", ["stairs", "reach", "step", "karate", "wind"])
def test_edit_prioritized(report, name):
    clip = ROOT / "data" / ("kick.bvh" if name == "karate" else "walk.bvh")
    spec = ROOT / "configs" / f"{name}.yaml"
    found = report("edit-prioritized", clip, "-s", spec, "-o", "out.bvh")
    assert found["clips"][0]["constraints"]


@pytest.mark.compiled
def test_edit_prioritized_that_misses_fails_or_has_nothing_to_do(report, bad, copy_spec):
    report("edit-prioritized", WALK, bad, "-s", copy_spec, "-o", "out", "--verify", exit_code=1)
    spec = ROOT / "configs" / "karate.yaml"
    far = ("--set", "constraints.kick.points.0.shift=[0, 900, 0]")
    found = report("edit-prioritized", ROOT / "data" / "kick.bvh", "-s", spec, "-o", "out.bvh", *far)
    assert found["clips"][0]["constraints"][-1]["gave_way_to"]


def test_info(report, clip, bad):
    report("info", WALK, "--contacts", "--at", "58", "--joint", "RightToeBase", "--joint", "{end_site: RightToeBase}")
    report("info", clip(), WALK, bad, exit_code=1)
    found = report("info", clip(), WALK, "--at", "3", "--joint", "RightToeBase", exit_code=1)
    assert [one["status"] for one in found["clips"]] == ["failed", "ok"]


def test_diff(report, clip):
    clip("a/same.bvh")
    clip("b/same.bvh")
    clip("a/new.bvh", seed=1)
    clip("b/new.bvh", seed=2)
    clip("a/gone.bvh")
    clip("a/long.bvh")
    clip("b/long.bvh", frames=9)
    found = report("diff", "a", "b", exit_code=2)
    assert {one["status"] for one in found["clips"]} == {"same", "different", "missing", "not_comparable"}


def test_check(report, bad, copy_spec):
    report("check", WALK, bad, "--limit", "jumps=0", exit_code=1)
    copy_spec.write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\nhinges: [Nope]\n")
    found = report("check", WALK, "-s", copy_spec, "--limit", "frames=3", exit_code=3)
    (clip,) = found["clips"]
    assert (clip["passed"], len(clip["spec_errors"])) == (["frames"], 1)


def test_a_model_of_very_many_clips(report, golf, copy_spec, monkeypatch):
    copy_spec.write_text("schema: motionedit/normalize/v1\n")
    report("normalize", *golf.swings[:4], "-s", copy_spec, "-o", "n")
    monkeypatch.setattr(vectors, "MOST_IN_MEMORY", 3)
    assert report("fit-pca", "n", "-o", "m.npz")["streamed"]["passes"]


def test_what_is_warned_of_is_in_the_report(report, run, clip, tmp_path):
    """Of normalize, in its clips and in all of them together; of fit-pca; of an edit."""
    (tmp_path / "n.yaml").write_text("schema: motionedit/normalize/v1\nup: y\nunit: mm\n")
    clips = [clip(f"in/walk{n}.bvh", seed=n, frames=8 if n else 40) for n in range(3)]
    found = report("normalize", *clips, "-s", "n.yaml", "-o", "n")
    assert [any("a leg is" in line for line in one["warnings"]) for one in found["clips"]] == [True] * 3
    assert [line for line in found["warnings"] if "is it one of them?" in line]
    assert report("normalize", *clips, "-s", "n.yaml", "-o", "n", "--update")["clips"] == found["clips"]
    (tmp_path / "f.yaml").write_text("schema: motionedit/fit-pca/v1\nunit: mm\n")
    assert "a leg is" in report("fit-pca", "n", "-s", "f.yaml", "-o", "m.npz")["warnings"][0]
    edit = ("edit-prioritized", WALK, "-s", ROOT / "configs" / "reach.yaml", "--set", "unit=mm", "-o", "out.bvh")
    printed = [line.removeprefix("motionedit: warning: ") for line in run(*edit).stderr.splitlines()]
    warnings = report(*edit)["clips"][0]["warnings"]
    assert any("a leg is" in line for line in warnings)
    assert [line for line in printed if line in warnings] == warnings


def objects(schema, path=""):
    """Yield every object of a schema that has keys of its own, with its place."""
    if isinstance(schema, dict):
        if "properties" in schema:
            yield path, schema
        for key, value in schema.items():
            yield from objects(value, f"{path}/{key}")
    elif isinstance(schema, list):
        for i, value in enumerate(schema):
            yield from objects(value, f"{path}/{i}")


def test_a_key_that_is_not_in_the_schema_one_that_is_missing_and_another_type_are_faults(report):
    found = report("edit-prioritized", WALK, "-s", ROOT / "configs" / "reach.yaml", "-o", "out.bvh")
    constraint = found["clips"][0]["constraints"][0]
    for change in ({"extra": 1}, {"priority": "high"}, {"status": "fine"}, {"frames": {"error": [0.0]}}):
        wrong = copy.deepcopy(found)
        wrong["clips"][0]["constraints"][0] = {**constraint, **change}
        assert not VALIDATOR.is_valid(wrong), change
    wrong = copy.deepcopy(found)
    del wrong["clips"][0]["metrics"]
    assert not VALIDATOR.is_valid(wrong)


def test_every_key_says_what_it_means():
    for path, schema in objects(SCHEMA):
        assert schema["description"], path
        for key, value in schema["properties"].items():
            assert value.get("description") or "$ref" in value, f"{path}: {key}"


# Of numbers: what they are measured in, and keys of those that have no unit.
UNITS = re.compile(r"clip units|degrees|\b(m|m/s|Hz|seconds|share|standard deviations)\b")
PURE = {
    *("explained_variance", "times", "residual", "alpha", "coefficients"),
    *("mahalanobis", "median", "axis", "quaternion"),
}


def is_numeric(schema):
    if "anyOf" in schema:
        return any(map(is_numeric, schema["anyOf"]))
    if schema.get("type") == "array":
        return is_numeric(schema["items"])
    return "number" in (schema.get("type"), *(schema.get("type") or ()))


def test_every_number_says_its_unit():
    for path, schema in objects(SCHEMA):
        for key, value in schema["properties"].items():
            if is_numeric(value) and not PURE & {key, *path.split("/")}:
                assert UNITS.search(value["description"]), f"{path}: {key}"


def test_the_page_on_files_names_every_key_of_the_reports():
    page = (ROOT / "docs" / "files.md").read_text(encoding="utf-8").partition("## The report")[2].partition("\n## ")[0]
    named = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`", page))))
    keys = {key for _, schema in objects(SCHEMA) for key in schema["properties"]}
    assert keys - named == set()


def test_the_fixed_keys_are_required():
    for name in ("goal", "constraint"):
        required = set(SCHEMA["$defs"][name]["required"])
        assert required >= {"name", "priority", "error_max", "error_rms", "error_angle_max", "frame", "status"}
        assert "gave_way_to" in required
    for name in ("pc_clip", "prioritized_clip"):
        assert {"clip", "output", "status", "message", "unit", "metrics"} <= set(SCHEMA["$defs"][name]["required"])
