"""The clip itself as one more motion of the database: the way in which it differs from them is one more way to differ.

    C' = (1 - 1/M) C + d d^T / (M + 1)        d: how the clip differs from the mean of the M motions

is the covariance of all M + 1. Of all directions d is the one that a change to another motion is sure to have to do
with, and most of it lies outside of the others' components. But what a clip differs by all along may be its own, as
its stance is: what that is beyond how much the database's motions differ all along is no part of d. Its mean over
time m, a joint at a time, counts by min(1, (1 + 1/M) s^2 / |m|^2), s^2 the variance of such means: James and Stein's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.coefficients.prior import EACH
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.pca.model import MotionModel


def with_one_more(model: MotionModel, deviation: FloatArray) -> MotionModel:
    """Return the model with a clip's own difference as one more component, the last, which is as long as it is.

    Parameters
    ----------
    deviation : shape (F, n)
        The clip on the timeline, less the mean motion.
    """
    known, count = model.components, len(model.clips)
    own = deviation - _own_all_along(model, deviation)
    rows = np.concatenate((known.components, own.reshape(1, -1)))
    variance = np.append((1.0 - 1.0 / count) * known.explained_variance, 1.0 / (count + 1))
    return replace(model, components=replace(known, components=frozen(rows), explained_variance=frozen(variance)))


def change_of_alpha(change: FloatArray, known: MotionModel, joined: MotionModel) -> FloatArray:
    """Return what a change in a model with one more does to the coefficients alpha of the model, shape (m,).

    Parameters
    ----------
    change : shape (m,) or (m + 1,)
        Of the coefficients of `joined`, which may be the model itself.
    """
    count = len(known.components.explained_variance)
    more = change[count:] @ joined.components.components[count:]
    alpha: FloatArray = change[:count] + known.components.components @ more
    return alpha


def _own_all_along(model: MotionModel, deviation: FloatArray) -> FloatArray:
    """Return the part of a clip's mean difference, shape (n,), that the database's motions do not account for."""
    means = model.component_rows.mean(axis=1)
    usual = (model.components.explained_variance @ means**2).reshape(-1, EACH).sum(axis=1)
    usual *= 1.0 + 1.0 / len(model.clips)
    mean = deviation.mean(axis=0).reshape(-1, EACH)
    squares = (mean * mean).sum(axis=1)
    own = 1.0 - usual / np.maximum(np.maximum(squares, usual), np.finfo(np.float64).tiny)
    all_along: FloatArray = (own[:, None] * mean).ravel()
    return all_along
