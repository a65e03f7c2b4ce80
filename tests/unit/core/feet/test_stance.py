"""Where a foot stands, found at once: the compiled part and numpy agree."""

import numpy as np
import pytest
from human import skeleton_of

from motionedit.core.body.contacts import Plant
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.compiled import compiled, solver_name
from motionedit.core.feet.stance import FootPath, stance_of

BODY = find_anatomy(skeleton_of())


def foot(rng, frames):
    """Return a foot that goes anywhere, turned a little more at every frame, some of the turns by their other sign."""
    turns = np.cumsum(rng.normal(scale=0.02, size=(frames, 4)), axis=0) + np.eye(4)[0]
    turns *= rng.choice([-1.0, 1.0], size=(frames, 1)) / np.linalg.norm(turns, axis=1, keepdims=True)
    return FootPath(*(rng.normal(size=(frames, 3)) if width == 3 else turns for width in (3, 4, 3)))


def plants(rng, frames):
    """Return plants of a heel and of a toe that follow each other, overlap and meet, in any order."""
    found = []
    for part in ("heel", "toe"):
        edges = np.unique(rng.integers(0, frames, size=8))
        for k, (start, stop) in enumerate(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)):
            if k % 2 == 0 or rng.random() < 0.3:
                found.append(Plant("left", part, 0, 0, start, stop - int(k % 2 == 1 or rng.random() < 0.5), 0.0))
    return [found[k] for k in rng.permutation(len(found)) if found[k].start <= found[k].stop]


@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(20))
def test_a_compiled_stance_is_that_of_numpy(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    path, asked = foot(rng, 40), plants(rng, 40) if seed else []
    found = stance_of(path, asked)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    expected = stance_of(path, asked)
    for name in ("heel", "toe", "whole"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), strict=True)
    for name in ("heel_place", "toe_place", "turn"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), rtol=0.0, atol=1e-14)


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
def test_plants_beyond_the_frames_and_arrays_of_another_size_are_an_error_and_no_crash():
    three, four, flags = np.zeros((5, 3)), np.zeros((5, 4)), np.zeros(5, bool)
    given = [three, three, four, three]
    out = [flags, flags, three.copy(), three.copy(), four.copy(), np.zeros(5, np.int64)]
    for span in ((0, 0, 5), (1, -1, 2), (0, 3, 2)):
        with pytest.raises(ValueError, match="plant 0 is at no frames"):
            compiled().stance(*given, np.array([span]), *out, 5, 1)
    with pytest.raises(ValueError, match="turn has 120 bytes instead of"):
        compiled().stance(three, three, three, three, np.zeros((0, 3), np.int64), *out, 5, 0)
