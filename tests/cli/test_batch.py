"""A run over clips: what is written, what is reported, and what one bad clip means for the others."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from motionedit.core.bvh import VerifyResult, unedited_bytes
from motionedit.errors import ClipError, MotionEditErrors, SpecError
from motionedit.jobs.batch.one_clip import Outcome
from motionedit.jobs.batch.plan import RunOptions, plan
from motionedit.jobs.batch.run import run_batch
from motionedit.jobs.batch.values import map_tasks


@dataclass(frozen=True)
class Copy:
    """Copies clips, but for those whose name says what is to go wrong."""

    status: str = "ok"

    def __call__(self, clip, task):
        name = task.relative
        if name.startswith("bad"):
            raise ClipError("went wrong", file=task.label)
        if name.startswith("nameless"):
            raise ClipError("went wrong")
        if name.startswith("joint"):
            raise MotionEditErrors("two", [SpecError("no joint", file="s.yaml", line=n) for n in (2, 3)])
        if name.startswith("bug"):
            raise KeyError(name)
        return Outcome(
            unedited_bytes(clip),
            {"unit": "cm"},
            status=self.status,
            warnings=("beware",) if name.startswith("warn") else (),
            details=("one layer",),
        )


@pytest.fixture
def go(tmp_path, clip, monkeypatch):
    """Return a function that makes clips of the given names and runs Copy over them into out/."""
    monkeypatch.chdir(tmp_path)

    def run(*names, work=None, output="out", **options):
        for n, name in enumerate(names):
            clip(f"in/{name}.bvh", seed=n)
        options = RunOptions(**options)
        return run_batch(plan([Path("in")], output, options=options), work or Copy(), options)

    return run


@pytest.mark.parametrize("jobs", [1, 2, 0])
def test_results_are_in_order_and_the_bytes_the_same_for_any_jobs(go, jobs):
    result = go("a", "b", "deep/c", jobs=jobs)
    assert result.paths == ["out/a.bvh", "out/b.bvh", "out/deep/c.bvh"]
    assert result.records[2] == {
        "clip": "in/deep/c.bvh",
        "output": "out/deep/c.bvh",
        "status": "ok",
        "message": None,
        "unit": "cm",
        "warnings": [],
    }
    assert result.exit_code == 0
    for path in result.paths:
        assert Path(path).read_bytes() == Path(path.replace("out", "in")).read_bytes()


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("fault", ["bad", "nameless", "joint", "bug"])
def test_a_clip_that_fails_fails_alone(go, fault, jobs):
    result = go("a", fault, "z", jobs=jobs)
    assert result.paths == ["out/a.bvh", "out/z.bvh"]
    assert [record["status"] for record in result.records] == ["ok", "failed", "ok"]
    assert result.records[1]["output"] is None
    assert result.exit_code == 1
    expected = {
        "bad": ["in/bad.bvh: went wrong"],
        "nameless": ["in/nameless.bvh: went wrong"],
        "joint": ["s.yaml:2: no joint", "s.yaml:3: no joint"],
        "bug": ["in/bug.bvh: unexpected KeyError: 'bug.bvh'; please report it (-vv shows where)"],
    }
    assert [str(error) for error in result.failures] == expected[fault]
    assert result.records[1]["message"] == "; ".join(expected[fault])


def test_with_vv_a_fault_of_ours_is_raised_to_show_its_place(go):
    with pytest.raises(KeyError, match="bug"):
        go("bug", verbosity=2)


def test_a_file_that_bvhio_reads_as_another_motion_is_not_kept(go, monkeypatch):
    def look(_data, _motion, *, leg_length):
        return VerifyResult(distance=leg_length, frame=7, joint="Hips", skipped=0, tolerance=0.1)

    monkeypatch.setattr("motionedit.core.bvh.check_with_bvhio", look)
    result = go("a", verify=True)
    assert "in/a.bvh: --verify: bvhio reads joint Hips at frame 7" in str(result.failures[0])
    assert not Path("out").exists()


def test_fail_fast_does_not_begin_the_clips_after_a_failed_one(go):
    result = go("a", "bad", "z", keep_going=False)
    assert result.paths == ["out/a.bvh"]
    assert not Path("out/z.bvh").exists()
    assert len(result.records) == 2
    assert result.exit_code == 1


def test_a_fault_of_the_spec_in_every_clip_is_the_specs(go):
    assert go("joint1", "joint2").exit_code == 2
    assert go("joint1", "joint2", "a").exit_code == 1
    assert not Path("out/joint1.bvh").exists()


def test_fail_fast_does_not_take_the_first_clip_for_all(go):
    assert go("joint1", "z", keep_going=False).exit_code == 1


@pytest.mark.parametrize(
    ("status", "strict", "code"),
    [
        ("ok", True, 0),
        ("far", True, 0),
        ("rough", True, 3),
        ("rough", False, 0),
        ("out_of_tolerance", True, 3),
        ("unreachable", True, 3),
        ("out_of_tolerance", False, 0),
    ],
)
def test_strict_counts_goals_that_were_not_met(go, status, strict, code):
    assert go("a", work=Copy(status), strict=strict).exit_code == code


def test_a_failed_clip_comes_before_a_missed_goal(go):
    assert go("a", "bad", work=Copy("unreachable"), strict=True).exit_code == 1


def test_an_unreadable_clip_names_its_line(go, clip):
    clip("in/a.bvh").write_text("HIERARCHY\nROOT Hips\n{\n")
    result = go("b")
    assert result.exit_code == 1
    assert str(result.failures[0]).startswith("in/a.bvh:")


def test_a_clip_that_cannot_be_opened_is_a_failure(go, clip):
    clip("in/a.bvh").unlink()
    Path("in/a.bvh").symlink_to("nowhere")
    result = go("b")
    assert [record["status"] for record in result.records] == ["failed", "ok"]
    assert "in/a.bvh" in str(result.failures[0])


def test_an_output_that_cannot_be_written_is_a_failure(go):
    Path("out/a.bvh").mkdir(parents=True)
    result = go("a", "b")
    assert result.paths == ["out/b.bvh"]
    assert str(result.failures[0]).startswith("out/a.bvh: cannot be written: ")
    assert sorted(path.name for path in Path("out").iterdir()) == ["a.bvh", "b.bvh"]


def test_warnings_have_the_clips_name_where_there_are_several(go):
    assert go("warn").warnings == ["beware"]
    assert go("a").warnings == ["in/warn.bvh: beware"]


def test_lenient_warnings_come_along(go, clip):
    path = clip("in/a.bvh")
    path.write_text(path.read_text().replace("Frames: 8", "Frames: 9"))
    assert go("b").exit_code == 1
    result = go("b", lenient=True)
    assert result.exit_code == 0
    assert len(result.warnings) == 1


def test_a_dry_run_writes_nothing_and_says_what_it_would(go):
    result = go("a", "bad", dry_run=True)
    assert result.details == [("in/a.bvh -> out/a.bvh", ("one layer",))]
    assert result.paths == []
    assert not Path("out").exists()


def test_standard_output_gets_the_bytes(go):
    result = go("a", output="-")
    assert result.content == Path("in/a.bvh").read_bytes()
    assert result.paths == []
    assert result.records[0]["output"] is None


def test_update_leaves_current_outputs_alone(go):
    go("a", "b")
    Path("out/b.bvh").unlink()
    Path("out/a.bvh").write_bytes(b"kept")
    tasks = plan([Path("in")], "out", options=RunOptions(update=True))
    result = run_batch(tasks, Copy(), RunOptions(update=True))
    assert result.paths == ["out/b.bvh"]
    assert result.current == 1
    assert Path("out/a.bvh").read_bytes() == b"kept"


def test_a_run_removes_what_a_killed_run_left(go):
    Path("out").mkdir()
    Path("out/.a.bvh.1234.motionedit-partial").write_bytes(b"half")
    go("a")
    assert [path.name for path in Path("out").iterdir()] == ["a.bvh"]


def test_progress_counts_every_clip(go):
    counted = []

    class Progress:
        def __init__(self, length):
            counted.append(length)

        def __enter__(self):
            return lambda: counted.append("tick")

        def __exit__(self, *_):
            counted.append("done")

    go("a", "bad", progress=Progress)
    assert counted == [2, "tick", "tick", "done"]


def half(number):
    if number % 2:
        raise ClipError("odd", file=str(number))
    if number == 6:
        raise OSError(28, "No space left on device", "six")
    if number == 8:
        raise MotionEditErrors("two", [SpecError("x"), SpecError("y")])
    return number // 2


@pytest.mark.parametrize("jobs", [1, 2])
def test_map_tasks_gives_errors_as_values_in_order(jobs):
    values = map_tasks(half, [2, 3, 4, 6, 8], RunOptions(jobs=jobs))
    assert [str(value) for value in values] == ["1", "3: odd", "2", "six: No space left on device", "x\ny"]
    assert [type(fault) for fault in values[-1].errors] == [SpecError, SpecError]
