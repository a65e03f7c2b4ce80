"""Names for the array types that signatures use (shapes stand in the docstrings), and what numpy lacks for arrays."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]
BoolArray = NDArray[np.bool_]

_Array = TypeVar("_Array", bound=NDArray[Any])


def frozen(array: _Array) -> _Array:
    """Return the array itself, made read-only: a data class holds no array that can change under it."""
    array.setflags(write=False)
    return array


def runs(there: BoolArray) -> list[tuple[int, int]]:
    """Return (first, last) of each run of True, shape (F,)."""
    padded = np.zeros(len(there) + 2, dtype=np.bool_)
    padded[1:-1] = there
    edges = np.flatnonzero(padded[1:] != padded[:-1]).tolist()
    return [(start, stop - 1) for start, stop in zip(edges[::2], edges[1::2], strict=True)]


def median(values: FloatArray) -> FloatArray:
    """Return the median over the first axis; `numpy.median` would import numpy.ma, which takes longer than an edit."""
    middle = len(values) // 2
    if len(values) % 2:
        result: FloatArray = np.partition(values, middle, axis=0)[middle]
        return result
    ordered = np.partition(values, (middle - 1, middle), axis=0)
    between: FloatArray = (ordered[middle - 1] + ordered[middle]) / 2.0
    return between


def percentile(rows: FloatArray, share: float) -> FloatArray:
    """Return a percentile (0 to 100) over the first axis, linear between rows; not numpy's, as with `median`."""
    ordered = np.sort(rows, axis=0)
    place = share / 100.0 * (len(rows) - 1)
    below = int(place)
    above = min(below + 1, len(rows) - 1)
    between: FloatArray = ordered[below] + (place - below) * (ordered[above] - ordered[below])
    return between
