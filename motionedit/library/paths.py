"""Paths and specs as the functions of the face take them."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from motionedit.errors import UsageError
from motionedit.spec.faults import show

AnyPath = str | os.PathLike[str]
AnySpec = AnyPath | Mapping[str, Any]

# No file system that anybody uses has names of more bytes.
_LONGEST_NAME = 255
# How a spec's text may begin: a key and a colon, a mapping in braces, a comment.
_YAML = re.compile(r"\s*(?:\w[\w-]*\s*:(?:\s|$)|\{|#)")


def path_of(path: AnyPath, *, wanted: str = "a path") -> Path:
    """Return a path; ``-``, which is a stream on the command line, is refused, and so is what is no path.

    Raises
    ------
    UsageError
        It is neither; `wanted` says in the message what would be right.
    """
    name = os.fspath(path) if isinstance(path, (str, os.PathLike)) else None
    if not isinstance(name, str):
        raise UsageError(f"must be {wanted}, not a value of type {type(path).__name__}")
    if name in ("", "-") or "\0" in name:
        raise UsageError(f"{show(name)} is no file; give a path")
    if isinstance(path, str) and len(name.splitlines()) > 1:
        raise UsageError(f"{show(name)} is a text of several lines; give a path")
    if any(len(os.fsencode(part)) > _LONGEST_NAME for part in Path(name).parts):
        raise UsageError(f"{show(name)} is too long for a file's name; give a path")
    return Path(name)


def spec_of(spec: AnySpec) -> Path | Mapping[str, Any]:
    """Return a spec as `load_spec` takes it."""
    if isinstance(spec, Mapping):
        return spec
    if isinstance(spec, str) and (len(spec.splitlines()) > 1 or (_YAML.match(spec) and not os.path.lexists(spec))):
        raise UsageError(f"{show(spec)} looks like YAML text; give a spec as a path or a mapping")
    return path_of(spec, wanted="a spec, as a path or a mapping")
