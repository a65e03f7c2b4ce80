"""The four commands one after the other, on the project's own golf swings."""

import json
import shutil
from pathlib import Path

import pytest

from motionedit.core.bvh import read_clip
from motionedit.jobs.batch import held
from motionedit.jobs.batch.plan import ClipTask

ROOT = Path(__file__).parents[2]
SWINGS = ROOT / "data/golf"
NAMES = sorted(path.name for path in SWINGS.glob("*.bvh"))


@pytest.fixture
def swings(run, tmp_path):
    """Work in a folder with the swings and the specs."""
    del run
    shutil.copytree(SWINGS, tmp_path / "golf")
    for name in ("golf-fit.yaml", "golf-edit.yaml"):
        shutil.copy(ROOT / "configs" / name, tmp_path)
    spec = (ROOT / "configs/golf-normalize.yaml").read_text()
    (tmp_path / "golf-normalize.yaml").write_text(spec.replace("../data/golf/events.csv", "golf/events.csv"))
    return tmp_path


@pytest.mark.usefixtures("swings")
def test_clips_become_a_timeline_a_model_and_edits(run):
    normalized = run("normalize", "golf", "-s", "golf-normalize.yaml", "-o", "normal", "-j", 2)
    assert (normalized.exit_code, normalized.stdout.split()) == (0, [f"normal/{name}" for name in NAMES])
    fitted = run("fit-pca", "normal", "-s", "golf-fit.yaml", "-o", "golf.npz", "--report", "fit.json")
    assert (fitted.exit_code, fitted.stdout) == (0, "golf.npz\n")
    assert fitted.stderr.splitlines()[0].split() == ["component", "variance", "share", "%", "sum", "%"]
    assert list(json.loads(Path("fit.json").read_text()))[:5] == ["schema", "version", "command", "spec", "clips"]
    edited = run("edit-pc", "golf", "-m", "golf.npz", "-s", "golf-edit.yaml", "-o", "edited", "--report", "-", "-j", 0)
    assert edited.exit_code == 0
    clips = json.loads(edited.stdout)["clips"]
    assert {clip["status"] for clip in clips} <= {"ok", "far", "rough"}
    assert all(Path(clip["output"]).exists() for clip in clips)
    assert run("diff", "golf", "edited").exit_code == 3
    # With one component the goal is out of reach, which --strict makes an exit code.
    one = ("edit-pc", "golf", "-m", "golf.npz", "-s", "golf-edit.yaml", "-o", "edited", "--set", "components=1")
    one += ("--set", "solver.method=gauss-newton")
    assert run(*one).exit_code == 0
    assert run(*one, "--strict").exit_code == 3
    again = run("fit-pca", "normal", "-o", "golf.npz", "--no-overwrite")
    assert (again.exit_code, again.stderr.count("\n")) == (2, 1)
    Path("report.json").touch()
    normalize = ("normalize", "golf", "-s", "golf-normalize.yaml", "-o", "new")
    for one in (("fit-pca", "normal", "-o", "new.npz"), normalize):
        refused = run(*one, "--report", "report.json", "--no-overwrite")
        assert refused.stderr == "motionedit: error: report.json: exists, and --no-overwrite is given\n"
        assert not Path(one[-1]).exists()
    streamed = run("normalize", "-", *normalize[2:])
    reason = "'-' is not for normalize, which reads each clip twice; give files"
    assert (streamed.exit_code, streamed.stderr) == (2, f"motionedit: error: {reason}\n")
    Path("new").mkdir()
    shutil.copy("normal/normalization.json", "new")
    refused = run(*normalize, "--no-overwrite")
    assert refused.stderr == "motionedit: error: new/normalization.json: exists, and --no-overwrite is given\n"


@pytest.mark.usefixtures("swings")
def test_a_leg_of_an_odd_length_questions_the_unit(run):
    doubt = "m long where the unit is m: is that the clip's unit?"
    slip = ("--set", "unit=m")
    assert doubt in run("normalize", "golf", "-s", "golf-normalize.yaml", "-o", "normal", *slip).stderr
    run("fit-pca", "normal", "-s", "golf-fit.yaml", "-o", "golf.npz")
    edit = ("edit-pc", f"golf/{NAMES[0]}", "-m", "golf.npz", "-s", "golf-edit.yaml", "-o", "edited")
    assert doubt in run(*edit, *slip).stderr
    assert doubt not in run(*edit).stderr
    far = run(*edit, "--set", "goals.ball.shift=[0, 0, 1000]").stderr
    assert "legs, and a leg of this clip is 86.5 long: is it in the clip's unit?" in far


@pytest.fixture
def reads(monkeypatch, tmp_path):
    """Return a file with a line for each clip that is read, by any process."""
    path = tmp_path / "reads.txt"

    def read(source, **options):
        with path.open("a") as stream:
            stream.write(f"{source.name}\n")
        return read_clip(source, **options)

    monkeypatch.setattr("motionedit.core.bvh.read_clip", read)
    return path


@pytest.mark.usefixtures("swings")
@pytest.mark.parametrize("jobs", [1, 2])
def test_normalize_reads_a_clip_once_where_the_clips_fit_and_writes_the_same_where_they_do_not(
    run, reads, monkeypatch, jobs
):
    normalize = ("normalize", "golf", "-s", "golf-normalize.yaml", "-j", jobs)
    assert run(*normalize, "-o", "once").exit_code == 0
    names = reads.read_text().split()
    assert set(names) == set(NAMES)
    # Of two workers one may have had time for what the other one holds.
    assert len(names) == len(NAMES) if jobs == 1 else len(names) < 2 * len(NAMES)
    monkeypatch.setattr("motionedit.jobs.normalize.job._MOST_HELD", 0)
    reads.unlink()
    assert run(*normalize, "-o", "twice").exit_code == 0
    assert sorted(reads.read_text().split()) == sorted(2 * NAMES)
    for path in Path("once").iterdir():
        if not path.name.startswith("."):
            assert path.read_bytes() == (Path("twice") / path.name).read_bytes()


def test_a_run_that_fails_holds_no_clips_for_the_next(run, swings):
    (swings / "golf/swing02.bvh").write_text("no clip")
    normalize = ("normalize", "golf", "-s", "golf-normalize.yaml", "-o")
    assert run(*normalize, "normal").exit_code == 1
    shutil.copy(SWINGS / "swing02.bvh", swings / "golf")
    shutil.copy(SWINGS / "swing03.bvh", swings / "golf/swing01.bvh")
    assert run(*normalize, "normal").exit_code == 0
    assert (held._HELD.clips, held._HELD.bytes) == ({}, 0)
    assert run(*normalize, "again").exit_code == 0
    one, other = (Path(folder, "swing01.bvh").read_bytes() for folder in ("normal", "again"))
    assert one == other


def test_as_many_clips_are_held_as_fit(swings):
    tasks = [ClipTask(swings / "golf" / name, name, None, name) for name in NAMES]
    clips = [read_clip(task.source) for task in tasks]
    sizes = [clip.motion.rotations.nbytes + clip.motion.translations.nbytes for clip in clips]
    try:
        for task, clip in zip(tasks, clips, strict=True):
            held.hold(task, clip, most=sum(sizes[:3]))
        found = [held.with_held(task).clip for task in tasks]
    finally:
        held.let_go()
    assert [clip is not None for clip in found] == [True] * 3 + [False] * 7
    assert all(one.motion is other.motion for one, other in zip(found[:3], clips, strict=False))
    assert all(held.with_held(task) is task for task in tasks)


def test_normalize_fails_as_a_whole_unless_told_to_keep_going(run, swings):
    (swings / "golf/swing02.bvh").write_text("no clip")
    result = run("normalize", "golf", "-s", "golf-normalize.yaml", "-o", "normal")
    assert (result.exit_code, result.stdout) == (1, "")
    assert not (swings / "normal").exists()
    result = run("normalize", "golf", "-s", "golf-normalize.yaml", "-o", "normal", "--keep-going")
    assert (result.exit_code, result.stdout.split()) == (
        1,
        [f"normal/{name}" for name in NAMES if name != "swing02.bvh"],
    )


def test_a_preview_is_one_page(run, swings):
    result = run("preview", "golf/swing01.bvh", "golf/swing02.bvh", "-o", "swings.html")
    assert (result.exit_code, result.stdout) == (0, "swings.html\n")
    assert (swings / "swings.html").stat().st_size > 1000
    result = run("preview", "golf/swing01.bvh", "-o", "swings.html", "--no-overwrite")
    assert result.stderr == "motionedit: error: swings.html: exists, and --no-overwrite is given\n"
