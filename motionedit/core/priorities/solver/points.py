"""The unknowns of a solve, and how they move a point of the body: the rows that tasks are made of ([PRIO] 3)."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.bones import below
from motionedit.core.kinematics import Effector, WorldPoses, effector_positions
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class Columns:
    """The unknowns of a solve: world-axis increments of `joints` (K,), then the translation of joint `root`."""

    skeleton: Skeleton
    joints: IntArray
    root: int

    @property
    def size(self) -> int:
        """Number of unknowns, 3 K + 3."""
        return 3 * len(self.joints) + 3

    @cached_property
    def places(self) -> IntArray:
        """Each joint's place among the columns, shape (J,); -1 where it is none."""
        return frozen(places_of(self.joints, len(self.skeleton)))

    @property
    def root_is_free(self) -> bool:
        """Whether the root has all three position channels; it moves along those that it has."""
        return len(self.skeleton.position_axes[self.root]) == 3


@lru_cache(maxsize=32)
def columns_of(skeleton: Skeleton, joints: frozenset[int], root: int) -> Columns:
    """Return the unknowns of joints and a root: the same for all clips that share a skeleton."""
    return Columns(skeleton, frozen(np.array(sorted(joints), dtype=np.intp)), root)


def places_of(joints: IntArray, count: int) -> IntArray:
    """Return each joint's place among some of them, shape (count,); -1 where it is none of them."""
    places = np.full(count, -1)
    places[joints] = np.arange(len(joints))
    return places


@dataclass(frozen=True, eq=False)
class Recruited:
    """Which unknowns a task may use: `joints` (K,) of the columns, and the root's translation."""

    joints: BoolArray
    root: bool


@lru_cache(maxsize=64)
def recruited_of(columns: Columns, recruits: Recruits) -> Recruited:
    """Return which of the columns are recruited."""
    mine = np.zeros(len(columns.skeleton), dtype=np.bool_)
    mine[list(recruits.joints)] = True
    return Recruited(frozen(mine[columns.joints]), recruits.root)


def moved_by(skeleton: Skeleton, joint: int, *, itself: bool) -> BoolArray:
    """Return which joints move a point of `joint` when they turn, shape (J,): its ancestors, and perhaps itself."""
    chain = skeleton.chain(joint)
    moved = np.zeros(len(skeleton), dtype=np.bool_)
    moved[chain if itself else chain[:-1]] = True
    return moved


@dataclass(frozen=True, eq=False)
class Point:
    """A point or joint as the unknowns move it: its effector and the recruited unknowns."""

    columns: Columns
    effector: Effector
    recruited: Recruited

    def position(self, poses: WorldPoses) -> FloatArray:
        """Return the world position, shape (N, 3)."""
        return effector_positions(poses, self.effector)

    def rotation(self, poses: WorldPoses) -> FloatArray:
        """Return the world rotation of its joint, shape (N, 4)."""
        rotation: FloatArray = poses.rotations[:, self.effector.joint]
        return rotation

    def position_rows(self, poses: WorldPoses) -> FloatArray:
        """Return d(position)/d(unknowns), shape (N, 3, n): e_a x (p_e - p_j), the identity for the root."""
        levers = self.position(poses)[:, None] - poses.positions[:, self.columns.joints]
        return lever_rows(levers, self._mask(itself=self.effector.is_off), root=self.moves_with_root)

    def rotation_rows(self, poses: WorldPoses) -> FloatArray:
        """Return d(world-axis increment of the rotation)/d(unknowns), shape (N, 3, n): the identity per ancestor."""
        count = len(poses.positions)
        rows = np.zeros((count, 3, self.columns.size))
        mask = self._mask(itself=True)
        rows[:, :, :-3] = np.kron(mask.astype(float), np.eye(3))
        return rows

    def _mask(self, *, itself: bool) -> BoolArray:
        moved = moved_by(self.columns.skeleton, self.effector.joint, itself=itself)
        mask: BoolArray = moved[self.columns.joints] & self.recruited.joints
        return mask

    @cached_property
    def moves_with_root(self) -> bool:
        """Whether the root's translation is recruited and moves it."""
        return self.recruited.root and bool(below(self.columns.skeleton, self.columns.root)[self.effector.joint])


@lru_cache(maxsize=64)
def point_of(columns: Columns, effector: Effector, recruits: Recruits) -> Point:
    """Return an effector as what is recruited of the columns moves it."""
    return Point(columns, effector, recruited_of(columns, recruits))


def lever_rows(levers: FloatArray, mask: FloatArray | BoolArray, *, root: bool) -> FloatArray:
    """Return the rows of a point from its levers (N, K, 3): -[lever]x per masked joint, scaled by the mask's values."""
    count, columns = levers.shape[:2]
    levers = levers * np.asarray(mask, dtype=float)[:, None]
    rows = np.zeros((count, 3, columns + 1, 3))
    x, y, z = levers[..., 0], levers[..., 1], levers[..., 2]
    rows[:, 0, :-1, 1], rows[:, 0, :-1, 2] = z, -y
    rows[:, 1, :-1, 0], rows[:, 1, :-1, 2] = -z, x
    rows[:, 2, :-1, 0], rows[:, 2, :-1, 1] = y, -x
    if root:
        rows[:, :, -1] = np.eye(3)
    return rows.reshape(count, 3, 3 * columns + 3)


def turn_to_local(
    skeleton: Skeleton, poses: WorldPoses, local: FloatArray, *, joints: IntArray, targets: FloatArray
) -> FloatArray:
    """Return the world-axis increments that bring joints to target local rotations, shape (N, len(joints), 3)."""
    z = rot.log(rot.multiply(targets, rot.conjugate(local[:, joints])))
    parents = skeleton.parents[joints]
    inner = parents >= 0
    z[:, inner] = rot.rotate(poses.rotations[:, parents[inner]], z[:, inner])
    return z
