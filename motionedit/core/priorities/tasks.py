"""Tasks: a constraint at many frames at once, its error and its Jacobian ([PRIO] sections 3 and 4).

A task of k rows over N frames gives e, shape (N, k), and J, shape (N, k, n). The n = 3 K + 3 unknowns of a frame are
world-axis increments w of K column joints (a joint's world rotation becomes exp(w) R), then the root's translation.
Lengths are normalised metres; radians of orientation rows count as `METRES_PER_RADIAN`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import Masses, center_of_mass, subtree_centers
from motionedit.core.kinematics import Effector, WorldPoses, effector_positions
from motionedit.core.units import METRES_PER_RADIAN
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
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


@dataclass(frozen=True, eq=False)
class Recruited:
    """Which unknowns a task may use: `joints` (K,) of the columns, and the root's translation."""

    joints: BoolArray
    root: bool


class Task(Protocol):
    """A constraint over the frames that are solved together."""

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return (e, J) at frames of the task, shapes (N, k) and (N, k, n).

        Parameters
        ----------
        poses : WorldPoses
            Of the N frames.
        local : shape (N, J, 4)
            Their local rotations.
        frames : shape (N,)
            Which of the task's own frames these are.
        """


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

    def position_rows(self, poses: WorldPoses) -> FloatArray:
        """Return d(position)/d(unknowns), shape (N, 3, n): e_a x (p_e - p_j), the identity for the root."""
        offset = bool(np.any(self.effector.offset))
        levers = self.position(poses)[:, None] - poses.positions[:, self.columns.joints]
        return lever_rows(levers, self._mask(itself=offset), root=self.moves_with_root)

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

    @property
    def moves_with_root(self) -> bool:
        """Whether the root's translation is recruited and moves it."""
        return self.recruited.root and self.columns.root in self.columns.skeleton.chain(self.effector.joint)


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


@dataclass(frozen=True, eq=False)
class PositionTask:
    """A point follows targets, shape (F, 3), along the axes of `measure`, or in the frame of a base joint."""

    point: Point
    targets: FloatArray
    measure: FloatArray
    axes: tuple[int, ...]
    base: Point | None = None

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = target - x and dx/d(unknowns), as `Task`."""
        del local
        x, J = self.point.position(poses), self.point.position_rows(poses)
        if self.base is not None:
            x, J = _in_base(self.base, poses, x, J)
        axes = self.measure[list(self.axes)]
        return self.targets[frames][:, list(self.axes)] - x @ axes.T, axes @ J


def _in_base(base: Point, poses: WorldPoses, x: FloatArray, J: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a point and its rows in the base's frame: R_b^T (p - p_b), d = R_b^T (dp - dp_b - w_b x (p - p_b))."""
    between = x - base.position(poses)
    rows = J - base.position_rows(poses) + rot.skew(between) @ base.rotation_rows(poses)
    inverse = np.swapaxes(rot.to_matrix(poses.rotations[:, base.effector.joint]), 1, 2)
    return (inverse @ between[..., None])[..., 0], inverse @ rows


@dataclass(frozen=True, eq=False)
class OrientationTask:
    """A joint follows target rotations, quaternions (F, 4), in the world or in the frame of a base joint."""

    point: Point
    targets: FloatArray
    base: Point | None = None

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = log(q_target q^-1) and d(increment)/d(unknowns), in metres, as `Task`."""
        del local
        q, J = poses.rotations[:, self.point.effector.joint], self.point.rotation_rows(poses)
        if self.base is not None:
            q_base = poses.rotations[:, self.base.effector.joint]
            inverse = np.swapaxes(rot.to_matrix(q_base), 1, 2)
            J = inverse @ (J - self.base.rotation_rows(poses))
            q = rot.multiply(rot.conjugate(q_base), q)
        e = rot.log(rot.multiply(self.targets[frames], rot.conjugate(q)))
        return METRES_PER_RADIAN * e, METRES_PER_RADIAN * J


@dataclass(frozen=True, eq=False)
class PoseTask:
    """Position and orientation of one joint together: a footplant that cannot roll."""

    position: PositionTask
    orientation: OrientationTask

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the rows of both, as `Task`."""
        parts = [task.evaluate(poses, local, frames) for task in (self.position, self.orientation)]
        return np.concatenate([e for e, _ in parts], axis=1), np.concatenate([J for _, J in parts], axis=1)


@dataclass(frozen=True, eq=False)
class CenterOfMassTask:
    """The CoM follows targets (F, 3) along the given axes of `measure`."""

    columns: Columns
    recruited: Recruited
    masses: Masses
    targets: FloatArray
    measure: FloatArray
    axes: tuple[int, ...]

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = target - c and (m_sub / M) e_a x (c_sub - p_j), as `Task`."""
        del local
        centers, shares = subtree_centers(poses, self.masses)
        joints = self.columns.joints
        weight = shares[joints] * self.recruited.joints
        rows = lever_rows(centers[:, joints] - poses.positions[:, joints], weight, root=self.recruited.root)
        axes = self.measure[list(self.axes)]
        e = self.targets[frames][:, list(self.axes)] - center_of_mass(poses, self.masses) @ axes.T
        return e, axes @ rows


@dataclass(frozen=True, eq=False)
class AimTask:
    """A direction fixed in a joint, unit (3,), looks at targets (F, 3) in the world, or in the frame of a base joint.

    A base without targets is looked at itself.
    """

    point: Point
    axis: FloatArray
    targets: FloatArray | None
    base: Point | None

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the turn from d to the target's direction, and (I - d d^T) w + d x (dp_e - dp_t) / r, as `Task`."""
        del local
        d = rot.rotate(poses.rotations[:, self.point.effector.joint], self.axis)
        at, moved = self._place(poses, frames)
        way = at - self.point.position(poses)
        distance = np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
        t = way / distance
        turn = rot.cross(d, t)
        sine = np.linalg.norm(turn, axis=1, keepdims=True)
        cosine = np.sum(d * t, axis=1, keepdims=True)
        angle = np.arctan2(sine, cosine)
        # Straight behind, any axis square to d will do.
        side = np.where(sine < 1e-9, _square_to(d), turn / np.maximum(sine, 1e-9))
        J = self.point.rotation_rows(poses)
        J = J - d[:, :, None] * (d[:, None, :] @ J)
        swing = self.point.position_rows(poses)
        if moved is not None:
            swing = swing - moved
        J = J + rot.skew(d) @ swing / distance[..., None]
        return METRES_PER_RADIAN * angle * side, METRES_PER_RADIAN * J

    def _place(self, poses: WorldPoses, frames: IntArray) -> tuple[FloatArray, FloatArray | None]:
        """Return what is looked at, p_b + R_b t, and its rows, dp_b - [R_b t]x w_b; None where it stands still."""
        if self.base is None:
            if self.targets is None:
                raise ValueError("an aim needs targets or a base")
            return self.targets[frames], None
        at, rows = self.base.position(poses), self.base.position_rows(poses)
        if self.targets is None:
            return at, rows
        arm = rot.rotate(poses.rotations[:, self.base.effector.joint], self.targets[frames])
        return at + arm, rows - rot.skew(arm) @ self.base.rotation_rows(poses)


def _square_to(d: FloatArray) -> FloatArray:
    helper = np.eye(3)[np.argmin(np.abs(d), axis=1)]
    square = rot.cross(d, helper)
    side: FloatArray = square / np.linalg.norm(square, axis=1, keepdims=True)
    return side


@dataclass(frozen=True, eq=False)
class PostureTask:
    """Joints keep given local rotations: `places` are their columns, `targets` (F, len(places), 4)."""

    columns: Columns
    places: IntArray
    targets: FloatArray

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = log(q_target q^-1) as world-axis increments, and the identity per joint, as `Task`."""
        joints = self.columns.joints[self.places]
        e = posture_error(self.columns.skeleton, poses, local, joints=joints, targets=self.targets[frames])
        rows = np.zeros((3 * len(joints), self.columns.size))
        for i, place in enumerate(self.places):
            rows[3 * i : 3 * i + 3, 3 * place : 3 * place + 3] = METRES_PER_RADIAN * np.eye(3)
        return METRES_PER_RADIAN * e.reshape(len(local), -1), np.broadcast_to(rows, (len(local), *rows.shape))


def posture_error(
    skeleton: Skeleton, poses: WorldPoses, local: FloatArray, *, joints: IntArray, targets: FloatArray
) -> FloatArray:
    """Return the world-axis increments that bring joints to target local rotations, shape (N, len(joints), 3)."""
    z = rot.log(rot.multiply(targets, rot.conjugate(local[:, joints])))
    parents = skeleton.parents[joints]
    inner = parents >= 0
    z[:, inner] = rot.rotate(poses.rotations[:, parents[inner]], z[:, inner])
    return z
