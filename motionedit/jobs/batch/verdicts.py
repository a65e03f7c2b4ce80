"""What became of the clips of earlier runs into a folder: a line for each, in one hidden file beside them.

`--update` passes over an output only where its verdict is known: the clip then stands in the report, and counts under
`--strict`, as if it had been made now. A line is added as a clip is done, so that a stopped run loses none.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from io import FileIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from motionedit.core.plain_values import items, json_of, mapping, text
from motionedit.dataclass import dataclass
from motionedit.jobs.batch.files import Places, atomic_write, place
from motionedit.regular_files import read_file
from motionedit.report.record import plain, without_frames
from motionedit.version import __version__

try:
    import fcntl
except ImportError:  # Windows, which keeps two writers of one line apart by itself
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

NAME = ".motionedit-verdicts.jsonl"
# What an entry of the report has of its run, not of the work, with other names for the same files another; and what is
# kept beside it.
_KEPT_ELSEWHERE = ("clip", "output", "warnings")


@dataclass(frozen=True)
class Verdict:
    """What a run had to say of a clip: its entry in the report, and its warnings.

    `frames` says whether the entry has all that is told frame by frame, or nothing of it.
    """

    record: dict[str, Any]
    warnings: tuple[str, ...]
    frames: bool


def run_key(command: str, data: Mapping[str, Any], *, files: Sequence[Path] = (), more: object = None) -> str:
    """Return what is the same for two runs that make the same of a clip.

    Parameters
    ----------
    data
        The spec with `--set` applied.
    files
        What else is read: event tables, the model.
    more
        What else makes a difference: plain values.

    Raises
    ------
    OSError
        A file cannot be read.
    """
    digests = [hashlib.sha256(read_file(path)).hexdigest() for path in files]
    said = json.dumps([__version__, command, data, digests, more], default=str)
    return hashlib.sha256(said.encode(errors="surrogatepass")).hexdigest()


def verdicts_in(output: str, key: str, *, update: bool, dry_run: bool) -> Verdicts | None:
    """Return the verdicts where a run's outputs go.

    None where there is no such folder: for standard output, for a dry run, and for one file without `--update`, beside
    which nothing is left that was not asked for.
    """
    if output == "-" or dry_run:
        return None
    if not output.lower().endswith(".bvh"):
        return Verdicts(Path(output), key)
    return Verdicts(Path(output).parent, key) if update else None


class Verdicts:
    """The verdicts on the outputs in a folder and below it; `key` says what the run makes of them (`run_key`)."""

    def __init__(self, folder: Path, key: str) -> None:
        self._root, self._places = place(folder), Places()
        self.path = folder / NAME
        self._key = key
        self._known: dict[str, bytes] | None = None
        self._added = 0
        self._end = 0  # of the last line of this run: where no other wrote, it is whole

    def recall(
        self, output: Path, *, stamp: tuple[int, int] | None, frames: bool | None, verify: bool
    ) -> Verdict | None:
        """Return the verdict on an output; None where there is none on these very files, as wanted now.

        `stamp` tells the clip's file from others. With `frames` it has what is told frame by frame, without it not;
        None: nobody asks. With `verify` it says how bvhio read the output.
        """
        if self._known is None:
            self._known = dict(self._lines())
        try:
            said = mapping(json_of(self._known[self._name(output)]))
            now = (self._key, [*(stamp or ())], hashlib.sha256(read_file(output)).hexdigest())
            record = mapping(said["record"])
            text(record["status"])
            lacks = (frames and not said["by_frame"]) or (verify and "verify" not in record)
            if lacks or (said["key"], said["clip"], said["sha256"]) != now:
                return None
            record = without_frames(record) if frames is False else record
            return Verdict(record, tuple(map(text, items(said["warnings"]))), bool(said["by_frame"]))
        except (OSError, KeyError, ValueError):
            return None

    def line(self, output: Path, digest: str, verdict: Verdict, *, stamp: tuple[int, int] | None) -> bytes:
        """Return the line of a verdict, for `add`; `digest` is the SHA-256 of the output that was written just now."""
        said = {
            "output": self._name(output),
            "sha256": digest,
            "clip": stamp,
            "key": self._key,
            "by_frame": verdict.frames,
            "record": plain({key: value for key, value in verdict.record.items() if key not in _KEPT_ELSEWHERE}),
            "warnings": list(verdict.warnings),
        }
        return json.dumps(said).encode() + b"\n"

    def add(self, lines: Sequence[bytes]) -> None:
        """Add lines: of clips that came together at once, since to open the file takes longer than to make a line."""
        if not lines:
            return
        data = b"".join(lines)
        # Without its verdict a clip is made again: that is all that a full disk does here.
        with contextlib.suppress(OSError), self._opened() as stream:
            at = stream.seek(0, os.SEEK_END)
            if at not in (0, self._end) and stream.seek(-1, os.SEEK_END) and stream.read(1) != b"\n":
                at += stream.write(b"\n")  # a killed run wrote but half a line
            self._end = at + stream.write(data)
            self._added += len(data)

    def close(self) -> None:
        """Leave out lines that later ones stand for."""
        with contextlib.suppress(OSError):
            if not self._added or self.path.stat().st_size == self._added:
                return
            with self._opened():
                last = sorted(dict(self._lines()).items())
                atomic_write(self.path, [line + b"\n" for _, line in last])

    def _name(self, output: Path) -> str:
        return self._places.of(output).removeprefix(self._root)

    @contextlib.contextmanager
    def _opened(self) -> Iterator[FileIO]:
        """Give the file to add to, held against other runs; one of them may have put another in its place meanwhile."""
        while True:
            with FileIO(self.path, "a+") as stream:
                if fcntl is not None:
                    fcntl.flock(stream, fcntl.LOCK_EX)  # let go as it is closed
                if self.path.stat().st_ino == os.fstat(stream.fileno()).st_ino:
                    yield stream
                    return

    def _lines(self) -> Iterator[tuple[str, bytes]]:
        """Yield the outputs that the file tells of, each with its line: as text, which takes the least memory."""
        with contextlib.suppress(OSError):
            for line in read_file(self.path).splitlines():
                # A line that a killed run began is none.
                with contextlib.suppress(ValueError, KeyError):
                    yield text(mapping(json_of(line))["output"]), line
