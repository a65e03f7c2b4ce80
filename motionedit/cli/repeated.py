"""Lines that many clips have in common: a few of each kind are said, the others are counted."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_SAID = 3


def few_of_each_kind(lines: Sequence[tuple[str | None, str]], *, rest: str) -> Iterator[str]:
    """Yield lines, of each kind the first few, and after these one with the number of the others.

    Parameters
    ----------
    lines : sequence of (str or None, str)
        Kind and text; all lines of kind None are said.
    rest : str
        What follows that number: what they are (``{kind}`` is their kind), and where to find them.
    """
    of_kind, said = Counter(kind for kind, _ in lines), Counter[str | None]()
    for kind, line in lines:
        said[kind] += 1
        # One more takes no more room than the line that counts it.
        if kind is None or said[kind] <= _SAID or of_kind[kind] == _SAID + 1:
            yield line
        if kind is not None and said[kind] == _SAID < of_kind[kind] - 1:
            yield f"{of_kind[kind] - _SAID:,} more {rest.format(kind=kind)}"
