"""Reads back the JSON report of an edit, whose goals and constraints a page shows, and finds its clips."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from motionedit.core.plain_values import BEYOND_SENSE, json_of
from motionedit.dataclass import dataclass
from motionedit.errors import UsageError
from motionedit.jobs.batch.files import identity
from motionedit.regular_files import read_file
from motionedit.report.record import SCHEMA

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.jobs.batch.plan import ClipTask

COMMANDS = ("edit-pc", "edit-prioritized")


@dataclass(frozen=True)
class EditReport:
    """A report of an edit: the file's `name`, the `spec` of the edit as plain data, and its `clips`."""

    name: str
    spec: dict[str, Any]
    clips: list[dict[str, Any]]


def read_report(path: Path) -> EditReport:
    """Return a report of `edit-pc` or `edit-prioritized`.

    Raises
    ------
    UsageError
        It cannot be read, is no such report, or is another command's.
    """
    name = str(path)
    try:
        data = json_of(read_file(path))
    except OSError as error:
        raise UsageError(f"cannot be read: {error.strerror or error}", file=name) from error
    except ValueError as error:  # not JSON, or not text at all
        raise UsageError("is no JSON; give a report that an edit wrote with --report", file=name) from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA or not isinstance(data.get("clips"), list):
        raise UsageError(f"is no report ({SCHEMA}); give one that an edit wrote with --report", file=name)
    if data.get("command") not in COMMANDS:
        raise UsageError(
            f"is a report of {data.get('command')}; a page shows those of {' and '.join(COMMANDS)}", file=name
        )
    if not _is_sensible(data):
        raise UsageError("has numbers beyond sense; give a report as an edit wrote it", file=name)
    spec = data.get("spec")
    return EditReport(name, spec if isinstance(spec, dict) else {}, [c for c in data["clips"] if isinstance(c, dict)])


def _is_sensible(value: object) -> bool:
    """Tell whether all numbers in plain values are such as lengths, angles and frames are."""
    if isinstance(value, dict):
        return all(map(_is_sensible, value.values()))
    if isinstance(value, list):
        return all(map(_is_sensible, value))
    return not isinstance(value, (int, float)) or abs(value) <= BEYOND_SENSE


@dataclass(frozen=True)
class Match:
    """A clip of a report, and the places among the clips given of what was written and of what it was written from."""

    record: dict[str, Any]
    edited: int
    before: int | None


def matches(report: EditReport, tasks: Sequence[ClipTask]) -> list[Match]:
    """Return the report's clips that are among those given: by the path of their `output`, else by its stem.

    Raises
    ------
    UsageError
        None is.
    """
    written = [record for record in report.clips if isinstance(record.get("output"), str)]
    found: dict[int, dict[str, Any]] = {}
    stems = Counter(Path(record["output"]).stem for record in written)
    for find in (_by_path, _by_stem):
        for record in written:
            if any(record is other for other in found.values()) or (find is _by_stem and stems[_stem(record)] > 1):
                continue
            free = {i: task.source for i, task in enumerate(tasks) if task.source is not None and i not in found}
            edited = find(record, free)
            if edited is not None:
                found[edited] = record
    if not found:
        raise UsageError(f"fits none of the clips given: {_wrote(written)}", file=report.name)
    return [Match(record, edited, _before(record, edited, tasks)) for edited, record in sorted(found.items())]


def _wrote(records: Sequence[dict[str, Any]]) -> str:
    if not records:
        return "it wrote none"
    others = f" and {len(records) - 1} more" if len(records) > 1 else ""
    return f"it wrote {records[0]['output']}{others}; give that too"


def _stem(record: dict[str, Any]) -> str:
    return Path(record["output"]).stem


def _by_path(record: dict[str, Any], free: dict[int, Path]) -> int | None:
    wanted = identity(Path(record["output"]))
    return next((i for i, path in free.items() if record["output"] == _told(path) or identity(path) == wanted), None)


def _told(path: Path) -> str:
    """Return a path as a report has it, whose text has no bytes that are none."""
    return str(path).encode(errors="replace").decode()


def _by_stem(record: dict[str, Any], free: dict[int, Path]) -> int | None:
    """Return the last clip of that stem: of two of one name, the edited one is given after its input."""
    source = identity(Path(str(record.get("clip"))))
    return next((i for i, p in reversed(free.items()) if p.stem == _stem(record) and identity(p) != source), None)


def _before(record: dict[str, Any], edited: int, tasks: Sequence[ClipTask]) -> int | None:
    """Return the input's place: by its path, else by its stem, else the other one of two."""
    source = Path(str(record.get("clip")))
    others = {i: task.source for i, task in enumerate(tasks) if i != edited and task.source is not None}
    named = [i for i, path in others.items() if record.get("clip") == _told(path) or identity(path) == identity(source)]
    named += [i for i, path in others.items() if path.stem == source.stem]
    named += [1 - edited] if len(tasks) == 2 else []
    return named[0] if named else None
