"""Whatever a user can cause is a MotionEditError that says all that is wrong; what is written is whole and no input."""

import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.errors import ClipError, SpecError, UsageError

ROOT = Path(__file__).resolve().parents[2]
SWING = "data/golf/swing04.bvh"

NOTHING = {"constraints": []}


def refused(call, *arguments, **options):
    with pytest.raises(motionedit.MotionEditError) as caught:
        call(*arguments, **options)
    return str(caught.value).splitlines()


def test_all_faults_of_a_mapping_are_raised_together_by_their_keys():
    spec = {"constraints": [{"type": "position", "efector": "LeftHand", "priority": object()}, {"type": "pos"}]}
    lines = refused(motionedit.edit_prioritized, "data/walk.bvh", spec)
    assert lines[0] == "spec: constraints.0.priority: a value of type object cannot stand in a spec"
    assert lines[1] == "spec: constraints.0.efector: unknown key; did you mean 'effector'?"
    assert lines[2].startswith("spec: constraints.1.type: must be position, orientation")
    assert len(lines) == 3


def test_a_fault_that_needs_the_clip_names_key_and_clip():
    goal = {"type": "position", "effector": "LeftHnd", "priority": 1}
    lines = refused(motionedit.edit_prioritized, "data/walk.bvh", {"constraints": [goal]})
    assert lines == ["spec: constraints.0.effector: no joint 'LeftHnd' in data/walk.bvh; did you mean 'LeftHand'?"]


def test_a_fault_of_a_file_names_its_line(tmp_path):
    spec = tmp_path / "reach.yaml"
    spec.write_text("schema: motionedit/edit-prioritized/v1\nconstraint: []\n")
    assert f"{spec}:2: constraint: unknown key; did you mean 'constraints'?" in refused(
        motionedit.edit_prioritized, "data/walk.bvh", spec
    )


def test_a_spec_of_another_command_is_refused():
    lines = refused(motionedit.edit_prioritized, "data/walk.bvh", {"schema": "motionedit/edit-pc/v1", "goals": []})
    assert lines == ["spec: schema: this is a spec of edit-pc; edit-prioritized wants motionedit/edit-prioritized/v1"]


def test_keys_are_words_and_nothing_is_endless():
    deep = {}
    deep["constraints"] = [deep]
    assert any(
        "nested more than 50 deep" in line for line in refused(motionedit.edit_prioritized, "data/walk.bvh", deep)
    )
    assert "spec: a key must be a word, not 3" in refused(motionedit.edit_prioritized, "data/walk.bvh", {3: 4})


AN_EVENT = "a frame such as 94, a time such as 3.76s or 71.2%, or {frames: ...} or {detect: ...}"


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (
            "x",
            f"events.hit: must be {AN_EVENT}; not 'x'",
        ),
        (
            None,
            f"events.hit: needs a value: {AN_EVENT}",
        ),
        (object(), "events.hit: a value of type object cannot stand in a spec"),
        (9000, f"events.hit: in {SWING}: frame 9000 is outside the take, whose frames are 0 to 120"),
    ],
)
def test_a_faulty_event_is_named(fitted, frame, message):
    goal = {"at": "hit", "effector": "RightHand", "shift": [0, 0, 1]}
    assert message in refused(motionedit.edit_pc, SWING, fitted, {"goals": [goal]}, events={"hit": frame})


WAVE = {"type": "position", "effector": "LeftHand", "priority": 1, "points": [{"at": "wave", "shift": [0, 1, 0]}]}


def test_an_event_that_nothing_asks_for_is_refused(fitted):
    goal = {"at": 80, "effector": "RightHand", "shift": [0, 0, 1]}
    assert refused(motionedit.edit_pc, SWING, fitted, {"goals": [goal]}, events={"hti": 85}) == [
        "events.hti: no such event in the spec or the model; did you mean 'hit'?"
    ]
    for spec, words in (
        ({"constraints": [WAVE], "events": {"wave": 4}}, "did you mean 'wave'?"),
        ({"constraints": [], "events": {"step": 4}}, "there are: step"),
        (NOTHING, "there are none"),
    ):
        assert refused(motionedit.edit_prioritized, "data/walk.bvh", spec, events={"wvae": 70}) == [
            f"events.wvae: no such event in the spec; {words}"
        ]


def test_an_event_that_the_spec_lists_or_names_or_the_model_has_is_taken(fitted):
    rule = {"effector": "Head", "maximum_of": "height"}
    for spec in (
        {"constraints": [WAVE]},
        {"constraints": [], "events": {"wave": 4}},
        {"constraints": [], "events": {"top": {"detect": {**rule, "after": "wave"}}}},
        {"constraints": [], "events": {"top": {"detect": {**rule, "between": ["wave - 5", "wave + 5"]}}}},
    ):
        assert motionedit.edit_prioritized("data/walk.bvh", spec, events={"wave": 70}).report["status"] == "ok"
    goal = {"at": "top", "effector": "RightHand", "shift": [0, 0, 1]}
    edit = motionedit.edit_pc(SWING, fitted, {"goals": [goal]}, events={"top": 70, "hit": 85})
    assert edit.report["goals"][0]["frame"] == 70


def test_one_fault_is_raised_as_itself_with_its_place(tmp_path):
    spec = tmp_path / "reach.yaml"
    spec.write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\nsmoothign: 3\n")
    with pytest.raises(motionedit.SpecError) as caught:
        motionedit.edit_prioritized("data/walk.bvh", spec)
    assert (caught.value.file, caught.value.line, caught.value.key) == (str(spec), 3, "smoothign")
    with pytest.raises(motionedit.SpecError) as caught:
        motionedit.edit_prioritized(
            "data/walk.bvh", {"constraints": [{**WAVE, "effector": "LeftHnd"}]}, events={"wave": 4}
        )
    assert (caught.value.file, caught.value.key) == ("spec", "constraints.0.effector")
    assert caught.value.errors == (caught.value,)
    with pytest.raises(motionedit.MotionEditErrors) as group:
        motionedit.edit_prioritized("data/walk.bvh", {"constraints": [], "a": 1, "b": 2})
    assert [error.key for error in group.value.errors] == ["a", "b"]


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("constraints: []", "'constraints: []'"),
        ("{constraints: []}", "'{constraints: []}'"),
        ("schema: motionedit/edit-prioritized/v1\nconstraints: []\n", "'schema: motionedit/edit-prioritized/..."),
        ("# reach\n" * 1000, "'# reach\\n# reach\\n# reach\\n# reach\\n..."),
    ],
)
def test_a_spec_s_text_is_told_from_a_path(text, shown):
    wanted = [f"{shown} looks like YAML text; give a spec as a path or a mapping"]
    assert refused(motionedit.edit_prioritized, "data/walk.bvh", text) == wanted
    assert refused(motionedit.normalize, "data/golf", text) == wanted


def test_a_file_whose_name_looks_like_yaml_is_a_spec(tmp_path, monkeypatch):
    shutil.copy(ROOT / "data" / "walk.bvh", tmp_path)
    monkeypatch.chdir(tmp_path)
    Path("spec: one").write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\n")
    assert motionedit.edit_prioritized("walk.bvh", "spec: one").report["status"] == "ok"


def test_long_texts_are_not_shown_whole():
    for text, words in (
        ("x" * 9000, "too long"),
        ("HIERARCHY\nROOT\n" * 900, "several lines"),
        ("y\0" * 9000, "no file"),
    ):
        for call in (motionedit.read, motionedit.normalize):
            (line,) = refused(call, text, *([{}] if call is motionedit.normalize else []))
            assert words in line
            assert len(line) < 120


@pytest.mark.parametrize(
    ("value", "shown"), [("2", "'2'"), (None, "None"), (1.5, "1.5"), (-1, "-1"), (True, "True"), ([1], "a list")]
)
def test_a_number_of_workers_is_a_whole_number(value, shown):
    for name, call, arguments in (
        ("jobs", motionedit.normalize, ("data/golf", {})),
        ("jobs", motionedit.fit_pca, ("data/golf",)),
        ("threads", motionedit.edit_prioritized, ("data/walk.bvh", NOTHING)),
    ):
        with pytest.raises(motionedit.UsageError) as caught:
            call(*arguments, **{name: value})
        assert str(caught.value) == f"{name} must be a whole number, 1 or more, or 0 for all cores; not {shown}"


@pytest.mark.parametrize(("value", "shown"), [("yes", "'yes'"), (None, "None"), (1, "1"), ([], "a list")])
def test_a_switch_is_true_or_false(value, shown, fitted, tmp_path):
    for call, arguments in (
        (motionedit.read, ("data/walk.bvh",)),
        (motionedit.normalize, ("data/golf", {})),
        (motionedit.edit_pc, (SWING, fitted, {"goals": []})),
        (motionedit.edit_prioritized, ("data/walk.bvh", NOTHING)),
    ):
        with pytest.raises(motionedit.UsageError) as caught:
            call(*arguments, lenient=value)
        assert str(caught.value) == f"lenient must be True or False, not {shown}"
    edit = motionedit.edit_prioritized("data/walk.bvh", NOTHING)
    assert refused(edit.write, tmp_path / "x.bvh", page=value) == [f"page must be True or False, not {shown}"]
    assert list(tmp_path.iterdir()) == []


def test_numbers_and_switches_of_numpy_are_taken():
    edit = motionedit.edit_prioritized("data/walk.bvh", NOTHING, threads=np.int32(2), lenient=np.bool_(0))
    assert edit.report["status"] == "ok"


def test_a_result_of_many_clips_is_no_clip(fitted, normalized):
    for result in (fitted, normalized):
        (line,) = refused(motionedit.edit_prioritized, result, NOTHING)
        assert line.endswith(f"not a value of type {type(result).__name__}; give one of its clips, such as its .clip")


def test_what_is_no_clip_no_spec_and_no_model_is_refused(fitted):
    assert refused(motionedit.read, 3) == ["must be a path, not a value of type int"]
    assert refused(motionedit.read, "-") == ["'-' is no file; give a path"]
    assert refused(motionedit.read, "a\0b") == ["'a\\x00b' is no file; give a path"]
    assert refused(motionedit.edit_prioritized, "data/walk.bvh", NOTHING, events=[94]) == [
        "events must be a mapping of names to frames, such as {'hit': 94}"
    ]
    assert refused(motionedit.read, "nix.bvh") == ["nix.bvh: cannot be read: No such file or directory"]
    assert refused(motionedit.edit_prioritized, None, NOTHING) == [
        "must be a clip, as a path, a Clip or an Edited, not a value of type NoneType"
    ]
    assert refused(motionedit.edit_prioritized, "nix.bvh", NOTHING) == ["nix.bvh: no such file or folder"]
    assert refused(motionedit.edit_prioritized, "data/golf", NOTHING) == [
        "data/golf: is a folder; an edit takes one clip"
    ]
    assert refused(motionedit.edit_prioritized, "data/walk.bvh", []) == [
        "must be a spec, as a path or a mapping, not a value of type list"
    ]
    assert "no such file" in refused(motionedit.edit_prioritized, "data/walk.bvh", "nix.yaml")[0]
    assert refused(motionedit.edit_pc, SWING, 3, {"goals": []})
    assert refused(motionedit.edit_pc, SWING, {"components": 3}, "configs/golf-edit.yaml") == [
        "must be a model, as a path or what fit_pca returned, not a value of type dict"
    ]
    assert "cannot be read" in refused(motionedit.edit_pc, SWING, "nix.npz", "configs/golf-edit.yaml")[0]
    assert (
        "another skeleton than the model (in memory)"
        in refused(motionedit.edit_pc, "data/walk.bvh", fitted, "configs/golf-edit.yaml")[0]
    )


def test_what_cannot_be_normalized_or_fitted_is_refused():
    assert refused(motionedit.normalize, [], {}) == ["no clip is given"]
    assert refused(motionedit.normalize, 3, {}) == ["must be clips or folders, not a value of type int"]
    assert refused(motionedit.normalize, [3], {}) == [
        "must be a clip, as a path, a Clip or an Edited, not a value of type int"
    ]
    assert refused(motionedit.normalize, "data/golf", {}, jobs=-1) == [
        "jobs must be a whole number, 1 or more, or 0 for all cores; not -1"
    ]
    swing = motionedit.read(SWING)
    both = "data/golf/swing04.bvh and data/golf/swing04.bvh would both be called swing04.bvh; "
    assert refused(motionedit.normalize, [SWING, SWING], {}) == [f"{both}give the folder that both are below"]
    for clips in ([swing, swing], [swing, SWING]):
        assert refused(motionedit.normalize, clips, {}) == [
            f"{both}give one another label, such as dataclasses.replace(clip, label='other.bvh')"
        ]
    one = motionedit.normalize(swing, {})
    assert refused(motionedit.fit_pca, one) == ["normalized clips: lists 1 clip; a PCA needs two or more"]
    assert refused(motionedit.fit_pca, "data/golf") == [
        "data/golf/normalization.json: not there; 'motionedit normalize' writes it beside the clips"
    ]
    what = "give the folder that 'motionedit normalize' wrote"
    assert refused(motionedit.fit_pca, SWING) == [f"{SWING}: is a file, not a folder; {what}"]
    assert refused(motionedit.fit_pca, "nix") == [f"nix: no such folder; {what}"]
    assert "what normalize returned, or its folder" in refused(motionedit.fit_pca, swing)[0]


def test_every_clip_that_cannot_be_normalized_is_named(tmp_path):
    for name in ("a.bvh", "b.bvh"):
        (tmp_path / name).write_text("HIERARCHY\n")
    lines = refused(motionedit.normalize, [tmp_path, SWING], {})
    assert [line.partition(":")[0] for line in lines] == [str(tmp_path / "a.bvh"), str(tmp_path / "b.bvh")]


def test_what_the_system_says_of_a_folder_is_an_error_of_the_face(monkeypatch):
    def denied(top, **_):
        raise PermissionError(13, "Permission denied", str(top))

    monkeypatch.setattr("os.walk", denied)
    assert refused(motionedit.normalize, "data/golf", {}) == ["data/golf: Permission denied"]


def test_an_error_that_is_no_user_s_is_raised_as_it_is(monkeypatch):
    def broken(*_, **__):
        raise ZeroDivisionError("ours")

    monkeypatch.setattr("motionedit.jobs.edit_prioritized.job.facts_of", broken)
    with pytest.raises(ZeroDivisionError, match="ours"):
        motionedit.edit_prioritized("data/walk.bvh", "configs/reach.yaml")


def test_a_group_of_faults_is_one_error_and_can_be_taken_apart():
    inner = motionedit.MotionEditErrors("inner", [ClipError("third", file="b.bvh")])
    group = motionedit.MotionEditErrors("all", [SpecError("first", file="s.yaml", line=2), UsageError("second"), inner])
    copied = pickle.loads(pickle.dumps(group))  # noqa: S301  our own
    for one in (group, copied):
        assert isinstance(one, motionedit.MotionEditError)
        assert str(one) == "s.yaml:2: first\nsecond\nb.bvh: third"
        assert [type(error) for error in one.errors] == [SpecError, UsageError, ClipError]
        assert (one.message, one.exit_code, one.file, one.line, one.key) == ("all", 2, None, None, None)
    kinds = []
    try:
        raise group
    except* SpecError as specs:
        kinds += specs.exceptions
    except* motionedit.MotionEditError as others:
        kinds += others.exceptions
    assert len(kinds) == 3
