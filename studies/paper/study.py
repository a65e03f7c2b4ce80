"""What the studies of the papers share: a scratch lab, the golf database, and what a study hands back."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.bvh import read_clip
from motionedit.core.pca.model_file import read_model
from studies.lab import effector_path, table_text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from motionedit.core.pca.model import MotionModel
    from studies.lab import Edited, Lab

ROOT = Path(__file__).resolve().parents[2]
GOLF = {"events": {"hit": {"frames": str(ROOT / "data" / "golf" / "events.csv")}}}
# The solver of [PC], and its output: centimetres, xi = 10, stop at 1 cm; eq. (3) alone on the timeline.
ALGORITHM_1 = {"method": "damped", "damping": 10.0, "damping_unit": "cm", "max_iterations": 1500, "tolerance": 1.0}
# Components alone, the smallest change of coefficients.
COMPONENTS_ALONE: dict[str, Any] = {"solver": {"method": "gauss-newton"}}
PAPERS_OUTPUT = {"residual": "drop", "timing": "normalized"}
# The method of [PRIO]: the FIR filter and a pass that repairs, joints that give alike and turn as far as they like.
AS_PRIO = {"smoothing": {"method": "paper", "passes": 2}, "stiffness": "none", "limits": "off", "hinges": "off"}


@dataclass(frozen=True)
class Table:
    """A table of a study: `name` is that of its block in docs/papers.md; headings are the first of `rows`.

    `quoted`: it holds times, or needs clips that are not part of the project, so it is not compared with the page.
    """

    name: str
    title: str
    rows: tuple[tuple[str, ...], ...]
    quoted: bool = False

    @property
    def text(self) -> str:
        """The table as it is printed."""
        return table_text(self.title, self.rows)


@dataclass(frozen=True)
class Findings:
    """What a study found: tables, and pictures by name."""

    tables: tuple[Table, ...] = ()
    pictures: Mapping[str, Figure] = field(default_factory=dict)


class Study:
    """What a study works with: a lab, the clips of data/, the folder of real clips or None.

    `quick` asks for a few clips and goals in place of all, to see that everything runs.
    """

    def __init__(self, lab: Lab, *, clips: Path | None = None, quick: bool = False) -> None:
        self.lab, self.clips, self.quick = lab, clips, quick
        # Of what is timed: others may be at work on the machine, which only ever adds time.
        self.rounds = 1 if quick else 3
        self.swings = [ROOT / "data" / "golf" / f"swing{n:02d}.bvh" for n in range(1, 11)]
        lines = [line.split("\t") for line in (ROOT / "data" / "golf" / "balls.tsv").read_text().splitlines()[1:]]
        self.styles = [int(line[1]) for line in lines]
        self.balls = np.array([[float(x) for x in line[2:]] for line in lines])
        events = (ROOT / "data" / "golf" / "events.csv").read_text().split()[1:]
        self.hits = [int(line.split(",")[1]) for line in events]

    @cached_property
    def model_path(self) -> Path:
        """The model of the ten swings."""
        return self.lab.model(self.swings, GOLF)

    @cached_property
    def model(self) -> MotionModel:
        """The same, read."""
        return read_model(self.model_path)

    def edit(self, swing: int, goal: Mapping[str, Any], *, model: Path | None = None, **spec: Any) -> Edited:  # noqa: ANN401  keys of a spec
        """Return a swing (0-based) edited by one goal on the club's head at the hit."""
        ball = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, **goal}
        content = {"unit": "cm", "goals": [ball], **spec}
        return self.lab.edit(self.swings[swing], model or self.model_path, content)

    def near_balls(self, swing: int, *, least: float, most: float) -> list[int]:
        """Return the swings (0-based) whose balls lie this far from a swing's own, the nearest first."""
        apart = np.linalg.norm(self.balls - self.balls[swing], axis=1)
        return [int(i) for i in np.argsort(apart) if least <= apart[i] <= most]


def club_head(path: Path) -> FloatArray:
    """Return the path of the club's head, shape (F, 3)."""
    return effector_path(path, "Club", end_site=True)


def joint(path: Path, name: str) -> int:
    """Return the index of a joint of a clip."""
    return read_clip(path).motion.skeleton.names.index(name)


def spread(values: FloatArray | list[float], form: str) -> str:
    """Return ``median (least to most)``."""
    low, middle, high = np.percentile(values, [0, 50, 100])
    return f"{middle:{form}} ({low:{form}} to {high:{form}})"
