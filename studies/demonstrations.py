"""The demonstrations of [PRIO] as specs: those of configs/, and the same asked of any clip, sized to its body."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.bvh import read_clip
from motionedit.jobs.clip.facts import facts_of
from motionedit.spec.load import load_spec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.body.contacts import Plant

ROOT = Path(__file__).resolve().parents[1]


def config(name: str) -> dict[str, Any]:
    """Return a spec of configs/ as plain data, without its schema."""
    data = load_spec(ROOT / "configs" / f"{name}.yaml", "edit-prioritized").data
    return {key: value for key, value in data.items() if key != "schema"}


def reach(clip: Path, *, axes: Sequence[str] = ("x", "z")) -> list[dict[str, Any]]:
    """Return a hand that reaches up and out in mid-clip, above the CoM, by default on the ground plane.

    Feet that may not roll make the legs lift and lower the body: its height cannot stay as it was for nothing.
    """
    motion = read_clip(clip).motion
    skeleton, anatomy = motion.skeleton, anatomy_of(motion)
    hand = skeleton.names[anatomy.arms[0].wrist] if anatomy.arms else ""
    at, size = len(motion) // 2, anatomy.leg_length
    shift = [0.2 * size, 0.5 * size, 0.2 * size]
    return [
        {"type": "position", "effector": hand, "priority": 4, "points": [{"at": at, "shift": shift}]},
        {"type": "com", "priority": 2, "relative_to": "world", "axes": list(axes)},
    ]


def step(clip: Path) -> list[dict[str, Any]]:
    """Return a high-priority ankle over low-priority feet."""
    motion = read_clip(clip).motion
    skeleton, anatomy = motion.skeleton, anatomy_of(motion)
    feet = [skeleton.names[j] for _, j in anatomy.foot_points]
    at, lift = len(motion) // 2, [0, 0.3 * anatomy.leg_length, 0]
    ankle = skeleton.names[anatomy.legs[1].ankle] if anatomy.legs else feet[0]
    return [
        {"type": "position", "effector": ankle, "priority": 10, "points": [{"at": at, "shift": lift}]},
        {"type": "position", "effector": feet, "priority": 2, "tolerance": "off"},
    ]


def karate(clip: Path) -> list[dict[str, Any]]:
    """Return a kick that goes higher while the support foot rides its own path."""
    facts = facts_of(read_clip(clip))
    anatomy, up = facts.anatomy, facts.up
    left, right = (foot.ankle for foot in anatomy.legs or ())
    heights = {j: facts.poses.positions[:, j] @ up for j in (left, right)}
    kick, support = (left, right) if heights[left].max() > heights[right].max() else (right, left)
    names, rise = facts.clip.motion.skeleton.names, [float(x) for x in 0.12 * anatomy.leg_length * up]
    at = int(np.argmax(heights[kick]))
    eases = {"ease_in": "0.35s", "ease_out": "0.35s"}
    return [
        {"type": "pose", "effector": names[support], "priority": 10},
        {"type": "com", "priority": 5, "axes": ["x", "z"]},
        {"type": "position", "effector": names[kick], "priority": 2, "points": [{"at": at, "shift": rise}], **eases},
    ]


def stairs(clip: Path) -> list[dict[str, Any]]:
    """Return a climb: every plant a step above the last, the CoM with the feet."""
    return [*foot_plants(clip, rise=0.14 * leg(clip)), {"type": "com", "priority": 5, "axes": ["x", "z"]}]


def foot_plants(clip: Path, *, rise: float = 0.0) -> list[dict[str, Any]]:
    """Return a pose for each foot that holds it in every plant of its ankle; each plant `rise` clip units higher.

    One rigid goal for a foot cannot contradict itself, as an ankle's and a toe's may.
    """
    motion = read_clip(clip).motion
    ankles = [leg.ankle for leg in anatomy_of(motion).legs or ()]
    plants = [plant for plant in plants_of(clip) if plant.joint in ankles]
    starts = sorted({plant.start for plant in plants})
    constraints: list[dict[str, Any]] = []
    for ankle in ankles:
        points = [
            {"hold": [plant.start, plant.stop], "shift": [0, rise * level(plant.start, starts), 0]}
            for plant in plants
            if plant.joint == ankle
        ]
        name = motion.skeleton.names[ankle]
        constraints.append({"type": "pose", "effector": name, "priority": 10, "points": points})
    return constraints


def plants_of(clip: Path) -> list[Plant]:
    """Return the plants of a clip's feet."""
    return list(facts_of(read_clip(clip)).plants)


def level(start: int, starts: Sequence[int]) -> int:
    """Return how many steps have been taken before a plant."""
    return sum(b > a for a, b in pairwise(starts) if b <= start)


def leg(clip: Path) -> float:
    """Return the clip's leg length."""
    return anatomy_of(read_clip(clip).motion).leg_length
