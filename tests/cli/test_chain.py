"""The four commands one after the other, on the project's own golf swings."""

import json
import shutil
from pathlib import Path

import pytest

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
