"""--update passes over what is done, and knows what was said of it."""

import json
import os
from contextlib import contextmanager
from pathlib import Path

import pytest

from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.edit_prioritized import job
from motionedit.spec.load import load_spec

MISSED = {"type": "position", "effector": "LeftForeArm", "points": [{"at": 4, "shift": [0, 900, 0]}], "tolerance": 0.1}


@pytest.fixture
def edit(run, clip, tmp_path):
    """Return a runner of an edit of two clips that misses its goal."""
    (tmp_path / "s.yaml").write_text(
        json.dumps({"schema": "motionedit/edit-prioritized/v1", "constraints": [{**MISSED, "name": "far"}]})
    )
    for n, name in enumerate("ab"):
        clip(f"in/{name}.bvh", seed=n)

    def go(*more):
        return run("edit-prioritized", "in", "-s", "s.yaml", "-o", "out", *more)

    return go


def test_a_skipped_clip_keeps_its_place_in_the_report_and_its_exit_code(edit):
    assert edit("--report", "first.json").exit_code == 0
    Path("out/b.bvh").unlink()
    resumed = edit("--update", "--strict", "--report", "second.json")
    assert (resumed.exit_code, resumed.stdout) == (3, "out/b.bvh\n")
    assert "in/a.bvh: unreachable: far:" in resumed.stderr
    assert "2 clips: 2 unreachable" in resumed.stderr
    assert json.loads(Path("second.json").read_text()) == json.loads(Path("first.json").read_text())


def test_where_nothing_is_to_be_done_what_was_missed_before_is_counted(edit):
    edit()
    assert edit("--update").stderr.splitlines()[-1] == "2 clips: 2 unreachable"


def test_quietly_what_was_missed_before_is_told_where_it_counts(edit):
    edit()
    assert edit("-q", "--update").stderr == ""
    assert "in/b.bvh: unreachable: far:" in edit("-q", "--update", "--strict").stderr


def test_with_strict_an_output_that_missed_is_older_than_its_clip_so_that_make_makes_it_again(edit):
    assert edit("--strict").exit_code == 3
    assert Path("out/a.bvh").stat().st_mtime < Path("in/a.bvh").stat().st_mtime
    again = edit("--update", "--strict")
    assert (again.exit_code, again.stdout) == (3, "out/a.bvh\nout/b.bvh\n")


def test_another_set_is_another_spec(edit):
    edit()
    assert edit("--update").stdout == ""
    changed = edit("--update", "--set", "constraints.far.weight=2")
    assert changed.stdout == "out/a.bvh\nout/b.bvh\n"
    assert edit("--update", "--set", "constraints.far.weight=2").stdout == ""


def test_an_output_that_somebody_changed_is_made_again(edit):
    edit()
    Path("out/a.bvh").write_bytes(Path("out/b.bvh").read_bytes())
    assert edit("--update").stdout == "out/a.bvh\n"


def test_what_a_killed_run_began_to_say_is_no_verdict(edit):
    edit()
    path = Path("out/.motionedit-verdicts.jsonl")
    first, second = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(first + second[:200])
    assert edit("--update").stdout == "out/b.bvh\n"
    assert edit("--update").stdout == ""


def test_verdicts_are_the_same_bytes_for_any_number_of_workers_and_any_number_of_runs(edit):
    path = Path("out/.motionedit-verdicts.jsonl")
    edit()
    before = path.read_bytes()
    edit("-j", "2")
    assert path.read_bytes() == before


def test_normalize_makes_all_anew_where_the_list_of_clips_is_another(run):
    golf = Path(__file__).resolve().parents[2] / "data" / "golf"
    swings = [golf / f"swing0{n}.bvh" for n in (1, 2, 3)]
    spec = golf.parents[1] / "configs" / "golf-normalize.yaml"
    assert run("normalize", *swings, "-s", spec, "-o", "n", "--report", "a.json").exit_code == 0
    again = run("normalize", *swings, "-s", spec, "-o", "n", "--update", "--report", "b.json")
    assert (again.stdout, again.stderr) == ("", "3 up to date\n")
    assert Path("a.json").read_text() == Path("b.json").read_text()
    fewer = run("normalize", *swings[:2], "-s", spec, "-o", "n", "--update")
    assert fewer.stdout == "n/swing01.bvh\nn/swing02.bvh\n"
    assert len(json.loads(Path("n/normalization.json").read_text())["clips"]) == 2


def test_a_clip_in_whose_place_an_older_one_was_put_is_edited_again(edit, clip):
    edit()
    old = clip("old.bvh", seed=7)
    os.utime(old, (1, 1))
    old.replace("in/a.bvh")
    assert edit("--update").stdout == "out/a.bvh\n"
    assert edit("--update").stdout == ""


def test_a_report_has_frames_of_skipped_clips_where_it_has_those_of_others(edit):
    edit()
    both = "out/a.bvh\nout/b.bvh\n"
    assert edit("--update", "--report-frames").stdout == ""  # nobody is told
    assert edit("--update", "--report-frames", "--report", "with.json").stdout == both
    Path("out/b.bvh").unlink()
    assert edit("--update", "--report", "without.json").stdout == "out/b.bvh\n"
    frames = [
        ["frames" in clip["constraints"][0] for clip in json.loads(Path(name).read_text())["clips"]]
        for name in ("with.json", "without.json")
    ]
    assert frames == [[True, True], [False, False]]


def test_what_was_not_verified_is_made_again_where_it_is_to_be(edit):
    edit()
    assert edit("--update", "--verify").stdout == "out/a.bvh\nout/b.bvh\n"
    assert edit("--update", "--verify").stdout == ""
    assert edit("--update").stdout == ""


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_clip_counts_as_done_when_its_verdict_is_kept(clip, jobs, tmp_path):
    """A run that is killed then loses no verdict of a clip that its progress told of."""
    for seed in range(24):
        clip(f"in/{seed}.bvh", seed=seed)
    spec = load_spec({"schema": "motionedit/edit-prioritized/v1", "constraints": [MISSED]}, "edit-prioritized")
    kept = []

    @contextmanager
    def progress(_clips):
        yield lambda: kept.append((tmp_path / "out/.motionedit-verdicts.jsonl").read_bytes().count(b"\n"))

    job.run(spec, [tmp_path / "in"], str(tmp_path / "out"), RunOptions(jobs=jobs, progress=progress))
    assert len(kept) == 24
    assert all(lines >= done for done, lines in enumerate(kept, start=1))
