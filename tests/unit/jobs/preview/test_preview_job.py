import importlib.util
from pathlib import Path

import numpy as np
import pytest
from mannequin import bvh_text

from motionedit.errors import BvhError, ClipError, MotionEditErrors, UsageError
from motionedit.jobs.batch.plan import find_clips
from motionedit.jobs.preview import job as preview


@pytest.fixture
def clip(tmp_path):
    path = tmp_path / "swing.bvh"
    path.write_text(bvh_text())
    return path


def bodies_of(*paths):
    clips = preview._clips(find_clips(paths), lenient=False)
    return [figure.body for figure in preview._figures(clips, [path.stem for path in paths], {})]


def test_a_page_is_written_and_named(clip, tmp_path):
    target = tmp_path / "new" / "swing.html"
    assert preview.run([clip], target) == [target]
    assert b"<title>swing - motionedit preview</title>" in target.read_bytes()


def test_another_ending_is_refused_with_the_ones_there_are(clip, tmp_path):
    with pytest.raises(UsageError, match=r"swing\.gif: .*\.html.*\.png.*\.svg"):
        preview.run([clip], tmp_path / "swing.gif")


def test_more_clips_than_a_picture_shows_are_refused_before_any_is_read(tmp_path):
    for n in range(101):
        (tmp_path / f"{n}.bvh").write_text("")
    with pytest.raises(UsageError, match=r"101 clips are too many for one picture; give 100 of them at most"):
        preview.run([tmp_path], tmp_path / "all.html")


def test_a_sheet_without_matplotlib_names_the_extra(clip, tmp_path, monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr("motionedit.report.sheet.find_spec", lambda name: None if name == "matplotlib" else find(name))
    with pytest.raises(UsageError, match=r"motionedit\[plot\]"):
        preview.run([clip], tmp_path / "swing.png")


def test_a_clip_that_cannot_be_read_fails_the_page_and_nothing_is_written(clip, tmp_path):
    (tmp_path / "bad.bvh").write_text("HIERARCHY\n")
    target = tmp_path / "out" / "x.html"
    with pytest.raises(BvhError, match=r"bad\.bvh"):
        preview.run([clip, tmp_path / "bad.bvh"], target)
    (tmp_path / "worse.bvh").write_text("")
    with pytest.raises(MotionEditErrors) as caught:
        preview.run([tmp_path], target)
    assert len(caught.value.exceptions) == 2
    assert not target.exists()


def test_a_place_that_cannot_be_written_is_named(clip, tmp_path):
    with pytest.raises(ClipError, match=r"x\.html: cannot be written"):
        preview.run([clip], clip / "x.html")
    assert clip.read_text() == bvh_text()
    assert not list(tmp_path.glob("**/.*"))


def test_a_clip_in_metres_is_shown_at_the_size_of_one_in_centimetres(clip, tmp_path):
    metres = tmp_path / "metres.bvh"
    metres.write_text(bvh_text(scale=0.01))
    first, second = bodies_of(clip, metres)
    assert first.scale == 1.0
    assert second.scale == pytest.approx(100.0)
    np.testing.assert_allclose(second.positions, first.positions, atol=0.01)
    assert second.limbs[0].radii == pytest.approx(first.limbs[0].radii, rel=1e-3)
    assert second.size == pytest.approx(first.size)


def test_another_person_is_not_resized(clip, tmp_path):
    child = tmp_path / "child.bvh"
    child.write_text(bvh_text(scale=0.7))
    assert [body.scale for body in bodies_of(clip, child)] == [1.0, 1.0]


@pytest.mark.parametrize(
    ("labels", "short"),
    [
        (["data/walk.bvh"], ["walk"]),
        (["data/walk.bvh", "out/kick.bvh"], ["walk", "kick"]),
        (["data/walk.bvh", "out/walk.bvh"], ["data/walk", "out/walk"]),
        (["walk.bvh", "out/./walk.bvh"], ["walk", "out/walk"]),
        (["a/x/w.bvh", "b/x/w.bvh", "b/y/w.bvh"], ["a/x/w", "b/x/w", "b/y/w"]),
        (["walk.bvh", "walk.bvh"], ["walk", "walk"]),
        (["<stdin>"], ["<stdin>"]),
    ],
)
def test_labels_keep_only_the_folders_that_tell_them_apart(labels, short):
    assert preview.short_labels([str(Path(label)) for label in labels]) == short
