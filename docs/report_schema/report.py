"""The JSON Schema of a report: what each command's `--report` holds."""

from __future__ import annotations

from motionedit.report.record import SCHEMA
from report_schema.edits import EDIT_PARTS
from report_schema.forms import WARNINGS, Schema, list_of, obj, or_null, part, text
from report_schema.others import MODEL, OTHER_PARTS

# What stands in `clips` of each command's report.
_CLIPS: dict[str, tuple[str, ...]] = {
    "normalize": ("normalized_clip", "failed"),
    "fit-pca": (),
    "edit-pc": ("pc_clip", "failed"),
    "edit-prioritized": ("prioritized_clip", "failed"),
    "info": ("shown_clip", "failed"),
    "diff": ("compared_clip",),
    "check": ("checked_clip", "failed"),
}


def report_schema() -> Schema:
    """Return the schema of every report, draft 2020-12; what it does not name is not allowed."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A report of motionedit",
        "description": "What --report writes. Lengths are in the clip's unit, angles in degrees, frames count from 0.",
        "oneOf": [part(_name(command)) for command in _CLIPS],
        "$defs": {_name(command): _report(command) for command in _CLIPS} | EDIT_PARTS | OTHER_PARTS,
    }


def _name(command: str) -> str:
    return f"{command.replace('-', '_')}_report"


def _report(command: str) -> Schema:
    kinds = _CLIPS[command]
    clips = list_of({"anyOf": [part(kind) for kind in kinds]}, "one entry per clip, in the run's order")
    return obj(
        f"The report of {command}.",
        {
            "schema": {"const": SCHEMA, "description": "another number where a key changes its meaning"},
            "version": text("the program's"),
            "command": {"const": command, "description": "what wrote it"},
            "spec": or_null({"type": "object"}, "the spec with --set applied; null where there is none"),
            "clips": clips if kinds else list_of({}, "empty: the model has no clips to write", 0),
            **(MODEL if command == "fit-pca" else WARNINGS if command == "normalize" else {}),
        },
        optional=("streamed",),
    )
