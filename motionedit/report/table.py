"""Tables for the terminal: one row per clip, and the numbers a busy person looks for."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any
from unicodedata import combining, east_asian_width

if TYPE_CHECKING:
    from collections.abc import Sequence

# Of more clips than this, only those that are not ok get a row, unless more is asked for; of more components the first.
MOST_ROWS = 40


def text_table(headings: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return rows under their headings, aligned: numbers right, text left; columns without any value left out."""
    cells = [[number(value) for value in row] for row in rows]
    kept = [c for c in range(len(headings)) if any(row[c] for row in cells)]
    lines = [[headings[c] for c in kept], *([row[c] for c in kept] for row in cells)]
    right = [all(_is_number(row[c]) for row in cells) for c in kept]
    widths = [max(width_of(line[i]) for line in lines) for i in range(len(kept))]
    return "\n".join(
        "  ".join(
            cell.rjust(width) if numeric else padded(cell, width)
            for cell, width, numeric in zip(line, widths, right, strict=True)
        ).rstrip()
        for line in lines
    )


def width_of(text: str) -> int:
    """Return how many columns of a terminal a text takes: two for each wide letter, such as those of Japanese names."""
    if text.isascii():
        return len(text)
    return sum(0 if combining(letter) else 1 + (east_asian_width(letter) in "WF") for letter in text)


def padded(text: str, width: int) -> str:
    """Return a text with blanks after it, so that it is as wide."""
    return text + " " * (width - width_of(text))


def number(value: object) -> str:
    """Return a value as a table shows it: four digits, no exponent for large numbers, nothing for None."""
    if value is None:
        return ""
    if not isinstance(value, float):
        return str(value)
    if abs(value) >= 1000.0:
        return f"{value:.0f}"
    return f"{value:.4g}" if value == 0.0 or abs(value) >= 1e-3 else f"{value:.0e}"


def results_table(records: Sequence[dict[str, Any]], seconds: Sequence[float | None], *, verbosity: int = 0) -> str:
    """Return the results of a run: a row per clip, with -v the goals of each clip.

    `seconds` are the records' own; a clip without any, which an earlier run made, has no row.
    """
    rows, units, goals = [], set(), []
    every = verbosity > 0 or sum(time is not None for time in seconds) <= MOST_ROWS
    for record, time in zip(records, seconds, strict=True):
        if time is None or not (every or record["status"] != "ok"):
            continue
        rows.append(_row(record, time))
        if record["status"] != "failed":
            units.add(record.get("unit"))
        if verbosity > 0 and _goals(record):
            goals.append(_goals_table(record))
    headings = (
        *("clip", "status", "worst goal", "error" + _in(units), "tolerance", "frame"),
        *("iterations", "foot slide", "sliding", "jerk", "step", "seconds"),
    )
    return "\n".join([*([text_table(headings, rows)] if rows else []), *goals])


def count_line(statuses: Sequence[str]) -> str:
    """Return the line that counts clips by their status, which ends a run of several."""
    return f"{len(statuses)} clips: " + ", ".join(f"{n} {status}" for status, n in Counter(statuses).items())


def _in(units: set[str | None]) -> str:
    """Return the unit of the errors where all clips have one."""
    (unit,) = units if len(units) == 1 else (None,)
    return f" ({unit})" if unit else ""


def _row(record: dict[str, Any], seconds: float) -> tuple[object, ...]:
    worst: dict[str, Any] = max(_goals(record), key=_weight, default={})
    error, tolerance = _worst_error(worst)
    return (
        record["clip"],
        record["status"],
        worst.get("name"),
        error,
        tolerance,
        worst.get("frame"),
        _iterations(record),
        _change(record, "foot_slide_max"),
        _percent(record, "foot_sliding_share"),
        _ratio(record, "jerk_rms"),
        _step(record),
        None if record["status"] == "failed" else f"{seconds:.2f}",
    )


def _worst_error(goal: dict[str, Any]) -> tuple[str | None, str | None]:
    """Return a goal's error and tolerance: the length, or the angle where that is the larger part of its tolerance."""
    length, angle = ((goal.get(f"error{kind}_max"), goal.get(f"tolerance{kind}")) for kind in ("", "_angle"))
    if length[0] is not None and (angle[0] is None or _share(*length) >= _share(*angle)):
        return number(length[0]), number(length[1]) or "off"
    if angle[0] is None:
        return None, None
    return f"{number(angle[0])}°", f"{number(angle[1])}°" if angle[1] is not None else "off"


def _share(error: float | None, tolerance: float | None) -> float:
    """Return an error as a share of its tolerance; 0 where it may be anything."""
    return error / tolerance if error is not None and tolerance else 0.0


def _goals(record: dict[str, Any]) -> list[dict[str, Any]]:
    goals: list[dict[str, Any]] = record.get("goals") or record.get("constraints") or []
    return goals


def _goals_table(record: dict[str, Any]) -> str:
    error = "error" + _in({record.get("unit")})
    headings = (
        record["clip"],
        "priority",
        error,
        "tolerance",
        "degrees",
        "tolerance",
        "frame",
        "status",
        "gave way to",
    )
    keys = ("name", "priority", "error_max", "tolerance", "error_angle_max", "tolerance_angle", "frame", "status")
    rows = [
        (*(goal.get(key) for key in keys), ", ".join(goal.get("gave_way_to") or ()) or None) for goal in _goals(record)
    ]
    return "\n" + text_table(headings, rows)


def _measures(record: dict[str, Any], key: str) -> tuple[float, float] | None:
    """Return a measure before and after the edit, None where one is not known."""
    metrics = record.get("metrics") or {}
    before, after = ((metrics.get(side) or {}).get(key) for side in ("before", "after"))
    return None if before is None or after is None else (before, after)


def _weight(goal: dict[str, Any]) -> tuple[bool, bool, float, float]:
    """Return what tells the worst goal: what is missed, what --strict counts, the share of its tolerance, how far."""
    length, angle = (goal.get(f"error{kind}_max") for kind in ("", "_angle"))
    share = max(_share(length, goal.get("tolerance")), _share(angle, goal.get("tolerance_angle")))
    return goal.get("status") != "ok", bool(goal.get("strict", True)), share, float(length or angle or 0.0)


def _iterations(record: dict[str, Any]) -> str | None:
    """Return the iterations of a solve; of many, one for each frame, the median and the largest number."""
    found = record.get("iterations")
    if isinstance(found, dict):
        return f"{found['median']:g}, max {found['max']}"
    return None if found is None else str(found)


def _change(record: dict[str, Any], key: str) -> str | None:
    """Return a measure before and after, as ``1.2 -> 1.3``."""
    found = _measures(record, key)
    return found and f"{number(found[0])} -> {number(found[1])}"


def _percent(record: dict[str, Any], key: str) -> str | None:
    """Return a share before and after, as ``97 -> 0 %``."""
    found = _measures(record, key)
    return found and f"{100.0 * found[0]:.3g} -> {100.0 * found[1]:.3g} %"


def _ratio(record: dict[str, Any], key: str) -> str | None:
    """Return a measure after over before, as ``1.04 x``."""
    found = _measures(record, key)
    return f"{found[1] / found[0]:.2f} x" if found and found[0] > 0.0 else None


def _step(record: dict[str, Any]) -> str | None:
    """Return the largest step of a joint's change, as ``1.2°``: in a sixtieth of a second."""
    found = _measures(record, "step_max")
    return found and f"{number(found[1])}°"


def _is_number(text: str) -> bool:
    return (
        not text
        or text.replace(".", "").replace("e-", "").removeprefix("-").removesuffix(" x").removesuffix("°").isdecimal()
    )
