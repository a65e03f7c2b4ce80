"""Turns a clip's motion into a body that the preview draws: upright points, limbs with thickness, a head."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.bones import below
from motionedit.core.body.tree import zero_pose
from motionedit.report.preview.body import Ball, Body, Hull, Limb, Side

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.clip.facts import ClipFacts

# Radii at a limb's two ends, in leg lengths (0.85 m): a lean figure whose joints are easy to tell apart.
_RADII = {
    "thigh": (0.088, 0.062),
    "shin": (0.062, 0.038),
    "foot": (0.042, 0.030),
    "toe": (0.030, 0.022),
    "hip": (0.080, 0.080),
    "spine": (0.095, 0.095),
    "neck": (0.050, 0.045),
    "collar": (0.050, 0.052),
    "upper arm": (0.054, 0.042),
    "forearm": (0.042, 0.030),
    "hand": (0.032, 0.020),
    "finger": (0.012, 0.010),
    "prop": (0.008, 0.007),
    "limb": (0.035, 0.025),
}
# What a joint's end site continues as, where it does not go on as the joint's own part.
_TIPS = {"forearm": "hand", "shin": "foot", "neck": "face", "prop": "prop"}
# A link shorter than this (leg lengths) has no direction that could be drawn.
_SHORTEST = 0.005
_HEAD_RADIUS = 0.118
# A link below the wrist longer than this (leg lengths) is something held: hands are shorter than 0.25.
_PROP_LENGTH = 0.4
# A figure whose lowest point stays this far (leg lengths) from up = 0 does not stand there: many rigs have their
# origin at the hips.
_FLOOR_REACH = 0.35


_HELPER_LENGTH = 0.3  # leg lengths
# Links that lie inside pelvis and chest where those are drawn, in the order of `_hulls`.
_COVERED = ("hip", "collar")


def body_of(facts: ClipFacts, *, label: str) -> Body:
    """Return the body of a clip.

    The file's up axis becomes y. Limb thickness and sides come from the anatomy found in the skeleton; what is
    not found there is drawn as thin limbs.
    """
    motion, anatomy, skeleton, first = facts.clip.motion, facts.anatomy, facts.bones, facts.first
    size = anatomy.leg_length or 1.0
    turn = upright(facts.up)
    front = turn @ facts.heading_frame().axes[2]
    parts = _parts(skeleton, anatomy)
    hulls = _hulls(skeleton, anatomy)
    covered = _COVERED[: len(hulls)]
    # Beside pelvis and chest, short links that are no limb are helpers of some rig: twist bones, breasts.
    lengths = np.linalg.norm(skeleton.offsets, axis=-1) / size
    carried = below(skeleton, facts.travel)
    ways = set() if anatomy.pelvis is None else set(skeleton.chain(anatomy.pelvis).tolist())
    for j, part in enumerate(parts):
        if part in covered or (hulls and part == "limb" and lengths[j] < _HELPER_LENGTH):
            parts[j] = "covered"
        if not carried[j] or j == facts.travel or j in ways:
            # What only says where the body is, and what stands beside it, is no limb.
            parts[j] = "none"
    balls = _head(facts)
    points = [facts.poses.positions, *_tips(facts.poses, skeleton), *(ball.path[:, None] for ball in balls)]
    positions = np.concatenate(points, axis=1) @ turn.T
    # What does not hang on the body is neither shown nor looked at: a root metres away.
    drawn = np.concatenate((carried, carried[[site.joint for site in skeleton.end_sites]]))
    positions[:, np.flatnonzero(~drawn)] = positions[:, [facts.travel]]
    names = [name if shown else "" for name, shown in zip((*skeleton.names, *_tip_names(skeleton)), drawn, strict=True)]
    lowest = float(positions[first:, : len(drawn), 1].min())
    return Body(
        label=label,
        names=(*names, *("" for _ in balls)),
        positions=positions,
        frame_time=motion.frame_time,
        first=first,
        limbs=_limbs(skeleton, parts, _sides(skeleton, anatomy), positions=positions, size=size),
        hulls=hulls,
        balls=tuple(Ball(len(drawn) + i, ball.radius, ball.part) for i, ball in enumerate(balls)),
        trails=_trails(skeleton, anatomy, parts),
        size=size,
        forward=(float(front[0]), float(front[1]), float(front[2])),
        axes=_axis_names(turn),
        floor=lowest if abs(lowest) > _FLOOR_REACH * size else 0.0,
    )


def upright(up: FloatArray) -> FloatArray:
    """Return the turn that brings the signed axis `up` to y and moves as few other axes as can be, shape (3, 3)."""
    axis = int(np.argmax(np.abs(up)))
    sign = float(np.sign(up[axis]))
    turn = np.eye(3)
    if axis == 1:
        turn *= (1.0, sign, sign)
    else:
        turn[[axis, 1]] = turn[[1, axis]]
        turn[1] *= sign
        turn[axis] *= -sign
    return turn


def _axis_names(turn: FloatArray) -> tuple[str, str, str]:
    x, y, z = (("-" if row.sum() < 0 else "") + "xyz"[int(np.argmax(np.abs(row)))] for row in turn)
    return x, y, z


def _tips(poses: WorldPoses, skeleton: Skeleton) -> list[FloatArray]:
    return [
        (poses.positions[:, site.joint] + rot.rotate(poses.rotations[:, site.joint], site.offset))[:, None]
        for site in skeleton.end_sites
    ]


def _tip_names(skeleton: Skeleton) -> list[str]:
    return [f"{skeleton.names[site.joint]} (end site)" for site in skeleton.end_sites]


def _below(skeleton: Skeleton, joint: int) -> list[int]:
    """Return the joints under `joint`, itself first, in file order."""
    joints: list[int] = np.flatnonzero(below(skeleton, joint)).tolist()
    return joints


def _between(skeleton: Skeleton, top: int | None, bottom: int) -> list[int]:
    """Return the joints from below `top` down to `bottom`; from the root where `top` is not above it."""
    chain: list[int] = skeleton.chain(bottom).tolist()
    return chain[chain.index(top) + 1 :] if top in chain else chain


def _parts(skeleton: Skeleton, anatomy: Anatomy) -> list[str]:
    """Return what the link that ends in each joint is: a key of `_RADII`, or "face"."""
    parts = ["limb"] * len(skeleton)

    def name(part: str, joints: list[int]) -> None:
        for j in joints:
            parts[j] = part

    if anatomy.head is not None:
        name("spine", skeleton.chain(anatomy.head).tolist())
        name("neck", _between(skeleton, anatomy.chest, anatomy.head))
        name("face", _below(skeleton, anatomy.head)[1:])
    for arm in anatomy.arms or ():
        name("collar", _between(skeleton, anatomy.chest, arm.shoulder))
        name("upper arm", _between(skeleton, arm.shoulder, arm.elbow))
        name("forearm", _between(skeleton, arm.elbow, arm.wrist))
        hand = _below(skeleton, arm.wrist)[1:]
        name("hand", hand)
        name("finger", [j for j in hand if skeleton.parents[j] != arm.wrist])
        name("prop", _held(skeleton, arm.wrist, size=anatomy.leg_length))
    for leg in anatomy.legs or ():
        name("hip", _between(skeleton, anatomy.pelvis, leg.thigh))
        name("thigh", _between(skeleton, leg.thigh, leg.knee))
        name("shin", _between(skeleton, leg.knee, leg.ankle))
        name("foot", _below(skeleton, leg.ankle)[1:])
        if leg.toe is not None:
            name("toe", _below(skeleton, leg.toe)[1:])
    return parts


def _held(skeleton: Skeleton, wrist: int, *, size: float) -> list[int]:
    """Return the joints below a wrist that lead to a link too long for a hand: a club, a racket."""
    long = _PROP_LENGTH * size
    hand = _below(skeleton, wrist)[1:]
    far = [j for j in hand if np.linalg.norm(skeleton.offsets[j]) > long]
    far += [e.joint for e in skeleton.end_sites if e.joint in hand and np.linalg.norm(e.offset) > long]
    return sorted({j for end in far for j in _between(skeleton, wrist, end)})


def _sides(skeleton: Skeleton, anatomy: Anatomy) -> list[Side]:
    sides: list[Side] = ["middle"] * len(skeleton)
    names: tuple[Side, Side] = ("left", "right")
    tops = [(side, leg.thigh) for side, leg in zip(names, anatomy.legs or (), strict=False)]
    for side, arm in zip(names, anatomy.arms or (), strict=False):
        tops.append((side, arm.shoulder if arm.clavicle is None else arm.clavicle))
    for side, top in tops:
        for j in _below(skeleton, top):
            sides[j] = side
    return sides


def _limbs(
    skeleton: Skeleton, parts: list[str], sides: list[Side], *, positions: FloatArray, size: float
) -> tuple[Limb, ...]:
    """Return the limbs to draw: links of some length, from each parent to its child and to the end sites."""
    links = [(int(p), j, parts[j], sides[j]) for j, p in enumerate(skeleton.parents) if p >= 0]
    for i, site in enumerate(skeleton.end_sites):
        part = "prop" if np.linalg.norm(site.offset) > _PROP_LENGTH * size else parts[site.joint]
        # What ends a hand, a foot or a toe goes on as such; what ends a limb is thin.
        part = part if part in {"prop", "foot", "toe", "hand", "finger", "face"} else _TIPS.get(part, "limb")
        links.append((site.joint, len(skeleton) + i, part, sides[site.joint]))
    limbs = []
    for start, end, part, side in links:
        length = float(np.linalg.norm(positions[0, end] - positions[0, start]))
        if part not in _RADII or length < _SHORTEST * size:
            continue
        thick, thin = (size * radius for radius in _RADII[part])
        if part == "limb":
            # Nothing is known of it: never thicker than long.
            thick, thin = min(thick, 0.3 * length), min(thin, 0.2 * length)
        limbs.append(Limb(start, end, (thick, thin), side))
    return tuple(limbs)


def _hulls(skeleton: Skeleton, anatomy: Anatomy) -> tuple[Hull, ...]:
    """Return pelvis and chest, whose turn against each other is half of a pose."""
    if anatomy.legs is None or anatomy.pelvis is None:
        return ()
    size = anatomy.leg_length
    left, right = anatomy.legs
    pelvis = Hull((left.thigh, right.thigh, anatomy.pelvis), (0.085 * size, 0.085 * size, 0.09 * size))
    if anatomy.arms is None or anatomy.chest is None:
        return (pelvis,)
    left_arm, right_arm = anatomy.arms
    trunk = [anatomy.pelvis, *_between(skeleton, anatomy.pelvis, anatomy.chest)]
    waist = trunk[len(trunk) // 2]
    chest = Hull((left_arm.shoulder, right_arm.shoulder, waist), (0.062 * size, 0.062 * size, 0.098 * size))
    return pelvis, chest


class _BallPath(NamedTuple):
    """A ball's centre over the frames, (F, 3) in the file's axes, its radius and what it is."""

    path: FloatArray
    radius: float
    part: Literal["head", "nose"]


def _head(facts: ClipFacts) -> list[_BallPath]:
    """Return the head, and the nose where the skeleton tells where the head looks."""
    anatomy, skeleton = facts.anatomy, facts.bones
    if anatomy.head is None or anatomy.legs is None:
        return []
    head, radius = anatomy.head, _HEAD_RADIUS * anatomy.leg_length
    zero = zero_pose(skeleton)
    left, right = (zero[leg.thigh] for leg in anatomy.legs)
    up = _unit(zero[head] - 0.5 * (left + right))
    tips = [site.offset for site in skeleton.end_sites if site.joint == head]
    tips += [skeleton.offsets[j] for j in skeleton.children[head]]
    reach = max((float(tip @ up) for tip in tips), default=0.0)
    q = facts.poses.rotations[:, head]
    # The ball stands on a head joint at the neck's top, and about one that is already inside the skull.
    center = facts.poses.positions[:, head] + rot.rotate(q, max(0.5 * reach, 0.6 * radius) * up)
    # left x up = ahead: so a face looks in the pose where every channel is zero.
    across = right - left if anatomy.mirrored else left - right
    looks = rot.rotate(q, _unit(np.cross(across, up)))
    balls = [_BallPath(center, radius, "head")]
    if looks[facts.first] @ facts.heading_frame().axes[2] > 0.0:
        balls.append(_BallPath(center + 0.95 * radius * looks, 0.28 * radius, "nose"))
    return balls


def _unit(vector: FloatArray) -> FloatArray:
    unit: FloatArray = vector / (np.linalg.norm(vector) or 1.0)
    return unit


def _trails(skeleton: Skeleton, anatomy: Anatomy, parts: list[str]) -> tuple[int, ...]:
    """Return the points whose paths tell most: the far ends of what is held, else the hands, else the end sites."""
    joints = len(skeleton)
    held = [
        joints + i
        for i, site in enumerate(skeleton.end_sites)
        if parts[site.joint] == "prop" or np.linalg.norm(site.offset) > _PROP_LENGTH * anatomy.leg_length
    ]
    held += [j for j in range(joints) if parts[j] == "prop" and not skeleton.children[j] and not held]
    hands = [arm.wrist for arm in anatomy.arms or ()]
    return tuple(held or hands or range(joints, joints + min(2, len(skeleton.end_sites))))
