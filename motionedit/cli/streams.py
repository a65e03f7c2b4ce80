"""Standard output and error that take every letter, whatever the terminal or the system's own encoding."""

from __future__ import annotations

import io
import sys


def take_every_letter() -> None:
    """Let a letter that a stream's encoding lacks be written as its number, and no error; Windows writes UTF-8.

    Windows gives pipes and files the encoding of its region: a path or a schema there would be no other program's to
    read. Names of joints and files may have any letters.
    """
    for stream in (sys.stdout, sys.stderr):
        # A program without a console has none on Windows.
        if isinstance(stream, io.TextIOWrapper):
            if sys.platform == "win32":
                stream.reconfigure(encoding="utf-8", errors="backslashreplace")
            elif stream.errors == "strict":
                stream.reconfigure(errors="backslashreplace")
