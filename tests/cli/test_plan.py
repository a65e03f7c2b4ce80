"""Which clips a run takes, where each goes, and what is refused before any work."""

import os
from pathlib import Path

import pytest

from motionedit.errors import UsageError
from motionedit.jobs.batch.plan import RunOptions, find_clips, plan
from motionedit.jobs.batch.verdicts import verdicts_in

OPTIONS = RunOptions()


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Work in a folder that holds takes/{a.bvh,B.BVH,deep/c.bvh} and what is no clip."""
    monkeypatch.chdir(tmp_path)
    for name in ("a.bvh", "B.BVH", "deep/c.bvh", ".hidden.bvh", ".git/x.bvh", "notes.txt", ".a.bvh.partial"):
        path = tmp_path / "takes" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")
    return tmp_path


def outputs(*clips, output, options=OPTIONS, **more):
    return [
        task.output and task.output.as_posix()
        for task in plan([Path(clip) for clip in clips], output, options=options, **more)
    ]


def test_a_folder_stands_for_its_clips_in_any_case_sorted():
    tasks = find_clips([Path("takes")])
    assert [task.relative for task in tasks] == ["B.BVH", "a.bvh", "deep/c.bvh"]
    assert [task.label for task in tasks] == ["takes/B.BVH", "takes/a.bvh", "takes/deep/c.bvh"]


def test_a_folder_keeps_its_layout_in_the_output_folder():
    assert outputs("takes", output="out") == ["out/B.BVH", "out/a.bvh", "out/deep/c.bvh"]


def test_the_output_folder_inside_the_input_folder_is_left_out():
    for name in ("takes/out/a.bvh", "takes/out/deep/c.bvh"):
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_bytes(b"")
    assert outputs("takes", output="takes/./out") == [
        "takes/out/B.BVH",
        "takes/out/a.bvh",
        "takes/out/deep/c.bvh",
    ]


def test_a_name_ending_in_bvh_is_that_file():
    assert outputs("takes/a.bvh", output="new/b.BVH") == ["new/b.BVH"]


def test_an_output_file_of_an_earlier_run_inside_the_folder_is_no_clip():
    Path("takes/deep/out.bvh").write_bytes(b"")
    assert outputs("takes/deep", output="takes/deep/out.bvh") == ["takes/deep/out.bvh"]


def test_standard_input_and_output():
    assert outputs("-", output="-") == [None]
    assert outputs("-", output="x.bvh") == ["x.bvh"]
    (task,) = plan([Path("-")], "-", options=OPTIONS)
    assert task.source is None


@pytest.mark.parametrize(
    ("clips", "output", "message"),
    [
        (["takes"], "x.fbx", "x.fbx: clips are written as .bvh, not as .fbx"),
        (["takes/a.bvh"], "x.JSON", "x.JSON: clips are written as .bvh, not as .JSON"),
        (["takes"], "x.bvh", "-o x.bvh: 3 clips cannot go to x.bvh; give a folder"),
        (["takes"], "-", "-o -: 3 clips cannot go to standard output; give a folder"),
        (["-"], "out", "a clip from standard input has no name"),
        (["-", "-"], "out", "can be read only once"),
        (["nope.bvh"], "out", "nope.bvh: no such file or folder"),
        (["takes/.git"], "takes/.git", "is an input"),
        (["empty"], "out", "empty: no .bvh file in this folder"),
        (["takes/a.bvh"], "takes/notes.txt", "takes/notes.txt: is a file; give a folder"),
        (["takes/a.bvh"], "folder.bvh", "folder.bvh: is a folder"),
        (["takes", "takes/a.bvh"], "out", "takes/a.bvh and takes/a.bvh would both be written to out/a.bvh"),
        (["takes/a.bvh", "other/a.bvh"], "out", "takes/a.bvh and other/a.bvh would both be written to out/a.bvh"),
        (["takes/a.bvh"], "takes/a.bvh", "takes/a.bvh: is an input of this run"),
        (["takes/a.bvh"], "takes/../takes/a.bvh", "is an input of this run"),
        (["takes/a.bvh"], "takes", "takes/a.bvh: is an input of this run"),
        (["takes"], "takes", "takes/B.BVH: is an input of this run, and .* (and 2 more)"),
        (["takes/a.bvh"], "link.bvh", "link.bvh: is an input of this run"),
        (["takes/a.bvh"], "linked", "linked/a.bvh: is an input of this run"),
        (["takes/a.bvh"], "spec.bvh", "spec.bvh: is an input of this run"),
    ],
)
def test_what_cannot_be_is_refused(clips, output, message):
    Path("empty").mkdir()
    Path("folder.bvh").mkdir()
    Path("other").mkdir()
    Path("other/a.bvh").write_bytes(b"")
    Path("link.bvh").symlink_to("takes/a.bvh")
    Path("linked").symlink_to("takes")
    Path("spec.bvh").write_bytes(b"")
    with pytest.raises(UsageError, match=message.replace("(", r"\(").replace(")", r"\)")) as caught:
        outputs(*clips, output=output, depends=[Path("spec.bvh")])
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("report", "message"),
    [
        ("takes/a.bvh", "is an input"),
        ("out/a.bvh", "the report and takes/a.bvh"),
        ("out/.motionedit-verdicts.jsonl", "the report and what --update remembers"),
        ("out", "out: would be a file and the folder of other outputs"),
    ],
)
def test_the_report_is_neither_input_nor_output(report, message):
    verdicts = verdicts_in("out", "", update=False, dry_run=False)
    with pytest.raises(UsageError, match=message):
        outputs("takes/a.bvh", output="out", options=RunOptions(report=Path(report)), verdicts=verdicts)


def test_a_clip_is_not_written_where_another_has_its_folder():
    Path("other/a.bvh").mkdir(parents=True)
    Path("other/a.bvh/b.bvh").write_bytes(b"")
    with pytest.raises(UsageError, match=r"out/a\.bvh: would be a file and the folder of other outputs"):
        outputs("takes", "other", output="out")


def test_no_overwrite_refuses_an_output_that_exists():
    Path("out").mkdir()
    Path("out/a.bvh").write_bytes(b"")
    with pytest.raises(UsageError, match=r"out/a\.bvh: exists"):
        outputs("takes", output="out", options=RunOptions(overwrite=False))
    assert outputs("takes/deep", output="out", options=RunOptions(overwrite=False)) == ["out/c.bvh"]


def times(**seconds):
    for name, second in seconds.items():
        os.utime({"clip": "takes/a.bvh", "spec": "spec.yaml", "output": "out/a.bvh"}[name], (second, second))


@pytest.mark.parametrize(
    ("clip", "spec", "output", "current"), [(1, 2, 3, True), (1, 2, 2, True), (4, 2, 3, False), (1, 4, 3, False)]
)
def test_update_passes_over_outputs_that_nothing_is_newer_than(clip, spec, output, current):
    Path("out").mkdir()
    Path("out/a.bvh").write_bytes(b"")
    Path("spec.yaml").write_bytes(b"")
    times(clip=clip, spec=spec, output=output)
    tasks = plan([Path("takes")], "out", options=RunOptions(update=True), depends=[Path("spec.yaml")])
    assert [task.current for task in tasks] == [False, current, False]


@pytest.mark.parametrize(("clip", "output"), [("-", "x.bvh"), ("takes/a.bvh", "-")])
def test_update_needs_files(clip, output):
    with pytest.raises(UsageError, match="--update compares the times of files"):
        outputs(clip, output=output, options=RunOptions(update=True))
