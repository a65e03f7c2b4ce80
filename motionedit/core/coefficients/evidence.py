"""How much of a change leaves the components: what goals at several frames say of it by themselves.

What they ask for at once, e = J_c z_c + J_r z_r with z ~ N(0, s^2), has the covariance s^2 ((1 - g) A + g B), A and B
being what components and residual make of unit variance. The g under which e is the likeliest, whatever its size s, is
high where the components would have to be stretched to go from one goal to the next.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# One standard deviation of g about what the database says, as a factor of its odds g / (1 - g): e^2.
_CAUTION = 2.0
_SHARES = 65  # that are tried
# Metres at leg length 0.85 m: goals that are so near say nothing; and what B has on its diagonal, over its mean.
_NOTHING, _LEAST = 1e-9, 1e-9


def likeliest_share(error: FloatArray, jacobian: FloatArray, *, components: int, share: float, most: float) -> float:
    """Return g, from `share` to `most`.

    Parameters
    ----------
    error : shape (p,)
        e, what goals ask for.
    jacobian : shape (p, m + n)
        d(what they see) / dy under a prior with `share`, its first m columns of the components.
    components : int
        m.
    share : float
        g as the database has it, more than 0 and less than 1.
    most : float
        The largest g.
    """
    A = _square(jacobian[:, :components]) / (1.0 - share)
    B = _square(jacobian[:, components:]) / share
    size = float(np.trace(B)) / len(B)
    if most <= share or size == 0.0 or float(np.linalg.norm(error)) < _NOTHING:
        return share
    L = np.linalg.cholesky(B + _LEAST * size * np.eye(len(B)))
    half = np.linalg.solve(L, A)
    values, vectors = np.linalg.eigh(np.linalg.solve(L, half.T))
    asked = (vectors.T @ np.linalg.solve(L, error)) ** 2
    g = np.linspace(share, most, _SHARES)
    variances = (1.0 - g[:, None]) * np.maximum(values, 0.0) + g[:, None]
    unlikely = 0.5 * len(error) * np.log((asked / variances).sum(axis=1)) + 0.5 * np.log(variances).sum(axis=1)
    odds = np.log(g / (1.0 - g)) - np.log(share / (1.0 - share))
    return float(g[np.argmin(unlikely + 0.5 * (odds / _CAUTION) ** 2)])


def _square(rows: FloatArray) -> FloatArray:
    squares: FloatArray = rows @ rows.T
    return squares
