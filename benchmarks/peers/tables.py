"""The page of results as text: the introduction, the machine, a table under each title."""

from __future__ import annotations

from benchmarks.results import table

INTRODUCTION = """\
# Beside other tools

Written by `make bench-peers`; what it means is in [docs/comparison.md](../docs/comparison.md). Times are the best of
several rounds in which all that is compared takes a turn, so ratios hold on other machines, times do not. One thread
each. Errors are for a body with legs of 0.85 m.
"""

Table = list[tuple[str, ...]]


def page(described: str, parts: list[tuple[str, Table]]) -> str:
    """Return the page of results: the introduction, the machine, a table under each title."""
    return "\n".join([INTRODUCTION, described, *(table(title, rows) for title, rows in parts)]) + "\n"
