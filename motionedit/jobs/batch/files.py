"""Writing files so that a name never stands for half a file, and telling whether two names are one file."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from typing import TYPE_CHECKING, BinaryIO

try:
    import fcntl
except ImportError:  # Windows, where a file that a run has open cannot be removed anyway
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_PARTIAL = ".motionedit-partial"
# Windows replaces no file that another program has open; virus scanners and indexers let go in less than this.
_SECONDS_TO_REPLACE = 2.0
_SECONDS_BETWEEN_TRIES = 0.05


def atomic_write(path: Path, data: bytes | Iterable[bytes | memoryview]) -> None:
    """Write a file, whole or in pieces, by way of a temporary one in the same folder, renamed when it is whole.

    Folders on the way are made. An error or an interrupt leaves the old file, or none, and no temporary one.

    Raises
    ------
    OSError
        The folder cannot be made or written, or the disk is full.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    pieces = (data,) if isinstance(data, bytes) else data
    if path.exists() and not path.is_file():
        # A device or a pipe, such as /dev/stdout: there is nothing to rename.
        with path.open("wb") as stream:
            stream.writelines(pieces)
        return
    # Not `tempfile`: its files are closed to the group, and the rename would keep them so.
    temporary = path.with_name(f".{path.name[:40]}.{os.urandom(4).hex()}{_PARTIAL}")
    try:
        with temporary.open("xb") as stream:
            # A file system without locks only keeps what a killed run leaves.
            with contextlib.suppress(OSError):
                _hold(stream)
            stream.writelines(pieces)
            stream.flush()
            if fcntl is not None:  # renamed while it is held, so that no other run takes it for a leftover
                temporary.replace(path)
        if fcntl is None:
            _replace_when_let_go(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def clean_leftovers(folders: Iterable[Path]) -> None:
    """Remove the temporary files that killed runs left in these folders; those of a living run stay."""
    for folder in sorted(set(folders)):
        if not folder.is_dir():
            continue
        for path in sorted(folder.iterdir()):
            if path.name.startswith(".") and path.name.endswith(_PARTIAL):
                # What cannot be opened, held or removed is another's, and harms nobody.
                with contextlib.suppress(OSError):
                    _remove_leftover(path)


def identity(path: Path) -> tuple[int, int] | str:
    """Return what is equal for two spellings of one file, through links too; the file need not exist."""
    try:
        status = path.stat()
    except OSError:
        return place(path)
    # Some file systems of Windows number no files: every one of theirs would be the same.
    return (status.st_dev, status.st_ino) if status.st_ino else place(path)


def place(path: Path) -> str:
    """Return what is equal for two spellings of one place, in letters of any case where the system makes no difference.

    Of a Mac it is not known whether it does: the usual ones make none, and one file in place of two would be lost.
    """
    real = os.path.realpath(path)
    return real.casefold() if sys.platform in ("win32", "darwin") else real


def _replace_when_let_go(temporary: Path, path: Path) -> None:
    """Give a closed file its name, though others may have the old one open for a moment, as on Windows."""
    until = time.monotonic() + _SECONDS_TO_REPLACE
    while True:
        try:
            temporary.replace(path)
        except PermissionError:
            if time.monotonic() > until:
                raise
            time.sleep(_SECONDS_BETWEEN_TRIES)
        else:
            return


def _remove_leftover(path: Path) -> None:
    if fcntl is None:  # one that is open here, too, could not be removed
        path.unlink()
        return
    with path.open("rb") as stream:
        _hold(stream)
        path.unlink()


def _hold(stream: BinaryIO) -> None:
    """Lock an open temporary file: the lock dies with its process, so a file without one is a leftover."""
    if fcntl is not None:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
