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
# Of a clip's square from the mean: what is nearer is made of the others, and says nothing of how far clips lie apart.
_ROUNDING = 1e-10
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
    pca = model.components
    if pca.left_out is None:
        return 0.0
    # Of its own clips, too, it leaves what components that are not used would explain: all clips of many that are
    # nearly alike lie much farther from those in use than from each other.
    squares = pca.left_out.squares
    furthest = float(np.maximum(pca.left_out.residuals, squares - (pca.coefficients**2).sum(axis=1)).max())
    # And of a clip as much as of the mean of its own is not held against it.
    unused = max(pca.total_variance - float(pca.explained_variance.sum()), 0.0)
    if not furthest > _ROUNDING * float(squares.max()):
        return 0.0
    return float(np.sqrt(max(projection.residual - unused, 0.0) / furthest))
