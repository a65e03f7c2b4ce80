"""Pose coordinates, principal components and the model file ([PC] 4.1)."""

import numpy as np
import pytest
from sklearn.decomposition import PCA
from strokes import TIMELINE, database, fitted, model_of, stroke

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.pca.coordinates import rotation_tracks, space_joints
from motionedit.core.pca.database import FitSettings
from motionedit.core.pca.fit import components_for
from motionedit.core.pca.model_file import FORMAT, model_bytes, read_model
from motionedit.core.rotation_vectors import relabelled, unwrapped
from motionedit.errors import ModelError


def test_eigenvalues_and_components_are_scikit_learns():
    X = np.random.default_rng(0).normal(size=(12, 400)) @ np.diag(np.linspace(0.1, 3.0, 400))
    ours, theirs = fitted(X), PCA(n_components=11, svd_solver="full").fit(X)
    np.testing.assert_allclose(ours.explained_variance, theirs.explained_variance_, rtol=1e-9)
    np.testing.assert_allclose(ours.explained_variance_ratio, theirs.explained_variance_ratio_, rtol=1e-9)
    same = np.abs(np.sum(ours.components * theirs.components_, axis=1))
    np.testing.assert_allclose(same, 1.0, atol=1e-9)


def test_components_are_orthonormal_and_their_signs_do_not_depend_on_the_order_of_clips():
    X = np.random.default_rng(1).normal(size=(8, 90))
    ours, shuffled = fitted(X), fitted(X[::-1])
    np.testing.assert_allclose(ours.components @ ours.components.T, np.eye(7), atol=1e-12)
    np.testing.assert_allclose(shuffled.components, ours.components, atol=1e-10)
    np.testing.assert_allclose(shuffled.coefficients[::-1], ours.coefficients, atol=1e-10)


def test_ten_motions_have_nine_components_and_are_rebuilt_by_them():
    X = np.random.default_rng(2).normal(size=(10, 300))
    pca = fitted(X)
    assert len(pca.components) == 9
    np.testing.assert_allclose(pca.mean + pca.coefficients @ pca.components, X, atol=1e-12)


def test_motions_of_fewer_dimensions_have_as_many_components():
    rng = np.random.default_rng(3)
    X = 5.0 + rng.normal(size=(9, 3)) @ rng.normal(size=(3, 200))
    assert len(fitted(X).components) == 3


@pytest.mark.parametrize("count", [2, 9])
def test_equal_motions_have_nothing_to_teach(count):
    with pytest.raises(ValueError, match="all the same"):
        fitted(np.tile(np.random.default_rng(4).normal(size=300), (count, 1)))


@pytest.mark.parametrize(("share", "count"), [(0.5, 1), (0.6, 1), (0.61, 2), (0.9, 2), (0.95, 3), (1.0, 3)])
def test_a_share_of_the_variance_asks_for_the_least_number_of_components(share, count):
    assert components_for(np.array([0.6, 0.3, 0.1]), share) == count


def test_rotation_vectors_are_unwrapped_over_many_turns():
    angle = np.linspace(0.5, 14.0, 300)
    axis = np.array([0.6, 0.0, 0.8])
    q = rot.exp(angle[:, None, None] * axis)
    tracks = rotation_tracks(q, rot.IDENTITY[None])
    np.testing.assert_allclose(tracks[:, 0], angle[:, None] * axis, atol=1e-9)


def test_unwrapping_leaves_a_steady_track_alone_and_copies_it():
    v = np.random.default_rng(5).normal(scale=0.3, size=(50, 4, 3)).cumsum(axis=0) * 0.05
    out = unwrapped(v)
    np.testing.assert_array_equal(out, v)
    assert out is not v


def test_a_track_that_winds_the_other_way_is_moved_as_a_whole():
    target = np.zeros((40, 2, 3)) + np.array([0.0, 3.0, 0.1])
    other = target * (1.0 - rot.TURN / np.linalg.norm(target, axis=-1, keepdims=True))
    moved, k = relabelled(other, target)
    np.testing.assert_allclose(moved, target, atol=1e-9)
    assert list(k) == [1.0, 1.0] or list(k) == [-1.0, -1.0]


@pytest.mark.parametrize("scale", [0.5, 2.0, 5.0])
def test_the_turns_of_a_track_are_the_ones_that_come_nearest_of_all_three(scale):
    rng = np.random.default_rng(6)
    v, target = rng.normal(scale=scale, size=(2, 30, 40, 3))
    moved, k = relabelled(v, target)
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    choices = np.stack([v * (1.0 + rot.TURN * turns / length) for turns in (0.0, -1.0, 1.0)])
    best = np.argmin(((choices - target) ** 2).sum(axis=(1, 3)), axis=0)
    np.testing.assert_array_equal(k, np.array([0.0, -1.0, 1.0])[best])
    np.testing.assert_allclose(moved, np.take_along_axis(choices, best[None, None, :, None], axis=0)[0], atol=1e-12)
    assert (scale < 1.0) == (not k.any())


def test_what_stands_above_the_travel_and_what_is_excluded_stays_out():
    motion = stroke(0)
    joints = space_joints(motion, travel=0, excluded=frozenset({3, 5}))
    assert joints[0] == 0
    assert not {3, 5} & set(joints)
    assert len(joints) == len(motion.skeleton) - 2


@pytest.mark.parametrize("representation", ["centred", "exponential"])
def test_the_database_is_rebuilt_by_its_own_coefficients(representation):
    model = model_of(*_with_timeline(database()), settings=FitSettings(representation))
    pca = model.components
    assert len(pca.components) <= 8
    assert pca.explained_variance_ratio.sum() == pytest.approx(1.0)
    assert model.space.size == 3 + 3 * 23


def _with_timeline(strokes):
    motions, hits = strokes
    return motions, TIMELINE, hits


def test_the_plain_exponential_map_and_the_centred_one_differ_in_their_reference_alone():
    motions, timeline, hits = _with_timeline(database())
    centred = model_of(motions, timeline, hits)
    plain = model_of(motions, timeline, hits, settings=FitSettings("exponential"))
    np.testing.assert_array_equal(plain.space.references, np.tile(rot.IDENTITY, (23, 1)))
    assert np.abs(centred.space.references - plain.space.references).max() > 0.01


def test_units_rates_and_headings_do_not_change_the_components():
    motions, hits = database()
    model = model_of(motions, TIMELINE, hits)
    moved = [_scaled(motion, 100.0) for motion in database(heading=np.pi)[0]]
    other = model_of(moved, TIMELINE, hits)
    np.testing.assert_allclose(other.components.explained_variance, model.components.explained_variance, rtol=1e-9)
    np.testing.assert_allclose(other.components.coefficients, model.components.coefficients, atol=1e-9)


def _scaled(motion, factor):
    from dataclasses import replace

    skeleton = motion.skeleton
    bigger = replace(skeleton, offsets=skeleton.offsets * factor)
    return Motion(bigger, motion.rotations, motion.translations * factor, motion.frame_time)


def test_a_model_comes_back_from_its_file_bit_for_bit(tmp_path):
    motions, hits = database(4)
    model = model_of(motions, TIMELINE, hits)
    path = tmp_path / "model.npz"
    path.write_bytes(model_bytes(model))
    again = read_model(path)
    assert model_bytes(again) == path.read_bytes()
    assert again.clips == model.clips
    assert again.timeline == model.timeline
    assert again.rules == model.rules
    np.testing.assert_array_equal(again.component_rows, model.component_rows)


def test_a_model_holds_no_pickle_and_no_time(tmp_path):
    import zipfile

    motions, hits = database(3)
    path = tmp_path / "model.npz"
    path.write_bytes(model_bytes(model_of(motions, TIMELINE, hits)))
    with zipfile.ZipFile(path) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    np.load(path, allow_pickle=False)["components"]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not a model file"),
        (b"HIERARCHY", "not a model file"),
        (b"PK\x03\x04 broken", "not a model file"),
    ],
)
def test_what_is_no_model_is_refused_in_one_line(tmp_path, content, message):
    path = tmp_path / "model.npz"
    path.write_bytes(content)
    with pytest.raises(ModelError, match=message):
        read_model(path)


def test_a_missing_a_foreign_and_a_newer_model_are_refused(tmp_path):
    with pytest.raises(ModelError, match="cannot be read: No such file"):
        read_model(tmp_path / "none.npz")
    foreign = tmp_path / "foreign.npz"
    np.savez(foreign, a=np.zeros(3))
    with pytest.raises(ModelError, match="not a model file: other arrays than a model has"):
        read_model(foreign)
    motions, hits = database(3)
    newer = tmp_path / "newer.npz"
    newer.write_bytes(model_bytes(model_of(motions, TIMELINE, hits)).replace(FORMAT.encode(), b"motionedit/model/v9"))
    with pytest.raises(ModelError):
        read_model(newer)


def test_a_truncated_model_keeps_its_leading_components():
    motions, hits = database()
    model = model_of(motions, TIMELINE, hits)
    cut = model.truncated(3)
    np.testing.assert_array_equal(cut.component_rows, model.component_rows[:3])
    assert cut.components.explained_variance_ratio.sum() < 1.0
    # With all components every motion of a database lies at the same distance, (M - 1) / sqrt(M).
    np.testing.assert_allclose(model.mahalanobis(model.components.coefficients), 8 / 3, rtol=1e-6)
