"""The tool's own jobs as functions over a scratch folder: normalize, fit, edit, and what came out, measured by FK."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

import motionedit
from motionedit.core import kinematics
from motionedit.core.bvh import Clip, read_clip, resampled_bytes
from motionedit.core.kinematics import Effector

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.arrays import FloatArray

DIRECTIONS = np.vstack((np.eye(3), -np.eye(3)))


@dataclass(frozen=True)
class Edited:
    """One edited clip: the file written, its record in the report, what was warned of."""

    path: Path
    record: dict[str, Any]
    warnings: tuple[str, ...] = ()


class Lab:
    """A scratch folder in which every step gets a place of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._count = itertools.count()

    def place(self) -> Path:
        """Return a new folder."""
        path = self.folder / f"{next(self._count):05d}"
        path.mkdir(parents=True)
        return path

    def normalized(self, clips: Sequence[Path], spec: dict[str, Any]) -> Path:
        """Return the folder of clips normalized by a spec."""
        return motionedit.normalize(clips, spec).write(self.place())

    def model(self, clips: Sequence[Path], spec: dict[str, Any], *, fit: dict[str, Any] | None = None) -> Path:
        """Return the model of clips, normalized by a spec."""
        return motionedit.fit_pca(motionedit.normalize(clips, spec), fit).write(self.place() / "model.npz")

    def edit(self, clip: Path, model: Path, spec: dict[str, Any]) -> Edited:
        """Return a clip edited by a spec."""
        return self._written(motionedit.edit_pc(clip, model, spec))

    def edit_prioritized(self, clip: Path, spec: dict[str, Any]) -> Edited:
        """Return a clip edited by constraints."""
        return self._written(motionedit.edit_prioritized(clip, spec))

    def _written(self, edit: motionedit.Edited) -> Edited:
        return Edited(edit.write(self.place()), edit.report, tuple(edit.warnings))

    def cut(self, clip: Clip, start: int, stop: int, name: str) -> Path:
        """Return a file with frames start to stop (both in) of a clip."""
        rows = slice(start, stop + 1)
        motion = clip.motion
        part = motion.at(rows)
        path = self.place() / name
        path.write_bytes(resampled_bytes(clip, part))
        return path


def effector_path(path: Path, joint: str, *, end_site: bool = False) -> FloatArray:
    """Return the world positions of a point over all frames of a file, shape (F, 3)."""
    motion = read_clip(path).motion
    index = motion.skeleton.names.index(joint)
    local = np.zeros(3)
    if end_site:
        local = next(site.offset for site in motion.skeleton.end_sites if site.joint == index)
    return kinematics.effector_positions(kinematics.forward(motion), Effector(index, local))


def joint_positions(path: Path) -> FloatArray:
    """Return the world positions of all joints of a file, shape (F, J, 3)."""
    return kinematics.forward(read_clip(path).motion).positions


def jerk(positions: FloatArray) -> float:
    """Return the root mean square third difference."""
    return float(np.sqrt(np.mean(np.diff(positions, 3, axis=0) ** 2)))


def largest_jerk(positions: FloatArray) -> float:
    """Return the largest third difference."""
    return float(np.linalg.norm(np.diff(positions, 3, axis=0), axis=-1).max())


def table_text(title: str, rows: Sequence[Sequence[str]]) -> str:
    """Return rows under a title, the columns aligned."""
    widths = [max(len(row[c]) for row in rows) for c in range(len(rows[0]))]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join([title, "", *(f"  {line}".rstrip() for line in lines)])


def print_table(title: str, rows: Sequence[Sequence[str]]) -> None:
    """Print rows under a title, the columns aligned."""
    print(f"\n{table_text(title, rows)}")
