"""The motion PCA model: a timeline, a pose space, and the principal components of one behaviour's motions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.pca.coordinates import PoseSpace
    from motionedit.core.pca.fit import PrincipalComponents
    from motionedit.core.skeleton import Skeleton
    from motionedit.core.timeline.warp import Timeline


@dataclass(frozen=True)
class DatabaseClip:
    """One motion of the database: its name, its file's SHA-256, and its events' frames in the source."""

    name: str
    digest: str
    events: tuple[tuple[str, float], ...]


@dataclass(frozen=True, eq=False)
class MotionModel:
    """All that an edit needs to know of a behaviour.

    Attributes
    ----------
    skeleton : Skeleton
        The database's.
    space : PoseSpace
        What the columns of a pose mean.
    timeline : Timeline
        F frames, their rate, the events' places.
    travel : int
        The joint that carries the travel.
    up : shape (3,)
        Signed unit axis.
    components : PrincipalComponents
        Of motion vectors of D = n F values, a frame's n values together.
    clips : tuple of DatabaseClip
        In the order of `components.coefficients`.
    rules : dict
        How the database was normalized (JSON values): alignment, rest pose, events.
    """

    skeleton: Skeleton
    space: PoseSpace
    timeline: Timeline
    travel: int
    up: FloatArray
    components: PrincipalComponents
    clips: tuple[DatabaseClip, ...]
    rules: dict[str, Any]

    def __repr__(self) -> str:
        # Not its arrays, which would fill a screen.
        count, timeline = len(self.components.explained_variance), self.timeline
        size = f"{timeline.frames} frames, {timeline.frame_rate:.4g} Hz"
        return f"<MotionModel: {count} components of {len(self.clips)} clips, {size}>"

    @property
    def mean_rows(self) -> FloatArray:
        """The mean motion, shape (F, n)."""
        return self.components.mean.reshape(self.timeline.frames, self.space.size)

    @property
    def component_rows(self) -> FloatArray:
        """The components frame by frame, shape (m, F, n)."""
        return self.components.components.reshape(-1, self.timeline.frames, self.space.size)

    def mahalanobis(self, coefficients: FloatArray) -> FloatArray:
        """Return |alpha / sqrt(lambda)| of coefficient rows, shape (...), over the components that there are."""
        deviation = np.sqrt(self.components.explained_variance)
        norm: FloatArray = np.linalg.norm(coefficients / deviation, axis=-1)
        return norm

    def truncated(self, count: int) -> MotionModel:
        """Return the model with its first `count` components alone."""
        full = self.components
        cut = replace(
            full,
            components=full.components[:count],
            explained_variance=full.explained_variance[:count],
            coefficients=frozen(full.coefficients[:, :count].copy()),
        )
        return replace(self, components=cut)
