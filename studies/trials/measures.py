"""What a stranger sees of an edit: jerk, joints that pop, necks and ankles beyond their range, knees bent back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from studies.trials.bodies import SIDES
from studies.trials.kinematics import angle

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import FloatArray
    from studies.trials.bodies import Body
    from studies.trials.kinematics import Take

# Degrees in a sixtieth of a second from which the step of a joint's change is a pop.
POP = 10.0
# Degrees beyond its own range from which a part looks broken: neck and spine, clavicles and ankles.
TRUNK, LIMB = 60.0, 45.0
# Degrees by which a knee or an elbow may be bent back beyond what the input does.
BACK = 5.0


@dataclass(frozen=True)
class Measured:
    """What is measured of an edited clip against its input.

    Attributes
    ----------
    jerk : float
        Root mean square third difference of all joints, over the input's.
    pop : float
        The largest step of a joint's change that is a pop, degrees in a sixtieth of a second; 0: none.
    where : str
        ``LeftArm@61``: the joint that pops, and the frame.
    neck, back : float
        How far the neck is beyond its range, a knee or an elbow bent back, degrees.
    broken : tuple of str
        The parts that look broken.
    """

    jerk: float
    pop: float
    where: str
    neck: float
    back: float
    broken: tuple[str, ...]

    @property
    def is_seen(self) -> bool:
        """Whether a viewer would see the edit."""
        return self.pop > 0.0 or self.jerk > 2.0 or bool(self.broken)


def measured(body: Body, edited: Take) -> Measured:
    """Return what is measured of an edited clip."""
    pop, where = _pop(body, edited)
    beyond = {part: (_beyond(body, edited, lower, upper), most) for part, lower, upper, most in _parts()}
    back = max(_bent_back(body, edited), 0.0)
    broken = [part for part, (degrees, most) in beyond.items() if degrees > most]
    return Measured(
        jerk=_jerk(edited, body.first) / _jerk(body.take, body.first),
        pop=pop,
        where=where,
        neck=beyond["neck"][0],
        back=back,
        broken=(*broken, *(("bent back",) if back > BACK else ())),
    )


def _jerk(take: Take, first: int) -> float:
    return float(np.sqrt(np.mean(np.sum(np.diff(take.positions[first:], 3, axis=0) ** 2, axis=-1))))


def _steps(turns: FloatArray, frame_time: float) -> FloatArray:
    """Return the steps of rotations (F, J, 3, 3) from frame to frame, degrees in a sixtieth of a second."""
    return angle(np.swapaxes(turns[:-1], -1, -2) @ turns[1:]) / (60.0 * frame_time)


def _pop(body: Body, edited: Take) -> tuple[float, str]:
    before, after = body.take.local[body.first :], edited.local[body.first :]
    own = _steps(before, body.take.frame_time).max(axis=0)
    steps = _steps(np.swapaxes(before, -1, -2) @ after, body.take.frame_time)
    pops = np.where(steps > np.maximum(POP, own), steps, 0.0)
    frame, joint = np.unravel_index(int(np.argmax(pops)), pops.shape)
    if pops[frame, joint] == 0.0:
        return 0.0, ""
    return float(pops[frame, joint]), f"{body.take.names[joint]}@{frame + body.first + 1}"


def _parts() -> Iterator[tuple[str, str, str, float]]:
    """Yield what can look broken: its name, the part, what it is measured against, and how far it may go."""
    yield "neck", "head", "chest", TRUNK
    yield "spine", "chest", "hips", TRUNK
    for side in SIDES:
        yield f"clavicle {side}", f"clavicle {side}", "chest", LIMB
        yield f"ankle {side}", f"ankle {side}", f"knee {side}", LIMB


def _beyond(body: Body, edited: Take, lower: str, upper: str) -> float:
    """Return how much further than in the input a part is turned from its mean in the input, at most."""

    def relative(take: Take) -> FloatArray:
        R = take.rotations[body.first :]
        turn: FloatArray = np.swapaxes(R[:, body.joint(upper)], -1, -2) @ R[:, body.joint(lower)]
        return turn

    own, taken = relative(body.take), relative(edited)
    # The rotation that is nearest to all of them.
    U, _, V = np.linalg.svd(own.mean(axis=0))
    mean = U @ V
    return float(angle(mean.T @ taken).max() - angle(mean.T @ own).max())


def _bent_back(body: Body, edited: Take) -> float:
    limbs = [("thigh", "knee", "ankle"), ("shoulder", "elbow", "wrist")]
    most = 0.0
    for side in SIDES:
        for top, joint, end in limbs:
            joints = [body.joint(f"{part} {side}") for part in (top, joint, end)]
            axis = _bends(body.take, joints)[1].sum(axis=0)
            own, taken = (np.copysign(*_signs(take, joints, axis)).min() for take in (body.take, edited))
            most = max(most, float(min(0.0, own) - taken))
    return most


def _signs(take: Take, joints: list[int], axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angles by which a limb is bent, and numbers that are negative where it is bent back."""
    bend, sides = _bends(take, joints)
    return bend, sides @ axis


def _bends(take: Take, joints: list[int]) -> tuple[FloatArray, FloatArray]:
    """Return by how many degrees a limb is bent, shape (F,), and about what, in its upper bone's frame, (F, 3)."""
    top, joint, end = joints
    upper, lower = (take.positions[:, b] - take.positions[:, a] for a, b in ((top, joint), (joint, end)))
    upper, lower = (bone / np.linalg.norm(bone, axis=1, keepdims=True) for bone in (upper, lower))
    side = np.cross(upper, lower)
    bend = np.degrees(np.arctan2(np.linalg.norm(side, axis=1), np.sum(upper * lower, axis=1)))
    return bend, np.einsum("fba,fb->fa", take.rotations[:, top], side)
