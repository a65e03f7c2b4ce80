"""The session of the README on the golf swings: normalize, fit-pca, edit-pc, as typed."""

import json

import numpy as np
import pytest
from golf_edits import HITS, edit_spec

from motionedit.core.bvh import parse_clip, read_clip, resampled_bytes
from motionedit.jobs.fit_pca import database
from studies.lab import effector_path


def test_the_session_of_the_readme(run, configs, data, tmp_path):
    assert run("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", "n").exit_code == 0
    assert len(list((tmp_path / "n").glob("*.bvh"))) == 10
    listing = json.loads((tmp_path / "n" / "normalization.json").read_text())
    assert (listing["frames"], listing["frame_rate"]) == (131, 25.0)
    fit = run("fit-pca", "n", "-o", "golf.npz", "-s", configs / "golf-fit.yaml")
    assert fit.exit_code == 0
    assert fit.stdout == "golf.npz\n"
    assert "100.00" in fit.stderr
    edit = run("edit-pc", data / "swing04.bvh", "-m", "golf.npz", "-s", configs / "golf-edit.yaml", "-o", "e.bvh")
    assert edit.exit_code == 0
    frame = HITS["swing04"]
    before, after = (
        effector_path(path, "Club", end_site=True)[frame] for path in (data / "swing04.bvh", tmp_path / "e.bvh")
    )
    np.testing.assert_allclose(after - before, [0, 0, 10], atol=0.01)


def test_the_same_bytes_for_any_number_of_jobs(run, configs, data, tmp_path, monkeypatch):
    monkeypatch.setattr(database, "_FEW_BYTES", -1)  # these are so few that no worker would be started to read them
    for jobs in ("1", "2"):
        run("normalize", data, "-s", configs / "golf-normalize.yaml", "-o", f"n{jobs}", "-j", jobs)
        run("fit-pca", f"n{jobs}", "-o", f"m{jobs}.npz", "-j", jobs)
        spec = edit_spec(tmp_path / "e.yaml")
        run("edit-pc", data, "-m", f"m{jobs}.npz", "-s", spec, "-o", f"e{jobs}", "-j", jobs)
    for folder in ("n", "e"):
        first, second = (sorted((tmp_path / f"{folder}{jobs}").glob("[!.]*")) for jobs in ("1", "2"))
        assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
        assert len(first) >= 10
    assert (tmp_path / "m1.npz").read_bytes() == (tmp_path / "m2.npz").read_bytes()


def test_an_edit_that_asks_for_nothing_writes_the_inputs_bytes(run, golf, data, tmp_path):
    still = edit_spec(tmp_path / "still.yaml")
    result = run("edit-pc", data, "-m", golf.model, "-s", still, "-o", "out", "--set", "goals.ball.shift=[0, 0, 0]")
    assert result.exit_code == 0
    empty = golf.spec(tmp_path / "empty.yaml", goals=[])
    run("edit-pc", data, "-m", golf.model, "-s", empty, "-o", "none")
    for clip in data.glob("*.bvh"):
        assert (tmp_path / "out" / clip.name).read_bytes() == clip.read_bytes()
        assert (tmp_path / "none" / clip.name).read_bytes() == clip.read_bytes()


def test_verify_reads_the_edit_back_with_another_reader(run, golf, data, tmp_path):
    result = run(
        *("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", edit_spec(tmp_path / "e.yaml")),
        *("-o", "e.bvh", "--verify", "--report", "r.json"),
    )
    assert result.exit_code == 0
    assert json.loads((tmp_path / "r.json").read_text())["clips"][0]["verify"]["distance"] < 0.09


def test_a_far_goal_is_unreachable_and_strict_says_so(run, golf, data, tmp_path):
    far = edit_spec(tmp_path / "far.yaml")
    arguments = ("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", far, "-o", "e.bvh")
    result = run(*arguments, "--set", "goals.ball.shift=[0, 0, 150]", "--strict", "--report", "r.json")
    assert result.exit_code == 3
    record = json.loads((tmp_path / "r.json").read_text())["clips"][0]
    assert record["status"] == "unreachable"
    assert record["change"]["norm"] <= record["change"]["bound"] * (1 + 1e-4)
    assert "out of reach of the database's motions" in result.stderr
    off = run(
        *arguments, "--set", "goals.ball.shift=[0, 0, 150]", "--set", "goals.ball.tolerance=off", "--report", "r.json"
    )
    assert off.exit_code == 0
    assert json.loads((tmp_path / "r.json").read_text())["clips"][0]["goals"][0]["status"] == "ok"


@pytest.mark.parametrize(
    ("priorities", "gave_way", "words"),
    [
        ((3, 2, 1), {"back": ["ahead"]}, "it gave way to ahead"),
        ((1, 1, 1), {"ahead": ["back"], "back": ["ahead"]}, "shared by weight with ahead"),
    ],
)
def test_a_missed_goal_names_what_it_gave_way_to_and_nothing_else(
    run, golf, data, tmp_path, priorities, gave_way, words
):
    asked = (
        ("ahead", "hit", "RightHand", [5, 0, 0]),
        ("down", 40, "Head", [0, -1, 0]),
        ("back", "hit", "RightHand", [-5, 0, 0]),
    )
    goals = [
        {"name": name, "at": at, "effector": joint, "shift": shift, "priority": priority}
        for (name, at, joint, shift), priority in zip(asked, priorities, strict=True)
    ]
    spec = edit_spec(tmp_path / "e.yaml", goals=goals)
    result = run("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", spec, "-o", "e.bvh", "--report", "r.json")
    record = json.loads((tmp_path / "r.json").read_text())["clips"][0]
    assert {goal["name"]: goal["gave_way_to"] for goal in record["goals"] if goal["gave_way_to"]} == gave_way
    assert {goal["status"] for goal in record["goals"]} == {"ok", "out_of_tolerance"}
    assert words in result.stderr


def test_the_report_has_the_fixed_keys(run, golf, data, tmp_path):
    spec = edit_spec(tmp_path / "e.yaml")
    run("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", spec, "-o", "e.bvh", "--report", "r.json")
    report = json.loads((tmp_path / "r.json").read_text())
    assert list(report)[:4] == ["schema", "version", "command", "spec"]
    clip = report["clips"][0]
    assert {"clip", "output", "status", "message", "unit", "metrics", "goals", "iterations", "history"} <= set(clip)
    assert {"alpha", "mahalanobis", "nearest"} <= set(clip)
    for moment in ("before", "after"):
        assert {"foot_slide_max", "jerk_rms"} <= set(clip["metrics"][moment])
        assert len(clip["alpha"][moment]) == 9
    goal = clip["goals"][0]
    assert {"name", "priority", "error_max", "error_rms", "error_angle_max", "frame", "status"} <= set(goal)
    assert len(clip["history"]) == clip["iterations"] + 1


def test_a_dry_run_says_what_it_would_do_and_writes_nothing(run, golf, data, tmp_path):
    spec = edit_spec(tmp_path / "e.yaml")
    before = sorted(tmp_path.iterdir())
    result = run("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", spec, "-o", "e.bvh", "--dry-run")
    assert result.exit_code == 0
    assert f"ball: frame {HITS['swing01']}, 10 away" in result.stdout
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("goals.ball.at=top", "no event 'top' in this spec or in the model; there are: 'hit'"),
        ("components=10", "the model has 9 components, not 10"),
        ("goals.ball.effector={end_site: Clubb}", "no joint 'Clubb' in"),
        ("goals.ball.at=500", "500 is outside the clip, whose frames are 0 to 128"),
        ("events={hit: 0}", "'hit' at frame 0 is not after its first frame"),
    ],
)
def test_what_the_clip_or_the_model_lacks_is_said_in_one_line(run, golf, data, tmp_path, change, message):
    spec = edit_spec(tmp_path / "e.yaml")
    result = run("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", spec, "-o", "e.bvh", "--set", change)
    assert result.exit_code in {1, 2}
    errors = [line for line in result.stderr.splitlines() if line.startswith("motionedit: error:")]
    assert len(errors) == 1
    assert message in errors[0]
    assert not (tmp_path / "e.bvh").exists()


def test_all_joints_that_goals_name_and_a_clip_lacks_are_told_with_one_list(run, golf, data, tmp_path):
    (tmp_path / "e.yaml").write_text(
        "schema: motionedit/edit-pc/v1\ngoals:\n"
        "  - {at: 3, effector: Xyz, relative_to: Qqq, shift: [0, 0, 1]}\n"
        "  - {at: 4, effector: Head, shift: [0, 0, 1]}\n"
        "  - {at: 5, effector: Vvv, shift: [0, 0, 1]}\n"
    )
    result = run("edit-pc", data / "swing01.bvh", "-m", golf.model, "-s", "e.yaml", "-o", "e.bvh")
    errors = [line for line in result.stderr.splitlines() if line.startswith("motionedit: error:")]
    assert result.exit_code == 2
    assert [error.split(": ")[2:4] for error in errors] == [
        ["e.yaml:3", "goals.0.effector"],
        ["e.yaml:3", "goals.0.relative_to"],
        ["e.yaml:5", "goals.2.effector"],
    ]
    assert [error.count("; its joints are ") for error in errors] == [1, 0, 0]


EVENTS_NOWHERE = {"hit": "Xyz", "top": "LeftWrist", "end": "Qqq"}


def test_all_joints_that_events_are_looked_for_by_are_told_with_one_list(run, data, tmp_path):
    rules = [
        f"  {name}: {{detect: {{effector: {joint}, minimum_of: height}}}}" for name, joint in EVENTS_NOWHERE.items()
    ]
    (tmp_path / "n.yaml").write_text("\n".join(["schema: motionedit/normalize/v1", "events:", *rules]))
    result = run("normalize", data, "-s", "n.yaml", "-o", "n", "--report", "r.json")
    mark = "motionedit: error: n.yaml:"
    errors = [line.removeprefix(mark) for line in result.stderr.splitlines() if line.startswith(mark)]
    where = f"in {data / 'swing01.bvh'}"
    assert result.exit_code == 2
    assert errors[0].startswith(f"3: events.hit.detect.effector: no joint 'Xyz' {where}; its joints are Hips, ")
    assert errors[0].endswith("(and in 9 more clips)")
    assert errors[1:] == [
        f"4: events.top.detect.effector: no joint 'LeftWrist' {where}; did you mean 'LeftHand'? (and in 9 more clips)",
        f"5: events.end.detect.effector: no joint 'Qqq' {where} (and in 9 more clips)",
    ]
    messages = [clip["message"] for clip in json.loads((tmp_path / "r.json").read_text())["clips"]]
    assert [message.count("no joint") for message in messages] == [3] * 10
    assert "\n" not in messages[0]


def test_a_clip_of_another_skeleton_fails_alone(run, golf, data, clip, tmp_path):
    other = clip("other.bvh")
    spec = edit_spec(tmp_path / "e.yaml")
    result = run("edit-pc", data / "swing01.bvh", other, "-m", golf.model, "-s", spec, "-o", "out")
    assert result.exit_code == 1
    assert "another skeleton than the model" in result.stderr
    assert (tmp_path / "out" / "swing01.bvh").exists()


def test_a_clip_that_is_not_in_the_database_gets_its_event_by_the_models_rule(run, golf, data, tmp_path):
    late = read_clip(data / "swing01.bvh")
    motion = late.motion
    part = motion.at(slice(6, None))
    (tmp_path / "late.bvh").write_bytes(resampled_bytes(late, part))
    spec = edit_spec(tmp_path / "e.yaml")
    result = run("edit-pc", "late.bvh", "-m", golf.model, "-s", spec, "-o", "e.bvh", "--report", "r.json")
    assert result.exit_code == 0
    assert json.loads((tmp_path / "r.json").read_text())["clips"][0]["goals"][0]["frame"] == pytest.approx(
        HITS["swing01"] - 6, abs=1
    )


def test_a_clip_from_standard_input_goes_to_standard_output(run, golf, data, tmp_path):
    spec = edit_spec(tmp_path / "e.yaml", events={"hit": HITS["swing01"]})
    piped = run("edit-pc", "-", "-m", golf.model, "-s", spec, "-o", "-", stdin=(data / "swing01.bvh").read_bytes())
    assert piped.exit_code == 0
    clip = parse_clip(piped.stdout_bytes, label="piped")
    assert len(clip.motion) == 129
