"""Clips that check holds against limits, and a spec: what its own command would miss in them is said, nothing else."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.motion import Motion

DATA = Path(__file__).parents[2] / "data"
WALK, SKATING, SWING = DATA / "walk.bvh", DATA / "walk-skating.bvh", DATA / "golf" / "swing04.bvh"


@pytest.fixture
def held_against(run, tmp_path):
    """Return a runner of check with a spec: a command's name, the spec's other lines, and clips (one swing)."""

    def invoke(command, text, *arguments, clips=(SWING,)):
        (tmp_path / "s.yaml").write_text(f"schema: motionedit/{command}/v1\n{text}\n")
        return run("check", *clips, "-s", "s.yaml", *arguments)

    return invoke


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        ("{at: 4, effector: Fooo, shift: [0, 0, 1]}", "goals.0.effector: no joint 'Fooo' in"),
        ("{at: 4, effector: {end_site: Hips}, shift: [0, 0, 1]}", "has no end site"),
        ("{at: hit, effector: Head, relative_to: Bust, shift: [0, 0, 1]}", "goals.0.relative_to: no joint 'Bust' in"),
        ("{at: 400, effector: Head, shift: [0, 0, 1]}", "goals.0.at: in"),
        ("{at: top + 30s, effector: Head, shift: [0, 0, 1]}", "goals.0.at: in"),
    ],
)
def test_a_goal_names_what_the_clip_lacks(held_against, goal, message):
    top = "events: {top: {detect: {effector: Club, maximum_of: height}}}"
    done = held_against("edit-pc", f"{top}\ngoals: [{goal}]")
    assert done.exit_code == 3
    assert message in done.stdout


@pytest.mark.parametrize("command", ["edit-pc", "normalize"])
def test_a_rule_watches_a_joint_that_the_clip_lacks(held_against, command):
    rule = "events: {top: {detect: {effector: Fooo, maximum_of: height}}}"
    done = held_against(command, rule + ("\ngoals: []" if command == "edit-pc" else ""))
    assert done.exit_code == 3
    assert "events.top.detect.effector: no joint 'Fooo' in" in done.stdout


def test_every_fault_of_a_spec_is_told(held_against):
    goals = "goals: [{at: 4, effector: Fooo, shift: [0, 0, 1]}, {at: 400, effector: Baar, shift: [0, 0, 1]}]"
    done = held_against("edit-pc", goals)
    for key in ("goals.0.effector", "goals.1.effector", "goals.1.at"):
        assert f" {key}: " in done.stdout


def test_an_event_that_the_model_may_know_is_let_pass(held_against):
    after = "events: {late: {detect: {effector: Club, maximum_of: height, after: hit}}, other: {frames: {swing05: 9}}}"
    goals = ", ".join(f"{{at: {name}, effector: Head, shift: [0, 0, 1]}}" for name in ("hit", "late", "other"))
    assert held_against("edit-pc", f"{after}\ngoals: [{goals}]").exit_code == 0


def test_an_event_of_normalize_needs_a_frame_in_every_clip(held_against):
    done = held_against("normalize", "events: {hit: {frames: {swing04: 85}}}", clips=(SWING, DATA / "golf/swing05.bvh"))
    assert done.exit_code == 3
    lines = done.stdout.splitlines()
    assert ": ok (" in lines[0]
    assert "events.hit: no frame for" in lines[1]


def test_joints_to_exclude_are_looked_for(held_against):
    assert "exclude_joints.0: no joint 'Fooo'" in held_against("fit-pca", "exclude_joints: [Fooo, Club]").stdout
    assert held_against("fit-pca", "exclude_joints: [Club]").exit_code == 0


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_spec_that_fits_passes_by_workers_too(held_against, jobs):
    rule = "events: {top: {detect: {effector: Club, maximum_of: height}}}"
    goals = "goals: [{at: top, effector: {end_site: Club}, shift: [0, 0, 1]}]"
    clips = (SWING, DATA / "golf" / "swing05.bvh")
    assert held_against("edit-pc", f"{rule}\n{goals}", "-j", jobs, clips=clips).exit_code == 0


SPECS = {"normalize": "", "fit-pca": "", "edit-pc": "goals: []", "edit-prioritized": "constraints: []"}


@pytest.mark.parametrize("command", SPECS)
def test_clips_are_measured_by_the_body_and_the_up_that_the_spec_gives(held_against, command):
    done = held_against(command, f"{SPECS[command]}\nbody: {{left_arm: none, right_arm: none}}\nup: z")
    assert done.exit_code == 0
    assert "; z up; legs, head; " in done.stdout
    assert "; y up; " in held_against(command, f"{SPECS[command]}\nup: z", "--up", "y").stdout
    assert "; -y up; " in held_against(command, f"{SPECS[command]}\nup: -y").stdout
    assert "; -x up; " in held_against(command, SPECS[command], "--up", "-x").stdout


@pytest.mark.parametrize("command", SPECS)
def test_a_body_that_the_clip_lacks_is_told_once_and_the_clip_measured(held_against, command):
    done = held_against(command, f"{SPECS[command]}\nbody: {{head: Skul}}")
    assert done.exit_code == 3
    assert done.stdout.count("body.head: no joint 'Skul'") == 1
    assert "; legs, arms, head; " in done.stdout


def test_the_report_has_the_spec_that_clips_are_held_against(held_against, run, tmp_path):
    held_against("edit-pc", "goals: [{at: 4, effector: Fooo, shift: [0, 0, 1]}]", "--report", "r.json")
    spec = json.loads((tmp_path / "r.json").read_text())["spec"]
    goal = {"at": 4, "effector": "Fooo", "shift": [0, 0, 1]}
    assert spec == {"schema": "motionedit/edit-pc/v1", "goals": [goal]}
    run("check", SWING, "--report", "r.json")
    assert json.loads((tmp_path / "r.json").read_text())["spec"] is None


def test_a_report_named_xml_is_junit(held_against, tmp_path):
    (tmp_path / "cut.bvh").write_text("HIERARCHY\n")
    clips = (SWING, DATA / "golf" / "swing05.bvh", "cut.bvh")
    spec = "events: {hit: {frames: {swing04: 85}}}"
    assert held_against("normalize", spec, "--report", "r.xml", clips=clips).exit_code == 1
    suite = ET.parse(tmp_path / "r.xml").getroot()[0]  # noqa: S314  written a line above
    assert [[child.tag for child in case] for case in suite] == [[], ["failure"], ["error"]]
    assert suite.get("name") == "motionedit check"
    assert "events.hit: no frame for" in suite[1][0].get("message")


@pytest.mark.parametrize(
    "arguments",
    [
        ("normalize", SWING, "-s", "s.yaml", "-o", "n"),
        ("fit-pca", "n", "-o", "m.npz"),
        ("edit-pc", SWING, "-m", "s.yaml", "-s", "s.yaml", "-o", "o.bvh"),
        ("edit-prioritized", SWING, "-s", "s.yaml", "-o", "o.bvh"),
        ("info", SWING),
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_command_without_junit_refuses_its_name(run, tmp_path, arguments):
    (tmp_path / "s.yaml").write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\n")
    done = run(*arguments, "--report", "b.XML")
    assert done.exit_code == 2
    assert "b.XML would be JSON; check and diff alone write JUnit: name it b.json" in done.stderr
    assert not (tmp_path / "o.bvh").exists()


def test_check_tells_of_each_clip_and_of_limits_that_are_passed(run, tmp_path):
    done = run("check", WALK, SKATING, "--limit", "foot_sliding_share=0.5", "--report", "r.json")
    assert done.exit_code == 3
    first, second = done.stdout.splitlines()
    assert first.startswith(f"{WALK}: ok (24 Hz; 145 frames; cm; y up; legs, arms, head;")
    assert second.startswith(f"{SKATING}: unfit: foot_sliding_share 1 above 0.5 (")
    clips = json.loads((tmp_path / "r.json").read_text())["clips"]
    assert [each["status"] for each in clips] == ["ok", "unfit"]
    assert run("check", WALK, SKATING).exit_code == 0
    assert run("check", WALK, SKATING, "-j", "2", "--limit", "foot_sliding_share=0.5").stdout == done.stdout


@pytest.mark.parametrize("height", [-40.0, -8.0, 0.0, 8.0, 40.0])
def test_check_says_where_feet_stand_that_do_not_stand_on_the_floor(run, tmp_path, height):
    motion = read_clip(WALK).motion
    shifted = Motion(
        motion.skeleton, motion.rotations, motion.translations + np.array([0.0, height, 0.0]), motion.frame_time
    )
    (tmp_path / "w.bvh").write_bytes(new_bytes(shifted))
    done = run("check", "w.bvh", "--report", "r.json")
    (clip,) = json.loads((tmp_path / "r.json").read_text())["clips"]
    said = [line for line in clip["warnings"] if line.startswith("feet stand at y = ")]
    assert ("feet stand at y = " in done.stdout) == bool(said) == (abs(height) > 10.0)
    if said:
        assert abs(float(said[0].split(" = ")[1].split(":")[0]) - height) < 3.0


def test_check_takes_limits_of_a_file_and_refuses_what_is_no_limit(run, tmp_path):
    (tmp_path / "l.yaml").write_text("# CI\njumps: 0\nfoot_sliding_share: 0.5  # of held frames\n")
    assert run("check", SKATING, "--limits", "l.yaml").exit_code == 3
    assert run("check", SKATING, "--limits", "l.yaml", "--limit", "foot_sliding_share=1").exit_code == 0
    for given, message in (
        ("skate=1", "no measure 'skate'"),
        ("jumps", "must be MEASURE=NUMBER"),
        ("jumps=a", "a number"),
    ):
        done = run("check", WALK, "--limit", given)
        assert done.exit_code == 2
        assert message in done.stderr


def test_check_holds_clips_against_a_spec(run, tmp_path):
    (tmp_path / "s.yaml").write_text(
        "schema: motionedit/edit-prioritized/v1\nconstraints: [{type: position, effector: Nose, points: [{at: 3}]}]\n"
    )
    done = run("check", WALK, "-s", "s.yaml")
    assert done.exit_code == 3
    assert "s.yaml:2: constraints.0.effector" in done.stdout
    (tmp_path / "bad.bvh").write_text("HIERARCHY\n")
    assert run("check", WALK, "bad.bvh").exit_code == 1


def test_check_is_given_what_stands_beside_a_spec(held_against, run):
    follows = "constraints: [{type: position, effector: LeftFoot, follow: reference}]"
    assert "give reference: or --reference" in held_against("edit-prioritized", follows).stderr
    assert held_against("edit-prioritized", follows, "--reference", SWING).exit_code == 0
    assert "has another skeleton" in held_against("edit-prioritized", follows, "--reference", WALK).stdout
    refused = held_against("normalize", "frames: 9", "--reference", SWING)
    assert f"--reference {SWING}: s.yaml is a spec of normalize; it goes with one of edit-prioritized" in refused.stderr
    refused = held_against("normalize", "frames: 9", "-m", "s.yaml")
    assert "-m s.yaml: s.yaml is a spec of normalize; it goes with one of edit-pc" in refused.stderr
    assert "-m stands beside a spec: give -s too" in run("check", SWING, "-m", "s.yaml").stderr
    assert "--reference stands beside a spec" in run("check", SWING, "--reference", "s.yaml").stderr
