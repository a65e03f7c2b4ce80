"""What runs over whole folders say: counts, warnings that many clips share, and how far a run has come."""

import json

import pytest


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
