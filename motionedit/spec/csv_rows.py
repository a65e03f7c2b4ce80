"""CSV files that a spec names: their rows below a line with the columns, every fault with the file's own line."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.text_files import read_text

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def read_rows(path: Path, columns: Sequence[str], *, label: str) -> list[tuple[int, list[str]]]:
    """Return the rows below the line with the columns, each with its line; neither blank rows nor blanks around cells.

    Parameters
    ----------
    label : str
        The file's name in messages.

    Raises
    ------
    FaultyValueError
        It is no CSV file, or has other columns; one that cannot be read is a fault of the spec that names it.
    """
    text, fault = read_text(path)
    if fault is not None:
        if fault.line is None:
            raise faulty(f"cannot read '{label}': {fault.message}")
        raise FaultyValueError([Fault(fault.message, file=label, line=fault.line)])
    reader = csv.reader(text.splitlines(), strict=True)
    rows: list[tuple[int, list[str]]] = []
    try:
        rows.extend((reader.line_num, [cell.strip() for cell in row]) for row in reader)
    except csv.Error as error:
        raise FaultyValueError([Fault(f"not CSV: {error}", file=label, line=reader.line_num)]) from error
    rows = [(line, row) for line, row in rows if any(row)]
    if not rows or rows[0][1] != [*columns]:
        line, shown = (rows[0][0], show(",".join(rows[0][1]))) if rows else (1, "an empty file")
        message = f"the first line must be {','.join(columns)}, not {shown}"
        raise FaultyValueError([Fault(message, file=label, line=line)])
    return rows[1:]


def is_frame(cell: str) -> bool:
    """Return whether a cell is a whole number of at least 0, and no more than any clip has frames."""
    return cell.isascii() and cell.isdigit() and len(cell) < 10
