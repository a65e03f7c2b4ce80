"""Small text files read whole: UTF-8, with every reason why one cannot be in plain words."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from motionedit.regular_files import read_file
from motionedit.spec.faults import Fault

if TYPE_CHECKING:
    from pathlib import Path

# Far above any spec or table of events; a device or a film given by mistake is not read to its end.
MOST_BYTES = 4_000_000

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")
_UTF16 = (b"\xff\xfe", b"\xfe\xff")


def read_text(path: Path) -> tuple[str, Fault | None]:
    """Return a file's text without a byte order mark, and what is wrong with it; the text is then empty."""
    try:
        data = read_file(path, most=MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        return "", Fault(_reason(error))
    if len(data) > MOST_BYTES:
        return "", Fault(f"larger than {MOST_BYTES // 1_000_000} MB; is it the right file?")
    return _decoded(data)


def _decoded(data: bytes) -> tuple[str, Fault | None]:
    if data.startswith(_UTF16):
        return "", Fault("UTF-16 text; save it as UTF-8", line=1)
    if b"\0" in data:
        return "", Fault("a binary file, not text")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        return "", Fault("not UTF-8 text; save it as UTF-8", line=data.count(b"\n", 0, error.start) + 1)
    if match := _CONTROL.search(text):
        line = text.count("\n", 0, match.start()) + 1
        return "", Fault(f"the control character U+{ord(match[0]):04X} in the text; remove it", line=line)
    return text, None


def _reason(error: OSError | ValueError) -> str:
    match error:
        case FileNotFoundError():
            return "no such file"
        case IsADirectoryError():
            return "a folder, not a file"
        case PermissionError():
            return "no permission to read it"
        case OSError():
            return error.strerror or "cannot be read"
        case _:
            return "not a file name"
