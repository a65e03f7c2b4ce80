"""What runs over whole folders say: counts, warnings that many clips share, and how far a run has come."""

import json
from pathlib import Path

import pytest

from motionedit.cli.repeated import few_of_each_kind
from motionedit.jobs.batch.notices import notices_of
from motionedit.jobs.batch.one_clip import Done, Outcome
from motionedit.jobs.batch.plan import ClipTask

FAR = {"type": "position", "effector": "LeftForeArm", "points": [{"at": 4, "shift": [0, 900, 0]}], "tolerance": 0.1}
NO_LEGS = "no legs found: half the height stands for the leg length; body: in a spec says which joints are the legs"


@pytest.fixture
def edit(run, clip, tmp_path):
    """Return a runner of an edit of so many clips, which all miss its goal where it has one: warnings, other lines."""

    def go(count, *options, goals=()):
        spec = {"schema": "motionedit/edit-prioritized/v1", "constraints": list(goals)}
        path = tmp_path / "s.yaml"
        if not path.exists():
            path.write_text(json.dumps(spec))
        for n in range(count):
            if not (tmp_path / f"in/{n:02d}.bvh").exists():
                clip(f"in/{n:02d}.bvh", seed=n)
        done = run("edit-prioritized", "in", "-s", "s.yaml", "-o", "out", *options)
        lines = done.stderr.splitlines()
        mark = "motionedit: warning: "
        return [line.removeprefix(mark) for line in lines if mark in line], [line for line in lines if mark not in line]

    return go


@pytest.mark.parametrize("command", ["info", "check"])
def test_info_and_check_of_several_clips_end_with_a_count(run, clip, command):
    clip("in/a.bvh")
    (clip("in/b.bvh").parent / "c.bvh").write_text("no clip")
    done = run(command, "in")
    lines = done.stderr.splitlines()
    assert (done.exit_code, lines[-1]) == (1, "3 clips: 2 ok, 1 failed")
    assert lines[0].startswith("motionedit: error: in/c.bvh")
    assert "3 clips" not in done.stdout
    assert run(command, "in", "-q").stderr == done.stderr
    told = run(command, "in", "--report", "-")
    assert [entry["status"] for entry in json.loads(told.stdout)["clips"]] == ["ok", "ok", "failed"]
    assert told.stderr == done.stderr
    assert run(command, "in/a.bvh").stderr == ""
    assert run(command, "in/a.bvh", "in/b.bvh").stderr == "2 clips: 2 ok\n"
    assert run(command, "in/a.bvh", "in/b.bvh", "-q").stderr == ""


def test_clips_that_are_unfit_are_counted_and_quiet_runs_still_say_so(run, clip):
    clip("in/a.bvh")
    clip("in/b.bvh", seed=1)
    for options in ((), ("-j", "2"), ("-q",)):
        done = run("check", "in", "--limit", "frames=1", *options)
        assert (done.exit_code, done.stderr) == (3, "2 clips: 2 unfit\n")


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_warning_that_many_clips_share_is_said_for_a_few_and_counted_for_the_others(edit, jobs):
    warnings, others = edit(45, "-j", jobs)
    assert warnings == [
        *(f"in/{n:02d}.bvh: {NO_LEGS}" for n in range(3)),
        "42 more of this kind: --update -v tells of all",
    ]
    assert others == ["45 clips: 45 ok"]


def test_all_are_said_of_a_few_clips_and_with_v(edit):
    every = [f"in/{n:02d}.bvh: {NO_LEGS}" for n in range(41)]
    assert edit(40)[0] == every[:40]
    assert edit(41, "-v")[0] == every
    assert edit(41, "--dry-run")[0][3:] == ["38 more of this kind: -v tells of all"]
    assert edit(41, "-q") == ([], [])


def test_with_v_what_earlier_runs_warned_of_is_said_again_and_once(edit):
    first, _ = edit(3, goals=[FAR])
    assert len(first) == 6
    again, others = edit(3, "--update", "-v")
    assert (again, others) == (first, ["3 up to date", "3 clips: 3 unreachable"])
    assert len(edit(3, "--update")[0]) == 3


@pytest.mark.compiled
def test_each_clip_that_misses_its_goal_has_a_line_with_its_reason_however_many_they_are(edit):
    warnings, _ = edit(45, "-j", "2", goals=[{**FAR, "name": "far"}])
    reasons = [line.split(": ")[0] for line in warnings if ": far: " in line and "from its goal at frame 4" in line]
    assert reasons == [f"in/{n:02d}.bvh" for n in range(45)]
    assert [line for line in warnings if ": far: " not in line][2:] == [
        f"in/02.bvh: {NO_LEGS}",
        "42 more of this kind: --update -v tells of all",
    ]


def test_warnings_are_of_one_kind_where_they_differ_by_numbers_and_the_clips_name_alone():
    def kind(label, warning, reason="", status="ok"):
        task = ClipTask(Path(label), label, None, label)
        entry = {"message": reason or None}
        done = Done(Outcome(None, status=status, warnings=(warning,)))
        (notice,) = notices_of([(task, done)], [entry], alone=False, every=False)
        return notice.kind

    one = kind("in/a1.bvh", "in/a1.bvh:14: a leg is 86.5 m long, 1e-05 off")
    assert one == kind("in/b.bvh", "in/b.bvh:9: a leg is -2 m long, 3 off")
    assert kind("a", "Spine1 jerks at 3") != kind("a", "Spine2 jerks at 3")
    assert kind("a", "hand: 3 off", "hand: 3 off; foot: 4 off", "unreachable") is None
    assert kind("a", "no legs", "hand: 3 off; foot: 4 off", "unreachable") == "no legs"
    assert kind("a", "far off", "far off", "far") == "far off"


def test_four_of_a_kind_are_said_and_of_five_two_are_counted():
    four = [("a", f"a{n}") for n in range(4)]
    assert [*few_of_each_kind(four, rest="")] == ["a0", "a1", "a2", "a3"]
    mixed = [("b", "b0"), *four, (None, "x"), ("a", "a4"), (None, "y")]
    assert [*few_of_each_kind(mixed, rest="so")] == ["b0", "a0", "a1", "a2", "2 more so", "x", "y"]


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_run_of_many_clips_into_a_log_says_how_far_it_is(edit, jobs):
    lines = [f"{10 * n} of 100 clips" for n in range(1, 11)]
    assert edit(100, "-j", jobs)[1] == [*lines, "100 clips: 100 ok"]
    assert edit(100, "-q", "-j", jobs)[1] == []
