"""The words every spec shares: effectors, orientations, tolerances, units; times come from `times`."""

from __future__ import annotations

import math
import re
from dataclasses import field
from typing import TYPE_CHECKING, Literal

from motionedit.dataclass import dataclass
from motionedit.spec import grammar
from motionedit.spec.faults import Fault, FaultyValueError, did_you_mean, faulty, listed, show
from motionedit.spec.scalars import (
    Vector,
    items,
    name,
    names,
    number,
    numbers,
    one_of,
    vector,
    whole,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

# Metres a unit. `cmu` is the unit of the CMU motion capture files: 1/0.45 inch.
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "cmu": 0.0254 / 0.45}
EFFECTOR_WORDS = "a joint's name, {joint: NAME, offset: [x, y, z]}, {end_site: NAME} or {end_site: NAME, index: 0}"
ORIENTATION_WORDS = (
    "{euler: [x, y, z], order: ZXY}, {quaternion: [w, x, y, z]} or {rotation_vector: [x, y, z]}, in degrees"
)
# Many points of the body in a word.
BODY_PARTS = ("feet", "all")
RECRUIT_WORDS = "all, {up_to: JOINT}, {levels: 3} or {joints: [...]}"

# A quaternion shorter than this says nothing about a direction.
_SHORTEST_QUATERNION = 1e-6


@dataclass(frozen=True)
class Unit:
    """A unit of length: its `name` as written and its `metres`."""

    name: str
    metres: float


@dataclass(frozen=True)
class EffectorSpec:
    """A point of the body as a spec names it.

    `joint` is the joint's name. The point is the joint itself, `offset` (3 lengths, in the joint's frame), or, where
    `end_site`, the joint's end site number `index`.
    """

    joint: str
    offset: Vector | None = None
    end_site: bool = False
    index: int = 0


@dataclass(frozen=True)
class OrientationSpec:
    """A rotation as a spec writes it: `values` in degrees, or a unit quaternion [w, x, y, z].

    `order` names Euler channels as BVH does (ZXY is Rz Rx Ry) and is None for the other kinds; Euler values are
    always about x, y, z, whatever the order.
    """

    kind: Literal["euler", "quaternion", "rotation_vector"]
    values: tuple[float, ...]
    order: str | None = None


@dataclass(frozen=True)
class Tolerance:
    """How far from its goal is near enough.

    `position` in clip units and `angle` in degrees, None for the default; `off` may give way. `bare` was one number.
    """

    position: float | None = None
    angle: float | None = None
    off: bool = False
    bare: bool = field(default=False, compare=False)

    def as_angle(self) -> Tolerance:
        """Return the tolerance where a bare number means degrees."""
        return Tolerance(angle=self.position) if self.bare else self


@dataclass(frozen=True)
class Recruit:
    """Which joints may move: `kind` and its value (`joint` for up_to, `levels`, `joints`).

    `joints` may name a root's translation as ``NAME.position``.
    """

    kind: Literal["all", "up_to", "levels", "joints"] = "all"
    joint: str | None = None
    levels: int | None = None
    joints: tuple[str, ...] = ()


def read_keys(value: Mapping[str, object], parsers: Mapping[str, Callable[[object], object]]) -> dict[str, object]:
    """Return each key's parsed value; all unknown keys and faulty values are reported at once."""
    found: dict[str, object] = {}
    faults: list[Fault] = []
    for key, item in value.items():
        try:
            if key not in parsers:
                raise faulty(unknown_key(key, tuple(parsers)))
            if item is None:
                raise faulty("needs a value")
            found[key] = parsers[key](item)
        except FaultyValueError as error:
            faults += [fault.under(key) for fault in error.faults]
    if faults:
        raise FaultyValueError(faults)
    return found


def unknown_key(key: str, keys: tuple[str, ...]) -> str:
    """Return the message for a key that does not exist here."""
    return f"unknown key; {did_you_mean(key, keys, otherwise=f'the keys here are {listed(keys)}')}"


def parse_joint(value: object) -> str:
    """Return a joint's name."""
    return name(value, what="a joint's name")


def parse_joints(value: object) -> tuple[str, ...]:
    """Return a list of different joint names."""
    return names(value, what="a list of joints")


def parse_effector(value: object) -> EffectorSpec:
    """Return the effector of a name or of one of its mappings."""
    if isinstance(value, str):
        return EffectorSpec(parse_joint(value))
    if not isinstance(value, dict) or not value:
        raise faulty(f"must be an effector: {EFFECTOR_WORDS}; not {show(value)}")
    parsers = {
        "joint": parse_joint,
        "offset": vector,
        "end_site": parse_joint,
        "index": lambda item: whole(item, at_least=0),
    }
    found = read_keys(value, parsers)
    if ("joint" in found) == ("end_site" in found):
        raise faulty(f"needs one of joint, end_site: an effector is {EFFECTOR_WORDS}")
    if "end_site" in found:
        if "offset" in found:
            raise faulty("belongs to {joint: NAME, offset: [x, y, z]}; an end site has its own", "offset")
        return EffectorSpec(str(found["end_site"]), end_site=True, index=whole(found.get("index", 0)))
    if "index" in found:
        raise faulty("belongs to {end_site: NAME, index: 0}", "index")
    offset = vector(value["offset"]) if "offset" in found else None
    return EffectorSpec(str(found["joint"]), offset)


def parse_effectors(value: object) -> tuple[EffectorSpec, ...]:
    """Return the effectors of one form or of a list of them, one goal or constraint each."""
    if not isinstance(value, list):
        return (parse_effector(value),)
    found = items(value, parse_effector, what="an effector or a list of them")
    faults = [
        Fault(f"{show(value[i])} is listed twice", (i,)) for i, effector in enumerate(found) if effector in found[:i]
    ]
    if faults:
        raise FaultyValueError(faults)
    return found


def parse_body_points(value: object) -> str | tuple[EffectorSpec, ...]:
    """Return ``feet``, ``all``, or the effectors of one form or of a list of them."""
    return value if isinstance(value, str) and value in BODY_PARTS else parse_effectors(value)


def parse_orientation(value: object) -> OrientationSpec:
    """Return the orientation of one of its three mappings; quaternions are made unit ones."""
    if not isinstance(value, dict) or not value:
        raise faulty(f"must be an orientation: {ORIENTATION_WORDS}; not {show(value)}")
    parsers = {
        "euler": vector,
        "order": _parse_order,
        "quaternion": _parse_quaternion,
        "rotation_vector": vector,
    }
    found = read_keys(value, parsers)
    kinds = [key for key in ("euler", "quaternion", "rotation_vector") if key in found]
    if len(kinds) != 1:
        raise faulty(f"needs one of euler, quaternion, rotation_vector: {ORIENTATION_WORDS}")
    if kinds == ["euler"]:
        if "order" not in found:
            raise faulty("needs order beside euler, such as order: ZXY (Rz Rx Ry, as BVH channels)")
        return OrientationSpec("euler", vector(value["euler"]), str(found["order"]))
    if "order" in found:
        raise faulty("belongs to euler", "order")
    if kinds == ["quaternion"]:
        return OrientationSpec("quaternion", _parse_quaternion(value["quaternion"]))
    return OrientationSpec("rotation_vector", vector(value["rotation_vector"]))


def _parse_order(value: object) -> str:
    if isinstance(value, str) and re.fullmatch(grammar.ORDER, value):
        return value.upper()
    raise faulty(f"must be {one_of(grammar.ORDERS)}, not {show(value)}")


def _parse_quaternion(value: object) -> tuple[float, ...]:
    parts = numbers(value, count=4, what="four numbers [w, x, y, z]")
    length = math.hypot(*parts)
    if not _SHORTEST_QUATERNION < length < math.inf:
        raise faulty(f"must be a quaternion that can be made a unit one, not {show(value)}")
    return tuple(part / length for part in parts)


def parse_tolerance(value: object) -> Tolerance:
    """Return the tolerance of a number, ``{position: 0.5, angle: 0.1}`` or ``off``."""
    if value == "off":
        return Tolerance(off=True)
    if isinstance(value, dict) and value:
        found = read_keys(value, {"position": _positive, "angle": _positive})
        position, angle = found.get("position"), found.get("angle")
        return Tolerance(None if position is None else number(position), None if angle is None else number(angle))
    if isinstance(value, (str, bool, dict, list)):
        raise faulty(f"must be a number, {{position: 0.5, angle: 0.1}} or off, not {show(value)}")
    return Tolerance(_positive(value), bare=True)


def _positive(value: object) -> float:
    return number(value, above=0.0)


def parse_unit(value: object) -> Unit:
    """Return the unit of a name or of a number of metres."""
    if isinstance(value, str):
        if value not in UNITS:
            raise faulty(f"must be {one_of((*UNITS, 'a number of metres'))}, not {show(value)}")
        return Unit(value, UNITS[value])
    metres = number(value, above=0.0)
    return Unit(f"{metres:g} m", metres)


def parse_recruit(value: object) -> Recruit:
    """Return which joints are recruited: all, or one of three mappings."""
    if value == "all":
        return Recruit()
    if not isinstance(value, dict) or not value:
        raise faulty(f"must be {RECRUIT_WORDS}, not {show(value)}")
    levels: Callable[[object], object] = lambda item: whole(item, at_least=1)  # noqa: E731 (read as one table)
    found = read_keys(value, {"up_to": parse_joint, "levels": levels, "joints": parse_joints})
    if len(found) != 1:
        raise faulty(f"needs one of up_to, levels, joints: {RECRUIT_WORDS}")
    if "up_to" in found:
        return Recruit("up_to", joint=str(found["up_to"]))
    if "levels" in found:
        return Recruit("levels", levels=whole(found["levels"]))
    return Recruit("joints", joints=parse_joints(value["joints"]))
