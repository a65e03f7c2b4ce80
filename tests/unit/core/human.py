"""A made-up human of 23 joints for the tests of anatomy, ground, contacts and quality; lengths in metres, y up."""

from dataclasses import replace

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.skeleton import EndSite, Skeleton

ROOT_CHANNELS = ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation")
CHANNELS = ("Zrotation", "Xrotation", "Yrotation")
ANKLE_HEIGHT = 0.08
THIGH, SHANK = 0.42, 0.43

# name, parent, offset; legs straight down, arms straight down as well, toes forward (z); left is +x.
BONES = [
    ("Hips", None, (0.0, 0.0, 0.0)),
    ("LHipJoint", "Hips", (0.0, 0.0, 0.0)),
    ("LeftUpLeg", "LHipJoint", (0.1, -0.05, 0.0)),
    ("LeftLeg", "LeftUpLeg", (0.0, -THIGH, 0.0)),
    ("LeftFoot", "LeftLeg", (0.0, -SHANK, 0.0)),
    ("LeftToeBase", "LeftFoot", (0.0, -0.06, 0.13)),
    ("RHipJoint", "Hips", (0.0, 0.0, 0.0)),
    ("RightUpLeg", "RHipJoint", (-0.1, -0.05, 0.0)),
    ("RightLeg", "RightUpLeg", (0.0, -THIGH, 0.0)),
    ("RightFoot", "RightLeg", (0.0, -SHANK, 0.0)),
    ("RightToeBase", "RightFoot", (0.0, -0.06, 0.13)),
    ("Spine", "Hips", (0.0, 0.1, 0.0)),
    ("Spine1", "Spine", (0.0, 0.2, 0.0)),
    ("Neck", "Spine1", (0.0, 0.2, 0.0)),
    ("Head", "Neck", (0.0, 0.1, 0.02)),
    ("LeftShoulder", "Spine1", (0.05, 0.15, 0.0)),
    ("LeftArm", "LeftShoulder", (0.12, 0.0, 0.0)),
    ("LeftForeArm", "LeftArm", (0.0, -0.29, 0.0)),
    ("LeftHand", "LeftForeArm", (0.0, -0.25, 0.0)),
    ("RightShoulder", "Spine1", (-0.05, 0.15, 0.0)),
    ("RightArm", "RightShoulder", (-0.12, 0.0, 0.0)),
    ("RightForeArm", "RightArm", (0.0, -0.29, 0.0)),
    ("RightHand", "RightForeArm", (0.0, -0.25, 0.0)),
]
ENDS = {
    "LeftToeBase": (0.0, 0.0, 0.06),
    "RightToeBase": (0.0, 0.0, 0.06),
    "Head": (0.0, 0.18, 0.0),
    "LeftHand": (0.0, -0.15, 0.0),
    "RightHand": (0.0, -0.15, 0.0),
}
HIPS_HEIGHT = 0.05 + THIGH + SHANK + ANKLE_HEIGHT


def skeleton_of(bones=BONES, ends=None, *, turn=None, scale=1.0, rename=str):
    """Return the skeleton of (name, parent, offset) rows, its OFFSETs turned by a matrix and scaled."""
    turn = np.eye(3) if turn is None else np.asarray(turn, dtype=float)
    ends = ENDS if ends is None else ends
    order = [name for name, _, _ in bones]
    return Skeleton(
        names=tuple(rename(name) for name in order),
        parents=np.array([-1 if parent is None else order.index(parent) for _, parent, _ in bones]),
        offsets=scale * np.array([offset for _, _, offset in bones], dtype=float) @ turn.T,
        channels=tuple(ROOT_CHANNELS if parent is None else CHANNELS for _, parent, _ in bones),
        end_sites=tuple(
            EndSite(order.index(name), scale * turn @ np.array(offset))
            for name, offset in ends.items()
            if name in order
        ),
    )


def standing(skeleton, frames=20, *, frame_time=0.01, at=(0.0, HIPS_HEIGHT, 0.0)):
    """Return a motion that stands still, every rotation zero."""
    rotations = np.tile(rot.IDENTITY, (frames, len(skeleton), 1))
    translations = np.zeros((frames, len(skeleton.translated), 3))
    translations[:] = at
    return Motion(skeleton, rotations, translations, frame_time)


def with_rotation(motion, joint, frames, vector):
    """Return the motion with one joint turned by a rotation vector (rad) in some frames."""
    rotations = motion.rotations.copy()
    rotations[frames, motion.skeleton.names.index(joint)] = rot.exp(np.asarray(vector, dtype=float))
    return Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)


def with_axes(motion, turns):
    """Return the same motion of a body without end sites whose joints have other axes: frames turned by (J, 4)."""
    parents = motion.skeleton.parents
    above_it = np.concatenate((rot.IDENTITY[None], turns[parents[1:]]))
    skeleton = replace(motion.skeleton, offsets=rot.unrotate(above_it, motion.skeleton.offsets))
    rotations = rot.multiply(rot.multiply(rot.conjugate(above_it), motion.rotations), turns)
    return Motion(skeleton, rotations, motion.translations, motion.frame_time)


def above(bones, name, *, offset=(0.0, 0.0, 0.0)):
    """Return the rows with a new root above the old one."""
    return [(name, None, offset), *((n, name if p is None else p, o) for n, p, o in bones)]


def split(bones, name, middle, share):
    """Return the rows with a twist joint put into the bone that ends at `name`, at a share of its length."""
    rows = []
    for n, parent, offset in bones:
        if n == name:
            part = tuple(share * x for x in offset)
            rows.append((middle, parent, part))
            rows.append((n, middle, tuple(x - y for x, y in zip(offset, part, strict=True))))
        else:
            rows.append((n, parent, offset))
    return rows


def names_of(skeleton, joints):
    return [None if j is None else skeleton.names[j] for j in joints]


def legs_of(skeleton, anatomy):
    return [names_of(skeleton, (leg.thigh, leg.knee, leg.ankle, leg.toe)) for leg in anatomy.legs]


def arms_of(skeleton, anatomy):
    return [names_of(skeleton, (arm.clavicle, arm.shoulder, arm.elbow, arm.wrist)) for arm in anatomy.arms]


LEGS = [[side + part for part in ("UpLeg", "Leg", "Foot", "ToeBase")] for side in ("Left", "Right")]
ARMS = [[side + part for part in ("Shoulder", "Arm", "ForeArm", "Hand")] for side in ("Left", "Right")]


def assert_human(skeleton, anatomy):
    assert legs_of(skeleton, anatomy) == LEGS
    assert arms_of(skeleton, anatomy) == ARMS
    assert skeleton.names[anatomy.head] == "Head"
    assert skeleton.names[anatomy.pelvis] == "Hips"
    assert skeleton.names[anatomy.chest] == "Spine1"
    assert anatomy.warnings == ()
