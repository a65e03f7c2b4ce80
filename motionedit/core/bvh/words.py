"""The words of a BVH file's header, one after the other, and faults with the lines that they stand in."""

from __future__ import annotations

import re
from typing import NoReturn

from motionedit.core.bvh.scan import WORD_LENGTH, quoted, refusal

# Possessive, so that a file of blanks is walked once; the length is bounded, so that a word without end is cut.
_WORD = re.compile(rb"\s*+([{}]|[^\s{}]{1,%d}+)" % (WORD_LENGTH + 1))
_REST_OF_LINE = re.compile(rb"[^\r\n{}]*+")
_COUNT = re.compile(rb"[0-9]{1,15}")


class Words:
    """A file, and the byte `at` to read on from; `label` is what messages call it."""

    def __init__(self, data: bytes, label: str) -> None:
        self.data = data
        self.label = label
        self.at = 0

    def refuse(self, message: str, at: int) -> NoReturn:
        """Raise the error for a fault at a byte."""
        raise refusal(self.data, message, label=self.label, at=at)

    def word(self) -> tuple[bytes, int]:
        """Return the next word or brace and its place, and move past it; b"" at the end of the file."""
        match = _WORD.match(self.data, self.at)
        if match is None:
            return b"", len(self.data.rstrip())
        word, at = match.group(1), match.start(1)
        self._refuse_endless(word, at)
        self.at = match.end()
        return word, at

    def rest_of_line(self) -> bytes:
        """Return what stands up to a brace or the line's end, stripped, and move past it."""
        match = _REST_OF_LINE.match(self.data, self.at)
        assert match is not None  # noqa: S101 (the pattern matches the empty string)
        rest = match.group().strip()
        self._refuse_endless(rest, self.at)
        self.at = match.end()
        return rest

    def _refuse_endless(self, word: bytes, at: int) -> None:
        if len(word) > WORD_LENGTH:
            self.refuse(f"{quoted(word)} is longer than {WORD_LENGTH} characters", at)


def shown(word: bytes) -> str:
    """Return a word that was found as text for a message; the end of the file is nothing."""
    return quoted(word) if word else "nothing"


def is_count(word: bytes) -> bool:
    """Return whether a word is a whole number, with no sign."""
    return _COUNT.fullmatch(word) is not None
