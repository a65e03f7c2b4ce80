"""What a job reads off a clip before it works on it: up, travel, rest pose, heading, scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from motionedit.core import ground, kinematics
from motionedit.core.anatomy import Anatomy, find_anatomy

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

    def heading_frame(self, frame: int | None = None) -> ground.Frame:
        """Return the heading frame at a frame; by default the first after the rest pose."""
        return ground.heading_frame(
            self.clip.motion,
            self.poses,
            self.anatomy,
            up=self.up,
            frame=self.first if frame is None else frame,
            travel=self.travel,
        )


def facts_of(clip: Clip, *, up: str = "auto", keep_rest_pose: bool = False) -> ClipFacts:
    """Return a clip's facts; `up` other than ``auto`` is taken as given, with the sign that the body shows."""
    motion = clip.motion
    poses = kinematics.forward(motion)
    anatomy = find_anatomy(motion.skeleton, poses=poses)
    axis = ground.find_up(motion, poses, anatomy)
    if up != "auto" and ground.axis_name(axis).lstrip("-") != up:
        axis = ground.axis_vector(up)
    first = 0 if keep_rest_pose else ground.rest_pose_frames(motion, anatomy)
    return ClipFacts(clip, poses, anatomy, axis, ground.travel_joint(motion), min(first, len(motion) - 1))
