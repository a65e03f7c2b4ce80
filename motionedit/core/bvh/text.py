"""The text of a BVH file: its own bytes, where its numbers stand in them, and the motion that they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from motionedit.core.bvh.rows import values_between
from motionedit.core.bvh.scan import decimals
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.bvh.file_bytes import FileBytes
    from motionedit.core.bvh.header import Header
    from motionedit.core.bvh.rows import Rows
    from motionedit.core.motion import Motion


@dataclass(frozen=True, eq=False)
class BvhText:
    """A file's own bytes, where its header's numbers and its rows stand in them, and the motion they were read as.

    `values`, shape (F, C), are the channel values of a short clip; of a long one they are read from the bytes again.
    """

    file: FileBytes
    header: Header
    rows: Rows
    motion: Motion
    values: FloatArray | None = None

    @property
    def data(self) -> bytes:
        """The file's own bytes."""
        return self.file.whole()

    @property
    def frame_time_decimals(self) -> int:
        """How many decimals the file's frame time carries."""
        return decimals(bytes(self.file.between(*self.header.frame_time_span)))

    def values_between(self, start: int, stop: int) -> FloatArray:
        """Return the channel values of the frames from start up to stop, shape (stop - start, C)."""
        if self.values is not None:
            return self.values[start:stop]
        columns = self.header.skeleton.channel_count
        return values_between(self.file, self.rows, start, stop, columns=columns)


class Written(Protocol):
    """What the writers need of a clip: its name in messages, and its text."""

    @property
    def label(self) -> str:
        """The name that messages give it."""

    @property
    def text(self) -> BvhText:
        """The file's own bytes and their layout."""
