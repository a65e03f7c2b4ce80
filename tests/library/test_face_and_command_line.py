"""What the face returns is what the command line writes for the same clip and spec: bytes, reports, warnings."""

from pathlib import Path

import pytest

import motionedit

SWING = "data/golf/swing04.bvh"


def without_output(record):
    return {**record, "output": None}


def test_normalized_clips_are_those_of_the_command_line(command_line, tmp_path):
    report = command_line(
        "normalize", "data/golf", "-s", "configs/golf-normalize.yaml", "-o", tmp_path / "a", report="normalize"
    )
    result = motionedit.normalize("data/golf", "configs/golf-normalize.yaml")
    result.write(tmp_path / "b")
    names = sorted(path.name for path in (tmp_path / "a").glob("[!.]*"))
    assert sorted(path.name for path in (tmp_path / "b").glob("[!.]*")) == names
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert result.report == {**report, "clips": [without_output(record) for record in report["clips"]]}
    assert list(result.warnings) == command_line.warnings
    assert result.clip is result.clips[0]


def test_a_model_is_that_of_the_command_line_from_memory_and_from_a_folder(command_line, tmp_path, normalized):
    folder, spec = normalized.write(tmp_path / "normalized"), "configs/golf-fit.yaml"
    report = command_line("fit-pca", folder, "-s", spec, "-o", tmp_path / "a.npz", report="fit")
    for source in (normalized, folder, str(folder)):
        result = motionedit.fit_pca(source, spec)
        assert result.write(tmp_path / "b.npz").read_bytes() == (tmp_path / "a.npz").read_bytes()
        assert result.report == report
        assert list(result.warnings) == command_line.warnings


@pytest.mark.parametrize("source", ["fit", "model", "file"])
@pytest.mark.parametrize("spec", ["golf-edit", "golf-edit-paper"])
def test_an_edit_by_a_model_is_that_of_the_command_line(command_line, tmp_path, fitted, source, spec):
    model, spec = fitted.write(tmp_path / "golf.npz"), f"configs/{spec}.yaml"
    report = command_line("edit-pc", SWING, "-m", model, "-s", spec, "-o", tmp_path / "a.bvh", report="edit")
    result = motionedit.edit_pc(SWING, {"fit": fitted, "model": fitted.model, "file": model}[source], spec)
    assert result.write(tmp_path / "b.bvh").read_bytes() == (tmp_path / "a.bvh").read_bytes()
    assert result.report == without_output(report["clips"][0])
    assert list(result.warnings) == command_line.warnings


@pytest.mark.parametrize("spec", [pytest.param("stairs", marks=pytest.mark.compiled), "reach"])
def test_an_edit_by_priorities_is_that_of_the_command_line(command_line, tmp_path, spec):
    spec = f"configs/{spec}.yaml"
    report = command_line("edit-prioritized", "data/walk.bvh", "-s", spec, "-o", tmp_path / "a.bvh", report="edit")
    for clip in ("data/walk.bvh", Path("data/walk.bvh"), motionedit.read("data/walk.bvh")):
        result = motionedit.edit_prioritized(clip, spec)
        assert result.write(tmp_path / "b.bvh").read_bytes() == (tmp_path / "a.bvh").read_bytes()
        assert result.clip.text.data == (tmp_path / "a.bvh").read_bytes()
        assert result.report == without_output(report["clips"][0])
        assert list(result.warnings) == command_line.warnings


def test_what_is_out_of_reach_is_told_in_the_same_words(command_line, tmp_path):
    spec = tmp_path / "far.yaml"
    spec.write_text(
        "schema: motionedit/edit-prioritized/v1\n"
        "constraints: [{name: hand, type: position, effector: LeftHand, priority: 1, recruit: {levels: 2},\n"
        "  points: [{hold: [40, 60], position: [0, 900, 0]}]}]\n"
    )
    command_line("edit-prioritized", "data/walk.bvh", "-s", spec, "-o", tmp_path / "a.bvh")
    result = motionedit.edit_prioritized("data/walk.bvh", spec)
    assert list(result.warnings) == command_line.warnings
    assert any("hand" in warning for warning in result.warnings)
    assert result.report["status"] in ("unreachable", "out_of_tolerance")


def test_leniency_is_that_of_the_command_line(command_line, tmp_path):
    short = tmp_path / "short.bvh"
    short.write_bytes(Path("data/walk.bvh").read_bytes().replace(b"Frames: 145", b"Frames: 150"))
    with pytest.raises(motionedit.MotionEditError, match="Frames: says 150"):
        motionedit.read(short)
    clip = motionedit.read(short, lenient=True)
    for spec, constraints in (("reach", None), ("none", [])):
        path = f"configs/{spec}.yaml" if constraints is None else tmp_path / "none.yaml"
        if constraints is not None:
            path.write_text("schema: motionedit/edit-prioritized/v1\nconstraints: []\n")
        command_line("edit-prioritized", short, "-s", path, "-o", tmp_path / "a.bvh", "--lenient")
        result = motionedit.edit_prioritized(clip, path)
        assert result.write(tmp_path / "b.bvh").read_bytes() == (tmp_path / "a.bvh").read_bytes()
        assert list(result.warnings) == command_line.warnings
        same = motionedit.edit_prioritized(short, path, lenient=True)
        assert same.clip.text.data == result.clip.text.data
        assert list(same.warnings) == command_line.warnings
        with pytest.raises(motionedit.BvhError, match="Frames: says 150"):
            motionedit.edit_prioritized(short, path)


def test_leniency_of_an_edit_by_a_model_is_that_of_the_command_line(command_line, tmp_path, fitted):
    short, model, spec = tmp_path / "short.bvh", fitted.write(tmp_path / "golf.npz"), tmp_path / "edit.yaml"
    short.write_bytes(Path(SWING).read_bytes().replace(b"Frames: 121", b"Frames: 150"))
    spec.write_text(
        "schema: motionedit/edit-pc/v1\nevents: {hit: 85}\n"
        "goals: [{at: hit, effector: {end_site: Club}, shift: [0, 0, 3]}]\n"
    )
    command_line("edit-pc", short, "-m", model, "-s", spec, "-o", tmp_path / "a.bvh", "--lenient")
    with pytest.raises(motionedit.BvhError, match="Frames: says 150"):
        motionedit.edit_pc(short, model, spec)
    result = motionedit.edit_pc(short, model, spec, lenient=True)
    assert result.clip.text.data == (tmp_path / "a.bvh").read_bytes()
    assert list(result.warnings) == command_line.warnings


@pytest.mark.parametrize("read", [str, motionedit.read], ids=["path", "memory"])
def test_a_page_is_that_of_the_command_line_for_the_same_paths(command_line, tmp_path, fitted, read):
    model = fitted.write(tmp_path / "golf.npz")
    outputs = [tmp_path / "out" / name for name in ("walk-reach.bvh", "swing04.bvh")]
    command_line("edit-prioritized", "data/walk.bvh", "-s", "configs/reach.yaml", "-o", outputs[0], "--preview")
    command_line("edit-pc", SWING, "-m", model, "-s", "configs/golf-edit.yaml", "-o", outputs[1], "--preview")
    pages = [output.with_suffix(".html").read_bytes() for output in outputs]
    edits = [
        motionedit.edit_prioritized(read("data/walk.bvh"), "configs/reach.yaml"),
        motionedit.edit_pc(read(SWING), fitted, "configs/golf-edit.yaml"),
    ]
    for edit, output, page in zip(edits, outputs, pages, strict=True):
        output.with_suffix(".html").unlink()
        assert edit.write(output, page=True) == output
        assert output.with_suffix(".html").read_bytes() == page
    assert edits[0].page().replace(b"walk-edited", b"walk-reach") == pages[0]


def test_any_number_of_workers_and_threads_gives_the_same(normalized, fitted):
    swings = motionedit.normalize("data/golf", "configs/golf-normalize.yaml", jobs=2)
    assert [clip.text.data for clip in swings.clips] == [clip.text.data for clip in normalized.clips]
    again = motionedit.fit_pca(swings, "configs/golf-fit.yaml", jobs=2)
    assert (again.model.components.components == fitted.model.components.components).all()
    one, two = (motionedit.edit_prioritized("data/walk.bvh", "configs/reach.yaml", threads=n) for n in (1, 2))
    assert one.clip.text.data == two.clip.text.data
