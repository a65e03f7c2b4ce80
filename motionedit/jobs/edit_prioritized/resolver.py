"""From a constraint of a spec to what it is in a clip: joints, frames, axes, lengths.

What a type has of its own is resolved by what kind of value it is, so that no type is known here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.bones import below
from motionedit.core.kinematics import Effector
from motionedit.core.measure import WORLD, Level
from motionedit.core.priorities.kinds import KINDS
from motionedit.core.priorities.kinds.constraint import Movable
from motionedit.core.priorities.recruiting import NotOnTheWayError, RecruitRule
from motionedit.core.priorities.trajectories.lengths import LengthPoint
from motionedit.core.priorities.trajectories.positions import ControlPoint, active_interval
from motionedit.dataclass import dataclass
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.axes import GivenAxes
from motionedit.jobs.edit_prioritized.feet_in_clip import FeetInClip
from motionedit.spec import kinds
from motionedit.spec.faults import listed
from motionedit.spec.plants import PLANTS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.clip.faults import Faults
    from motionedit.jobs.clip.resolve import Place
    from motionedit.spec.constraints import ConstraintItem, OwnValue
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.model import Kind
    from motionedit.spec.points import Point
    from motionedit.spec.values import EffectorSpec, Recruit

_NOWHERE = Effector(0, np.zeros(3))


@dataclass(frozen=True, eq=False)
class Resolver:
    """One constraint's way into a clip; its errors are collected."""

    loaded: LoadedSpec[EditPrioritizedSpec]
    facts: ClipFacts
    events: Mapping[str, float]
    scale: float
    faults: Faults
    relative: str

    def constraints(self, spec: ConstraintItem) -> tuple[Constraint, ...]:
        """Return the constraints that an item stands for, lengths in normalised metres."""
        place = resolve.Place(self.loaded, spec.keys, self.facts.clip.label)
        frame_time = self.facts.clip.motion.frame_time
        own = {each.key: each for each in spec.own_values()}
        given = {key: self._value(each, place) for key, each in own.items()}
        measured = {key: given.pop(key) for key in spec.measure_keys}
        axes = GivenAxes.of(
            self.facts,
            own["frame"].value if "frame" in own else "world",
            counted=measured.get("axes", WORLD.counted),
        )
        points = self._points(spec.points, axes, place)
        if measured:
            given["measure"] = axes.measure(base=measured.get("relative_to"))
        found = KINDS[spec.type].several(
            name=str(spec.name),
            priority=spec.priority,
            weight=spec.weight,
            points=points,
            ease_in=spec.ease_in.in_frames(frame_time),
            ease_out=spec.ease_out.in_frames(frame_time),
            since=self.facts.first,
            yields=not spec.counts_for_strict,
            follow=spec.follow,
            **given,
        )
        for each in found:
            self._check_recruits(each, place, base=measured.get("relative_to"))
        return found

    def _value(self, own: OwnValue, constraint: Place) -> Any:  # noqa: ANN401  of any kind
        """Return what a key's value is in the clip; a value that names nothing there is what it is."""
        kind, value = own.kind, own.value
        if kind is kinds.FEET and value is None:
            return tuple(joint for _, joint in self.facts.anatomy.foot_points)
        if value is None or kind not in _WAYS:
            return value
        return _WAYS[kind](self, value, constraint.below(own.keys))

    @property
    def feet(self) -> FeetInClip:
        """What the clip says of its feet."""
        return FeetInClip(self.facts, self.events, self.faults, self.relative)

    def effector(self, effector: EffectorSpec, place: Place) -> Effector:
        """Return an effector, lengths in normalised metres."""
        skeleton, scale = self.facts.clip.motion.skeleton, self.scale
        return self.faults.get(lambda: resolve.effector(effector, skeleton, place, scale=scale), otherwise=_NOWHERE)

    def body_points(self, named: str | Sequence[EffectorSpec], place: Place) -> tuple[Effector, ...]:
        """Return the points of the body that a word or a list of effectors names, lengths in normalised metres."""
        if not isinstance(named, str):
            listed_at = [place.at(i) for i in range(len(named))]
            return tuple(self.effector(each, at) for each, at in zip(named, listed_at, strict=True))
        skeleton = self.facts.clip.motion.skeleton
        if named == "feet":
            feet = tuple(Effector(joint, np.zeros(3)) for _, joint in self.facts.anatomy.foot_points)
            if not feet:
                self.faults.add(place.error(f"no feet found in {place.clip}; list the effectors that are meant"))
            return feet
        moving = below(skeleton, self.facts.travel)
        sites = [Effector(site.joint, self.scale * site.offset) for site in skeleton.end_sites if moving[site.joint]]
        return (*(Effector(int(joint), np.zeros(3)) for joint in np.flatnonzero(moving)), *sites)

    def joint(self, name: str, place: Place) -> int | None:
        """Return the joint of a name; None where there is none."""
        return resolve.joint_if_there(name, self.facts.clip.motion.skeleton, place, self.faults)

    def joints(self, names: Sequence[str], place: Place) -> tuple[int, ...]:
        """Return the joints of names, those that there are."""
        return resolve.joints_if_there(names, self.facts.clip.motion.skeleton, place, self.faults)

    def rule(self, recruit: Recruit, constraint: Place) -> RecruitRule:
        """Return what a constraint may move."""
        place = resolve.recruit_place(constraint)
        if recruit.joint is not None:
            return RecruitRule("up_to", joint=self.joint(recruit.joint, place.at("up_to")))
        if recruit.kind != "joints":
            return RecruitRule(recruit.kind, levels=recruit.levels)
        skeleton, travel = self.facts.clip.motion.skeleton, self.facts.travel
        none: tuple[tuple[int, ...], bool] = ((), False)
        joints, root = self.faults.get(
            lambda: resolve.recruited_joints(recruit.joints, skeleton, place.at("joints"), travel=travel),
            otherwise=none,
        )
        return RecruitRule("joints", joints=joints, root=root)

    def _check_recruits(self, constraint: Constraint, place: Place, *, base: int | None) -> None:
        """Find an `up_to` that is not above the effector, and a base that goes wherever the effector goes."""
        if self.faults.errors:
            return
        skeleton = self.facts.clip.motion.skeleton
        try:
            recruits = constraint.recruits(Movable(skeleton, self.facts.travel, frozenset()))
        except NotOnTheWayError as error:
            names = listed([skeleton.names[j] for j in sorted(error.way, reverse=True)])
            joint = skeleton.names[error.joint]
            message = (
                f"'{joint}' is not on the way of '{constraint.name}' to the root in {place.clip}, which is {names}"
            )
            self.faults.add(resolve.recruit_place(place).at("up_to").error(message))
            return
        effector = constraint.at
        if base is None or effector is None or effector.joint not in skeleton.chain(base):
            return
        between = set(skeleton.chain(base).tolist()) - set(skeleton.chain(effector.joint).tolist())
        if not between & recruits.joints:
            message = (
                f"'{skeleton.names[base]}' hangs on the effector in {place.clip} and goes wherever it goes, so that it "
                "never moves in that frame; name another joint, such as one above it, recruit joints between the two, "
                "or leave it out for the world"
            )
            self.faults.add(place.at("relative_to").error(message))

    def _points(self, points: Sequence[Point], axes: GivenAxes, place: Place) -> tuple[ControlPoint, ...]:
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

    def _point(self, point: Point, axes: GivenAxes, place: Place) -> ControlPoint:
        motion, events = self.facts.clip.motion, self.events
        (mode,) = point.time_keys
        interval = point.hold or point.during
        if interval is not None:
            start, stop = resolve.frame_range(interval, place.at(mode), motion, events=events)
        else:
            start = stop = resolve.frame(point.start, place.at(mode), motion, events=events)
        bound, length = point.bound
        return LengthPoint(
            mode="at" if interval is None else "during" if point.hold is None else "hold",
            start=start,
            stop=stop,
            position=None if point.position is None else axes.position(point.position) * self.scale,
            shift=None if point.shift is None else axes.shift(point.shift) * self.scale,
            orientation=None if point.orientation is None else axes.rotation(resolve.orientation(point.orientation)),
            turn=None if point.turn is None else axes.turn(resolve.orientation(point.turn)),
            tension=point.tension,
            continuity=point.continuity,
            bias=point.bias,
            length=None if length is None else length * self.scale,
            bound=bound,
        )


# How values are found in the clip, by what kinds of values they are. No method of a resolver's own: it would be part of
# a circle, and the clip with it would stay in memory.
_WAYS: dict[Kind, Callable[[Resolver, Any, Place], object]] = {
    kinds.EFFECTORS: lambda own, given, at: own.effector(given[0], at),
    kinds.EFFECTOR: Resolver.effector,
    kinds.BODY_POINTS: Resolver.body_points,
    kinds.ANKLES: lambda own, given, at: own.feet.ankles(given, at),
    PLANTS: lambda own, given, at: own.feet.plants(given, at),
    kinds.OWN_HEIGHT: lambda _own, given, _at: None if given == "input" else given,
    kinds.HEIGHT: lambda own, given, _at: Level(own.facts.up, given * own.scale),
    kinds.RECRUIT: Resolver.rule,
    kinds.JOINT: Resolver.joint,
    kinds.JOINTS: Resolver.joints,
    kinds.FEET: Resolver.joints,
    kinds.DIRECTION: lambda _own, given, _at: np.array(given) / np.linalg.norm(given),
}
