"""A folder of normalized clips is of one run, or it is no database."""

import json
from pathlib import Path

import pytest

from motionedit.jobs.batch import one_clip

ROOT = Path(__file__).resolve().parents[2]
SWINGS = [ROOT / "data" / "golf" / f"swing0{n}.bvh" for n in (1, 2, 3)]
SPEC = ROOT / "configs" / "golf-normalize.yaml"


@pytest.fixture
def normalized(run):
    def go(*more):
        return run("normalize", *SWINGS, "-s", SPEC, "-o", "n", *more)

    assert go().exit_code == 0
    return go


@pytest.fixture
def listing():
    """Return a function that changes the list of a folder."""

    def change(function):
        path = Path("n/normalization.json")
        content = json.loads(path.read_text())
        function(content)
        path.write_text(json.dumps(content))

    return change


def test_a_run_that_stops_while_it_writes_leaves_no_list_over_clips_of_two_runs(run, normalized, monkeypatch):
    def stop(path, content):
        if path.name == "swing02.bvh":
            raise KeyboardInterrupt
        one_clip.atomic_write(path, content)

    monkeypatch.setattr(one_clip, "write_file", stop)
    assert normalized("--set", "frames=90").exit_code == 130
    fit = run("fit-pca", "n", "-o", "m.npz")
    assert fit.exit_code == 2
    assert "normalization.json: not there" in fit.stderr


def test_a_run_that_cannot_begin_leaves_the_older_one_whole(run, normalized):
    assert normalized("--set", "frame_rate=0").exit_code == 2
    assert run("fit-pca", "n", "-o", "m.npz").exit_code == 0


@pytest.mark.usefixtures("normalized")
def test_a_clip_that_is_not_the_one_that_was_listed_is_refused(run):
    other = Path("n/swing02.bvh")
    other.write_bytes(Path("n/swing01.bvh").read_bytes())
    fit = run("fit-pca", "n", "-o", "m.npz")
    assert fit.exit_code == 1
    assert "n/swing02.bvh: is not the clip that normalization.json lists" in fit.stderr
    assert not Path("m.npz").exists()


@pytest.mark.usefixtures("normalized")
@pytest.mark.parametrize("name", ["swing01.bvh", "./swing01.bvh", "../swing01.bvh", "/swing01.bvh"])
def test_duplicates_and_strangers_are_refused(run, listing, name):
    listing(lambda content: content["clips"][1].update(clip=name))
    fit = run("fit-pca", "n", "-o", "m.npz")
    assert fit.exit_code == 2
    assert ("twice" if "swing01" in name and name[0] != "/" and ".." not in name else "not below") in fit.stderr


@pytest.mark.usefixtures("normalized")
@pytest.mark.parametrize("written", ["n/swing01.bvh", "n/normalization.json", "fit.yaml", "m.npz", "link.bvh"])
def test_the_report_of_a_fit_is_none_of_its_files(run, written):
    Path("fit.yaml").write_text("schema: motionedit/fit-pca/v1\n")
    Path("link.bvh").symlink_to("n/swing02.bvh")
    before = Path(written).read_bytes() if Path(written).exists() else None
    fit = run("fit-pca", "n", "-o", "m.npz", "-s", "fit.yaml", "--report", written)
    assert fit.exit_code == 2
    assert "would both be written" in fit.stderr if before is None else "never overwritten" in fit.stderr
    assert before is None or Path(written).read_bytes() == before


def test_the_list_is_none_of_the_other_files_that_normalize_writes(normalized):
    done = normalized("--report", "n/normalization.json")
    assert done.exit_code == 2
    assert "normalization.json would both be written" in done.stderr
    assert json.loads(Path("n/normalization.json").read_text())["schema"] == "motionedit/normalization/v1"


@pytest.mark.usefixtures("normalized")
@pytest.mark.parametrize(
    "damage",
    [
        {"frames": None},
        {"frames": 1},
        {"frame_rate": 0},
        {"frame_rate": float("nan")},
        {"events": {"hit": 0}},
        {"events": [["hit", 3]]},
        {"up": "w"},
        {"rules": {}},
        {"clips": {"0": 1}},
        {"clips": [3]},
    ],
    ids=str,
)
def test_a_damaged_list_is_refused_in_a_line(run, listing, damage):
    listing(lambda content: content.update(damage))
    fit = run("fit-pca", "n", "-o", "m.npz")
    assert fit.exit_code == 2
    assert fit.stderr == "motionedit: error: n/normalization.json: damaged; make it again with 'motionedit normalize'\n"
