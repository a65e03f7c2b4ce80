"""CSV files of event frames: the columns ``clip,frame``, every fault with the file's own line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.spec.csv_rows import is_frame, read_rows
from motionedit.spec.faults import Fault, FaultyValueError, faulty, show

if TYPE_CHECKING:
    from pathlib import Path


def read_event_table(path: Path, *, label: str) -> dict[str, int]:
    """Return the frame of each clip that a CSV file lists, keys as written.

    Parameters
    ----------
    label : str
        The file's name in messages.

    Raises
    ------
    FaultyValueError
        With all faults of the file; one that cannot be read is a fault of the spec that names it.
    """
    table: dict[str, int] = {}
    lines: dict[str, int] = {}
    faults: list[Fault] = []
    for line, row in read_rows(path, ("clip", "frame"), label=label):
        try:
            clip, frame = _clip_and_frame(row)
            if clip in lines:
                raise faulty(f"clip {show(clip)} is listed twice, on lines {lines[clip]} and {line}")
            table[clip], lines[clip] = frame, line
        except FaultyValueError as error:
            faults += [Fault(found.message, file=label, line=line) for found in error.faults]
    if faults:
        raise FaultyValueError(faults)
    return table


def _clip_and_frame(row: list[str]) -> tuple[str, int]:
    if len(row) != 2:
        raise faulty(f"has {len(row)} values; a row is clip,frame")
    clip, frame = row
    if not clip:
        raise faulty("needs a clip before the comma")
    if not is_frame(frame):
        raise faulty(f"frame must be a whole number of at least 0, not {show(frame)}")
    return clip, int(frame)
