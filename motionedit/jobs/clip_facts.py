"""What a job reads off a clip before it works on it: up, travel, rest pose, heading, scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import ground, kinematics
from motionedit.core.anatomy import Anatomy, find_anatomy
from motionedit.core.timeline.alignment import Alignment, align_to
from motionedit.core.timeline.resample import resample

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.bvh import Clip
    from motionedit.core.kinematics import WorldPoses


@dataclass(frozen=True, eq=False)
class ClipFacts:
    """A clip and what was found in it.

    `poses` are the world transforms of all frames, `up` the signed unit axis (3,), `travel` the joint that carries
    the travel, `first` the first frame after a rest pose.
    """

    clip: Clip
    poses: WorldPoses
    anatomy: Anatomy
    up: FloatArray
    travel: int
    first: int

    @property
    def last(self) -> int:
        """The last frame."""
        return len(self.clip.motion) - 1

    def heading_frame(self, at: float | None = None) -> ground.Frame:
        """Return the heading frame at a frame or a part of one; by default the first after the rest pose."""
        motion, poses, frame = self.clip.motion, self.poses, self.first
        if at is not None:
            motion = resample(motion, np.array([at]), frame_time=motion.frame_time)
            poses, frame = kinematics.forward(motion), 0
        return ground.heading_frame(poses, self.anatomy, up=self.up, frame=frame, travel=self.travel)

    def alignment(self, *, heading: bool, position: bool, at: float | None) -> Alignment:
        """Return the alignment of a clip on the ground, by its heading frame at a frame (None: the first)."""
        return align_to(self.heading_frame(at), heading=heading, position=position)


def facts_of(clip: Clip, *, up: str = "auto", keep_rest_pose: bool = False) -> ClipFacts:
    """Return a clip's facts; `up` is ``auto`` or an axis' name such as ``y`` or ``-z``, which is taken as given."""
    motion = clip.motion
    poses = kinematics.forward(motion)
    anatomy = find_anatomy(motion.skeleton, poses=poses)
    axis = ground.find_up(motion, poses, anatomy) if up == "auto" else ground.axis_vector(up)
    first = 0 if keep_rest_pose else ground.rest_pose_frames(motion, anatomy)
    return ClipFacts(clip, poses, anatomy, axis, ground.travel_joint(motion), min(first, len(motion) - 1))
