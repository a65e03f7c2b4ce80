"""What --update leaves alone: outputs that nothing is newer than, of which all is known that this run is to say."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.jobs.batch.plan import ClipTask, RunOptions
    from motionedit.jobs.batch.verdicts import Verdicts


def with_verdicts(
    tasks: Sequence[ClipTask], depends: Sequence[Path], *, options: RunOptions, verdicts: Verdicts | None
) -> list[ClipTask]:
    """Return tasks with the stamps that verdicts are kept by; with --update, those marked that are current.

    Parameters
    ----------
    depends
        What each output is made from beside its clip.
    verdicts
        What is known of earlier outputs; None: times alone tell.
    """
    stamped = [task if verdicts is None else replace(task, stamp=_stamp_of(task.source)) for task in tasks]
    if not options.update:
        return stamped
    frames = None if options.report is None else options.tells_frames(len(tasks))
    current: list[ClipTask] = []
    for task in stamped:
        if not _nothing_is_newer(task, depends):
            current.append(task)
        elif verdicts is None:
            current.append(replace(task, current=True))
        else:
            verdict = verdicts.recall(task, frames=frames, verify=options.verify)
            current.append(replace(task, current=verdict is not None, verdict=verdict))
    return current


def _stamp_of(source: Path | None) -> tuple[int, int] | None:
    """Return what is another where a clip's file is another, though it be older: its size and its time (ns)."""
    if source is None:
        return None
    try:
        status = source.stat()
    except OSError:  # whoever reads it says so
        return None
    return status.st_size, status.st_mtime_ns


def _nothing_is_newer(task: ClipTask, depends: Sequence[Path]) -> bool:
    """Tell, by make's rule, whether no file that the output is made from is newer than it."""
    if task.elsewhere or task.output is None or task.source is None or not all(path.exists() for path in task.outputs):
        return False
    made = min(path.stat().st_mtime_ns for path in task.outputs)
    return all(made >= path.stat().st_mtime_ns for path in (task.source, *depends) if path.exists())
