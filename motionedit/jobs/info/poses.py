"""Where effectors are at given times: the answer to `motionedit info --at TIME --joint EFFECTOR`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.euler import angles_near
from motionedit.core.kinematics import Effector, effector_positions
from motionedit.dataclass import dataclass
from motionedit.errors import MotionEditError, UsageError
from motionedit.jobs.clip import resolve
from motionedit.spec.faults import FaultyValueError
from motionedit.spec.times import Time, parse_time
from motionedit.spec.values import EffectorSpec, parse_effector
from motionedit.spec.yaml_tree import value_from_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.clip.facts import ClipFacts

# The order for a joint whose own channels are not three axes.
_USUAL_ORDER = "ZXY"
# Positions are told to this part of the leg length, a hundredth of the usual tolerance; angles to 0.001 degrees.
_RESOLUTION = 1e-5
_ANGLE_DECIMALS = 3
_QUATERNION_DECIMALS = 6


@dataclass(frozen=True)
class Question:
    """What is asked of each clip: the poses of all `effectors` at all `times`."""

    times: tuple[Time, ...]
    effectors: tuple[EffectorSpec, ...]

    def __bool__(self) -> bool:
        return bool(self.times and self.effectors)


def ask(at: Sequence[str], joints: Sequence[str]) -> Question:
    """Return the question of the options' texts.

    A joint is its name as it stands, or a YAML mapping in braces: ``{joint: RightHand, offset: [0, -92, 0]}``.

    Raises
    ------
    UsageError
        A text that is no time or no effector.
    """
    try:
        times = tuple(parse_time(text) for text in at)
    except FaultyValueError as error:
        raise UsageError(str(error), key="--at") from error
    try:
        effectors = tuple(_effector_of(text) for text in joints)
    except FaultyValueError as error:
        raise UsageError(str(error), key="--joint") from error
    return Question(times, effectors)


def poses_at(facts: ClipFacts, question: Question) -> tuple[list[dict[str, Any]], list[MotionEditError]]:
    """Return the poses asked for, times in the order asked, and an error for each time or effector that is not there.

    Each pose has `at`, `effector` and, under `world` and `heading`, `position` (clip units), `euler` (degrees, x y z),
    `order` and `quaternion`.
    """
    motion = facts.clip.motion
    errors: list[MotionEditError] = []
    frames: list[int] = []
    effectors: list[tuple[EffectorSpec, Effector]] = []
    for time in question.times:
        try:
            frames.append(resolve.frame(time, _Option("--at", facts.clip.label), motion, events={}))
        except UsageError as error:
            errors.append(error)
    for spec in question.effectors:
        try:
            effectors.append((spec, resolve.effector(spec, motion.skeleton, _Option("--joint", facts.clip.label))))
        except UsageError as error:
            errors.append(error)
    return [_pose(facts, frame, spec, effector) for frame in frames for spec, effector in effectors], errors


@dataclass(frozen=True)
class _Option:
    """An option of the command line as the place of an error, where an edit has a key of its spec."""

    key: str
    clip: str

    def at(self, *_keys: str | int) -> _Option:
        return self

    def error(self, message: str) -> UsageError:
        return UsageError(message, key=self.key)


def _effector_of(text: str) -> EffectorSpec:
    return parse_effector(value_from_text(text) if text.lstrip().startswith("{") else text)


def _pose(facts: ClipFacts, frame: int, spec: EffectorSpec, effector: Effector) -> dict[str, Any]:
    motion = facts.clip.motion
    heading = facts.heading_frame()
    position = effector_positions(facts.poses, effector)[frame]
    rotation = facts.poses.rotations[frame, effector.joint]
    order = _order(motion.skeleton, effector.joint)
    in_heading = rot.between(heading.rotation, rotation)
    decimals = _decimals(facts.anatomy.leg_length)
    return {
        "at": frame,
        "seconds": frame * motion.frame_time,
        "effector": _plain(spec),
        "world": _transform(position, rotation, order=order, decimals=decimals),
        "heading": _transform(heading.points(position), in_heading, order=order, decimals=decimals),
    }


def _plain(spec: EffectorSpec) -> str | dict[str, Any]:
    """Return the effector as a spec says it."""
    if spec.end_site:
        return {"end_site": spec.joint, **({"index": spec.index} if spec.index else {})}
    return spec.joint if spec.offset is None else {"joint": spec.joint, "offset": list(spec.offset)}


def _order(skeleton: Skeleton, joint: int) -> str:
    axes = skeleton.rotation_axes[joint]
    return "".join("XYZ"[axis] for axis in axes) if sorted(axes) == [0, 1, 2] else _USUAL_ORDER


def _transform(position: FloatArray, rotation: FloatArray, *, order: str, decimals: int) -> dict[str, Any]:
    rotation = rot.normalize(rotation if rotation[0] >= 0.0 else -rotation)
    return {
        "position": _rounded(position, decimals),
        "euler": _rounded(np.degrees(_euler(rotation, order)), _ANGLE_DECIMALS),
        "order": order,
        "quaternion": _rounded(rotation, _QUATERNION_DECIMALS),
    }


def _euler(rotation: FloatArray, order: str) -> FloatArray:
    """Return the angles about x, y, z (rad), of both solutions the one nearest zero, shape (3,)."""
    axes = rot.euler_axes(order)
    euler = np.empty(3)
    euler[list(axes)] = angles_near(rotation[None], axes, seed=np.zeros(3))[0]
    return euler


def _decimals(leg_length: float) -> int:
    return 6 if leg_length <= 0.0 else min(max(round(-math.log10(_RESOLUTION * leg_length)), 0), 9)


def _rounded(values: FloatArray, decimals: int) -> list[float]:
    # Adding 0 turns -0.0 into 0.0.
    return [round(float(value), decimals) + 0.0 for value in values]
