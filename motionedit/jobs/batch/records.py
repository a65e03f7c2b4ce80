"""The records of a run, in order: a few in memory, more in a temporary file, so that many clips take no memory."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from io import BytesIO
from typing import IO, TYPE_CHECKING, Any, overload

from motionedit.errors import ClipError

if TYPE_CHECKING:
    from collections.abc import Iterable

Record = dict[str, Any]

_IN_MEMORY = 1 << 20  # bytes: some hundred clips


class Records(Sequence[Record]):
    """What a report says of each clip, one entry after the other; each is read anew when it is asked for."""

    def __init__(self, records: Iterable[Record] = (), *, in_memory: int = _IN_MEMORY) -> None:
        self._stream: IO[bytes] = BytesIO()
        self._in_memory = in_memory
        self._places: list[int] = []
        self._end = 0
        for record in records:
            self.append(record)

    def append(self, record: Record) -> None:
        """Add an entry.

        Raises
        ------
        ClipError
            The disk of temporary files is full.
        """
        data = pickle.dumps(record, protocol=pickle.HIGHEST_PROTOCOL)
        try:
            if self._end <= self._in_memory < self._end + len(data):
                self._stream = _on_disk(self._stream)
            self._stream.seek(self._end)
            self._stream.write(data)
            self._stream.flush()
        except OSError as error:
            import tempfile

            message = f"cannot be written, for the report: {error.strerror or error}; TMPDIR names another folder"
            raise ClipError(message, file=tempfile.gettempdir()) from error
        self._places.append(self._end)
        self._end += len(data)

    def __del__(self) -> None:
        self._stream.close()

    def __len__(self) -> int:
        return len(self._places)

    @overload
    def __getitem__(self, place: int) -> Record: ...

    @overload
    def __getitem__(self, place: slice) -> list[Record]: ...

    def __getitem__(self, place: int | slice) -> Record | list[Record]:
        if isinstance(place, slice):
            return [self[i] for i in range(*place.indices(len(self)))]
        self._stream.seek(self._places[place])
        record: Record = pickle.load(self._stream)  # noqa: S301  our own, written above
        return record


def _on_disk(stream: IO[bytes]) -> IO[bytes]:
    """Return a temporary file, which no other program sees, with what is in a stream."""
    import shutil
    import tempfile

    file = tempfile.TemporaryFile(prefix="motionedit-")  # noqa: SIM115  as long as the records
    stream.seek(0)
    shutil.copyfileobj(stream, file)
    return file
