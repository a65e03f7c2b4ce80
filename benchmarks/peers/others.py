"""The peers' own interpreters, each in a virtual environment of its own, and what one hears from them."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

HERE = Path(__file__).resolve().parent
ENVIRONMENTS = HERE.parents[1] / ".venv-peers"
# Seconds: a peer that takes longer is left.
PATIENCE = 600
# One thread each, as ours.
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


class PeerError(Exception):
    """A peer is not there, or its script fails; the text is for the table."""


def interpreter(name: str) -> Path:
    """Return a peer's Python.

    Raises
    ------
    PeerError
        Where the Makefile could not install it.
    """
    folder = ENVIRONMENTS / name
    if not (folder / ".installed").exists():
        raise PeerError("cannot be installed here")
    return folder / "bin" / "python"


def command(name: str, arguments: Sequence[str | Path]) -> list[str]:
    """Return the command line that runs a peer's script."""
    return [str(interpreter(name)), str(HERE / f"with_{name}.py"), *map(str, arguments)]


def environment() -> dict[str, str]:
    """Return the environment in which peers and we run."""
    return {**os.environ, **dict.fromkeys(THREADS, "1")}


def ask(name: str, *arguments: str | Path) -> dict[str, Any]:
    """Return the answer of a peer's script, the last line that it prints.

    Raises
    ------
    PeerError
        Where it is not installed, fails, takes too long, or says something else.
    """
    line = command(name, arguments)
    try:
        done = subprocess.run(line, env=environment(), capture_output=True, text=True, timeout=PATIENCE, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise PeerError(f"does not run: {type(error).__name__}") from error
    said = done.stdout.strip().splitlines()
    if done.returncode != 0 or not said:
        complaint = done.stderr.strip().splitlines()
        raise PeerError(f"fails: {complaint[-1][:80] if complaint else done.returncode}")
    try:
        answer: dict[str, Any] = json.loads(said[-1])
    except ValueError as error:
        raise PeerError("fails: says nothing that can be read") from error
    return answer


def versions(answer: dict[str, Any]) -> str:
    """Return the versions in an answer, as a table's footnote has them."""
    return ", ".join(f"{name} {number}" for name, number in answer["versions"].items())
