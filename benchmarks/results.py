"""What pages of results are made of: the machine in a line, a table under each title."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def machine() -> str:
    """Return the machine in a line: cores, processor, versions."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    names = ", ".join(f"{name} {version(name)}" for name in ("numpy", "bvhio"))
    return f"{cores} cores, {_processor()}, Python {platform.python_version()}, {names}"


def _processor() -> str:
    described = Path("/proc/cpuinfo")
    lines = described.read_text().splitlines() if described.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def table(title: str, rows: Sequence[Sequence[str]]) -> str:
    """Return a table under its title, as a part of a page; the first row is its heads."""
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([f"\n## {title}\n", lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])
