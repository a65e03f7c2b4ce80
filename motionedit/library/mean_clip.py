"""The mean motion of a model as a clip: a database's other face, to look at and to edit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.bvh import new_bytes, parse_clip
from motionedit.core.coefficients.projection import Projection, with_rows
from motionedit.core.motion import Motion
from motionedit.core.timeline.alignment import NO_ALIGNMENT

if TYPE_CHECKING:
    from motionedit.core.bvh import Clip
    from motionedit.core.pca.model import MotionModel

# Far below what any capture resolves: the clip is computed with, not only looked at.
_DECIMALS = 9


def mean_clip(model: MotionModel) -> Clip:
    """Return the mean motion, alpha = 0 in eq. (3), on the model's timeline; joints out of the model do not turn."""
    skeleton, timeline = model.skeleton, model.timeline
    rotations = np.tile(rot.IDENTITY, (timeline.frames, len(skeleton), 1))
    translations = np.tile(skeleton.offsets[skeleton.translated], (timeline.frames, 1, 1))
    still = Motion(skeleton, frozen(rotations), frozen(translations), 1.0 / timeline.frame_rate)
    mean = model.mean_rows
    projection = Projection(
        motion=still,
        travel=model.travel,
        joints=model.space.joints,
        alignment=NO_ALIGNMENT,
        places=np.arange(timeline.frames, dtype=np.float64),
        rows=mean,
        coefficients=np.zeros(len(model.components.explained_variance)),
        deviation=np.zeros_like(mean),
        residual=0.0,
        seconds=(timeline.frames - 1) / timeline.frame_rate,
    )
    return parse_clip(new_bytes(with_rows(projection, model.space, mean), decimals=_DECIMALS), label="mean.bvh")
