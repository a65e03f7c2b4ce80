"""Specs: YAML files with line numbers, one model for each command; nothing is imported before it is needed."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from motionedit.spec.document import Document

# Each command's module and model.
SPEC_COMMANDS = {
    "normalize": ("normalize", "NormalizeSpec"),
    "fit-pca": ("fit_pca", "FitPcaSpec"),
    "edit-pc": ("edit_pc", "EditPcSpec"),
    "edit-prioritized": ("edit_prioritized", "EditPrioritizedSpec"),
}


def schema_name(command: str) -> str:
    """Return what the first line of a command's spec says: ``motionedit/edit-pc/v1``."""
    return f"motionedit/{command}/v1"


def model_of(command: str) -> type[Document]:
    """Return the model of a command's spec."""
    module, name = SPEC_COMMANDS[command]
    found: type[Document] = getattr(import_module(f"motionedit.spec.{module}"), name)
    return found


def schema_of(command: str) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a command's spec, for editors."""
    from motionedit.spec.json_schema import schema_of_model

    return schema_of_model(model_of(command), schema_name(command))
