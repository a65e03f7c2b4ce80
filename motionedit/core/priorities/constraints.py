"""Constraints as asked for over a whole clip, and the tasks that they become frame by frame ([PRIO] section 4).

Lengths are normalised metres: the motion has been scaled before it comes here.
"""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import Effector, WorldPoses, effector_positions
from motionedit.core.priorities.recruiting import Reach, RecruitRule, Recruits, recruit_body, recruit_chain
from motionedit.core.priorities.tasks import (
    AimTask,
    CenterOfMassTask,
    Columns,
    OrientationTask,
    Point,
    PoseTask,
    PositionTask,
    PostureTask,
    Recruited,
    Task,
    moved_by,
)
from motionedit.core.priorities.trajectories import active_interval, position_targets, rotation_targets
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.trajectories import ControlPoint
    from motionedit.core.skeleton import Skeleton

EVERYTHING = RecruitRule()

Kind = Literal["position", "orientation", "pose", "com", "aim", "posture"]


@dataclass(frozen=True, eq=False)
class Constraint:
    """What the user asks for, resolved in one clip.

    Attributes
    ----------
    kind, name, priority, weight
        Larger priorities are more important; only their order matters.
    effector : Effector
        The point, or the joint that turns; not used by `com` and `posture`.
    base : int or None
        The joint in whose frame targets are measured.
    measure : shape (3, 3)
        Rows are the axes that positions are measured along.
    axes : tuple of int
        Which of them count.
    recruit : RecruitRule
    points : tuple of ControlPoint
        When and where; none: as in the input, the whole clip. Positions along the measuring axes.
    ease_in, ease_out : float
        Frames.
    support : tuple of int
        The set A of a `com`; empty: the input's own path.
    axis : shape (3,)
        What an `aim` looks along, in the joint.
    target : int or None
        The joint that an `aim` looks at.
    joints : tuple of int
        Those of a `posture`.
    """

    kind: Kind
    name: str
    priority: int
    weight: float
    effector: Effector
    base: int | None = None
    measure: FloatArray = field(default_factory=lambda: np.eye(3))
    axes: tuple[int, ...] = (0, 1, 2)
    recruit: RecruitRule = EVERYTHING
    points: tuple[ControlPoint, ...] = ()
    ease_in: float = 0.0
    ease_out: float = 0.0
    support: tuple[int, ...] = ()
    axis: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    target: int | None = None
    joints: tuple[int, ...] = ()

    @property
    def turns_itself(self) -> bool:
        """Whether turning the effector's own joint moves the task."""
        return self.kind in {"orientation", "pose", "aim"} or bool(np.any(self.effector.offset))

    @property
    def aim_base(self) -> int | None:
        """The joint in whose frame an aim's targets are: the one that is looked at, or that of `base`."""
        return self.base if self.target is None else self.target

    def active(self, frames: int) -> tuple[int, int]:
        """Return the first and last frame at which the constraint is active."""
        return active_interval(self.points, ease_in=self.ease_in, ease_out=self.ease_out, frames=frames)


def recruits_of(constraint: Constraint, skeleton: Skeleton, *, travel: int, body: frozenset[int]) -> Recruits:
    """Return what a constraint recruits.

    Raises
    ------
    ValueError
        If its `up_to` is not on the way to the root.
    """
    if constraint.kind == "posture":
        return Recruits(frozenset(constraint.joints), root=False)
    if constraint.kind == "com":
        return recruit_body(constraint.recruit, body)
    joint = constraint.effector.joint
    start = joint if constraint.turns_itself else max(int(skeleton.parents[joint]), 0)
    return recruit_chain(skeleton, constraint.recruit, start=start, travel=travel)


def reach_of(constraint: Constraint, skeleton: Skeleton, *, frames: int, body: frozenset[int]) -> Reach:
    """Return what moves a constraint's task: ancestors, those of its base and target, the root's translation."""
    first, last = constraint.active(frames)
    if constraint.kind == "posture":
        return Reach(frozenset(constraint.joints), root=False, first=first, last=last)
    if constraint.kind == "com":
        return Reach(body, root=True, first=first, last=last)
    joint, base = constraint.effector.joint, constraint.aim_base
    moved = moved_by(skeleton, joint, itself=constraint.turns_itself)
    if base is not None:
        # What moves both alike moves neither against the other.
        both = moved_by(skeleton, joint, itself=False) & moved_by(skeleton, base, itself=False)
        moved = (moved | moved_by(skeleton, base, itself=constraint.target is None)) & ~both
    root = base is None and constraint.kind != "orientation"
    return Reach(frozenset(map(int, np.flatnonzero(moved))), root, first, last)


@dataclass(frozen=True, eq=False)
class Targets:
    """Where a constraint's task shall be: frames `first` to `last`; positions (n, 3), rotations (n, 4), or None."""

    first: int
    last: int
    positions: FloatArray | None = None
    rotations: FloatArray | None = None


def targets_of(constraint: Constraint, poses: WorldPoses, *, curve: Literal["time", "index"]) -> Targets:
    """Return the targets of a position, orientation or pose; `poses` are the input's."""
    first, last = constraint.active(len(poses.positions))
    path, turns = _seen(constraint, poses)
    eases = {"ease_in": constraint.ease_in, "ease_out": constraint.ease_out}
    positions = rotations = None
    if constraint.kind in {"position", "pose"}:
        _, positions = position_targets(path, constraint.points, curve=curve, **eases)
    if constraint.kind in {"orientation", "pose"}:
        _, rotations = rotation_targets(turns, constraint.points, **eases)
    return Targets(first, last, positions, rotations)


def _seen(constraint: Constraint, poses: WorldPoses) -> tuple[FloatArray, FloatArray]:
    """Return the effector's path along the measuring axes (F, 3), and its rotations (F, 4), as targets are given."""
    path = effector_positions(poses, constraint.effector)
    turns = poses.rotations[:, constraint.effector.joint]
    if constraint.base is None:
        return path @ constraint.measure.T, turns
    inverse = rot.conjugate(poses.rotations[:, constraint.base])
    return rot.rotate(inverse, path - poses.positions[:, constraint.base]), rot.multiply(inverse, turns)


def aim_targets(constraint: Constraint, poses: WorldPoses, *, curve: Literal["time", "index"]) -> Targets:
    """Return the points that an aim looks at, eased from where it looks in the input.

    They are in the frame of the constraint's `aim_base` where it has one, and so follow it, else in the world. What
    looks at a joint looks at that frame's origin.

    Parameters
    ----------
    poses : WorldPoses
        The input's.
    """
    first, last = constraint.active(len(poses.positions))
    origin = effector_positions(poses, constraint.effector)
    look = rot.rotate(poses.rotations[:, constraint.effector.joint], constraint.axis)
    base, measure = constraint.aim_base, constraint.measure
    if base is not None:
        inverse = rot.conjugate(poses.rotations[:, base])
        origin, look = rot.rotate(inverse, origin - poses.positions[:, base]), rot.rotate(inverse, look)
    else:
        origin, look = origin @ measure.T, look @ measure.T
    if constraint.target is not None:
        gaze = origin + np.linalg.norm(origin, axis=1, keepdims=True) * look
        positions = (gaze * (1.0 - _share(constraint, len(origin), first, last))[:, None])[first : last + 1]
        return Targets(first, last, positions)
    given = next(point.position for point in constraint.points if point.position is not None)
    gaze = origin + np.linalg.norm(given - origin, axis=1, keepdims=True) * look
    _, positions = position_targets(
        gaze, constraint.points, ease_in=constraint.ease_in, ease_out=constraint.ease_out, curve=curve
    )
    return Targets(first, last, positions if base is not None else positions @ measure)


def _share(constraint: Constraint, frames: int, first: int, last: int) -> FloatArray:
    """Return how far an aim is eased in at each frame, 0 to 1, with a continuous slope; no points: all the way."""
    if not constraint.points:
        return np.ones(frames)
    start, stop = constraint.points[0].start, constraint.points[-1].stop
    f = np.arange(frames, dtype=np.float64)
    rise = np.ones(frames) if start <= first else np.clip((f - first) / (start - first), 0.0, 1.0)
    fall = np.ones(frames) if stop >= last else np.clip((last - f) / (last - stop), 0.0, 1.0)
    t = rise * fall
    share: FloatArray = t * t * (3.0 - 2.0 * t)
    return share


def task_of(
    constraint: Constraint,
    targets: Targets,
    frames: IntArray,
    columns: Columns,
    recruits: Recruits,
    *,
    masses: Masses,
    reference: Motion,
) -> Task:
    """Return the task of a constraint at frames that are solved together, all of them in its active interval.

    `reference` is the input, whose local rotations a posture keeps.
    """
    mine = np.zeros(len(columns.skeleton), dtype=np.bool_)
    mine[list(recruits.joints)] = True
    recruited = Recruited(mine[columns.joints], recruits.root)
    at = frames - targets.first
    if constraint.kind == "posture":
        joints = [j for j in constraint.joints if j in set(map(int, columns.joints))]
        places = np.searchsorted(columns.joints, joints)
        return PostureTask(columns, places, reference.rotations[frames[:, None], np.array(joints, dtype=np.intp)])
    positions = None if targets.positions is None else targets.positions[at]
    if constraint.kind == "com" and positions is not None:
        return CenterOfMassTask(columns, recruited, masses, positions, constraint.measure, constraint.axes)
    point = Point(columns, constraint.effector, recruited)
    if constraint.kind == "aim":
        looked_at = None
        if constraint.aim_base is not None:
            looked_at = Point(columns, Effector(constraint.aim_base, np.zeros(3)), recruited)
        return AimTask(point, constraint.axis, positions, looked_at)
    base = None
    if constraint.base is not None:
        base = Point(columns, Effector(constraint.base, np.zeros(3)), recruited)
    parts: list[PositionTask | OrientationTask] = []
    if positions is not None:
        parts.append(PositionTask(point, positions, constraint.measure, constraint.axes, base))
    if targets.rotations is not None:
        parts.append(OrientationTask(point, targets.rotations[at], base))
    if len(parts) == 1:
        return parts[0]
    position, orientation = parts
    if not isinstance(position, PositionTask) or not isinstance(orientation, OrientationTask):
        raise TypeError("a pose is a position and an orientation")
    return PoseTask(position, orientation)


def in_metres(constraint: Constraint, scale: float) -> Constraint:
    """Return a constraint whose lengths, given in clip units, are normalised metres."""
    points = tuple(
        replace(
            point,
            position=None if point.position is None else point.position * scale,
            shift=None if point.shift is None else point.shift * scale,
        )
        for point in constraint.points
    )
    effector = Effector(constraint.effector.joint, constraint.effector.offset * scale)
    return replace(constraint, points=points, effector=effector)


def order_of_layers(priorities: Sequence[int]) -> list[int]:
    """Return the distinct priorities, the most important first."""
    return sorted(set(priorities), reverse=True)
