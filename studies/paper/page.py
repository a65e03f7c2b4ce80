"""The blocks of docs/papers.md that hold what the studies printed.

A block is a comment ``<!-- make paper: NAME -->`` and the ```text below it. One whose comment ends in ``quoted`` holds
times, or figures of clips that are not part of the project: it is what one run printed, and is not compared.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from studies.paper.study import Table

_BLOCK = re.compile(
    r"(?P<head><!-- make paper: (?P<name>[\w-]+)(?P<quoted>, quoted)? -->\n```text\n)(?P<text>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)


def with_tables(page: str, tables: Iterable[Table]) -> str:
    """Return the page with these tables in their blocks; those that the page does not show are left out."""
    texts = {table.name: f"{table.text}\n" for table in tables}
    return _BLOCK.sub(lambda found: f"{found['head']}{texts.get(found['name'], found['text'])}```", page)


def shown_tables(page: str) -> dict[str, tuple[str, bool]]:
    """Return the text of each block by its name, and whether it is quoted."""
    return {
        found["name"]: (found["text"].removesuffix("\n"), found["quoted"] is not None)
        for found in _BLOCK.finditer(page)
    }
