"""PCA of more motions than are held in memory: the same model as by the Gram matrix, from blocks of a scratch file."""

import os
import tempfile

import numpy as np
import pytest
from sklearn.decomposition import PCA
from strokes import TIMELINE, database, fitted, model_of

from motionedit.core import rotations as rot
from motionedit.core.pca import streaming, tracks, vectors
from motionedit.core.pca.database import FitSettings
from motionedit.core.pca.fit import AllTheSameError, ComponentCount, TooFewComponentsError
from motionedit.core.pca.streaming import DEFAULT_COMPONENTS, MOST_COMPONENTS, RESIDUAL_TOLERANCE, stream_components
from motionedit.core.pca.tracks import make_consistent, other_windings, products_of
from motionedit.core.pca.vectors import CentredVectors, VectorsInFile, VectorsInMemory, motion_vectors
from motionedit.core.rotations import TURN


@pytest.fixture(autouse=True)
def _small_blocks(monkeypatch):
    monkeypatch.setattr(vectors, "_BLOCK_BYTES", 100_000)


def streamed(X, **count):
    with VectorsInFile() as held:
        held.write(0, X)
        return stream_components(CentredVectors(held, X.mean(axis=0)), count=ComponentCount(**count))


def decaying(clips, values, *, rank, fall, noise=0.0, seed=0):
    """Motions about a mean far from zero, whose standard deviations fall by a factor from component to component."""
    rng = np.random.default_rng(seed)
    left, right = (np.linalg.qr(rng.normal(size=(size, rank)))[0] for size in (clips, values))
    return 3.0 + (left * (100.0 * fall ** np.arange(rank))) @ right.T + noise * rng.normal(size=(clips, values))


def test_streaming_finds_the_components_of_the_gram_matrix_and_of_scikit_learn():
    X = decaying(600, 900, rank=60, fall=0.85, noise=1e-4)
    ours, gram = streamed(X, count=20), fitted(X, count=ComponentCount(20))
    theirs = PCA(n_components=20, svd_solver="full").fit(X)
    assert ours.residual < RESIDUAL_TOLERANCE
    assert ours.passes <= 6
    pca = ours.components
    np.testing.assert_allclose(pca.explained_variance, gram.explained_variance, rtol=1e-10)
    np.testing.assert_allclose(pca.explained_variance, theirs.explained_variance_, rtol=1e-10)
    np.testing.assert_allclose(pca.explained_variance_ratio, theirs.explained_variance_ratio_, rtol=1e-10)
    np.testing.assert_allclose(pca.components, gram.components, atol=1e-6)  # signs too
    np.testing.assert_allclose(pca.coefficients, gram.coefficients, atol=1e-4)
    np.testing.assert_allclose(pca.components @ pca.components.T, np.eye(20), atol=1e-12)
    np.testing.assert_allclose(pca.coefficients, (X - X.mean(axis=0)) @ pca.components.T, atol=1e-9)
    outside = pca.components - pca.components @ theirs.components_.T @ theirs.components_
    assert np.linalg.norm(outside, 2) < 1e-6


def test_a_residual_bounds_how_far_a_variance_is_from_the_nearest_true_one():
    X = decaying(400, 500, rank=300, fall=0.995)
    ours, all_of_them = streamed(X, count=30), fitted(X)
    off = np.abs(ours.components.explained_variance[:, None] - all_of_them.explained_variance).min(axis=1)
    assert off.max() <= ours.residual * all_of_them.explained_variance[0]


@pytest.mark.parametrize("limit", [2, 4, 40])
def test_the_residual_is_that_of_the_worst_component_and_it_is_gone_on_until_that_is_little(limit, monkeypatch):
    X = decaying(250, 300, rank=200, fall=0.99)
    passes, blocks = [], CentredVectors.blocks
    monkeypatch.setattr(CentredVectors, "blocks", lambda self: passes.append(self) or blocks(self))
    monkeypatch.setattr(streaming, "MOST_PASSES", limit)
    ours = streamed(X, count=12)
    assert ours.passes == len(passes)
    centred, E = X - X.mean(axis=0), ours.components.components
    values = np.sum((centred @ E.T) ** 2, axis=0)
    off = np.linalg.norm(centred.T @ (centred @ E.T) - E.T * values, axis=0).max() / values[0]
    assert ours.residual == pytest.approx(off, rel=1e-3, abs=1e-13)
    assert ours.passes == limit if limit < 40 else 4 < ours.passes < 40
    assert (ours.residual < RESIDUAL_TOLERANCE) == (limit == 40)


def test_streaming_gives_the_same_numbers_every_time():
    X = decaying(300, 400, rank=40, fall=0.8)
    one, other = streamed(X, count=10).components, streamed(X, count=10).components
    np.testing.assert_array_equal(one.components, other.components)
    np.testing.assert_array_equal(one.coefficients, other.coefficients)


def test_as_many_components_are_streamed_as_explain_the_share_that_is_asked_for():
    X = decaying(500, 600, rank=400, fall=0.992)
    ratios = fitted(X).explained_variance_ratio
    pca = streamed(X, share=0.95).components
    wanted = int(np.searchsorted(np.cumsum(ratios), 0.95)) + 1
    assert wanted > DEFAULT_COMPONENTS + 10  # more than the first block holds
    assert len(pca.components) == wanted
    np.testing.assert_allclose(pca.explained_variance_ratio.sum(), ratios[:wanted].sum(), rtol=1e-9)


def test_without_a_number_the_components_are_bounded_by_the_default_and_by_the_rank():
    assert len(streamed(decaying(300, 400, rank=200, fall=0.99)).components.components) == DEFAULT_COMPONENTS
    assert len(streamed(decaying(300, 400, rank=7, fall=0.5)).components.components) == 7
    assert len(streamed(decaying(5, 400, rank=5, fall=0.5)).components.components) == 4


@pytest.mark.parametrize(("clips", "available"), [(40, 39), (1500, MOST_COMPONENTS)])
def test_more_components_than_there_can_be_are_refused_with_their_number(clips, available):
    with pytest.raises(TooFewComponentsError) as caught:
        streamed(np.random.default_rng(1).normal(size=(clips, 1100)), count=available + 1)
    assert caught.value.available == available


def test_equal_motions_have_nothing_to_teach_a_stream():
    with pytest.raises(AllTheSameError):
        streamed(np.tile(np.random.default_rng(4).normal(size=300), (50, 1)))


@pytest.mark.parametrize("representation", ["centred", "exponential"])
def test_a_database_is_streamed_to_the_model_that_memory_gives(monkeypatch, representation):
    motions, hits = database(30)
    settings = FitSettings(representation, components=ComponentCount(8))
    held = model_of(motions, TIMELINE, hits, settings=settings)
    monkeypatch.setattr(vectors, "MOST_IN_MEMORY", 5)
    ours = model_of(motions, TIMELINE, hits, settings=settings)
    np.testing.assert_array_equal(ours.space.references, held.space.references)
    np.testing.assert_allclose(ours.components.mean, held.components.mean, atol=1e-13)
    np.testing.assert_allclose(ours.components.explained_variance, held.components.explained_variance, rtol=1e-9)
    np.testing.assert_allclose(ours.components.components, held.components.components, atol=1e-6)
    assert ours.clips == held.clips


@pytest.mark.parametrize("kind", [lambda: VectorsInMemory(7), VectorsInFile])
def test_vectors_come_back_block_by_block_with_what_was_put_in_their_place(kind, monkeypatch):
    monkeypatch.setattr(vectors, "_BLOCK_BYTES", 3 * 4 * 8)
    X = np.random.default_rng(2).normal(size=(7, 4))
    with kind() as held:
        for m, row in enumerate(X):
            held.write(m, row[None])
        assert held.count == 7
        for first, block in held.blocks():
            if first == 3:
                block[1] += 1.0
                held.write(first, block)
        blocks = {first: block.copy() for first, block in held.blocks()}
    assert sorted(blocks) == [0, 3, 6]
    X[4] += 1.0
    np.testing.assert_array_equal(np.concatenate([blocks[first] for first in (0, 3, 6)]), X)


def test_the_scratch_file_has_no_name_and_goes_with_its_context(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    held = motion_vectors(vectors.MOST_IN_MEMORY + 1)
    assert isinstance(held, VectorsInFile)
    with held:
        held.write(0, np.zeros((5, 5)))
        assert os.name == "nt" or not list(tmp_path.iterdir())
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValueError, match="closed"):
        next(held.blocks())


def test_rotations_that_come_in_parts_have_the_mean_of_the_whole():
    q = rot.normalize(np.random.default_rng(3).normal(size=(40, 5, 4)) + 1.0)
    products = sum(products_of(part) for part in (q[:7], q[7:30], -q[30:]))
    whole = np.einsum("fja,fjb->jab", q, q)
    np.testing.assert_allclose(rot.mean_of_products(products), rot.mean_of_products(whole), atol=1e-12)


def written(several):
    """Vectors in memory of tracks (F, K, 3), as they are gathered: with travel at 0 and v = log(q)."""
    held = VectorsInMemory(len(several))
    for m, track in enumerate(several):
        logs = rot.log(rot.exp(track)).reshape(len(track), -1)
        held.write(m, np.concatenate((np.zeros((len(track), 3)), logs), axis=1).reshape(1, -1))
    return held


def tracks_in(held, frames):
    return held.matrix.reshape(held.count, frames, -1)[:, :, 3:].reshape(held.count, frames, -1, 3)


def test_a_clip_whose_angles_pass_half_a_turn_is_brought_to_the_others():
    # About one axis, from 2 to 3.1 rad; the last clip starts beyond pi, where log gives the other way round.
    angle = np.linspace(2.0, 3.1, 40)
    several = [(angle + more)[:, None, None] * np.array([0.6, 0.0, 0.8]) for more in (0.0, 0.02, 1.3)]
    held = written(several)
    assert make_consistent(held, rot.IDENTITY[None], frames=40) == []
    np.testing.assert_allclose(tracks_in(held, 40), several, atol=1e-9)


def test_a_track_far_from_the_median_is_found_and_measured_by_the_median(monkeypatch):
    several = [np.full((10, 3, 3), 0.1) for _ in range(5)]
    for turned, (joint, length) in {3: (1, 3.0), 4: (2, 2.7), 1: (2, 2.0)}.items():
        several[turned][:, joint, 2] += length
    for most in (1, 1 << 24):  # gathered one by one, and all at once
        monkeypatch.setattr(tracks, "_MOST_GATHERED", most)
        found = make_consistent(written(several), np.tile(rot.IDENTITY, (3, 1)), frames=10)
        assert [(m, k) for m, k, _ in found] == [(3, 1), (4, 2)]
        np.testing.assert_allclose([stray for _, _, stray in found], [3.0, 2.7], atol=1e-9)


def test_only_joints_that_could_stray_are_gathered(monkeypatch):
    asked = []
    monkeypatch.setattr(tracks, "other_windings", lambda _, joints, **_more: asked.extend(joints) or [])
    several = [np.full((10, 3, 3), 0.01 * m) for m in range(6)]
    several[2][:, 1, 0] += 3.0
    make_consistent(written(several), np.tile(rot.IDENTITY, (3, 1)), frames=10)
    assert asked == [1]


def test_a_turn_too_many_is_a_stray_that_the_median_shows():
    held = VectorsInMemory(3)
    for m, length in enumerate((3.0, 3.0, 3.0 - TURN)):
        held.write(m, np.array([[0.0, 0.0, 0.0, length, 0.0, 0.0]]))
    assert other_windings(held, [0], frames=1) == [(2, 0, TURN)]
