"""When an output is current, by the files that it is made from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.jobs.batch.files import status_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def stamp_of(source: Path | None) -> tuple[int, int] | None:
    """Return what is another where a clip's file is another, though it be older: its size and its time (ns)."""
    status = None if source is None else status_of(source)
    return None if status is None else (status.st_size, status.st_mtime_ns)


def nothing_is_newer(outputs: Sequence[Path], made_from: Sequence[Path]) -> bool:
    """Tell, by make's rule, whether all outputs exist, and none of the files that they are made from is newer."""
    if not outputs or not all(path.exists() for path in outputs):
        return False
    made = min(path.stat().st_mtime_ns for path in outputs)
    return all(made >= path.stat().st_mtime_ns for path in made_from if path.exists())
