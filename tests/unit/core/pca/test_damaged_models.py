"""A file that is no model is refused in one line, whatever is wrong with it, and takes no more memory than its size."""

import io
import json
import zipfile

import numpy as np
import pytest
from strokes import TIMELINE, database, model_of

from motionedit.core.pca.array_file import array_bytes
from motionedit.core.pca.model_file import model_bytes, read_model
from motionedit.errors import ModelError

NAMES = (
    *("parents", "offsets", "end_site_joints", "end_site_offsets", "space_joints", "references"),
    *("up", "mean", "components", "explained_variance", "coefficients"),
)


@pytest.fixture(scope="module")
def good():
    motions, hits = database(4)
    with np.load(io.BytesIO(model_bytes(model_of(motions, TIMELINE, hits)))) as archive:
        return {name: archive[name] for name in archive.files}


@pytest.fixture
def refused(tmp_path):
    """Return a function that fails unless the bytes are refused; it returns the message."""

    def read(data):
        path = tmp_path / "m.npz"
        path.write_bytes(data)
        with pytest.raises(ModelError) as caught:
            read_model(path)
        return str(caught.value)

    return read


def with_about(good, **changes):
    about = {**json.loads(good["about"].tobytes()), **changes}
    return {**good, "about": np.frombuffer(json.dumps(about).encode(), np.uint8)}


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
@pytest.mark.parametrize("name", ["offsets", "references", "up", "mean", "components", "explained_variance"])
def test_numbers_that_are_none_are_refused(good, refused, name, value):
    array = good[name].copy()
    array.flat[-1] = value
    assert "damaged" in refused(array_bytes({**good, name: array}))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("change", ["shorter", "deeper", "no shape", "other type"])
def test_arrays_of_other_shapes_and_types_are_refused(good, refused, name, change):
    array = good[name]
    if not array.size:
        pytest.skip("these bodies have none")
    other = {
        "shorter": array[:-1],
        "deeper": array[..., None],
        "no shape": array.reshape(-1)[0].reshape(()),
        "other type": array.astype(np.float64 if array.dtype == np.int64 else np.int64),
    }[change]
    assert "damaged" in refused(array_bytes({**good, name: other}))


@pytest.mark.parametrize("variance", [0.0, -1.0])
def test_a_component_without_variance_is_refused(good, refused, variance):
    values = good["explained_variance"].copy()
    values[-1] = variance
    assert "damaged" in refused(array_bytes({**good, "explained_variance": values}))


@pytest.mark.parametrize(
    "changes",
    [
        {"frames": 1e9},
        {"frames": None},
        {"frame_rate": 0},
        {"scale": float("nan")},
        {"root_weight": 0},
        {"total_variance": -1},
        {"events": [["hit", 0]]},
        {"events": [["hit", 3], ["hit", 4]]},
        {"travel": 99},
        {"channels": []},
        {"joints": 3},
        {"clips": []},
        {"clips": [{}]},
        {"rules": None},
    ],
    ids=str,
)
def test_words_that_are_none_are_refused(good, refused, changes):
    assert "damaged" in refused(array_bytes(with_about(good, **changes)))


def test_deeply_nested_words_are_refused(good, refused):
    about = np.frombuffer(b"[" * 100_000, np.uint8)
    assert "damaged" in refused(array_bytes({**good, "about": about}))


def test_other_archives_are_refused(good, refused):
    data = array_bytes(good)
    assert "other arrays" in refused(array_bytes({"a": np.zeros(3)}))
    assert "no whole .npz file" in refused(data[: len(data) // 2])
    assert "no whole .npz file" in refused(b"")
    packed = io.BytesIO()
    np.savez_compressed(packed, **good)
    assert "packed" in refused(packed.getvalue())
    place = data.index(b"PK\x01\x02") + 8  # the flags of the directory's first entry
    encrypted = data[:place] + b"\x01" + data[place + 1 :]
    assert encrypted != data
    assert "encrypted" in refused(encrypted)


@pytest.mark.parametrize(
    "header", ["{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999,), }", "__import__"]
)
def test_an_array_is_as_large_as_it_says_and_nothing_is_evaluated(good, refused, header):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name in good:
            with archive.open(f"{name}.npy", "w") as member:
                text = (header + " " * 80 + "\n").encode()
                member.write(b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text)
    assert "not a model file: an array" in refused(buffer.getvalue())
