"""A reader of BVH files and forward kinematics that share nothing with the package, to measure its edits with."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.core.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint of a hierarchy: `parent` is -1 for the root; channels in the file's order."""

    name: str
    parent: int
    offset: tuple[float, float, float]
    channels: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Take:
    """A clip in the world.

    Attributes
    ----------
    joints : tuple of Joint
    positions : shape (F, J, 3), rotations : shape (F, J, 3, 3)
        Of all joints, in the world; clip units.
    frame_time : float
        Seconds.
    """

    joints: tuple[Joint, ...]
    positions: FloatArray
    rotations: FloatArray
    frame_time: float

    @property
    def names(self) -> list[str]:
        """The joints' names."""
        return [joint.name for joint in self.joints]

    @property
    def local(self) -> FloatArray:
        """The rotations against the parents, shape (F, J, 3, 3)."""
        own = self.rotations.copy()
        for j, joint in enumerate(self.joints):
            if joint.parent >= 0:
                own[:, j] = np.swapaxes(self.rotations[:, joint.parent], -1, -2) @ self.rotations[:, j]
        return own

    def __len__(self) -> int:
        return len(self.positions)


def read_take(path: Path) -> Take:
    """Return a file's motion in the world."""
    head, rows = re.split(r"^\s*MOTION\s*$", path.read_text(encoding="utf-8-sig"), maxsplit=1, flags=re.MULTILINE)
    joints = _joints(re.sub(r"([{}])", r" \1 ", head).split())
    lines = rows.split("\n")
    at = next(i for i, line in enumerate(lines) if line.strip().startswith("Frame Time"))
    values = np.array(" ".join(lines[at + 1 :]).split(), dtype=float)
    values = values.reshape(-1, sum(len(joint.channels) for joint in joints))
    return Take(joints, *_forward(joints, values), float(lines[at].split(":")[1]))


def angle(R: FloatArray) -> FloatArray:
    """Return the angles of rotation matrices (..., 3, 3), degrees."""
    turns = Rotation.from_matrix(R.reshape(-1, 3, 3)).magnitude().reshape(R.shape[:-2])
    degrees: FloatArray = np.degrees(turns)
    return degrees


def _joints(words: list[str]) -> tuple[Joint, ...]:
    """Return the joints of a hierarchy's words; names without blanks."""
    joints: list[Joint] = []
    inside: list[int] = []  # the joints whose braces are open; -1 of an end site
    i = 0
    while i < len(words):
        word = words[i]
        if word in {"ROOT", "JOINT"}:
            j = i + words[i:].index("CHANNELS")
            count = int(words[j + 1])
            x, y, z = (float(number) for number in words[i + 4 : i + 7])
            parent = inside[-1] if inside else -1
            joints.append(Joint(words[i + 1], parent, (x, y, z), tuple(words[j + 2 : j + 2 + count])))
            inside.append(len(joints) - 1)
            i = j + 2 + count
            continue
        if word == "End":
            inside.append(-1)
            i += 2
        elif word == "}":
            inside.pop()
        i += 1
    return tuple(joints)


def _forward(joints: tuple[Joint, ...], values: FloatArray) -> tuple[FloatArray, FloatArray]:
    frames = len(values)
    positions, rotations = np.zeros((frames, len(joints), 3)), np.zeros((frames, len(joints), 3, 3))
    column = 0
    for j, joint in enumerate(joints):
        place, turn = np.tile(np.array(joint.offset), (frames, 1)), Rotation.identity(frames)
        for channel in joint.channels:
            axis = channel[0].upper()
            if channel.lower().endswith("position"):
                place[:, "XYZ".index(axis)] = values[:, column]
            else:
                turn *= Rotation.from_euler(axis, values[:, column, None], degrees=True)
            column += 1
        R = turn.as_matrix()
        if joint.parent < 0:
            positions[:, j], rotations[:, j] = place, R
        else:
            above = rotations[:, joint.parent]
            positions[:, j] = positions[:, joint.parent] + np.einsum("fab,fb->fa", above, place)
            rotations[:, j] = above @ R
    return positions, rotations
