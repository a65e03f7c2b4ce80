"""Whether a model knows a clip's behaviour at all: how far the clip is from the database, and how long it lasts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.pca.model import MotionModel

# Times the furthest clip of the database, each seen from the others: beyond the first it is worth a word, beyond the
# second the clip is of another kind. Real strokes of one kind lie at 0.4 to 1.1.
_ODD, _OTHER = 1.25, 1.6
# Times as fast or slow as the database, the mean over the clip.
_SQUEEZED = 2.5


def unexplained(projection: Projection, model: MotionModel, *, seconds: float) -> tuple[list[str], list[str]]:
    """Return lines to warn of, and lines for which an edit is no better than rough.

    Parameters
    ----------
    seconds : float
        How long the clip lasts.
    """
    odd, other = [], []
    usual = (model.timeline.frames - 1) / model.timeline.frame_rate
    if not 1.0 / _SQUEEZED <= seconds / usual <= _SQUEEZED:
        other.append(f"the clip lasts {seconds:.3g} s, the database's {usual:.3g} s: is it one of them?")
    times = _times_the_furthest(projection, model)
    line = (
        f"the model does not explain this clip: it lies {times:.3g} times as far from the database as the furthest of "
        "its own clips from the others"
    )
    if times > _OTHER:
        other.append(line)
    elif times > _ODD:
        odd.append(line)
    return odd, other


def _times_the_furthest(projection: Projection, model: MotionModel) -> float:
    left_out = model.components.left_out
    if left_out is None or not left_out.residuals.max() > 0.0:
        return 0.0
    # What components that are not used would explain is not held against the clip.
    variance = model.components.explained_variance
    unused = max(model.components.total_variance - float(variance.sum()), 0.0)
    return float(np.sqrt(max(projection.residual - unused, 0.0) / left_out.residuals.max()))
