"""From the constraints of an edit-prioritized spec to constraints in a clip: joints, frames, axes, tolerances."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import Effector
from motionedit.core.priorities.constraints import Constraint, in_metres, recruits_of
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.trajectories import ControlPoint, active_interval
from motionedit.dataclass import dataclass
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.faults import Faults
from motionedit.spec.faults import listed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.ground import Frame
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.clip.resolve import Place
    from motionedit.spec.constraints import AnyConstraint, ComConstraint
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.points import Point
    from motionedit.spec.values import Recruit

# Where a constraint gives no tolerance: metres at leg length 0.85 m, and degrees.
DEFAULT_TOLERANCE = 1e-3
DEFAULT_ANGLE_TOLERANCE = 0.1

_NOWHERE = Effector(0, np.zeros(3))


@dataclass(frozen=True, eq=False)
class ClipConstraint:
    """A constraint in one clip.

    Attributes
    ----------
    constraint : Constraint
        In normalised metres.
    tolerance, angle_tolerance : float
        What counts as met: clip units, degrees; the defaults where the spec says nothing, or ``off``.
    may_give_way : bool
        Its tolerance is ``off``: nobody minds where it is missed.
    counts : bool
        `--strict` fails where it is missed.
    """

    constraint: Constraint
    tolerance: float
    angle_tolerance: float
    may_give_way: bool
    counts: bool


def clip_constraints(
    loaded: LoadedSpec[EditPrioritizedSpec],
    facts: ClipFacts,
    events: Mapping[str, float],
    *,
    scale: float,
    faults: Faults,
) -> list[ClipConstraint]:
    """Return the spec's constraints in a clip; what the clip lacks goes to `faults`.

    Parameters
    ----------
    events : mapping
        Frame of each event that the spec names.
    scale : float
        Normalised metres per clip unit.
    """
    found = []
    for spec in loaded.model.constraints:
        own = Faults()
        constraint = _Resolver(loaded, facts, events, own).constraint(spec)
        for error in own.errors:
            faults.add(error)
        met = spec.met_within
        found.append(
            ClipConstraint(
                constraint=in_metres(constraint, scale),
                tolerance=DEFAULT_TOLERANCE / scale if met.position is None else met.position,
                angle_tolerance=DEFAULT_ANGLE_TOLERANCE if met.angle is None else met.angle,
                may_give_way=met.off,
                counts=spec.counts_for_strict,
            )
        )
    return found


@dataclass(frozen=True, eq=False)
class _Axes:
    """The axes that a constraint's numbers are along: those of `heading`, or the world's (or a joint's)."""

    heading: Frame | None

    @property
    def measure(self) -> FloatArray:
        return np.eye(3) if self.heading is None else self.heading.axes

    def position(self, given: Sequence[float]) -> FloatArray:
        """Return a position along the measuring axes, from the world's origin."""
        position = np.array(given)
        return position if self.heading is None else self.measure @ self.heading.world_points(position)

    def rotation(self, q: FloatArray) -> FloatArray:
        """Return a rotation in the world."""
        return q if self.heading is None else rot.multiply(self.heading.rotation, q)


@dataclass(frozen=True, eq=False)
class _Resolver:
    """One constraint's way into a clip; its errors are collected."""

    loaded: LoadedSpec[EditPrioritizedSpec]
    facts: ClipFacts
    events: Mapping[str, float]
    faults: Faults

    def constraint(self, spec: AnyConstraint) -> Constraint:
        """Return the constraint, lengths in clip units."""
        place = resolve.Place(self.loaded, spec.keys, self.facts.clip.label)
        frame_time, skeleton = self.facts.clip.motion.frame_time, self.facts.clip.motion.skeleton
        heading = self.facts.heading_frame() if spec.type != "posture" and spec.frame == "heading" else None
        axes = _Axes(heading)
        found = Constraint(
            kind=spec.type,
            name=str(spec.name),
            priority=spec.priority,
            weight=spec.weight,
            effector=_NOWHERE,
            measure=axes.measure,
            axes=spec.axes if spec.type in {"position", "com"} else (0, 1, 2),
            points=self._points(spec.points, axes, place),
            ease_in=spec.ease_in.in_frames(frame_time),
            ease_out=spec.ease_out.in_frames(frame_time),
        )
        if spec.type == "posture":
            return replace(found, joints=self._joints(spec.joints, place.at("joints")))
        found = replace(found, recruit=self._rule(spec.recruit, resolve.recruit_place(place)))
        if spec.type == "com":
            return replace(found, support=self._support(spec, place.at("support")))
        at = resolve.Place(self.loaded, spec.effector_keys, place.clip)
        effector = self.faults.get(lambda: resolve.effector(spec.effector, skeleton, at), otherwise=_NOWHERE)
        found = replace(found, effector=effector, base=self._joint(spec.relative_to, place.at("relative_to")))
        if spec.type == "aim":
            axis = np.array(spec.axis) / np.linalg.norm(spec.axis)
            found = replace(found, axis=axis, target=self._joint(spec.target, place.at("target")))
        self._check_recruits(found, place)
        return found

    def _joint(self, name: str | None, place: Place) -> int | None:
        if name is None:
            return None
        return self.faults.get(lambda: resolve.joint(name, self.facts.clip.motion.skeleton, place), otherwise=None)

    def _joints(self, names: Sequence[str], place: Place) -> tuple[int, ...]:
        none: tuple[int, ...] = ()
        skeleton = self.facts.clip.motion.skeleton
        return self.faults.get(lambda: resolve.joints(names, skeleton, place), otherwise=none)

    def _support(self, spec: ComConstraint, place: Place) -> tuple[int, ...]:
        """Return the set A; by default the feet and toes that the skeleton has."""
        if spec.relative_to == "world":
            return ()
        if spec.support is None:
            return tuple(joint for _, joint in self.facts.anatomy.foot_points)
        return self._joints(spec.support, place)

    def _rule(self, recruit: Recruit, place: Place) -> RecruitRule:
        if recruit.kind == "up_to":
            return RecruitRule("up_to", joint=self._joint(recruit.joint, place.at("up_to")))
        if recruit.kind != "joints":
            return RecruitRule(recruit.kind, levels=recruit.levels)
        skeleton, travel = self.facts.clip.motion.skeleton, self.facts.travel
        none: tuple[tuple[int, ...], bool] = ((), False)
        joints, root = self.faults.get(
            lambda: resolve.recruited_joints(recruit.joints, skeleton, place.at("joints"), travel=travel),
            otherwise=none,
        )
        return RecruitRule("joints", joints=joints, root=root)

    def _check_recruits(self, constraint: Constraint, place: Place) -> None:
        """Find an `up_to` that is not above the effector."""
        if self.faults.errors:
            return
        skeleton, rule = self.facts.clip.motion.skeleton, constraint.recruit
        try:
            recruits_of(constraint, skeleton, travel=self.facts.travel, body=frozenset())
        except ValueError:
            first = replace(constraint, recruit=RecruitRule())
            way = recruits_of(first, skeleton, travel=self.facts.travel, body=frozenset()).joints
            names = listed([skeleton.names[j] for j in sorted(way, reverse=True)])
            joint = "" if rule.joint is None else skeleton.names[rule.joint]
            message = (
                f"'{joint}' is not on the way of '{constraint.name}' to the root in {place.clip}, which is {names}"
            )
            self.faults.add(resolve.recruit_place(place).at("up_to").error(message))

    def _points(self, points: Sequence[Point], axes: _Axes, place: Place) -> tuple[ControlPoint, ...]:
        found: list[ControlPoint] = []
        for i, point in enumerate(points):
            at = place.at("points", i)
            each = self.faults.get(lambda point=point, at=at: self._point(point, axes, at), otherwise=None)  # type: ignore[misc]
            if each is None:
                continue
            try:
                active_interval([*found[-1:], each], ease_in=0.0, ease_out=0.0, frames=len(self.facts.clip.motion))
            except ValueError as error:
                self.faults.add(at.error(f"in {place.clip}: {error}"))
            found.append(each)
        return tuple(found)

    def _point(self, point: Point, axes: _Axes, place: Place) -> ControlPoint:
        motion, events = self.facts.clip.motion, self.events
        (mode,) = point.time_keys
        count, frame_time = len(motion), motion.frame_time
        interval = point.hold or point.during
        if interval is not None:
            start, stop = resolve.frame_range(
                interval, place.at(mode), frames=count, frame_time=frame_time, events=events
            )
        else:
            start = resolve.frame(point.start, place.at(mode), frames=count, frame_time=frame_time, events=events)
            stop = start
        return ControlPoint(
            mode="at" if interval is None else "during" if point.hold is None else "hold",
            start=start,
            stop=stop,
            position=None if point.position is None else axes.position(point.position),
            shift=None if point.shift is None else np.array(point.shift),
            orientation=None if point.orientation is None else axes.rotation(resolve.orientation(point.orientation)),
            tension=point.tension,
            continuity=point.continuity,
            bias=point.bias,
        )
