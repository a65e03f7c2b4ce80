"""The touched rows of a short clip are written at once: to the bytes that the way of all clips comes to."""

from dataclasses import replace

import numpy as np
import pytest
from small_clip import HIERARCHY

from motionedit.core import rotations as rot
from motionedit.core.bvh import edited_bytes, parse_clip, splice
from motionedit.core.compiled import compiled
from motionedit.errors import BvhError

pytestmark = pytest.mark.skipif(compiled() is None, reason="only the compiled part knows that way")
FRAMES = 60
MOTION = f"MOTION\nFrames: {FRAMES}\nFrame Time: 0.01\n"


@pytest.fixture
def ways(monkeypatch):
    """Return what was written at once so far: None for each edit that was not."""
    found, short_edit = [], splice.short_edit
    monkeypatch.setattr(splice, "short_edit", lambda *given: found.append(short_edit(*given)) or found[-1])
    return found


def clip_of(rows, *, hierarchy=HIERARCHY, gap=" "):
    text = "\n".join(gap.join(f"{value:.5f}" for value in row) for row in rows)
    return parse_clip(f"{hierarchy}{MOTION}{text}\n".encode(), label="clip.bvh")


def walk(seed, *, scale=3.0):
    return np.cumsum(np.random.default_rng(seed).normal(scale=scale, size=(FRAMES, 9)), axis=0)


def edit_of(clip, seed, *, most=2.0):
    """Return a motion that turns and moves a little, and where that is taken: some runs of frames of each joint."""
    rng = np.random.default_rng(seed)
    turns = rot.about_axis(0, np.radians(rng.uniform(-most, most, size=(FRAMES, 2))))
    rotations = rot.multiply(turns, clip.motion.rotations)
    translations = clip.motion.translations + rng.normal(size=clip.motion.translations.shape)
    touched = np.repeat(rng.random((FRAMES // 6, 2)) < 0.5, 6, axis=0)
    moved = np.repeat(rng.random((FRAMES // 6, clip.motion.translations.shape[1])) < 0.3, 6, axis=0)
    return replace(clip.motion, rotations=rotations, translations=translations), touched, moved


def written(monkeypatch, clip, motion, touched, moved):
    """Return the edited bytes as they are written, and by the way of all clips."""
    usual = edited_bytes(clip, motion, touched=touched, moved=moved)
    with monkeypatch.context() as patched:
        patched.setattr(splice, "short_edit", lambda *_: None)
        return usual, edited_bytes(clip, motion, touched=touched, moved=moved)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("gap", [" ", " \t "])
def test_runs_of_touched_frames_are_written_at_once(monkeypatch, ways, seed, gap):
    clip = clip_of(walk(seed), gap=gap)
    usual, other = written(monkeypatch, clip, *edit_of(clip, seed))
    assert usual == other != clip.text.data
    assert None not in ways


@pytest.mark.parametrize("seed", range(12))
def test_edits_that_wind_another_way_round_come_out_the_same(monkeypatch, ways, seed):
    clip = clip_of(walk(seed, scale=60.0))
    usual, other = written(monkeypatch, clip, *edit_of(clip, seed, most=180.0))
    assert usual == other
    assert ways == [None]


def from_frame_20_on():
    touched = np.zeros((FRAMES, 2), dtype=bool)
    touched[20:, 1] = True
    return touched


def test_angles_near_gimbal_lock_come_out_the_same(monkeypatch, ways):
    clip = clip_of(walk(5, scale=0.5))
    rotations = clip.motion.rotations.copy()
    rotations[30:33, 1] = rot.from_euler(np.radians([[10.0, 90.0, 20.0]] * 3), (2, 0, 1))
    motion = replace(clip.motion, rotations=rotations)
    usual, other = written(monkeypatch, clip, motion, from_frame_20_on(), None)
    assert usual == other
    assert ways == [None]


def test_a_run_follows_the_frame_before_it_where_the_input_makes_a_whole_turn(monkeypatch, ways):
    rows = walk(6, scale=0.5)
    rows[20:, 6:] += 360.0
    usual, other = written(monkeypatch, clip_of(rows), clip_of(rows).motion, from_frame_20_on(), None)
    assert usual == other
    assert None not in ways
    assert np.abs(parse_clip(usual, label="clip.bvh").values[20:, 6:]).max() < 180.0


@pytest.mark.parametrize("channels", ["1 Zrotation", "2 Zrotation Xrotation"])
def test_joints_with_fewer_axes_come_out_the_same(monkeypatch, channels):
    hierarchy = HIERARCHY.replace("3 Zrotation Xrotation Yrotation", channels)
    clip = clip_of(walk(1)[:, : 6 + int(channels[0])], hierarchy=hierarchy)
    usual, other = written(monkeypatch, clip, *edit_of(clip, 1))
    assert usual == other != clip.text.data


@pytest.mark.parametrize("wound", [5e8, 7e9])
def test_angles_that_are_wound_up_come_out_the_same(monkeypatch, ways, wound):
    rows = walk(2)
    rows[:, 6] += wound
    usual, other = written(monkeypatch, clip_of(rows), *edit_of(clip_of(rows), 2))
    assert usual == other
    assert ways == [None]


def test_numbers_that_are_too_large_are_written_out_and_those_that_are_none_are_not(monkeypatch):
    clip = clip_of(walk(3))
    motion, touched, moved = edit_of(clip, 3)
    moved[:] = True
    usual, other = written(monkeypatch, clip, replace(motion, translations=motion.translations + 1e16), touched, moved)
    assert usual == other
    broken = replace(motion, translations=motion.translations * np.nan)
    with pytest.raises(BvhError, match="not finite"):
        edited_bytes(clip, broken, touched=touched, moved=moved)


@pytest.mark.parametrize("decimals", [5, 9])
def test_words_of_any_length_are_kept_beside_new_ones(monkeypatch, ways, decimals):
    text = (" ".join(f"{value:0{frame}.{decimals}f}" for value in row) for frame, row in enumerate(walk(4)))
    clip = parse_clip((HIERARCHY + MOTION + "\n".join(text)).encode(), label="clip.bvh")
    usual, other = written(monkeypatch, clip, *edit_of(clip, 4))
    assert usual == other
    assert None not in ways


SHAPES = {"sums": (6, 1, 4), "joints": 1, "columns": 3, "touched": (4, 2)}
SHAPES |= dict.fromkeys(("given", "values", "cells"), (4, 9))
TYPES = dict.fromkeys(("joints", "columns"), np.int64) | dict.fromkeys(("touched", "cells"), np.bool_)


def raw_rows(**other):
    arrays = {name: np.zeros(shape, TYPES.get(name, np.float64)) for name, shape in SHAPES.items()} | other
    return compiled().touched_rows(*arrays.values(), 1, 2, 4, 9, 1.0, 2.0, 1.0)


@pytest.mark.parametrize("name", SHAPES)
def test_buffers_of_a_wrong_size_are_an_error_and_no_crash(name):
    assert raw_rows() is True
    with pytest.raises(ValueError, match="bytes instead of"):
        raw_rows(**{name: np.zeros(0)})


@pytest.mark.parametrize(("name", "value"), [("joints", [2]), ("joints", [-1]), ("columns", [0, 1, 9])])
def test_joints_and_columns_that_are_none_are_an_error_and_no_crash(name, value):
    with pytest.raises(ValueError, match="no such joints, or no such columns"):
        raw_rows(**{name: np.array(value)})
