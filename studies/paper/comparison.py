"""What the two methods are asked for when a goal is moved at one frame, and what is measured of the results."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.body.quality import jerk_rms
from motionedit.core.bvh import read_clip
from studies.capsules import clearances, limb_pairs
from studies.demonstrations import plants_of
from studies.lab import joint_positions

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from motionedit.core.arrays import FloatArray
    from studies.lab import Edited, Lab

SECONDS = "Seconds of an edit, reading and writing in, least of three"  # a title
NEAR = 0.2  # s before and after the hit that count as near it


@dataclass(frozen=True)
class Task:
    """One clip and its goal: the effector (as in a spec) shall be moved by `shift` at the frame `hit`."""

    clip: Path
    hit: int
    effector: Any
    shift: FloatArray

    @property
    def pull(self) -> dict[str, Any]:
        """The goal as a shape constraint that eases in and out."""
        point = {"at": self.hit, "shift": self.shift.tolist()}
        return {"name": "goal", "type": "position", "effector": self.effector, "priority": 5, "points": [point]}


def feet(clip: Path) -> list[dict[str, Any]]:
    """Return three constraints on the feet that ride the input: all of the left one, ankle and toe of the right."""
    motion = read_clip(clip).motion
    skeleton, legs = motion.skeleton, anatomy_of(motion).legs
    if legs is None:
        return []
    names = [(skeleton.names[leg.ankle], None if leg.toe is None else skeleton.names[leg.toe]) for leg in legs]
    constraints = [{"type": "pose", "effector": names[0][0], "priority": 10}]
    constraints += [{"type": "position", "effector": joint, "priority": 10} for joint in names[1] if joint is not None]
    return constraints


def balance() -> dict[str, Any]:
    """Return the constraint that keeps the center of mass on the path that it has."""
    return {"type": "com", "priority": 2, "relative_to": "world"}


def grip() -> dict[str, Any]:
    """Return the constraint that keeps the left hand on the club as it is there."""
    return {"type": "pose", "effector": "LeftHand", "relative_to": "Club", "priority": 4}


def put_back(before: Path, after: Path, keep: Sequence[dict[str, Any]], lab: Lab) -> Edited:
    """Return an edit whose planted feet are put back to where they stood; `keep` rides what was edited."""
    positions = joint_positions(before)
    names = read_clip(before).motion.skeleton.names
    points: dict[int, list[dict[str, Any]]] = {}
    for plant in plants_of(before):
        place = positions[plant.start, plant.joint].tolist()
        points.setdefault(plant.joint, []).append({"hold": [plant.start, plant.stop], "position": place})
    plants = [
        {"type": "position", "effector": names[joint], "priority": 10, "points": held, "tolerance": "off"}
        for joint, held in points.items()
    ]
    return lab.edit_prioritized(after, {"constraints": [*plants, *keep]})


@dataclass(frozen=True)
class Outcome:
    """What came out of an edit; lengths in clip units, ratios over the input's.

    `left`: of the goal at the hit; `drift`: of planted feet; `slide`: their fastest speed per second; `jerk`: whole
    body; `overlap`: deepest of two limbs; `near`, `whole`: root mean square distance of the joints from the truth,
    NaN where there is none.
    """

    seconds: float
    left: float
    drift: float
    slide: float
    jerk: float
    overlap: float
    near: float
    whole: float

    @property
    def row(self) -> FloatArray:
        """All but the seconds."""
        return np.array([self.left, self.drift, self.slide, self.jerk, self.overlap, self.near, self.whole])


def timed(edit: Callable[[], Edited], *, rounds: int = 1) -> tuple[Edited, float]:
    """Return an edit and the seconds it took, reading and writing in: the least of some rounds."""
    seconds = []
    for _ in range(rounds):
        start = time.perf_counter()
        done = edit()
        seconds.append(time.perf_counter() - start)
    return done, min(seconds)


def outcome(
    task: Task, edited: Path, seconds: float, *, place: Callable[[Path], FloatArray], truth: Path | None
) -> Outcome:
    """Measure an edit in its file; `place` gives the effector's path (F, 3) in a file."""
    before, after = joint_positions(task.clip), joint_positions(edited)
    motion = read_clip(task.clip).motion
    plants = [(plant.joint, slice(plant.start, plant.stop + 1)) for plant in plants_of(task.clip)]
    moved = [np.linalg.norm(after[span, j] - before[span, j], axis=-1).max() for j, span in plants]
    speeds = [np.linalg.norm(np.diff(after[span, j], axis=0), axis=-1).max(initial=0.0) for j, span in plants]
    jerks = [jerk_rms(each, frame_time=motion.frame_time) for each in (before, after)]
    near, whole = _from_truth(task, after, truth, motion.frame_time)
    goal = place(task.clip)[task.hit] + task.shift
    return Outcome(
        seconds=seconds,
        left=float(np.linalg.norm(place(edited)[task.hit] - goal)),
        drift=float(max(moved, default=0.0)),
        slide=float(max(speeds, default=0.0)) / motion.frame_time,
        jerk=jerks[1] / jerks[0],
        overlap=overlap(edited),
        near=near,
        whole=whole,
    )


def overlap(clip: Path) -> float:
    """Return how deep two limbs of a clip are in each other at most, clip units; 0: they never touch."""
    motion = read_clip(clip).motion
    room = clearances(joint_positions(clip), limb_pairs(anatomy_of(motion)))
    return float(max(-room.min(initial=0.0), 0.0))


def _from_truth(task: Task, after: FloatArray, truth: Path | None, frame_time: float) -> tuple[float, float]:
    if truth is None:
        return float("nan"), float("nan")
    apart = np.sum((after - joint_positions(truth)) ** 2, axis=-1).mean(axis=1)
    reach = round(NEAR / frame_time)
    near = apart[task.hit - reach : task.hit + reach + 1]
    return float(np.sqrt(near.mean())), float(np.sqrt(apart.mean()))
