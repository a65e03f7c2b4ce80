"""Writing files so that a name never stands for half a file, and telling whether two names are one file."""

from __future__ import annotations

import contextlib
import os
import stat
import sys
import time
from typing import TYPE_CHECKING, BinaryIO

try:
    import fcntl
except ImportError:  # Windows, where a file that a run has open cannot be removed anyway
    fcntl = None  # type: ignore[assignment]

from motionedit.interrupts import clean_up_first

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

_PARTIAL = ".motionedit-partial"
# Windows replaces no file that another program has open; virus scanners and indexers let go in less than this.
_SECONDS_TO_REPLACE = 2.0
_SECONDS_BETWEEN_TRIES = 0.05
# Bytes; where none are given the system is asked whether the new file is a terminal.
_BUFFER = 1 << 16


def atomic_write(path: Path, data: bytes | Iterable[bytes | memoryview]) -> None:
    """Write a file, whole or in pieces, by way of a temporary one in the same folder, renamed when it is whole.

    Folders on the way are made. An error or an interrupt leaves the old file, or none, and no temporary one. A file
    that is replaced gives the new one its mode.

    Raises
    ------
    OSError
        The folder cannot be made or written, or the disk is full.
    """
    clean_up_first()
    pieces, old = (data,) if isinstance(data, bytes) else data, status_of(path)
    if old is not None and not stat.S_ISREG(old.st_mode):
        _write_through(path, pieces)
        return
    try:
        temporary, stream = _held_temporary(path)
    except (FileNotFoundError, NotADirectoryError):
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary, stream = _held_temporary(path)
    try:
        with stream:
            stream.writelines(pieces)
            stream.flush()
            _take_mode(old, temporary)
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
        for name in sorted(os.listdir(folder)):  # noqa: PTH208  of Paths it takes five times as long
            if name.startswith(".") and name.endswith(_PARTIAL):
                # What cannot be opened, held or removed is another's, and harms nobody.
                with contextlib.suppress(OSError):
                    _remove_leftover(folder / name)


def identity(path: Path) -> tuple[int, int] | str:
    """Return what is equal for two spellings of one file, through links too; the file need not exist."""
    return _identity(path, place)


def _identity(path: Path, place_of: Callable[[Path], str]) -> tuple[int, int] | str:
    return number_of(status_of(path)) or place_of(path)


def status_of(path: Path) -> os.stat_result | None:
    """Return the status of what a name stands for, through links too; None where it stands for nothing."""
    try:
        return os.stat(path)  # noqa: PTH116  of a Path it takes twice as long
    except OSError:  # whoever reads or writes there says so
        return None


def number_of(status: os.stat_result | None) -> tuple[int, int] | None:
    """Return the number that the system gives a file; None where there is none."""
    # Some file systems of Windows number no files: every one of theirs would be the same.
    return (status.st_dev, status.st_ino) if status is not None and status.st_ino else None


def place(path: Path) -> str:
    """Return what is equal for two spellings of one place, in letters of any case where the system makes no difference.

    Of a Mac it is not known whether it does: the usual ones make none, and one file in place of two would be lost.
    """
    return _as_one_case(os.path.realpath(path))


def _as_one_case(real: str) -> str:
    return real.casefold() if sys.platform in ("win32", "darwin") else real


class Places:
    """`place` of many files, for as long as no folder on the way is moved: each folder is looked up once."""

    def __init__(self) -> None:
        self._folders: dict[str, str] = {}

    def of(self, path: Path) -> str:
        """Return the place of a file that need not exist."""
        folder, name = os.path.split(path)
        if folder not in self._folders:
            self._folders[folder] = os.path.realpath(folder)
        real = os.path.join(self._folders[folder], name)  # noqa: PTH118  as above
        # Windows has names that lead elsewhere and are no links.
        is_plain = os.name == "posix" and name not in ("", ".", "..") and not os.path.islink(real)  # noqa: PTH114
        return _as_one_case(real) if is_plain else place(path)

    def identity(self, path: Path) -> tuple[int, int] | str:
        """Return `identity` of a file."""
        return _identity(path, self.of)


def _write_through(path: Path, pieces: Iterable[bytes | memoryview]) -> None:
    """Write to a device or a pipe, such as /dev/stdout: there is nothing to rename."""
    # A pipe that nobody reads is an error (ENXIO), not a reason to wait.
    handle = os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0))
    with open(handle, "wb") as stream:  # noqa: PTH123  of a handle
        if hasattr(os, "set_blocking"):
            os.set_blocking(handle, True)
        stream.writelines(pieces)


def _held_temporary(path: Path) -> tuple[Path, BinaryIO]:
    """Return a new hidden file in the folder of another, open and held."""
    start = os.fsdecode(os.fsencode(path.name)[:40])  # file systems count the bytes of a name
    while True:
        # Not `tempfile`: its files are closed to the group, and the rename would keep them so.
        temporary = path.with_name(f".{start}.{os.urandom(4).hex()}{_PARTIAL}")
        stream = temporary.open("xb", buffering=_BUFFER)
        if _held(stream, temporary):
            return temporary, stream
        stream.close()


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
    if not stat.S_ISREG(path.lstat().st_mode):  # a pipe of such a name would be waited for
        return
    with path.open("rb") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        path.unlink()


def _held(stream: BinaryIO, path: Path) -> bool:
    """Lock an open temporary file: the lock dies with its process, so a file without one is a leftover.

    Between its making and its lock another run may have taken it for one, and removed it: then it is not held.
    """
    if fcntl is None:
        return True
    try:
        fcntl.flock(stream, fcntl.LOCK_EX)  # a run that cleans holds it for a moment only
    except OSError:
        return True  # a file system without locks only keeps what a killed run leaves
    try:
        return os.path.samestat(os.fstat(stream.fileno()), path.stat())
    except FileNotFoundError:
        return False


def _take_mode(old: os.stat_result | None, new: Path) -> None:
    """Give a file the mode of the one that it will replace, where there is one."""
    if old is None:
        return
    # Where the old one is another user's the mode may not be ours to give; the content is.
    with contextlib.suppress(OSError):
        new.chmod(stat.S_IMODE(old.st_mode))


def bytes_of(paths: Iterable[Path | None]) -> int:
    """Return how large files are in all; what cannot be read will say so itself, and None is none."""
    sizes = 0
    for path in paths:
        with contextlib.suppress(OSError):
            sizes += 0 if path is None else path.stat().st_size
    return sizes
