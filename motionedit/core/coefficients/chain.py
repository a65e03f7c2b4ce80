"""One effector at one frame as a function of the principal coefficients: eq. (9) and (11) of [PC].

Only the joints on the way to the effector are evaluated. Lengths are normalised metres throughout.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Below this angle (rad) the three factors of exp and its Jacobian are taken from their series.
_SMALL_ANGLE = 1e-4
_SERIES = np.array([[[1.0], [1.0 / 2.0], [1.0 / 6.0]], [[-1.0 / 6.0], [-1.0 / 24.0], [-1.0 / 120.0]]])

# [v]x = (v @ _SKEW).reshape(3, 3)
_SKEW = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ]
)
_EYE = np.eye(3)


@dataclass(frozen=True, eq=False)
class CoefficientChain:
    """The c joints of a chain at one frame; what no coefficient moves has rows of zeros.

    Attributes
    ----------
    base_rotation, base_position : shapes (3, 3), (3,)
        World transform of the frame in which the first joint stands.
    translations : shape (c, 3)
        Of each joint in its parent's frame.
    references : shape (c, 3, 3)
        R_ref of each joint, so that its local rotation is R_ref exp(v); all of it where v stays zero.
    vectors : shape (c, 3)
        v where the unknowns are zero.
    rows : shape (c, 3, m)
        dv / d(unknowns): the slice J(E)_tk of [PC], Figure 1.
    travel_rows : shape (3, m)
        d(translation of the first joint) / d(unknowns).
    offset : shape (3,)
        The effector in the last joint's frame.
    """

    base_rotation: FloatArray
    base_position: FloatArray
    translations: FloatArray
    references: FloatArray
    vectors: FloatArray
    rows: FloatArray
    travel_rows: FloatArray
    offset: FloatArray

    @cached_property
    def base_frame(self) -> FloatArray:
        """The base's transform, shape (4, 4)."""
        frame = np.eye(4)
        frame[:3, :3], frame[:3, 3] = self.base_rotation, self.base_position
        return frame

    @cached_property
    def joint_frames(self) -> FloatArray:
        """The joints' transforms in their parents where none is turned, shape (c, 4, 4)."""
        frames = np.tile(np.eye(4), (len(self.translations), 1, 1))
        frames[:, :3, 3] = self.translations
        return frames

    @cached_property
    def world_travel_rows(self) -> FloatArray:
        """d(position of the first joint) / d(unknowns), shape (3, m), in the world."""
        return self.base_rotation @ self.travel_rows


@dataclass(frozen=True, eq=False)
class EffectorState:
    """Where an effector is, and how it moves with the m unknowns.

    `position` (3,), `rotation` (3, 3), `position_rows` (3, m) and `rotation_rows` (3, m): world-axis increments.
    """

    position: FloatArray
    rotation: FloatArray
    position_rows: FloatArray
    rotation_rows: FloatArray


def evaluate(chain: CoefficientChain, unknowns: FloatArray) -> EffectorState:
    """Return the effector's state at the given unknowns, shape (m,).

    J(alpha) = J(Theta) J(E)_tk, eq. (11): a change dv of a joint's rotation vector is the world-axis increment
    w = R_parent R_ref J_l(v) dv, which moves the effector by w x (p_e - p_j). Since J_l(v) = exp(v) J_l(v)^T, that
    is w = R_j J_l(v)^T dv with the joint's own world rotation R_j.
    """
    turns, jacobians = exp_and_left_jacobian(chain.vectors + chain.rows @ unknowns)
    count = len(turns)
    # Rotation and translation in one product a joint: numpy's calls cost more than its arithmetic here.
    local, world = chain.joint_frames.copy(), np.empty((count + 1, 4, 4))
    local[:, :3, :3] = chain.references @ turns
    local[0, :3, 3] += chain.travel_rows @ unknowns
    world[0] = chain.base_frame
    for parent, own, here in zip(world[:-1], local, world[1:], strict=True):
        np.dot(parent, own, out=here)
    R = world[1:, :3, :3]
    end = world[-1, :3, 3] + R[-1] @ chain.offset
    increments = R @ jacobians.swapaxes(1, 2)
    levers = ((world[1:, :3, 3] - end) @ _SKEW).reshape(count, 3, 3) @ increments
    rows = chain.rows.reshape(3 * count, -1)
    position_rows = levers.swapaxes(0, 1).reshape(3, -1) @ rows
    position_rows += chain.world_travel_rows
    rotation_rows = increments.swapaxes(0, 1).reshape(3, -1) @ rows
    return EffectorState(end, R[-1], position_rows, rotation_rows)


def exp_and_left_jacobian(v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return exp([v]x) and J_l(v), shapes (c, 3, 3): both are polynomials in the same [v]x."""
    t2 = np.einsum("ij,ij->i", v, v)
    small = t2 < _SMALL_ANGLE * _SMALL_ANGLE
    some = small.any()
    safe = np.where(small, 1.0, t2) if some else t2
    t = np.sqrt(safe)
    factors = np.empty((3, len(v), 1, 1))
    a, b, c = flat = factors[:, :, 0, 0]
    np.divide(np.sin(t), t, out=a)
    np.divide(1.0 - np.cos(t), safe, out=b)
    np.divide(1.0 - a, safe, out=c)
    if some:
        flat[:, small] = _SERIES[0] + _SERIES[1] * t2[small]
    a, b, c = factors
    V = (v @ _SKEW).reshape(-1, 3, 3)
    V2 = V @ V
    return _EYE + a * V + b * V2, _EYE + b * V + c * V2
