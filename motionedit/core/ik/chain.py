"""One effector at one frame as a function of the principal coefficients: eq. (9) and (11) of [PC].

Only the joints on the way to the effector are evaluated. Lengths are normalised metres throughout.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Below this angle (rad) the three factors of exp and its Jacobian are taken from their series.
_SMALL_ANGLE = 1e-4

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
    w = R_parent R_ref J_l(v) dv, which moves the effector by w x (p_e - p_j).
    """
    turns, jacobians = _exp_and_left_jacobian(chain.vectors + chain.rows @ unknowns)
    local = chain.references @ turns
    count = len(local)
    parents = np.empty((count, 3, 3))
    origins = np.empty((count, 3))
    R, p = chain.base_rotation, chain.base_position
    travel = chain.travel_rows @ unknowns
    for j in range(count):
        parents[j] = R
        p = p + R.dot(chain.translations[j] + travel if j == 0 else chain.translations[j])
        origins[j] = p
        R = R.dot(local[j])
    end = p + R.dot(chain.offset)
    increments = parents @ chain.references @ jacobians
    levers = ((origins - end) @ _SKEW).reshape(count, 3, 3) @ increments
    rows = chain.rows.reshape(3 * count, -1)
    position_rows = np.swapaxes(levers, 0, 1).reshape(3, -1) @ rows
    position_rows += chain.base_rotation @ chain.travel_rows
    rotation_rows = np.swapaxes(increments, 0, 1).reshape(3, -1) @ rows
    return EffectorState(end, R, position_rows, rotation_rows)


def _exp_and_left_jacobian(v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return exp([v]x) and J_l(v), shapes (c, 3, 3): both are polynomials in the same [v]x."""
    t2 = np.einsum("ij,ij->i", v, v)
    t = np.sqrt(t2)
    small = t < _SMALL_ANGLE
    safe = np.where(small, 1.0, t)
    sine, cosine = np.sin(safe), np.cos(safe)
    a = np.where(small, 1.0 - t2 / 6.0, sine / safe)
    b = np.where(small, 0.5 - t2 / 24.0, (1.0 - cosine) / (safe * safe))
    c = np.where(small, 1.0 / 6.0 - t2 / 120.0, (safe - sine) / (safe * safe * safe))
    V = (v @ _SKEW).reshape(-1, 3, 3)
    V2 = V @ V
    a, b, c = a[:, None, None], b[:, None, None], c[:, None, None]
    return _EYE + a * V + b * V2, _EYE + b * V + c * V2
