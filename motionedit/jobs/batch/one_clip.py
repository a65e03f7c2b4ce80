"""One clip of a run, as a worker does it: read, work on, verify, write; what goes wrong comes back as errors."""

from __future__ import annotations

import hashlib
import sys
import time
from dataclasses import field
from typing import TYPE_CHECKING, Any, Protocol

from motionedit.dataclass import dataclass, replace
from motionedit.errors import ClipError, MotionEditError
from motionedit.jobs.batch.files import atomic_write
from motionedit.jobs.batch.held import with_held
from motionedit.report.record import without_frames

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.core.motion import Motion
    from motionedit.jobs.batch.plan import ClipTask, RunOptions


@dataclass(frozen=True)
class Outcome:
    """What the work on one clip came to.

    Attributes
    ----------
    content : bytes, or an iterable of pieces of them, or None
        The file to write; None writes none. Pieces are made as they are written, and once.
    record : dict
        The clip's entry in the report, from `message` on; plain values only.
    status : str
        ``ok``, ``far``, ``rough``, ``out_of_tolerance`` or ``unreachable``; the last three are what `strict` counts.
    warnings : tuple of str
        One line each, without the clip's name.
    motion : Motion or None
        What the content should read back as, for `verify`; None is the clip's own.
    details : tuple of str
        Lines that --dry-run prints: layers, recruited joints, intervals, goals.
    digest : str or None
        The SHA-256 of the content, where that is known already.
    page : callable or None
        Makes the preview page that is written next to the clip, once the clip is.
    """

    content: bytes | Iterable[bytes | memoryview] | None
    record: dict[str, Any] = field(default_factory=dict)
    status: str = "ok"
    warnings: tuple[str, ...] = ()
    motion: Motion | None = None
    details: tuple[str, ...] = ()
    digest: str | None = None
    page: Callable[[], bytes] | None = None


class Work(Protocol):
    """What is done to each clip: a frozen dataclass that can be pickled."""

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        """Return the outcome for one clip, or raise a MotionEditError that fails it."""


@dataclass(frozen=True)
class Done:
    """What a worker sends back: an Outcome without its arrays, or errors.

    `digest` is the SHA-256 of the file that was written; `current` says that an earlier run made it.
    """

    outcome: Outcome = field(default_factory=lambda: Outcome(None))
    written: bool = False
    errors: tuple[MotionEditError, ...] = ()
    digest: str | None = None
    current: bool = False
    seconds: float = 0.0


@dataclass(frozen=True)
class RunOne:
    """All that is done to one clip, as a worker runs it."""

    options: RunOptions
    work: Work

    def __call__(self, task: ClipTask) -> Done:
        """Return what became of a clip; with -vv an error that is no user's is raised, to show its place."""
        start = time.perf_counter()
        try:
            done = self._run(task)
        except MotionEditError as error:
            done = Done(errors=error.errors)
        except Exception as error:
            if self.options.verbosity > 1:
                raise
            message = f"unexpected {type(error).__name__}: {error}; please report it (-vv shows where)"
            done = Done(errors=(ClipError(" ".join(message.split()), file=task.label),))
        return replace(done, seconds=time.perf_counter() - start)

    def _run(self, task: ClipTask) -> Done:
        clip = read_task(task, lenient=self.options.lenient)
        outcome = self.work(clip, task)
        warnings = (*clip.warnings, *outcome.warnings)
        content = outcome.content
        # A page beside the clip shows what is told frame by frame, whether or not the report does.
        record = outcome.record if self.options.report_frames else without_frames(outcome.record)
        if content is None or self.options.dry_run:
            return Done(Outcome(None, record, outcome.status, warnings, details=outcome.details))
        if not isinstance(content, bytes) and (self.options.verify or task.output is None):
            content = b"".join(content)
        if isinstance(content, bytes) and self.options.verify:
            record = {**record, "verify": _verify(clip, content, outcome.motion or clip.motion)}
        digest = None
        if task.output is not None:
            sha256 = hashlib.sha256()
            write_file(task.output, content if outcome.digest else _counted(content, sha256))
            content, digest = None, outcome.digest or sha256.hexdigest()
        if task.page is not None and outcome.page is not None:
            write_file(task.page, outcome.page())
        return Done(Outcome(content, record, outcome.status, warnings), written=True, digest=digest)


@dataclass(frozen=True)
class RunOwn:
    """All that is done to one clip that has its own work, and may be held since it was measured."""

    options: RunOptions

    def __call__(self, pair: tuple[ClipTask, Work]) -> Done:
        """Return what became of the clip."""
        task, work = pair
        return RunOne(self.options, work)(with_held(task))


def _counted(content: bytes | Iterable[bytes | memoryview], sha256: hashlib._Hash) -> Iterator[bytes | memoryview]:
    """Yield the pieces of a file, and let the digest know each."""
    for piece in (content,) if isinstance(content, bytes) else content:
        sha256.update(piece)
        yield piece


def write_file(path: Path, content: bytes | Iterable[bytes | memoryview]) -> None:
    """Write a file whole or not at all.

    Raises
    ------
    ClipError
        It cannot be written.
    """
    try:
        atomic_write(path, content)
    except OSError as error:
        raise ClipError(f"cannot be written: {error.strerror or error}", file=str(path)) from error


def read_task(task: ClipTask, *, lenient: bool) -> Clip:
    """Return the clip of a task: the one it holds, or that of its file or of standard input.

    Raises
    ------
    BvhError
        The file is no BVH clip.
    ClipError
        It cannot be read at all.
    """
    from motionedit.core.bvh import parse_clip, read_clip

    if task.clip is not None:
        return task.clip
    try:
        if task.source is None:
            if sys.stdin is None:
                raise ClipError("standard input is closed", file=task.label)
            return parse_clip(sys.stdin.buffer.read(), label=task.label, lenient=lenient)
        return read_clip(task.source, label=task.label, lenient=lenient)
    except OSError as error:
        raise ClipError(f"cannot be read: {error.strerror or error}", file=task.label) from error


def _verify(clip: Clip, content: bytes, motion: Motion) -> dict[str, Any]:
    """Return what bvhio, an independent reader, found in the bytes to write; a difference fails the clip."""
    from motionedit.core.body.find_anatomy import anatomy_of
    from motionedit.core.bvh import check_with_bvhio

    result = check_with_bvhio(content, motion, leg_length=anatomy_of(motion).leg_length)
    if not result.ok:
        raise ClipError(
            f"--verify: bvhio reads joint {result.joint} at frame {result.frame} {result.distance:.4g} from its "
            "place; the file was not kept",
            file=clip.label,
        )
    return {"distance": result.distance, "frames_skipped": result.skipped}
