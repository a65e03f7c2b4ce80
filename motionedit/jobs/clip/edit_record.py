"""What both edits say of a clip, and from when on a goal is missed where a spec gives no tolerance."""

from __future__ import annotations

from typing import Any

from motionedit.dataclass import dataclass

# Metres at leg length 0.85 m, and degrees.
DEFAULT_TOLERANCE = 1e-3
DEFAULT_ANGLE_TOLERANCE = 0.1

# What a clip comes to, the worst last: the worst of what holds is shown.
STATUSES = ("ok", "far", "rough", "out_of_tolerance", "unreachable")


def worst_status(*statuses: str) -> str:
    """Return the worst of some statuses; ``ok`` of none."""
    return max(statuses, key=STATUSES.index, default="ok")


@dataclass(frozen=True)
class EditRecord:
    """A clip's `status`, its `message` or None, its `warnings`, and its `record` in the report."""

    status: str
    message: str | None
    warnings: tuple[str, ...]
    record: dict[str, Any]
