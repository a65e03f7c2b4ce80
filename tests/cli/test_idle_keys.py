"""A key of a spec that would say nothing is refused at its line, or warned of: it is not read, and then passed over."""

import pytest
from prioritized_edits import WALK, hand


@pytest.fixture
def database(run, clip, tmp_path):
    """Return the folder with `n`, normalized clips, which have y up, and `m.npz`, the model of them."""
    for n in range(3):
        clip(f"in/walk{n}.bvh", seed=n)
    (tmp_path / "n.yaml").write_text("schema: motionedit/normalize/v1\nup: y\n")
    assert run("normalize", "in", "-s", "n.yaml", "-o", "n", "-q").exit_code == 0
    assert run("fit-pca", "n", "-o", "m.npz", "-q").exit_code == 0
    return tmp_path


@pytest.fixture
def fit(run, database):
    """Return a runner of fit-pca with a spec of one line."""

    def invoke(line):
        (database / "f.yaml").write_text(f"schema: motionedit/fit-pca/v1\n{line}\n")
        return run("fit-pca", "n", "-s", "f.yaml", "-o", "f.npz")

    return invoke


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        (
            "exclude_joints: [LeftArm, Hips]",
            "exclude_joints.1: in n: 'Hips' carries the travel, which a model always has",
        ),
        ("up: z", "up: the clips of n/normalization.json were normalized with y up, not z; leave it out"),
        ("up: -y", "up: the clips of n/normalization.json were normalized with y up, not -y; leave it out"),
    ],
)
def test_a_model_is_not_asked_for_what_it_cannot_be(fit, tmp_path, line, fault):
    done = fit(line)
    assert done.exit_code == 2
    assert done.stderr.startswith(f"motionedit: error: f.yaml:2: {fault}")
    assert not (tmp_path / "f.npz").exists()


def test_an_up_that_is_the_clips_own_changes_nothing(fit, tmp_path):
    assert fit("up: y").exit_code == 0
    assert (tmp_path / "f.npz").read_bytes() == (tmp_path / "m.npz").read_bytes()


def test_events_of_a_fit_are_warned_of(fit, tmp_path):
    done = fit("events: {hit: 3}")
    assert done.exit_code == 0
    assert "warning: events: nothing is taken from them; a model has the events of its normalized clips" in done.stderr
    assert (tmp_path / "f.npz").read_bytes() == (tmp_path / "m.npz").read_bytes()


def test_a_unit_in_which_no_leg_is_so_long_is_warned_of(fit):
    assert "a leg is 0.015 m long where the unit is mm: is that the clip's unit?" in fit("unit: mm").stderr
    assert "a leg is" not in fit("unit: cmu").stderr


def test_an_edit_has_the_up_of_its_model(run, database):
    goal = "goals: [{at: 3, effector: LeftForeArm, shift: [1, 0, 0]}]"
    answers = {}
    for up in ("y", "z"):
        (database / "e.yaml").write_text(f"schema: motionedit/edit-pc/v1\n{goal}\nup: {up}\n")
        answers[up] = run("edit-pc", "in/walk1.bvh", "-m", "m.npz", "-s", "e.yaml", "-o", "e.bvh")
    assert answers["y"].exit_code == 0
    assert answers["z"].exit_code == 2
    assert (
        "error: e.yaml:3: up: the clips of m.npz were normalized with y up, not z; leave it out" in answers["z"].stderr
    )


def test_a_reference_of_which_nothing_is_taken_is_refused(edit):
    asked = hand({"at": 50, "shift": [0, 5, 0]})
    idle = edit([asked], reference=str(WALK))
    assert idle.result.exit_code == 2
    place = f"s.yaml:{idle.line_of('reference')}: reference: nothing is taken from it"
    assert place in idle.result.stderr
    assert "reference: nothing is taken from it" in edit([asked], "--reference", WALK).result.stderr
    assert edit([asked, {"type": "footplants"}], reference=str(WALK)).result.exit_code == 0
