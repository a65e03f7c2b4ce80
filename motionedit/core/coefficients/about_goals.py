"""Components as a prior of changes about goals: laid over each other where the body is there, weaker far from them.

    E'_i(s) = w(s) (E_i(s) - G(s) x_i),   w(s) = c + (1 - c) (1 - product over goals t of (1 - exp(-(s - t)^2 / 2 T^2)))

G x moves a motion as a whole on the ground. Where a clip stands is not what makes a motion: the database was laid over
itself at one instant of its own, such as the first frame, and what its clips differ by in place and heading at another
one says where they went meanwhile, not how they reach. x_i takes that out at the goals. And of a few motions the
correlation of poses far apart in time is mostly chance: c is how much of it is believed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.coefficients.chain import exp_and_left_jacobian
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.pca.model import MotionModel

# Seconds, T: a movement is one about as long; edits hardly differ from 0.3 to 0.8.
_TOGETHER = 0.3
# Columns of Theta, the first: the travel's three, and the rotation vector of its joint.
_ROOT = 6


def components_about(
    model: MotionModel, places: FloatArray, *, believed: float, heading: bool, position: bool
) -> MotionModel:
    """Return the model with its components as they count about goals; they are no longer orthonormal.

    Parameters
    ----------
    places : shape (K,)
        The goals' places on the timeline.
    believed : float
        c, 0 to 1.
    heading, position : bool
        What of the clips' place on the ground to take out at the goals.
    """
    frames = np.arange(model.timeline.frames, dtype=np.float64)
    apart = (frames[:, None] - places) / model.timeline.frame_rate
    near = 1.0 - np.prod(-np.expm1(-0.5 * (apart / _TOGETHER) ** 2), axis=1)
    weights = believed + (1.0 - believed) * near
    E = model.component_rows * weights[:, None]
    if heading or position:
        at = model.timeline.frames_at(places)
        E[:, :, :_ROOT] = _laid_over(model, at, heading=heading, position=position) * weights[:, None]
    rows = frozen(E.reshape(len(E), -1))
    return replace(model, components=replace(model.components, components=rows))


def _laid_over(model: MotionModel, at: IntArray, *, heading: bool, position: bool) -> FloatArray:
    """Return components that on the mean of some frames neither turn nor move the body on the ground, shape (m, F, 6).

    They differ in what they do to the travel and to the rotation of its joint, which have the first columns. A turn by
    the angle x about up moves the travel by x up x (p - p_goal), and turns its joint by the world-axis increment x up;
    a change dv of its rotation vector is the increment R_ref J_l(v) dv.
    """
    up, mean = model.up, model.mean_rows
    E = model.component_rows[:, :, :_ROOT].copy()
    if heading:
        reference = rot.to_matrix(model.space.references[0])
        increments = reference @ exp_and_left_jacobian(mean[:, 3:6])[1]
        angles = np.einsum("i,fij,mfj->m", up, increments[at], E[:, at, 3:6]) / len(at)
        p = mean[:, :3]
        about = p - p[at].mean(axis=0)
        E[:, :, :3] -= angles[:, None, None] * np.cross(up, about)
        E[:, :, 3:6] -= angles[:, None, None] * np.linalg.solve(increments, up[:, None])[..., 0]
    if position:
        moves = E[:, at, :3].mean(axis=1)
        E[:, :, :3] -= (moves - np.outer(moves @ up, up))[:, None]
    return E
