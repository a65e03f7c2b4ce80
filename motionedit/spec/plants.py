"""When feet stand, as a user gives it: by foot in the spec, or for many clips in a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from motionedit.dataclass import dataclass
from motionedit.spec import kinds
from motionedit.spec.csv_rows import is_frame, read_rows
from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.model import Context, Kind
from motionedit.spec.times import Interval, parse_interval

if TYPE_CHECKING:
    from collections.abc import Mapping

PLANTS_WORDS = "auto, a CSV file (clip,foot,part,first,last), or a mapping such as {LeftFoot: [[20, 41], [76, 99]]}"
_COLUMNS = ("clip", "foot", "part", "first", "last")
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
        rows = () if context.folder is None else read_plant_table(path, label=context.label_of(value))
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
    rows = read_rows(path, _COLUMNS, label=label)
    problems = [(line, _row_fault(row)) for line, row in rows]
    if faults := [Fault(problem, file=label, line=line) for line, problem in problems if problem]:
        raise FaultyValueError(faults)
    return tuple(PlantRow(row[0], row[1], row[2], int(row[3]), int(row[4])) for _, row in rows)


def _row_fault(row: list[str]) -> str | None:
    """Return what is wrong with a row, None where nothing is."""
    if len(row) != len(_COLUMNS):
        return f"has {len(row)} values; a row is {','.join(_COLUMNS)}"
    if not row[0] or not row[1]:
        return "needs a clip and a foot: left, right or an ankle's joint"
    if row[2] not in _PARTS:
        return f"part must be heel, toe or foot (both), not {show(row[2])}"
    for cell in row[3:]:
        if not is_frame(cell):
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
