"""Names of files and joints as a terminal may have them: what would steer it, or is no text, is shown as its number."""

from __future__ import annotations


def printable(text: str) -> str:
    r"""Return a text of any lines with escapes, other control characters and bytes that are no letters as ``\x1b``."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n\t" else c.encode("unicode_escape").decode() for c in text)
