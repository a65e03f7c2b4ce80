"""Print the oldest releases of what motionedit needs to run and to draw, as pyproject.toml has them: NAME==VERSION.

Usage: python .ci/lowest.py > constraints.txt
"""

from __future__ import annotations

import tomllib
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"


def lowest(project: Path = PROJECT) -> list[str]:
    """Return a pin for each dependency, of the extra `plot` too; each has to have a floor and nothing else."""
    named = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    pins = []
    for requirement in (*named["dependencies"], *named["optional-dependencies"]["plot"]):
        name, floor, version = requirement.partition(">=")
        if not floor or not version.replace(".", "").isdigit():
            raise SystemExit(f"{project}: {requirement}: give a floor, NAME>=VERSION")
        pins.append(f"{name}=={version}")
    return pins


if __name__ == "__main__":
    print(*lowest(), sep="\n")
