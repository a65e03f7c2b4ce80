"""A file's bytes: held in memory or, of a long file while something else needs the room, read again piece by piece."""

from __future__ import annotations

import contextlib
import os
from io import FileIO
from typing import TYPE_CHECKING

from motionedit.errors import BvhError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_READ_AT_ONCE = 1 << 20


class FileBytes:
    """The bytes of a file, by their places in it; its length is theirs."""

    def __init__(self, data: bytes) -> None:
        self._length = len(data)
        self._data: bytes | None = data
        self._file: FileIO | None = None
        self._changed_at = 0

    def __len__(self) -> int:
        return self._length

    def __del__(self) -> None:
        if self._file is not None:
            self._file.close()

    def __getstate__(self) -> dict[str, object]:
        # An open file cannot be sent to another process.
        return {"_length": self._length, "_data": self.whole(), "_file": None, "_changed_at": 0}

    def whole(self) -> bytes:
        """Return all bytes."""
        return self._read(0, self._length) if self._data is None else self._data

    def between(self, start: int, stop: int) -> bytes | memoryview:
        """Return the bytes from one place up to another.

        Raises
        ------
        BvhError
            They are read again, and the file was changed.
        """
        return self._read(start, stop) if self._data is None else memoryview(self._data)[start:stop]

    def pieces(self, start: int, stop: int) -> Iterator[bytes | memoryview]:
        """Yield the bytes from one place up to another: what is not held in pieces. Raises as `between`."""
        step = _READ_AT_ONCE if self._data is None else max(stop - start, 1)
        for place in range(start, stop, step):
            yield self.between(place, min(place + step, stop))

    def let_go(self, path: Path) -> None:
        """Hold the bytes no more where the file at a path has them, and leave it open; else hold them on."""
        if self._data is None:
            return
        with contextlib.suppress(OSError):
            file = FileIO(path)
            status = os.fstat(file.fileno())
            if status.st_size == self._length and _has(file, self._data):
                self._data, self._file, self._changed_at = None, file, status.st_mtime_ns
            else:
                file.close()

    def _read(self, start: int, stop: int) -> bytes:
        file = self._file
        assert file is not None  # noqa: S101  for the type checker
        file.seek(start)
        parts = []
        while start < stop and (part := file.read(stop - start)):
            parts.append(part)
            start += len(part)
        if start < stop or os.fstat(file.fileno()).st_mtime_ns != self._changed_at:
            raise BvhError("was changed while it was edited; run again", file=str(file.name))
        return parts[0] if len(parts) == 1 else b"".join(parts)


def _has(file: FileIO, data: bytes) -> bool:
    """Return whether a file begins with data."""
    held = memoryview(data)
    return all(
        file.read(_READ_AT_ONCE) == held[place : place + _READ_AT_ONCE] for place in range(0, len(data), _READ_AT_ONCE)
    )
