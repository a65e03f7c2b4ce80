"""Reading files that are files: a pipe or a device in place of one is refused, and never waited for."""

from __future__ import annotations

import errno
import os
import stat
from io import BytesIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


class NotAFileError(OSError):
    """A pipe, a socket or a device where a file is wanted."""


# Bytes from which a file is read into room that is made for it.
_LARGE = 1 << 22


def read_file(path: Path, *, most: int = -1, room: Callable[[int], bytes] | None = None) -> bytes:
    """Return the bytes of a file, with `most` the first of them alone.

    `room` returns so many bytes that nobody else has, in which all those of a large file are read.

    Raises
    ------
    NotAFileError
        It is a pipe or a device: one without a writer would be waited for, one without an end read for ever.
    OSError
        It cannot be read.
    """
    # A pipe is opened without waiting for its writer, and then seen to be one; for a file that makes no difference.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOCTTY", 0)
    with open(path, "rb", opener=lambda name, _: os.open(name, flags)) as stream:
        status = os.fstat(stream.fileno())
        if not stat.S_ISREG(status.st_mode):
            raise NotAFileError(errno.EINVAL, "a pipe or a device, not a file", str(path))
        if room is None or most >= 0 or status.st_size < _LARGE:
            return stream.read(most)
        held = BytesIO(room(status.st_size))
        with held.getbuffer() as view:
            held.seek(stream.readinto(view))
        # It may have become shorter, or longer, meanwhile.
        held.truncate()
        held.write(stream.read())
        return held.getvalue()
