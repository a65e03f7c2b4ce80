"""When feet stand, as a user gives it: by foot in the spec, or for many clips in a CSV file."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from motionedit.dataclass import dataclass
from motionedit.spec import kinds
from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.model import Context, Kind
from motionedit.spec.text_files import read_text
from motionedit.spec.times import Interval, parse_interval

if TYPE_CHECKING:
    from collections.abc import Mapping

PLANTS_WORDS = "auto, a CSV file (clip,foot,part,first,last), or a mapping such as {LeftFoot: [[20, 41], [76, 99]]}"
_COLUMNS = ["clip", "foot", "part", "first", "last"]
_PARTS = ("heel", "toe", "foot")


class PlantRow(NamedTuple):
    """A plant of a CSV file: `foot` is left, right or a joint, `part` heel, toe, or foot for both."""

    clip: str
    foot: str
    part: str
    first: int
    last: int


@dataclass(frozen=True)
class PlantsSpec:
    """When feet stand: intervals of whole feet `by_foot`, or `rows` of a `file`; neither: found in the clip."""

    by_foot: Mapping[str, tuple[Interval, ...]] | None = None
    rows: tuple[PlantRow, ...] | None = None
    file: Path | None = None


def _plants(value: object, context: Context) -> PlantsSpec:
    if value == "auto":
        return PlantsSpec()
    if isinstance(value, str):
        path = Path(value) if context.folder is None else context.folder / value
        label = value if context.label in ("", ".") or Path(value).is_absolute() else f"{context.label}/{value}"
        rows = () if context.folder is None else read_plant_table(path, label=label)
        return PlantsSpec(rows=rows, file=path)
    if not isinstance(value, dict) or not value:
        raise faulty(f"must be {PLANTS_WORDS}; not {show(value)}")
    found: dict[str, list[Interval]] = {}
    faults: list[Fault] = []
    for foot, intervals in value.items():
        if not isinstance(intervals, list) or not intervals:
            faults.append(Fault("must be a list of intervals such as [[20, 41], [76, 99]]", (foot,)))
            continue
        for i, interval in enumerate(intervals):
            try:
                found.setdefault(foot, []).append(parse_interval(interval))
            except FaultyValueError as error:
                faults += [fault.under(i).under(foot) for fault in error.faults]
    if faults:
        raise FaultyValueError(faults)
    return PlantsSpec(by_foot={foot: tuple(intervals) for foot, intervals in found.items()})


def read_plant_table(path: Path, *, label: str) -> tuple[PlantRow, ...]:
    """Return the rows of a CSV file of plants.

    Raises
    ------
    FaultyValueError
        With all faults of the file, each with its line.
    """
    text, fault = read_text(path)
    if fault is not None:
        if fault.line is None:
            raise faulty(f"cannot read '{label}': {fault.message}")
        raise FaultyValueError([Fault(fault.message, file=label, line=fault.line)])
    lines = _lines(text, label)
    if not lines or lines[0][1] != _COLUMNS:
        shown = show(",".join(lines[0][1])) if lines else "an empty file"
        message = f"the first line must be {','.join(_COLUMNS)}, not {shown}"
        raise FaultyValueError([Fault(message, file=label, line=lines[0][0] if lines else 1)])
    problems = [(line, _row_fault(row)) for line, row in lines[1:]]
    if faults := [Fault(problem, file=label, line=line) for line, problem in problems if problem]:
        raise FaultyValueError(faults)
    return tuple(PlantRow(row[0], row[1], row[2], int(row[3]), int(row[4])) for _, row in lines[1:])


def _lines(text: str, label: str) -> list[tuple[int, list[str]]]:
    """Return the rows with their lines; blank ones are left out."""
    reader = csv.reader(text.splitlines(), strict=True)
    rows: list[tuple[int, list[str]]] = []
    try:
        rows.extend((reader.line_num, [cell.strip() for cell in row]) for row in reader)
    except csv.Error as error:
        raise FaultyValueError([Fault(f"not CSV: {error}", file=label, line=reader.line_num)]) from error
    return [(line, row) for line, row in rows if any(row)]


def _row_fault(row: list[str]) -> str | None:
    """Return what is wrong with a row, None where nothing is."""
    if len(row) != len(_COLUMNS):
        return f"has {len(row)} values; a row is {','.join(_COLUMNS)}"
    if not row[0] or not row[1]:
        return "needs a clip and a foot: left, right or an ankle's joint"
    if row[2] not in _PARTS:
        return f"part must be heel, toe or foot (both), not {show(row[2])}"
    for cell in row[3:]:
        if not (cell.isascii() and cell.isdigit() and len(cell) < 10):
            return f"first and last must be whole numbers of at least 0, not {show(cell)}"
    if int(row[4]) < int(row[3]):
        return f"ends at {row[4]}, before it begins at {row[3]}"
    return None


PLANTS = Kind(
    _plants,
    PLANTS_WORDS,
    {
        "anyOf": [
            {"type": "string", "minLength": 1},
            {
                "type": "object",
                "minProperties": 1,
                "additionalProperties": {
                    "type": "array",
                    "minItems": 1,
                    "items": kinds.INTERVAL.json,
                },
            },
        ]
    },
)
