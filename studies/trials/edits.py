"""Edits that people make, as constraints for any body of the trials; lengths in metres at a leg of 0.85 m."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation

from studies.trials.bodies import SIDES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import FloatArray
    from studies.trials.bodies import Body

Constraint = dict[str, Any]
Edit = list[Constraint]


def _numbers(values: FloatArray) -> list[float]:
    return [round(float(value), 5) for value in values]


def _position(name: str, effector: object, priority: int, points: Sequence[Constraint], **more: object) -> Constraint:
    return {
        "name": name,
        "type": "position",
        "effector": effector,
        "priority": priority,
        "points": list(points),
        **more,
    }


def _during(span: Sequence[int], shift: FloatArray) -> Constraint:
    return {"during": list(span), "shift": _numbers(shift)}


def _feet(body: Body, priority: int = 10) -> Edit:
    return [{"name": "feet", "type": "position", "effector": body.feet, "priority": priority}]


def _com(priority: int = 2, **more: object) -> Constraint:
    return {"name": "com", "type": "com", "relative_to": "world", "priority": priority, **more}


def _reach(body: Body, *, up: float, forward: float, left: float) -> Edit:
    around = body.frames(0.25) // 2
    hold = {"hold": [body.middle - around, body.middle + around]}
    point = {**hold, "shift": _numbers(body.way(up=up, forward=forward, left=left))}
    return [*_feet(body), _position("hand", body.parts["wrist Left"], 5, [point])]


def _near(body: Body) -> Edit:
    return [*_reach(body, up=0.15, forward=0.15, left=0.1), _com()]


def _far(body: Body) -> Edit:
    return [*_reach(body, up=0.45, forward=0.35, left=0.2), _com()]


def _at_the_limit(body: Body) -> Edit:
    return [*_reach(body, up=0.8, forward=0.5, left=0.3), _com()]


def _beyond_without_com(body: Body) -> Edit:
    return _reach(body, up=1.5, forward=2.0, left=1.2)


def _beyond(body: Body) -> Edit:
    return [*_beyond_without_com(body), _com()]


def _held(body: Body, span: Sequence[int], place: FloatArray) -> Edit:
    point = {"hold": list(span), "position": _numbers(place)}
    return [*_feet(body), _position("hand", body.parts["wrist Left"], 5, [point]), _com()]


def _fixed_point(body: Body) -> Edit:
    return _held(body, body.span(0.3, 0.7), body.place("wrist Left") + body.way(up=0.25, left=0.25, forward=0.2))


def _long_hold(body: Body) -> Edit:
    return _held(body, [body.first, len(body.take) - 1], body.place("wrist Left") + body.way(up=0.1))


def _wall(body: Body) -> Edit:
    axis = int(np.argmax(np.abs(body.axes[2])))
    point = {"hold": body.span(0.35, 0.65), "position": _numbers(body.place("chest") + body.way(forward=0.5))}
    hands = [body.parts[f"wrist {side}"] for side in SIDES]
    return [*_feet(body), _position("wall", hands, 5, [point], axes=["xyz"[axis]]), _com()]


def _box(body: Body) -> Edit:
    edit = _feet(body)
    for side, left in zip(SIDES, (0.15, -0.15), strict=True):
        at = body.turn("chest").T @ body.way(forward=0.35, left=left, up=-0.05)
        point = {"hold": body.span(0.25, 0.75), "position": _numbers(at)}
        where = {"relative_to": body.parts["chest"]}
        edit.append(_position(f"hand {side}", body.parts[f"wrist {side}"], 5, [point], **where))
    return [*edit, _com()]


def _both_high(body: Body) -> Edit:
    feet = [
        {"name": f"foot {side}", "type": "pose", "effector": body.parts[f"ankle {side}"], "priority": 10}
        for side in SIDES
    ]
    around = body.frames(0.3) // 2
    ride = _during([body.middle - around, body.middle + around], body.way(up=0.9, forward=0.1))
    return [*feet, _position("hands", [body.parts[f"wrist {side}"] for side in SIDES], 5, [ride]), _com()]


def _step(body: Body) -> Edit:
    ease = dict.fromkeys(("ease_in", "ease_out"), body.frames(0.4))
    over = {"at": body.middle, "shift": _numbers(body.way(up=0.3))}
    return [_position("over", body.parts["ankle Right"], 10, [over], **ease), *_feet(body, 2), _com(1)]


def _balance(body: Body) -> Edit:
    return [*_feet(body), _com(5, points=[_during(body.span(0.3, 0.7), body.way(left=0.12, up=-0.05))])]


def _hips(body: Body, up: float) -> Edit:
    return [*_feet(body), _position("hips", body.parts["hips"], 5, [_during(body.span(0.3, 0.7), body.way(up=up))])]


def _crouch(body: Body) -> Edit:
    return _hips(body, -0.2)


def _raise_hips(body: Body) -> Edit:
    return [*_hips(body, 0.12), _com()]


def _turned(body: Body, part: str, degrees: float, axis: FloatArray) -> Edit:
    """Return a part that is held turned in the world about an axis, from how it is in mid-clip."""
    turn = Rotation.from_rotvec(np.radians(degrees) * axis) * Rotation.from_matrix(body.turn(part))
    turned = {"rotation_vector": _numbers(np.degrees(turn.as_rotvec()))}
    point = {"hold": body.span(0.3, 0.7), "orientation": turned}
    one = {"name": "turn", "type": "orientation", "effector": body.parts[part], "priority": 5, "points": [point]}
    return [*_feet(body), one, _com()]


def _palm(body: Body) -> Edit:
    return _turned(body, "wrist Left", 70.0, body.axes[2])


def _lean(body: Body) -> Edit:
    return _turned(body, "chest", 35.0, body.axes[0])


def _gaze(body: Body) -> Edit:
    axis = _numbers(body.turn("head").T @ body.axes[2])
    at = body.place("head") + body.way(forward=1.5, left=1.2)
    point = {"hold": body.span(0.25, 0.75), "position": _numbers(at)}
    eyes = {"name": "eyes", "type": "aim", "effector": body.parts["head"], "axis": axis, "priority": 5}
    return [*_feet(body), {**eyes, "points": [point]}, _com()]


def _ends(body: Body) -> Edit:
    shift, frames = body.way(up=0.3, forward=0.1), len(body.take)
    rides = [_during(span, shift) for span in ([body.first + 1, frames // 4], [3 * frames // 4, frames - 2])]
    return [*_feet(body), _position("hand", body.parts["wrist Right"], 5, rides), _com()]


def _overlap(body: Body, priority: int = 5) -> Edit:
    hand = body.parts["wrist Left"]
    one = _position("one", hand, 5, [_during(body.span(0.3, 0.55), body.way(up=0.3))])
    two = _position("two", hand, priority, [_during(body.span(0.45, 0.7), body.way(forward=0.3))])
    return [*_feet(body), one, two, _com()]


def _overlap_above(body: Body) -> Edit:
    return _overlap(body, 7)


def _whole(body: Body) -> list[int]:
    return [body.first, len(body.take) - 1]


def _foot_over_hips(body: Body) -> Edit:
    hips = _position("hips", body.parts["hips"], 5, [_during(_whole(body), body.way(up=-0.15))])
    return [hips, _position("foot", body.parts["ankle Left"], 10, [{"during": body.span(0.45, 0.6)}])]


def _com_in_the_middle(body: Body) -> Edit:
    hand = _position("hand", body.parts["wrist Left"], 5, [_during(_whole(body), body.way(up=0.45, forward=0.3))])
    return [*_feet(body), hand, _com(points=[{"during": body.span(0.45, 0.6)}])]


EDITS: dict[str, Callable[[Body], Edit]] = {
    "near": _near,
    "far": _far,
    "at the limit": _at_the_limit,
    "beyond": _beyond,
    "beyond, no com": _beyond_without_com,
    "fixed point": _fixed_point,
    "long hold": _long_hold,
    "wall": _wall,
    "box": _box,
    "both high": _both_high,
    "step": _step,
    "balance": _balance,
    "crouch": _crouch,
    "raise hips": _raise_hips,
    "palm": _palm,
    "lean": _lean,
    "gaze": _gaze,
    "ends": _ends,
    "overlap": _overlap,
    "overlap above": _overlap_above,
    "foot over hips": _foot_over_hips,
    "com in the middle": _com_in_the_middle,
}
# A goal is out of reach in many frames, by design.
GIVING_WAY = (
    *("at the limit", "beyond", "beyond, no com", "fixed point", "long hold"),
    *("wall", "both high", "raise hips"),
)
# Constraints begin over others, or where the clip ends.
SWITCHING = ("overlap", "overlap above", "foot over hips", "com in the middle", "ends")
# A `com` below cannot be met for long.
STRICT = ("far", "at the limit", "beyond", "fixed point", "long hold", "wall", "both high", "raise hips")
