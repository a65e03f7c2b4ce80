"""From the goals of an edit-pc spec to requests in a clip, and from what was solved to the goals of a report."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.coefficients.goal_chains import GoalRequest
from motionedit.core.kinematics import effector_positions
from motionedit.core.timeline import round_half_up
from motionedit.core.timeline.warp import make_warp
from motionedit.dataclass import dataclass
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.axes import GivenAxes
from motionedit.jobs.clip.edit_record import DEFAULT_ANGLE_TOLERANCE, DEFAULT_TOLERANCE
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.edit_pc.solver import solver_tolerance

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import FloatArray
    from motionedit.core.kinematics import Effector, WorldPoses
    from motionedit.core.measure import Measure
    from motionedit.core.pca.model import MotionModel
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.clip.resolve import Place
    from motionedit.spec.edit_pc import EditPcSpec, PcGoal
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.times import Time


@dataclass(frozen=True, eq=False)
class ClipGoal:
    """A goal in one clip: the request, and what counts as met (clip units, degrees; None: not counted)."""

    spec: PcGoal
    name: str
    request: GoalRequest
    tolerance: float | None
    angle_tolerance: float | None


def clip_goals(
    loaded: LoadedSpec[EditPcSpec],
    model: MotionModel,
    facts: ClipFacts,
    *,
    events: dict[str, float],
    poses: WorldPoses,
) -> list[ClipGoal]:
    """Return the goals of a spec in the frames that are edited: the clip's own, or those of the model's timeline.

    Parameters
    ----------
    events : dict
        Frames of the clip's events.
    poses : WorldPoses
        World transforms of the motion that is edited, for shifts.

    Raises
    ------
    SpecError, MotionEditErrors
        Goals name what the clip lacks.
    """
    refuse_unknown_joints(loaded, facts)
    least = max(DEFAULT_TOLERANCE / model.space.scale, solver_tolerance(loaded.model))
    goals = []
    for i, goal in enumerate(loaded.model.goals):
        place = resolve.Place(loaded, ("goals", i), facts.clip.label)
        frame = resolve.frame(goal.at, place.at("at"), facts.clip.motion, events=events)
        if loaded.model.timing == "normalized":
            frame = _frame_on_timeline(goal.at, frame, model, facts, events=events)
        goals.append(_clip_goal(goal, _request(goal, facts, place, frame=frame, poses=poses), least_tolerance=least))
    return goals


def refuse_unknown_joints(loaded: LoadedSpec[EditPcSpec], facts: ClipFacts) -> None:
    """Raise the errors of all joints that goals name and the clip lacks."""
    faults, skeleton = Faults(), facts.clip.motion.skeleton
    for i, goal in enumerate(loaded.model.goals):
        place = resolve.Place(loaded, ("goals", i), facts.clip.label)
        faults.get(partial(resolve.effector, goal.effector, skeleton, place.at("effector")), otherwise=None)
        if goal.relative_to is not None:
            resolve.joint_if_there(goal.relative_to, skeleton, place.at("relative_to"), faults)
    faults.raise_all(f"joints that {facts.clip.label} lacks")


def _frame_on_timeline(at: Time, frame: int, model: MotionModel, facts: ClipFacts, *, events: dict[str, float]) -> int:
    timeline = model.timeline
    places = dict(timeline.events)
    if at.event is not None and at.text == at.event and at.event in places:
        return places[at.event]
    warp = make_warp(timeline, first=facts.first, last=facts.last, events=events, label=facts.clip.label)
    return round_half_up(float(warp.to_timeline(np.array([float(frame)]))[0]))


def _request(goal: PcGoal, facts: ClipFacts, place: Place, *, frame: int, poses: WorldPoses) -> GoalRequest:
    """Return what a goal asks for at a frame of `poses`."""
    skeleton = facts.clip.motion.skeleton
    effector = resolve.effector(goal.effector, skeleton, place.at("effector"))
    base = None
    if goal.relative_to is not None:
        base = resolve.joint(goal.relative_to, skeleton, place.at("relative_to"))
    axes = GivenAxes.of(facts, goal.frame, counted=goal.axes)
    measure = axes.measure(base=base)
    position = None if goal.position is None else axes.position(goal.position)
    if goal.shift is not None:
        position = seen(poses, frame, effector, measure)[0] + axes.shift(goal.shift)
    rotation = None if goal.orientation is None else axes.rotation(resolve.orientation(goal.orientation))
    if goal.turn is not None:
        turn = axes.turn(resolve.orientation(goal.turn))
        rotation = rot.multiply(turn, seen(poses, frame, effector, measure)[1])
    return GoalRequest(frame, effector, position, rotation, goal.weight, measure, goal.priority)


def _clip_goal(goal: PcGoal, request: GoalRequest, *, least_tolerance: float) -> ClipGoal:
    tolerance = goal.met_within
    if tolerance.off:
        return ClipGoal(goal, str(goal.name), request, None, None)
    position = least_tolerance if tolerance.position is None else tolerance.position
    angle = DEFAULT_ANGLE_TOLERANCE if tolerance.angle is None else tolerance.angle
    return ClipGoal(goal, str(goal.name), request, position, angle)


def seen(poses: WorldPoses, frame: int, effector: Effector, measure: Measure) -> tuple[FloatArray, FloatArray]:
    """Return an effector's position (3,) and its rotation (4,) as a goal states them."""
    one = poses.at(slice(frame, frame + 1))
    position = measure.positions(effector_positions(one, effector), one)
    return position[0], measure.rotations(one.rotations[:, effector.joint], one)[0]


def off(request: GoalRequest, poses: WorldPoses) -> tuple[float | None, float | None]:
    """Return how far a goal is off, clip units along its axes, and turned, rad; None of what it does not ask for."""
    position, rotation = seen(poses, request.frame, request.effector, request.measure)
    way = turn = None
    if request.position is not None:
        way = float(np.linalg.norm((request.position - position)[list(request.measure.counted)]))
    if request.rotation is not None:
        turn = float(rot.angle_between(rotation, request.rotation))
    return way, turn


def goal_record(goal: ClipGoal, poses: WorldPoses) -> dict[str, Any]:
    """Return a goal's entry in the report, measured by forward kinematics on the edited motion."""
    error, turn = off(goal.request, poses)
    angle = None if turn is None else float(np.degrees(turn))
    return {
        "name": goal.name,
        "priority": goal.spec.priority,
        "error_max": error,
        "error_rms": error,
        "error_angle_max": angle,
        "frame": goal.request.frame,
        "tolerance": goal.tolerance if error is not None else None,
        "tolerance_angle": goal.angle_tolerance if angle is not None else None,
        "status": "ok",
        "gave_way_to": [],
    }


def goal_place(request: GoalRequest, poses: WorldPoses) -> FloatArray | None:
    """Return where a goal wants its effector in the world, shape (3,); None where it asks for no position.

    Along axes that the goal leaves free it is where the effector is in `poses`.
    """
    if request.position is None:
        return None
    frame, measure = request.frame, request.measure
    one = poses.at(slice(frame, frame + 1))
    now = measure.positions(effector_positions(one, request.effector), one)
    place: FloatArray = measure.in_world(measure.aimed(now, request.position[None]), one)[0]
    return place


def numbers_of(request: GoalRequest) -> int:
    """Return how many numbers a goal asks for."""
    position = 0 if request.position is None else len(request.measure.counted)
    return position + (0 if request.rotation is None else 3)


def is_met(record: Mapping[str, Any]) -> bool:
    """Return whether a goal's record is within its tolerances."""
    pairs = ((record["error_max"], record["tolerance"]), (record["error_angle_max"], record["tolerance_angle"]))
    return all(error is None or limit is None or error <= limit for error, limit in pairs)
