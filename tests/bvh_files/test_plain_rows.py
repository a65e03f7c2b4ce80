"""Rows that an edit rewrites whole come out the same, whatever stands between their values."""

from dataclasses import replace

import numpy as np
import pytest
from small_clip import HIERARCHY, ROWS

from motionedit.core.bvh import edited_bytes, parse_clip, rows, splice

HEAD = f"{HIERARCHY}MOTION\nFrames: 3\nFrame Time: 0.04\n"


def rewritten(rows):
    """Return the clip of such rows with all its values rewritten, shifted by a quarter."""
    clip = parse_clip((HEAD + rows).encode(), label="clip.bvh")
    motion = replace(clip.motion, translations=clip.motion.translations + 0.25)
    touched = np.ones(motion.rotations.shape[:2], dtype=bool)
    return edited_bytes(clip, motion, touched=touched, moved=np.ones(motion.translations.shape[:2], dtype=bool))


@pytest.mark.parametrize(
    ("rows", "plain"),
    [
        (ROWS, True),
        (ROWS[:-1], True),
        (ROWS + "\n\n", True),
        (ROWS.replace(" 2 ", "  2 "), False),
        (ROWS.replace(" 2 ", "\t2 "), False),
        (ROWS.replace("6\n", "6 \n"), False),
        (ROWS.replace("\n", "\r\n"), False),
        (ROWS.replace("6\n", "6 \r", 1), False),
        (ROWS.replace("6\n1.5", "6\n\n1.5"), False),
    ],
)
def test_rows_without_odd_blanks_take_the_short_way_to_the_same_bytes(monkeypatch, rows, plain):
    ways = []
    is_plain = splice._is_plain
    monkeypatch.setattr(splice, "_is_plain", lambda *given: ways.append(is_plain(*given)) or ways[-1])
    short = rewritten(rows)
    assert ways == [plain]
    monkeypatch.setattr(splice, "_is_plain", lambda *_: False)
    assert rewritten(rows) == short


@pytest.mark.parametrize("size", [1, 60, 1 << 17])
@pytest.mark.parametrize(
    "odd", ["2", "+2", "2e0", ".2e1", "2.", "0.0000000000000000000000000000002e31", "2" + 25 * "0" + "e-25"]
)
def test_values_are_read_again_as_they_were_whatever_their_text(odd, size, monkeypatch):
    monkeypatch.setattr(rows, "BLOCK_BYTES", size)
    text = ROWS.replace("1.5 2 3", f" 1.5\t{odd} 3")
    assert text != ROWS
    clip = parse_clip((HEAD + text).encode(), label="clip.bvh")
    expected = [[float(word) for word in line.split()] for line in ROWS.splitlines()]
    np.testing.assert_array_equal(clip.values, expected)
    np.testing.assert_array_equal(clip.text.values_between(1, 2), expected[1:2])
