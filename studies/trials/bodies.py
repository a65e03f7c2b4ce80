"""The clips of the trials, and which joint plays which part in them: typed by hand, nothing is found by the package."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from studies.trials.kinematics import Take, read_take

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import FloatArray

ROOT = Path(__file__).resolve().parents[2]
SIDES = ("Left", "Right")
_LEG = 0.85  # metres, to which lengths are scaled

# Part: the joint's name; {side} is Left or Right, {s} L or R. Parts that a body does not have are not there.
_CMU = {
    "hips": "Hips",
    "chest": "Spine1",
    "head": "Head",
    "thigh": "{side}UpLeg",
    "knee": "{side}Leg",
    "ankle": "{side}Foot",
    "toe": "{side}ToeBase",
    "clavicle": "{side}Shoulder",
    "shoulder": "{side}Arm",
    "elbow": "{side}ForeArm",
    "wrist": "{side}Hand",
}
_EIGHT = {**_CMU, "chest": "Spine"}
_CHARACTER = {
    "hips": "CC_Base_Hip",
    "chest": "CC_Base_Spine02",
    "head": "CC_Base_Head",
    "thigh": "CC_Base_{s}_Thigh",
    "knee": "CC_Base_{s}_Calf",
    "ankle": "CC_Base_{s}_Foot",
    "toe": "CC_Base_{s}_ToeBase",
    "clavicle": "CC_Base_{s}_Clavicle",
    "shoulder": "CC_Base_{s}_Upperarm",
    "elbow": "CC_Base_{s}_Forearm",
    "wrist": "CC_Base_{s}_Hand",
}
_CMU_131 = {
    "hips": "Hips",
    "chest": "Chest2",
    "head": "Head",
    "thigh": "{side}Hip",
    "knee": "{side}Knee",
    "ankle": "{side}Ankle",
    "toe": "{side}Toe",
    "clavicle": "{side}Collar",
    "shoulder": "{side}Shoulder",
    "elbow": "{side}Elbow",
    "wrist": "{side}Wrist",
}
_KARATE = {k: v for k, v in _CMU.items() if k != "toe"} | {
    "thigh": "{side}Thigh",
    "elbow": "{side}Forearm",
    "chest": "Chest",
}


@dataclass(frozen=True)
class Source:
    """Where a clip is, below data/ or below the folder of real clips; its parts; its first frame after a rest pose."""

    file: str
    parts: Mapping[str, str]
    first: int = 0
    ships: bool = False


SOURCES = {
    "walk": Source("walk.bvh", _CMU, ships=True),
    "kick": Source("kick.bvh", _CMU, ships=True),
    "walk12": Source("motions/cmu_12_01_walk.bvh", _CMU, 1),
    "walk0701": Source("motions/cmu07/cmu_07_01_walk.bvh", _CHARACTER),
    "walk0704": Source("motions/cmu07/cmu_07_04_walk.bvh", _CHARACTER, 1),
    "eight": Source("motions/av_8walk.bvh", _EIGHT),
    "run": Source("motions/cmu_02_03_run.bvh", _CHARACTER),
    "punch": Source("motions/cmu_02_05_punch_strike.bvh", _CHARACTER),
    "bend": Source("motions/cmu_02_06_bend_scoop_rise.bvh", _CHARACTER),
    "uneven": Source("motions/cmu_03_01_uneven_terrain.bvh", _CHARACTER),
    "walk131": Source("motions/cmu_131_01_walk.bvh", _CMU_131),
    "mawashi": Source("motions/karate_mawashi_geri_left_1.bvh", _KARATE),
    "jump39": Source("motions/cmu13/cmu_13_39_jump.bvh", _CMU, 1),
    "jump42": Source("motions/cmu13/cmu_13_42_jump.bvh", _CMU, 1),
}


@dataclass(frozen=True, eq=False)
class Body:
    """A clip of the trials: its file, its motion in the world, and its parts, ``wrist Left`` or ``head``."""

    name: str
    path: Path
    take: Take
    parts: Mapping[str, str]
    first: int

    def joint(self, part: str) -> int:
        """Return the joint of a part."""
        return self.take.names.index(self.parts[part])

    def place(self, part: str) -> FloatArray:
        """Return where a part is in mid-clip, shape (3,)."""
        place: FloatArray = self.take.positions[self.middle, self.joint(part)]
        return place

    def turn(self, part: str) -> FloatArray:
        """Return how a part is turned in mid-clip, shape (3, 3)."""
        turn: FloatArray = self.take.rotations[self.middle, self.joint(part)]
        return turn

    @property
    def middle(self) -> int:
        """The frame in mid-clip."""
        return len(self.take) // 2

    @cached_property
    def metre(self) -> float:
        """Clip units a metre, at a leg of 0.85 m."""
        bones = [
            np.linalg.norm(self.take.joints[self.joint(f"{part} {side}")].offset)
            for part in ("knee", "ankle")
            for side in SIDES
        ]
        return float(np.sum(bones)) / 2.0 / _LEG

    @cached_property
    def axes(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Left, up and forward of the body in mid-clip, in the world; y is up."""
        left = (self.place("thigh Left") - self.place("thigh Right")) * [1.0, 0.0, 1.0]
        left /= np.linalg.norm(left)
        up = np.array([0.0, 1.0, 0.0])
        return left, up, np.cross(left, up)

    def way(self, *, left: float = 0.0, up: float = 0.0, forward: float = 0.0) -> FloatArray:
        """Return a way of so many metres, shape (3,), clip units."""
        way: FloatArray = np.array([left, up, forward]) @ np.stack(self.axes) * self.metre
        return way

    def frames(self, seconds: float) -> int:
        """Return how many frames so many seconds are."""
        return max(1, round(seconds / self.take.frame_time))

    def span(self, start: float, stop: float) -> list[int]:
        """Return two frames at shares of the clip."""
        return [int(start * len(self.take)), int(stop * len(self.take))]

    @property
    def feet(self) -> list[str]:
        """The names of ankles and toes."""
        parts = [f"{part} {side}" for side in SIDES for part in ("ankle", "toe")]
        return [self.parts[part] for part in parts if part in self.parts]


def body_of(name: str, clips: Path | None) -> Body:
    """Return a body of `SOURCES`; `clips` is the folder of real clips."""
    source = SOURCES[name]
    folder = ROOT / "data" if source.ships else clips
    if folder is None:
        raise FileNotFoundError(source.file)
    parts = {
        f"{part} {side}" if "{s" in joint else part: joint.format(side=side, s=side[0])
        for part, joint in source.parts.items()
        for side in SIDES
    }
    path = folder / source.file
    return Body(name, path, read_take(path), parts, source.first)


def names_of(clips: Path | None) -> Sequence[str]:
    """Return the names of all bodies whose files are there."""
    return [
        name
        for name, source in SOURCES.items()
        if source.ships or (clips is not None and (clips / source.file).exists())
    ]
