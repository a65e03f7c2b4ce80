"""The body of human.py as other programs rig it: other names, units, axes, channels, and what hangs on a body."""

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product

import numpy as np
from human import BONES, ENDS, ROOT_CHANNELS, above, skeleton_of, split
from rig_names import CONVENTIONS, styled
from rig_rows import CONTROLS, DOUBLED, EXTRAS, PARTS
from takes import SIDES, TAKES

from motionedit.core import rotations as rot
from motionedit.core.body.ground import axis_name
from motionedit.core.bvh import new_bytes, parse_clip
from motionedit.core.motion import Motion
from motionedit.jobs.clip.facts import facts_of

# Rows: the file's x, y, z of a body whose own axes are left, up, forward.
FILES = {
    "y": np.eye(3),
    "z": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]]),
    "-y": np.diag([-1.0, -1.0, 1.0]),
    "-z": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
}


# Bones cut in two: the joint at the end, what the one in between is called, and where it is.
ROLLS = [("*Leg", "*UpLegRoll", 0.5), ("*ForeArm", "*ArmRoll", 0.4), ("*Hand", "*ForeArmRoll", 0.6)]
CARRIERS = ("hips", "far hips", "root", "far root", "root and hips", "six", "six zero", "six other")
AXES = ("world", "T-pose", "along x", "along y", "along mirrored x", "rolled")


def mirrored(rows):
    """Return rows (name, parent, offset) with each `*` written out for both sides, in the order of a file."""
    both = []
    for name, parent, offset in rows:
        for side, sign in SIDES.items() if "*" in name else (("", 1.0),):
            x, y, z = offset
            both.append((name.replace("*", side), parent and parent.replace("*", side), (sign * x, y, z)))
    return in_file_order(both, 0)


@dataclass(frozen=True)
class Rig:
    """How a body is rigged, and what hangs on it.

    Attributes
    ----------
    names : str
        Of `CONVENTIONS`, or ``nameless``: what hangs on the body alone keeps its names.
    carrier : str
        Of `CARRIERS`: ``hips`` travel as the root or below a static ``root``, and their OFFSET is ``far`` off or not;
        the ``root and hips`` share the way, along the ground and up; or all joints have ``six`` channels, and OFFSETs
        that are the bones, ``zero`` or ``other`` ones.
    axes : str
        Of `AXES`: OFFSETs stand as the body does, with the joints' axes those of the ``world``, the arms straight down,
        or in a ``T-pose``; or each bone lies ``along`` an axis of its joint, along x with the others ``rolled`` anyhow.
        What is no bone or a piece of one has the axes of its parent.
    facing : float
        Degrees by which the body and its way are turned about up.
    order : int
        A seed: children and branches stand in another order in the file; 0 leaves them.
    hips : str
        ``bare``; or between them and the thighs CMU's hip ``joints`` at one place, or a ``pelvis``.
    rolls : bool
        Whether bones of limbs are cut in two.
    style : str
        Of `STYLES`: how the names of what hangs on the body are written.
    stretch : int
        A seed: bones are up to a fifth longer or shorter, alike on both sides; 0 leaves them.
    without : tuple of str
        Joints that are left out, with all that hangs on them.
    longer : str
        A joint whose bone is 1.9 times as long.
    neck : str
        ``beside`` the arms, on the joint ``below`` them, or on ``Spine``.
    """

    names: str = "plain"
    scale: float = 1.0
    up: str = "y"
    carrier: str = "hips"
    axes: str = "world"
    facing: float = 0.0
    order: int = 0
    extras: tuple[str, ...] = ()
    doubled: bool = False
    controls: bool = False
    hips: str = "bare"
    rolls: bool = False
    style: str = "LeftSkirt1"
    stretch: int = 0
    without: tuple[str, ...] = ()
    longer: str = ""
    neck: str = "beside"
    leaf_feet: bool = False


PLAIN = Rig()


def rows_of(rig):
    """Return the rows (name, parent, offset) and the ends of a rig, by the names of human.py."""
    rows = _sized(_body(rig), rig)
    for (end, middle, share), side in product(ROLLS, SIDES) if rig.rolls else ():
        rows = split(rows, end.replace("*", side), middle.replace("*", side), share)
    rows = [*rows, *(row for extra in rig.extras for row in EXTRAS[extra]), *(DOUBLED if rig.doubled else ())]
    ends = ENDS | {name: offset for name, _, offset in DOUBLED}
    gone = set(rig.without)
    if rig.leaf_feet:
        gone |= {side + "ToeBase" for side in SIDES}
        ends |= {side + "Foot": (0.0, -0.06, 0.13) for side in SIDES}
    for name, parent, _ in rows:
        if parent in gone:
            gone.add(name)
    rows = [row for row in rows if row[0] not in gone]
    if "root" in rig.carrier:
        rows = [*above(rows, "Root"), *(CONTROLS if rig.controls else ())]
    parents = {parent for _, parent, _ in rows}
    leaves = {name: tuple(0.3 * x for x in offset) for name, _, offset in rows if name not in parents}
    return rows, {name: ends.get(name, offset) for name, offset in leaves.items()}


def _body(rig):
    """Return the rows of the body alone, as its hips and its neck are rigged."""
    rows = list(BONES)
    if rig.hips != "joints":
        rows = [(n, "Hips" if p in ("LHipJoint", "RHipJoint") else p, o) for n, p, o in rows if "HipJoint" not in n]
    if rig.hips == "pelvis":
        rows = [(n, "Pelvis", (o[0], 0.0, 0.0)) if n.endswith("UpLeg") else (n, p, o) for n, p, o in rows]
        rows.insert(1, ("Pelvis", "Hips", (0.0, -0.05, 0.0)))
    if rig.neck == "below":
        rows = [(n, "Spine2", (o[0], 0.05, o[2])) if n.endswith("Shoulder") else (n, p, o) for n, p, o in rows]
        rows.insert([n for n, _, _ in rows].index("Spine1") + 1, ("Spine2", "Spine1", (0.0, 0.1, 0.0)))
    elif rig.neck == "Spine":
        rows = [(n, "Spine", (0.0, 0.4, 0.0)) if n == "Neck" else (n, p, o) for n, p, o in rows]
    return rows


def _sized(rows, rig):
    """Return the rows with the bones of the sizes that a rig asks for."""
    rng = np.random.default_rng(rig.stretch)
    sizes = {
        part: rng.uniform(0.8, 1.2) if rig.stretch else 1.0 for part in dict.fromkeys(_part(n) for n, _, _ in rows)
    }
    factors = {n: sizes[_part(n)] * (1.9 if n == rig.longer else 1.0) for n, _, _ in rows}
    return [(n, p, tuple(factors[n] * x for x in o)) for n, p, o in rows]


def _part(name):
    return re.sub("Left|Right|^[LR]", "", name)


def in_file_order(rows, seed):
    """Return rows in the order of a file, each joint followed by all that hang on it, the children shuffled."""
    rng = np.random.default_rng(seed)
    children = {}
    for row in rows:
        children.setdefault(row[1], []).append(row)
    ordered, waiting = [], children[None]
    while waiting:
        row = waiting.pop()
        ordered.append(row)
        below = children.get(row[0], [])[::-1]
        waiting += [below[i] for i in rng.permutation(len(below))] if seed else below
    return ordered


def file_names(rig):
    """Return what the file calls each joint of human.py and of what hangs on it."""
    rows, _ = rows_of(rig)
    hanging = {n: styled(n, rig.style) for extra in rig.extras if extra not in PARTS for n, _, _ in EXTRAS[extra]}
    if rig.names == "nameless":
        return {n: f"joint{i}" for i, (n, _, _) in enumerate(rows)} | hanging
    return {n: CONVENTIONS[rig.names].get(n, n) for n, _, _ in rows} | hanging


def motion_of(rig, take, *, noise=0.0, drift=0.0):
    """Return a take by a rig.

    Parameters
    ----------
    noise : float
        Metres by which the hips are off at each frame, and a half of that by which the ankles are off once more.
    drift : float
        Metres a second by which the body rises.
    """
    rows, ends = rows_of(rig)
    rows = in_file_order(rows, rig.order)
    rng = np.random.default_rng(1)
    frames = len(take.hips)
    facing = rot.about_axis(1, np.radians(rig.facing))
    own = _own_axes(rows, rig)
    bones = {name: np.array(offset) for name, _, offset in rows}
    rotations = np.empty((frames, len(rows), 4))
    translations = np.empty((frames, len(rows), 3))
    for j, (name, parent, _) in enumerate(rows):
        turns, place = np.broadcast_to(take.turns.get(name, rot.IDENTITY), (frames, 4)), bones[name]
        if name.endswith("Leg"):
            turns = rot.multiply(turns, rot.exp(noise * rng.normal(size=(frames, 3))))
        if name == "Hips":
            place = take.hips + noise * rng.normal(size=(frames, 3)) / np.sqrt(3.0)
            place[:, 1] += drift * np.arange(frames) / take.rate
            turns, place = rot.multiply(facing, turns), rot.rotate(facing, place)
            if rig.carrier == "root and hips":
                translations[:, 0], place = place * [1.0, 0.0, 1.0], place * [0.0, 1.0, 0.0]
        elif name.startswith("IK_") or parent is None:
            place = place + 1e-4 * rng.normal(size=(frames, 3))
        to_parent = rot.conjugate(own.get(parent, rot.IDENTITY))
        rotations[:, j] = rot.multiply(to_parent, rot.multiply(turns, own[name]))
        translations[:, j] = rot.rotate(to_parent, place)
    turn = FILES[rig.up]
    rotations[..., 1:] = rotations[..., 1:] @ turn.T
    translations = rig.scale * translations @ turn.T
    offsets = [(n, p, rot.rotate(rot.conjugate(own.get(p, rot.IDENTITY)), bones[n])) for n, p, _ in rows]
    sites = {name: rot.rotate(rot.conjugate(own[name]), np.array(offset)) for name, offset in ends.items()}
    skeleton = skeleton_of(offsets, sites, turn=turn, scale=rig.scale, rename=file_names(rig).get)
    skeleton = _with_channels(skeleton, rig, [name for name, _, _ in rows])
    return Motion(skeleton, rotations, translations[:, skeleton.translated], 1.0 / take.rate)


def _own_axes(rows, rig):
    """Return the axes of each joint in the body's own pose, as quaternions by name."""
    rng = np.random.default_rng(rig.order)
    own = {}
    for name, parent, offset in rows:
        if name.endswith(("Roll", "HipJoint")):
            own[name] = own[parent]
        elif name == "Root" or rig.axes == "world":
            own[name] = rot.IDENTITY
        elif rig.axes == "T-pose":
            side = next(
                (side for side in SIDES if name.startswith((side + "Arm", side + "ForeArm", side + "Hand"))), None
            )
            own[name] = own.get(parent, rot.IDENTITY)
            if side is not None:
                own[name] = rot.about_axis(2, np.array(-SIDES[side] * np.pi / 2))
        else:
            axis = np.eye(3)[int(rig.axes.endswith("y"))]
            bone = next((o for _, p, o in rows if p == name and np.any(o)), offset)
            sign = -1.0 if "mirrored" in rig.axes and name.startswith("Right") else 1.0
            own[name] = _turn_to(sign * axis, np.array(bone, dtype=float))
            if rig.axes == "rolled":
                own[name] = rot.multiply(own[name], rot.about_axis(0, np.array(rng.uniform(-np.pi, np.pi))))
    return own


def _turn_to(axis, bone):
    """Return the shortest turn of an axis into the direction of a bone."""
    length = np.linalg.norm(bone)
    if length == 0.0:
        return rot.IDENTITY
    half = axis + bone / length
    if np.linalg.norm(half) < 1e-9:
        return rot.about_axis(2, np.array(np.pi))
    half /= np.linalg.norm(half)
    return np.array([axis @ half, *np.cross(axis, half)])


def _with_channels(skeleton, rig, names):
    six = [rig.carrier.startswith("six") or name in ("Hips", "Root") or name.startswith("IK_") for name in names]
    channels = tuple(ROOT_CHANNELS if all_six else plain for all_six, plain in zip(six, skeleton.channels, strict=True))
    offsets = skeleton.offsets.copy()
    if rig.carrier == "six zero":
        offsets[:] = 0.0
    elif rig.carrier == "six other":
        offsets += rig.scale * np.random.default_rng(rig.order).normal(size=offsets.shape)
    elif "far" in rig.carrier:
        offsets[names.index("Hips")] = rig.scale * np.array([3.0, -4.0, 5.0])
    return replace(skeleton, channels=channels, offsets=offsets)


@dataclass(frozen=True)
class Found:
    """What was found in a clip: joints by their names in human.py, lengths in metres, plants in seconds."""

    joints: dict
    up: str
    leg: float
    first: int
    heading: float
    plants: tuple
    warnings: tuple
    missing: tuple


def found_in(rig, take, **changes):
    """Return what is found in the file of a take by a rig."""
    clip = parse_clip(new_bytes(motion_of(rig, take, **changes), decimals=9), label="take.bvh")
    facts = facts_of(clip)
    called = {new: old for old, new in file_names(rig).items()}
    names = [called[name] for name in clip.motion.skeleton.names]
    turned = facts.heading_frame().degrees - rig.facing
    return Found(
        joints=_joints(facts.anatomy, names),
        up=axis_name(facts.up),
        leg=facts.anatomy.leg_length / rig.scale,
        first=facts.first,
        heading=(turned + 180.0) % 360.0 - 180.0,
        plants=tuple((p.foot, p.part, p.start / take.rate, p.stop / take.rate) for p in facts.plants),
        warnings=facts.warnings,
        missing=facts.anatomy.missing,
    )


def _joints(anatomy, names):
    def name(joint):
        return None if joint is None else names[joint]

    joints = {part: name(getattr(anatomy, part)) for part in ("head", "pelvis", "chest")}
    for side, leg in zip(("left", "right"), anatomy.legs or (), strict=False):
        joints |= {f"{side} {part}": name(getattr(leg, part)) for part in ("thigh", "knee", "ankle", "toe")}
    for side, arm in zip(("left", "right"), anatomy.arms or (), strict=False):
        joints |= {f"{side} {part}": name(getattr(arm, part)) for part in ("clavicle", "shoulder", "elbow", "wrist")}
    return joints


@lru_cache
def plainly_found(take, rate):
    """Return what is found in a take of `TAKES` by the plain body."""
    return found_in(PLAIN, TAKES[take](rate))
