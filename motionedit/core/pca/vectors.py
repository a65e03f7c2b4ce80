"""Motion vectors of many clips, in memory or in a scratch file: written one by one, then read block by block."""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO, Protocol, Self

import numpy as np

from motionedit.dataclass import dataclass
from motionedit.errors import ClipError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import TracebackType

    from motionedit.core.arrays import FloatArray

# Up to so many clips all vectors are held, and the Gram matrix of all pairs is cheap; above, they wait in a file.
MOST_IN_MEMORY = 2000
# Bytes of vectors that are held at a time: enough for fast matrix products.
_BLOCK_BYTES = 1 << 25


class MotionVectors(Protocol):
    """The vectors of M motions, D values each; a context that gives back what it holds."""

    @property
    def count(self) -> int:
        """How many vectors there are, M."""

    def write(self, first: int, block: FloatArray) -> None:
        """Put vectors, shape (B, D), in place of those from `first` on; new ones follow the last."""

    def blocks(self) -> Iterator[tuple[int, FloatArray]]:
        """Yield (first, vectors of shape (B, D)) in order; a block may be changed, and is good until the next."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def motion_vectors(count: int) -> VectorsInMemory | VectorsInFile:
    """Return a place for the vectors of so many clips: memory, or a scratch file where that would take too much."""
    return VectorsInMemory(count) if count <= MOST_IN_MEMORY else VectorsInFile()


class VectorsInMemory:
    """Up to `count` vectors as one matrix."""

    def __init__(self, count: int) -> None:
        self._rows, self._filled = np.empty((count, 0)), 0

    @property
    def count(self) -> int:
        """How many vectors there are."""
        return self._filled

    @property
    def matrix(self) -> FloatArray:
        """All vectors, shape (M, D); not a copy."""
        return self._rows[: self._filled]

    def write(self, first: int, block: FloatArray) -> None:
        """Put vectors, shape (B, D), in place of those from `first` on."""
        if not self._rows.shape[1]:
            self._rows = np.empty((len(self._rows), block.shape[1]))
        stop = first + len(block)
        if not np.shares_memory(block, self._rows):
            self._rows[first:stop] = block
        self._filled = max(self._filled, stop)

    def blocks(self) -> Iterator[tuple[int, FloatArray]]:
        """Yield (first, vectors), views of the matrix."""
        step = _rows_of_a_block(self._rows.shape[1])
        for first in range(0, self._filled, step):
            yield first, self._rows[first : min(first + step, self._filled)]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._rows, self._filled = np.empty((0, 0)), 0


class VectorsInFile:
    """Any number of vectors in a file without a name, in the folder for such files; it goes with the program.

    Read, not mapped: pages of a map would count as this program's memory.
    """

    def __init__(self) -> None:
        import tempfile

        self._file: BinaryIO = tempfile.TemporaryFile(prefix="motionedit-")  # noqa: SIM115
        self._size = self._filled = 0

    @property
    def count(self) -> int:
        """How many vectors there are."""
        return self._filled

    def write(self, first: int, block: FloatArray) -> None:
        """Put vectors, shape (B, D), in place of those from `first` on.

        Raises
        ------
        ClipError
            There is no room for them.
        """
        self._size = block.shape[1]
        try:
            self._file.seek(first * self._size * 8)
            self._file.write(np.ascontiguousarray(block).data.cast("B"))
            self._file.flush()
        except OSError as error:
            import tempfile

            message = f"no room for the scratch file ({error.strerror or error}); TMPDIR names another folder"
            raise ClipError(message, file=tempfile.gettempdir()) from error
        self._filled = max(self._filled, first + len(block))

    def blocks(self) -> Iterator[tuple[int, FloatArray]]:
        """Yield (first, vectors), each read over the last."""
        step = _rows_of_a_block(self._size)
        buffer = np.empty((step, self._size))
        for first in range(0, self._filled, step):
            block = buffer[: min(step, self._filled - first)]
            self._file.seek(first * self._size * 8)
            self._file.readinto(block.data.cast("B"))  # type: ignore[attr-defined]
            yield first, block

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


@dataclass(frozen=True, eq=False)
class CentredVectors:
    """Motion vectors less their mean, read block by block."""

    vectors: MotionVectors
    mean: FloatArray

    @property
    def count(self) -> int:
        """How many vectors there are."""
        return self.vectors.count

    def blocks(self) -> Iterator[tuple[int, FloatArray]]:
        """Yield (first, vectors less the mean), each over the last."""
        buffer = np.empty((0, len(self.mean)))
        for first, block in self.vectors.blocks():
            if len(buffer) < len(block):
                buffer = np.empty(block.shape)
            yield first, np.subtract(block, self.mean, out=buffer[: len(block)])


def _rows_of_a_block(size: int) -> int:
    return max(_BLOCK_BYTES // (8 * max(size, 1)), 1)
