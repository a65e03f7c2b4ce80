"""From the goals and constraints of a report to the marks of a page, on the bodies that the page shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.kinematics import Effector, effector_positions
from motionedit.core.plain_values import number
from motionedit.core.priorities.kinds import KINDS
from motionedit.dataclass import dataclass, replace
from motionedit.errors import UsageError
from motionedit.jobs.preview.bodies import upright
from motionedit.report.preview.marks import Curve, Edit, Mark, Span

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.kinds.constraint import Symbol
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.report.preview.body import Body

# What stands at `type` for a goal of edit-pc.
_GOAL = "goal"
# An offset and an end site nearer to each other than this (leg lengths) are one point.
_SAME_POINT = 1e-4
_NO_FRAMES = {"error": None, "error_angle": None}


@dataclass(eq=False)
class Figure:
    """A clip on the page: its facts, and its body, which gets a point for each effector that it lacks."""

    facts: ClipFacts
    body: Body

    def point(self, record: Mapping[str, Any], masses: Mapping[str, float]) -> int | None:
        """Return the body's point that is a mark's effector, None where the mark has none or the clip lacks it."""
        if _look(record).weighs:
            return self._added(self._center_of_mass(masses))
        effector, skeleton = record.get("effector"), self.facts.clip.motion.skeleton
        if effector is None or effector["joint"] not in skeleton.names:
            return None
        joint, offset = skeleton.names.index(effector["joint"]), np.array(effector["offset"], dtype=np.float64)
        near = _SAME_POINT * self.facts.anatomy.leg_length
        if np.linalg.norm(offset) <= near and self.body.names[joint]:
            return joint
        for i, site in enumerate(skeleton.end_sites):
            if site.joint == joint and np.linalg.norm(site.offset - offset) <= near:
                return len(skeleton) + i
        return self._added(effector_positions(self.facts.poses, Effector(joint, offset)))

    def on_page(self, places: FloatArray) -> FloatArray:
        """Return world positions (n, 3) of the clip as the page has them."""
        shown: FloatArray = self.body.scale * (places @ upright(self.facts.up).T)
        return shown

    def _center_of_mass(self, masses: Mapping[str, float]) -> FloatArray:
        skeleton = self.facts.clip.motion.skeleton
        given = {skeleton.names.index(name): float(mass) for name, mass in masses.items() if name in skeleton.names}
        facts = self.facts
        rotations = facts.clip.motion.rotations[facts.first :]
        laid = find_masses(facts.bones, facts.anatomy, rotations=rotations, given=given or None)
        return center_of_mass(facts.poses, laid)

    def _added(self, path: FloatArray) -> int:
        positions = np.concatenate((self.body.positions, self.on_page(path)[:, None]), axis=1)
        self.body = replace(self.body, names=(*self.body.names, ""), positions=positions)
        return len(self.body.names) - 1


@dataclass(frozen=True)
class _Look:
    """How a mark is drawn, and whether its place is the center of mass: see `Mark`, and the kinds of constraints."""

    symbol: Symbol
    looks: bool = False
    instant: bool = False
    weighs: bool = False


def _look(record: Mapping[str, Any]) -> _Look:
    """Return how a record's mark is drawn; a goal of edit-pc is a place at one instant."""
    name = str(record["type"])
    if name == _GOAL:
        return _Look("ring", instant=True)
    kind = KINDS[name]
    return _Look(kind.symbol, looks=kind.looks, weighs=kind.weighs)


def edit_of(
    record: Mapping[str, Any],
    figures: Sequence[Figure],
    *,
    edited: int,
    before: int | None,
    masses: Mapping[str, float],
    report: str,
) -> Edit:
    """Return the marks of one clip of a report, its goals or constraints, the most important first.

    Parameters
    ----------
    edited, before
        Places of the edited clip and of its input among the figures; these two get the points of effectors.
    masses
        Kg by joint, as the spec has them.
    report : str
        Its name, for the error.

    Raises
    ------
    UsageError
        The record is not as an edit writes it, or of another clip.
    """
    try:
        asked = [_goal(goal) for goal in record.get("goals") or ()]
        asked += record.get("constraints") or ()
        marks = [_mark(each, figures, edited=edited, before=before, masses=masses) for each in asked]
        marks.sort(key=lambda mark: -mark.priority)
        return Edit(edited, str(record["status"]), record.get("message"), record.get("unit"), tuple(marks))
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        label = figures[edited].facts.clip.label
        raise UsageError(f"does not fit {label}: another clip's, or not as an edit writes it", file=report) from error


def _goal(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return a goal of edit-pc as a constraint of one frame."""
    frame, target = record["frame"], record.get("target")
    return {
        **record,
        "type": _GOAL,
        "first_frame": frame,
        "last_frame": frame,
        "points": [{"mode": "at", "first": frame, "last": frame}],
        "frames": {
            "error": None if record["error_max"] is None else [record["error_max"]],
            "error_angle": None if record["error_angle_max"] is None else [record["error_angle_max"]],
            "target": None if target is None else [target],
        },
    }


def _mark(
    record: Mapping[str, Any],
    figures: Sequence[Figure],
    *,
    edited: int,
    before: int | None,
    masses: Mapping[str, float],
) -> Mark:
    first, last = int(record["first_frame"]), int(record["last_frame"])
    if not 0 <= first <= last < len(figures[edited].facts.clip.motion):
        raise ValueError("frames")
    # A report of many clips tells nothing frame by frame: the goal has its interval then, but no place and no curves.
    frames, count = record.get("frames", _NO_FRAMES), last - first + 1
    target = frames.get("target")
    found = [(f, figures[f].point(record, masses)) for f in (edited, before) if f is not None]
    if record.get("effector") is not None and found[0][1] is None:
        raise ValueError("joint")
    look = _look(record)
    return Mark(
        name=str(record["name"]),
        kind=str(record["type"]),
        symbol=look.symbol,
        looks=look.looks,
        instant=look.instant,
        priority=int(record["priority"]),
        status=str(record["status"]),
        gave_way_to=tuple(map(str, record["gave_way_to"])),
        first=first,
        last=last,
        spans=tuple(Span(str(p["mode"]), int(p["first"]), int(p["last"])) for p in record.get("points") or ()),
        places=None if target is None else figures[edited].on_page(_array(target, (count, 3))),
        lengths=_curve(frames["error"], record["tolerance"], count),
        angles=_curve(frames["error_angle"], record["tolerance_angle"], count),
        points=tuple((f, point) for f, point in found if point is not None),
    )


def _curve(values: object, tolerance: object, count: int) -> Curve | None:
    if values is None:
        return None
    return Curve(_array(values, (count,)), None if tolerance is None else number(tolerance, 0.0))


def _array(values: object, shape: tuple[int, ...]) -> FloatArray:
    array = np.array(values, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError("shape")
    return array
