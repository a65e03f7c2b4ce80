"""Arrays come back from a file as they were, numpy reads it too, and the bytes are those of the arrays alone."""

import io

import numpy as np

from motionedit.core.pca.array_file import array_bytes, read_arrays

ARRAYS = {
    "numbers": np.arange(12.0).reshape(3, 4),
    "none": np.zeros((0, 3)),  # as the end sites of a skeleton without any
    "places": np.array([3, -1], np.int64),
    "words": np.frombuffer("ö".encode(), np.uint8),
}


def test_arrays_come_back_as_they_were():
    data = array_bytes(ARRAYS)
    with np.load(io.BytesIO(data)) as archive:
        for found in (read_arrays(data, names=list(ARRAYS)), archive):
            for name, array in ARRAYS.items():
                assert found[name].dtype == array.dtype
                assert np.array_equal(found[name], array)


def test_the_bytes_do_not_depend_on_how_an_array_lies_in_memory():
    turned = {**ARRAYS, "numbers": np.asfortranarray(ARRAYS["numbers"])}
    assert array_bytes(turned) == array_bytes(ARRAYS)
