"""A notebook's session: clips in memory from step to step, specs as mappings, nothing printed, nothing changed."""

import copy
import doctest
import os
import shutil
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.core.kinematics import forward

ROOT = Path(__file__).resolve().parents[2]
SWING = "data/golf/swing04.bvh"

HAND = {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 1}
RAISED = {"constraints": [{**HAND, "points": [{"hold": [40, 60], "shift": [0, 15, 0]}]}]}
BALL = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}}


def test_a_clip_is_edited_in_three_lines(tmp_path):
    edit = motionedit.edit_prioritized("data/walk.bvh", RAISED)
    assert edit.report["status"] == "ok"
    written = motionedit.read(edit.write(tmp_path / "walk.bvh"))
    assert (written.motion.rotations == edit.clip.motion.rotations).all()
    assert edit.clip.motion.rotations.shape == (145, 31, 4)


def test_swings_are_normalized_fitted_and_edited_in_memory(tmp_path, monkeypatch, mapping):
    folder = tmp_path / "golf"
    shutil.copytree(ROOT / "data" / "golf", folder)
    clips = [motionedit.read(path) for path in sorted(folder.glob("*.bvh"))]
    spec = mapping("golf-normalize")
    spec["events"]["hit"]["frames"] = {"swing01": 85}
    shutil.rmtree(folder)
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path / "empty")
    swings = motionedit.normalize(clips, spec)
    fit = motionedit.fit_pca(swings, {"components": 6})
    edit = motionedit.edit_pc(clips[3], fit, {"goals": [{**BALL, "shift": [0, 0, 6]}]})
    hands = motionedit.edit_prioritized(edit.clip, RAISED)
    assert [result.report["status"] for result in (edit, hands)] == ["ok", "ok"]
    assert hands.clip.label == clips[3].label
    assert list(Path().iterdir()) == []
    assert list(tmp_path.iterdir()) == [tmp_path / "empty"]


def test_an_edit_goes_on_from_a_normalized_clip(fitted, normalized):
    edit = motionedit.edit_pc(
        normalized.clips[3],
        fitted,
        {"goals": [{**BALL, "at": 66, "shift": [0, 0, 3]}]},
        events={"hit": dict(normalized.normalization.timeline.events)["hit"]},
    )
    assert edit.report["status"] == "ok"
    assert edit.clip.label == "swing04.bvh"


def test_the_clip_of_a_model_is_its_mean_and_can_be_edited(fitted, normalized):
    mean, motions = fitted.clip, [clip.motion for clip in normalized.clips]
    hips = np.mean([forward(motion).positions[:, 0] for motion in motions], axis=0)
    assert forward(mean.motion).positions[:, 0] == pytest.approx(hips, abs=1e-6)
    # Rotations near each other: their mean is between them.
    club = mean.motion.skeleton.names.index("Club")
    paths = np.array([forward(motion).positions[:, club] for motion in motions])
    away = np.linalg.norm(forward(mean.motion).positions[:, club] - paths.mean(axis=0), axis=1)
    assert away.max() < 0.5 * np.linalg.norm(paths - paths.mean(axis=0), axis=-1).max()
    hit = dict(fitted.model.timeline.events)["hit"]
    edit = motionedit.edit_pc(mean, fitted, {"goals": [{**BALL, "shift": [0, 0, 3]}]}, events={"hit": hit})
    assert edit.report["status"] == "ok"
    assert np.abs(edit.report["alpha"]["before"]).max() < 0.01  # aligned anew


def test_nothing_that_is_given_is_changed(fitted, mapping):
    clip, spec = motionedit.read(SWING), mapping("golf-edit")
    before, rotations, content = copy.deepcopy(spec), clip.motion.rotations.copy(), clip.text.data
    coefficients = fitted.model.components.coefficients.copy()
    motionedit.edit_pc(clip, fitted, spec)
    assert spec == before
    assert (clip.motion.rotations == rotations).all()
    assert clip.text.data == content
    assert (fitted.model.components.coefficients == coefficients).all()
    with pytest.raises(ValueError, match="read-only"):
        clip.motion.rotations[0] = 0.0


def test_nothing_is_printed_and_the_environment_stays(fitted, capsys):
    before = dict(os.environ)
    far = {**HAND, "points": [{"hold": [40, 60], "position": [0, 900, 0]}]}
    edit = motionedit.edit_prioritized("data/walk.bvh", {"constraints": [far]})
    motionedit.edit_pc(SWING, fitted, "configs/golf-edit.yaml")
    assert edit.warnings
    assert capsys.readouterr() == ("", "")
    assert dict(os.environ) == before


@pytest.mark.compiled
def test_a_mapping_says_what_a_file_says(mapping):
    spec = mapping("stairs")
    from_file = motionedit.edit_prioritized("data/walk.bvh", "configs/stairs.yaml")
    assert motionedit.edit_prioritized("data/walk.bvh", spec).clip.text.data == from_file.clip.text.data
    del spec["schema"]
    assert motionedit.edit_prioritized("data/walk.bvh", spec).clip.text.data == from_file.clip.text.data


def test_arrays_tuples_and_numbers_of_numpy_stand_for_lists_and_numbers():
    points = ({"hold": np.array([40, 60]), "shift": np.array([0.0, 15.0, 0.0])},)
    hand = {**HAND, "priority": np.int64(1), "weight": np.float64(1.0), "points": points}
    edit = motionedit.edit_prioritized("data/walk.bvh", {"constraints": (hand,)})
    assert edit.clip.text.data == motionedit.edit_prioritized("data/walk.bvh", RAISED).clip.text.data


def test_paths_in_a_mapping_are_relative_to_the_working_folder(tmp_path, monkeypatch):
    for n in (1, 2):
        shutil.copy(ROOT / "data" / "golf" / f"swing0{n}.bvh", tmp_path)
    (tmp_path / "hits.csv").write_text("clip,frame\nswing01,84\nswing02,91\n")
    monkeypatch.chdir(tmp_path)
    for table in ("hits.csv", Path("hits.csv"), tmp_path / "hits.csv"):
        result = motionedit.normalize(["swing01.bvh", "swing02.bvh"], {"events": {"hit": {"frames": table}}})
        assert [clip.events["hit"] for clip in result.normalization.clips] == [84, 91]
    assert Path("hits.csv") in result.inputs or tmp_path / "hits.csv" in result.inputs


def test_events_of_a_clip_take_the_place_of_the_spec_s(fitted):
    spec = {"goals": [{**BALL, "shift": [0, 0, 3]}], "events": {"hit": 80}}
    assert motionedit.edit_pc(SWING, fitted, spec).report["goals"][0]["frame"] == 80
    assert motionedit.edit_pc(SWING, fitted, spec, events={"hit": 88}).report["goals"][0]["frame"] == 88
    point = {"at": "wave", "shift": [0, 15, 0]}
    waving = {"constraints": [{**HAND, "points": [point]}], "events": {"wave": 50}}
    moved = motionedit.edit_prioritized("data/walk.bvh", waving, events={"wave": np.int64(70)})
    same = motionedit.edit_prioritized("data/walk.bvh", {**waving, "events": {"wave": 70}})
    assert moved.clip.text.data == same.clip.text.data
    assert waving["events"] == {"wave": 50}


def test_an_edit_that_changes_nothing_returns_the_clip_itself():
    clip = motionedit.read("data/walk.bvh")
    assert motionedit.edit_prioritized(clip, {"constraints": []}).clip is clip


def test_an_edited_clip_can_be_edited_and_normalized_as_it_is(fitted):
    first = motionedit.edit_pc(SWING, fitted, {"goals": [{**BALL, "shift": [0, 0, 3]}]})
    second = motionedit.edit_prioritized(first, RAISED)
    assert second.before is first.clip
    assert second.clip.text.data == motionedit.edit_prioritized(first.clip, RAISED).clip.text.data
    assert motionedit.normalize([first, "data/golf/swing05.bvh"], {}).clips[0].label == "swing04.bvh"


def test_whole_numbers_of_other_libraries_are_frames_of_events():
    class Whole:
        def __index__(self):
            return 70

    waving = {"constraints": [{**HAND, "points": [{"at": "wave", "shift": [0, 15, 0]}]}]}
    edits = [
        motionedit.edit_prioritized("data/walk.bvh", waving, events={"wave": n}) for n in (70, np.int16(70), Whole())
    ]
    assert len({edit.clip.text.data for edit in edits}) == 1


def test_a_page_is_written_over_no_input(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "data" / "walk.bvh", "walk.bvh")
    Path("edit.html").write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\n")
    edit = motionedit.edit_prioritized("walk.bvh", "edit.html")
    with pytest.raises(motionedit.UsageError, match=r"edit\.html: is an input"):
        edit.write("edit.bvh", page=True)
    assert not Path("edit.bvh").exists()


def test_results_are_short_where_they_are_shown(fitted, normalized):
    edit = motionedit.edit_prioritized("data/walk.bvh", RAISED)
    assert repr(edit) == "<Edited 'data/walk.bvh': ok, 145 frames>"
    assert repr(edit.clip) == "<Clip 'data/walk.bvh': 145 frames, 31 joints, 24 Hz>"
    assert repr(normalized) == "<Normalized: 10 clips of 131 frames>"
    assert repr(fitted) == f"<Fitted: {len(fitted.model.components.explained_variance)} components of 10 clips>"


def test_the_module_lists_what_it_has():
    assert set(motionedit.__all__) <= set(dir(motionedit))
    for name in motionedit.__all__:
        assert getattr(motionedit, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'fit'"):
        motionedit.fit  # noqa: B018


FUNCTIONS = ("read", "normalize", "fit_pca", "edit_pc", "edit_prioritized")


@pytest.mark.parametrize("place", ["", ".core.bvh.read", *(f".library.{name}" for name in FUNCTIONS)])
def test_examples_in_docstrings_run(place, tmp_path, monkeypatch):
    for folder in ("data", "configs"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)
    module = import_module(f"motionedit{place}")
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    done = doctest.testmod(module, extraglobs={"motionedit": motionedit}, optionflags=flags)
    assert done.failed == 0
    assert done.attempted > 0
