"""The clips of [PRIO]'s demonstrations, what is read off them, and the bodies with their balance drawn."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.body.contacts import sole_tracks
from motionedit.core.body.quality import foot_drift
from motionedit.core.bvh import read_clip
from motionedit.core.units import STANDARD_LEG
from motionedit.jobs.clip.facts import facts_of
from studies.paper.drawing import GREY, INK, body, hull, outside

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.core.arrays import FloatArray
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.report.preview.body import Body
    from studies.paper.drawing import Stage


_LOW = 0.07  # leg lengths over its lowest at which a point of a foot stands, as contacts are found


@dataclass(frozen=True)
class Shown:
    """A clip to measure and to draw."""

    path: Path

    @cached_property
    def facts(self) -> ClipFacts:
        """What a job reads off it."""
        return facts_of(read_clip(self.path))

    @cached_property
    def body(self) -> Body:
        """What is drawn of it."""
        return body(self.path)

    @cached_property
    def com(self) -> FloatArray:
        """The center of mass, shape (F, 3)."""
        facts = self.facts
        return center_of_mass(
            facts.poses, find_masses(facts.bones, facts.anatomy, rotations=facts.clip.motion.rotations[facts.first :])
        )

    @cached_property
    def feet(self) -> FloatArray:
        """Ankles and toes, the points A, shape (F, K, 3)."""
        joints = [joint for _, joint in self.facts.anatomy.foot_points]
        return self.facts.poses.positions[:, joints]

    @property
    def barycenter(self) -> FloatArray:
        """The mean of A, shape (F, 3)."""
        mean: FloatArray = self.feet.mean(axis=1)
        return mean

    @property
    def centimetres(self) -> float:
        """Centimetres per clip unit, for a leg as long as all bodies are scaled to."""
        return 1e2 * STANDARD_LEG / self.size

    @property
    def size(self) -> float:
        """Leg length."""
        return self.facts.anatomy.leg_length

    def point(self, name: str) -> FloatArray:
        """Return the path of a joint, shape (F, 3)."""
        return self.facts.poses.positions[:, self.facts.clip.motion.skeleton.names.index(name)]

    def drift_of(self, edited: Shown) -> float:
        """Return how far an edit moves what stands in this clip, at most, clip units."""
        before, after = (sole_tracks(shown.facts.poses, self.facts.anatomy) for shown in (self, edited))
        return foot_drift(before, after, self.facts.plants)

    def support(self, frame: int) -> FloatArray:
        """Return the outline on the ground of what stands at a frame: points of the feet as low as they ever are."""
        heights = self.feet[:, :, 1]
        low = self.feet[frame][heights[frame] < np.percentile(heights, 2.0, axis=0) + _LOW * self.size]
        # A foot is some centimetres wide on both sides of its joints, and goes on before the toes.
        around = 0.05 * self.size * np.array([[1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
        return hull((low[:, None] + around).reshape(-1, 3))

    def lost_balance(self, frame: int) -> float:
        """Return how far the CoM's ground point is outside the support, clip units; 0: it stands."""
        return outside(self.com[frame], self.support(frame))


def stand_over(
    source: Shown, stage: Stage, clip: Shown, frame: int, color: str, *, anchor: FloatArray, at: float
) -> None:
    """Draw a pose with its support on the ground and its center of mass plumbed to it, over the source's in grey."""
    size = clip.size
    if clip is not source:
        stage.pose(source.body, frame, GREY, anchor=anchor, at=at, alpha=0.3)
    stage.floor(anchor, at, half=(0.9 * size, 0.9 * size), step=0.3 * size)
    stage.area(clip.support(frame), GREY, anchor=anchor, at=at)
    stage.pose(clip.body, frame, color, anchor=anchor, at=at)
    com = clip.com[frame]
    ground = com * np.array([1.0, 0.0, 1.0])
    stage.path(np.stack((com, ground)), INK, anchor=anchor, at=at, width=0.9)
    stage.mark(com, "o", "#ffd34d", anchor=anchor, at=at, size=6.0)
    stage.mark(ground, "o", INK, anchor=anchor, at=at, size=3.0)
