"""Clips of many programs are read, keep their bytes, and are rewritten without loss."""

import os
import re
from pathlib import Path

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.bvh import edited_bytes, parse_clip, read_clip, unedited_bytes
from motionedit.errors import BvhError

FOLDER = os.environ.get("MOTIONEDIT_CLIPS", "")
PATHS = sorted(Path(FOLDER).rglob("*.bvh")) if FOLDER else []
if not PATHS:
    pytest.skip("MOTIONEDIT_CLIPS names no folder of real clips", allow_module_level=True)

# Declares 3069 frames and has 3070 rows.
WRONG_COUNT = "Boxing_Toes.bvh"
NUMBER = re.compile(rb"[-+.0-9eE]+")


def name_of(path):
    return str(path.relative_to(FOLDER))


@pytest.fixture(params=PATHS, ids=name_of, scope="module")
def clip(request):
    return read_clip(request.param, lenient=request.param.name.endswith(WRONG_COUNT))


def test_every_value_is_correctly_rounded_and_every_byte_kept(clip):
    data = unedited_bytes(clip)
    rows = data[clip.text.header.rows_start :]
    exact = np.array([float(word) for word in rows.split()])
    np.testing.assert_array_equal(clip.values.reshape(-1), exact)
    np.testing.assert_array_equal(np.signbit(clip.values.reshape(-1)), np.signbit(exact))
    assert parse_clip(data, label="again", lenient=True).sha256 == clip.sha256


def test_writing_every_value_anew_loses_nothing(clip):
    motion = clip.motion
    every = np.ones((len(motion), len(motion.skeleton)), dtype=bool)
    written = edited_bytes(clip, motion, touched=every, moved=every[:, : len(motion.skeleton.translated)])
    again = parse_clip(written, label="again").motion
    assert np.degrees(rot.angle_between(again.rotations, motion.rotations)).max() <= 2e-4
    np.testing.assert_allclose(again.translations, motion.translations, atol=1e-6)
    if not clip.warnings:
        assert NUMBER.sub(b"#", written) == NUMBER.sub(b"#", unedited_bytes(clip))


def test_a_wrong_row_count_is_refused_unless_lenient():
    paths = [path for path in PATHS if path.name.endswith(WRONG_COUNT)]
    if not paths:
        pytest.skip(f"no {WRONG_COUNT} among the clips")
    with pytest.raises(BvhError, match="128: Frames: says 3069, the file has 3070 rows"):
        read_clip(paths[0])
    assert len(read_clip(paths[0], lenient=True).motion) == 3070
