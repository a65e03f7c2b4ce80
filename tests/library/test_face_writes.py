"""What the functions of `import motionedit` write over, and what not."""

import shutil
from pathlib import Path

import pytest

import motionedit

ROOT = Path(__file__).resolve().parents[2]
NOTHING = {"constraints": []}


def refused(call, *arguments, **options):
    with pytest.raises(motionedit.MotionEditError) as caught:
        call(*arguments, **options)
    return str(caught.value).splitlines()


def test_an_input_is_never_overwritten_under_any_name_or_after_any_number_of_steps(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "data" / "walk.bvh", "walk.bvh")
    shutil.copy(ROOT / "configs" / "reach.yaml", "reach.yaml")
    Path("link.bvh").symlink_to("walk.bvh")
    before = Path("walk.bvh").read_bytes()
    first = motionedit.edit_prioritized("walk.bvh", "reach.yaml")
    second = motionedit.edit_prioritized(first.clip, NOTHING)
    normalized = motionedit.normalize("walk.bvh", {})
    for edit in (first, second):
        for name in ("walk.bvh", tmp_path / "walk.bvh", "link.bvh", "."):
            assert "an input is never overwritten" in refused(edit.write, name)[0]
    assert "an input is never overwritten" in refused(normalized.write, ".")[0]
    assert sorted(path.name for path in Path().iterdir()) == ["link.bvh", "reach.yaml", "walk.bvh"]
    assert Path("walk.bvh").read_bytes() == before


def test_an_input_is_not_overwritten_after_the_working_folder_has_changed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "data" / "golf", "golf")
    Path("reach.yaml").write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\n")
    clip, path = motionedit.read("golf/swing01.bvh"), "golf/swing01.bvh"
    normalized = motionedit.normalize("golf", {"events": {"hit": {"frames": "golf/events.csv"}}})
    made = motionedit.fit_pca(normalized.write("normalized"))
    model = made.write("model.npz")
    edits = [motionedit.edit_prioritized(one, "reach.yaml") for one in (clip, path)]
    edits += [motionedit.edit_prioritized(edits[0], NOTHING), motionedit.edit_prioritized(normalized.clips[0], NOTHING)]
    edits.append(motionedit.edit_pc(path, model, {"goals": []}))
    Path("elsewhere").mkdir()
    monkeypatch.chdir("elsewhere")
    for edit in edits:
        assert "an input is never overwritten" in refused(edit.write, "../golf/swing01.bvh")[0]
    again = motionedit.edit_prioritized(edits[1], NOTHING)
    assert "an input is never overwritten" in refused(again.write, "../golf/swing01.bvh")[0]
    for clip in (edits[1].clip, normalized.clips[0]):
        assert "an input is never overwritten" in refused(motionedit.write, clip, "../golf/swing01.bvh")[0]
    for result in (*edits, normalized, made):
        assert all(each.is_absolute() and each.exists() for each in result.inputs)
    assert {tmp_path / "model.npz", tmp_path / path} == set(edits[-1].inputs)
    assert tmp_path / "golf" / "events.csv" in normalized.inputs
    assert "an input is never overwritten" in refused(normalized.write, "../golf")[0]
    assert "an input is never overwritten" in refused(made.write, "../normalized/swing01.bvh")[0]


def test_a_clip_from_memory_may_take_any_free_name(tmp_path, monkeypatch):
    edit = motionedit.edit_prioritized("data/walk.bvh", NOTHING)
    monkeypatch.chdir(tmp_path)
    assert edit.write("walk.bvh") == Path("walk.bvh")
    assert edit.write("new/folder") == Path("new/folder/walk.bvh")
    assert edit.write("walk.bvh").read_bytes() == edit.clip.text.data


def test_what_cannot_be_written_leaves_what_was_there(tmp_path, fitted, normalized, monkeypatch):
    edit = motionedit.edit_prioritized("data/walk.bvh", "configs/reach.yaml")
    target = tmp_path / "walk.bvh"
    target.write_text("old")
    (tmp_path / "file").write_text("no folder")
    assert "cannot be written" in refused(edit.write, tmp_path / "file" / "walk.bvh")[0]
    assert refused(edit.write, "-") == ["'-' is no file; give a path"]
    assert "several files are written" in refused(normalized.write, tmp_path / "a.bvh")[0]
    assert "give a name such as model.npz" in refused(fitted.write, tmp_path)[0]

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.urandom", full)
    assert refused(edit.write, target) == [f"{target}: cannot be written: No space left on device"]
    assert target.read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "walk.bvh"]
