"""Reading files that are files: a pipe or a device in place of one is refused, and never waited for."""

from __future__ import annotations

import errno
import os
import stat
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


class NotAFileError(OSError):
    """A pipe, a socket or a device where a file is wanted."""


def read_file(path: Path, *, most: int = -1) -> bytes:
    """Return the bytes of a file, with `most` the first of them alone.

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
        if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            raise NotAFileError(errno.EINVAL, "a pipe or a device, not a file", str(path))
        return stream.read(most)
