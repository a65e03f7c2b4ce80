"""What a model does not explain of a clip is measured by what it leaves of its own."""

from types import SimpleNamespace

import numpy as np
import pytest

from motionedit.core.pca.fit import ComponentCount, fit_centred
from motionedit.jobs.edit_pc.unexplained import unexplained

RNG = np.random.default_rng(3)
# Forty motions that are nearly made of each other: eight ways to differ, and hardly anything beside.
ALIKE = RNG.normal(size=(40, 8)) @ RNG.normal(size=(8, 300)) + 1e-3 * RNG.normal(size=(40, 300))
CENTRED = ALIKE - ALIKE.mean(axis=0)


def said(kept, vector):
    """Return what is said of a motion vector, less the mean, by a model that keeps so many components."""
    pca = fit_centred(CENTRED, ALIKE.mean(axis=0), count=ComponentCount(kept))
    residual = float(vector @ vector - np.sum((pca.components @ vector) ** 2))
    model = SimpleNamespace(components=pca, timeline=SimpleNamespace(frames=101, frame_rate=100.0))
    return unexplained(SimpleNamespace(residual=max(residual, 0.0)), model, seconds=1.0)


@pytest.mark.parametrize("kept", [2, 4, 7, None])
def test_a_model_disowns_none_of_its_own_clips_however_few_components_it_keeps(kept):
    assert [said(kept, vector) for vector in CENTRED] == [([], [])] * len(CENTRED)


@pytest.mark.parametrize("kept", [4, None])
def test_a_clip_of_another_kind_is_no_better_than_rough(kept):
    odd, other = said(kept, 3.0 * RNG.normal(size=300) * np.linalg.norm(CENTRED, axis=1).max() / np.sqrt(300))
    assert odd == []
    assert other[0].startswith("the model does not explain this clip")


def test_where_every_clip_is_made_of_the_others_nothing_is_said():
    twice = np.concatenate((CENTRED[:10], CENTRED[:10]))
    twice -= twice.mean(axis=0)
    pca = fit_centred(twice, np.zeros(300), count=ComponentCount())
    model = SimpleNamespace(components=pca, timeline=SimpleNamespace(frames=101, frame_rate=100.0))
    assert unexplained(SimpleNamespace(residual=1.0), model, seconds=1.0) == ([], [])
