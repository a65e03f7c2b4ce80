"""CSV files of event frames: the columns ``clip,frame``, every fault with the file's own line."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.text_files import read_text

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
    text, fault = read_text(path)
    if fault is not None:
        if fault.line is None:
            raise faulty(f"cannot read '{label}': {fault.message}")
        raise FaultyValueError([Fault(fault.message, file=label, line=fault.line)])
    table: dict[str, int] = {}
    lines: dict[str, int] = {}
    faults: list[Fault] = []
    for line, row in _rows(text, label):
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


def _rows(text: str, label: str) -> list[tuple[int, list[str]]]:
    """Return the rows after the header with their lines; blank lines are left out."""
    reader = csv.reader(text.splitlines(), strict=True)
    rows: list[tuple[int, list[str]]] = []
    try:
        rows.extend((reader.line_num, row) for row in reader if any(cell.strip() for cell in row))
    except csv.Error as error:
        raise FaultyValueError([Fault(f"not CSV: {error}", file=label, line=reader.line_num)]) from error
    header = [cell.strip() for cell in rows[0][1]] if rows else []
    if header != ["clip", "frame"]:
        line = rows[0][0] if rows else 1
        shown = show(",".join(header)) if header else "an empty file"
        raise FaultyValueError([Fault(f"the first line must be clip,frame, not {shown}", file=label, line=line)])
    return rows[1:]


def _clip_and_frame(row: list[str]) -> tuple[str, int]:
    if len(row) != 2:
        raise faulty(f"has {len(row)} values; a row is clip,frame")
    clip, frame = row[0].strip(), row[1].strip()
    if not clip:
        raise faulty("needs a clip before the comma")
    if not (frame.isascii() and frame.isdigit() and len(frame) < 10):
        raise faulty(f"frame must be a whole number of at least 0, not {show(frame)}")
    return clip, int(frame)
