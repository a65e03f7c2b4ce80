"""What a job reads off a clip before it works on it: up, travel, rest pose, heading, scale."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import kinematics
from motionedit.core.arrays import frozen
from motionedit.core.blocks import BLOCK_FRAMES, blocks_of, frame_blocks
from motionedit.core.body import ground
from motionedit.core.body.anatomy import NOTHING_GIVEN, Anatomy, GivenBody
from motionedit.core.body.bends import find_bends
from motionedit.core.body.bones import find_bones, travel_joint
from motionedit.core.body.contacts import planted, plants_of, sole_tracks, stands_of
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.mirrored import as_it_points
from motionedit.core.body.rest_pose import rest_pose_frames
from motionedit.core.body.steps import own_steps
from motionedit.core.body.still import as_it_turns
from motionedit.core.body.up import find_up
from motionedit.dataclass import dataclass
from motionedit.errors import ClipError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.bends import Bend
    from motionedit.core.body.contacts import Plant, Stand
    from motionedit.core.body.steps import Steps
    from motionedit.core.bvh import Clip
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton
    from motionedit.core.timeline.alignment import Alignment


Line = Literal["hips", "feet"]

# Cosine of the angle between the feet's line and the hips' up to which feet stand side by side: 35 degrees.
SIDE_BY_SIDE = 0.82
# Seconds on both sides of a frame that decide whether a foot stands there.
_AROUND = 2.0
_HEAPED = (
    "position channels put most joints onto their parents, as if they were shifts from OFFSET; by the format they "
    "replace it, and so all lie in a heap"
)


class Poses:
    """World transforms of a motion: made when they are first asked for, and anew after they were forgotten."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._made: WorldPoses | None = None

    def get(self) -> WorldPoses:
        """Return the world transforms of all frames."""
        if self._made is None:
            self._made = kinematics.forward(self._motion)
        return self._made

    def gathered(self, read: Callable[[WorldPoses], Sequence[FloatArray]]) -> list[FloatArray]:
        """Return arrays that are read off the world transforms frame by frame, shapes (F, ...).

        Block by block where the transforms of a long motion are not held; they are not afterwards, either.
        """
        if self._made is not None or len(self._motion) <= BLOCK_FRAMES:
            return list(read(self.get()))
        whole: list[FloatArray] = []
        for block in frame_blocks(len(self._motion)):
            parts = read(kinematics.forward(self._motion.at(block)))
            whole = whole or [np.empty((len(self._motion), *part.shape[1:])) for part in parts]
            for array, part in zip(whole, parts, strict=True):
                array[block] = part
        return whole

    def blocks(self) -> Iterator[WorldPoses]:
        """Yield them in blocks of frames; those of a long motion are made one by one where they are not held."""
        if self._made is not None or len(self._motion) <= BLOCK_FRAMES:
            return blocks_of(self.get())
        return (kinematics.forward(self._motion.at(block)) for block in frame_blocks(len(self._motion)))

    def forget(self) -> None:
        """Give back their memory: for a long clip twice that of its file."""
        self._made = None

    def forget_long(self) -> None:
        """Give it back where that is much."""
        if len(self._motion) > BLOCK_FRAMES:
            self.forget()


@dataclass(frozen=True, eq=False)
class ClipFacts:
    """A clip and what was found in it.

    `bones` is its skeleton with bones for OFFSETs, `up` the signed unit axis (3,), `travel` the joint that carries the
    travel, `first` the first frame after a rest pose, `world` what holds the world transforms, `warnings` what was not
    found or is unsure, a line each.
    """

    clip: Clip
    bones: Skeleton
    anatomy: Anatomy
    up: FloatArray
    travel: int
    first: int
    world: Poses
    warnings: tuple[str, ...]

    @property
    def poses(self) -> WorldPoses:
        """World transforms of all frames."""
        return self.world.get()

    @cached_property
    def tracks(self) -> FloatArray:
        """The paths of heels and toes, shape (F, P, 3), as `sole_tracks`."""
        (tracks,) = self.world.gathered(lambda poses: [sole_tracks(poses, self.anatomy)])
        return frozen(tracks)

    @cached_property
    def bends(self) -> tuple[Bend, ...]:
        """To which side knees and elbows bend, as `find_bends`."""
        return find_bends(self.clip.motion.skeleton, self.poses, self.anatomy, first=self.first)

    @cached_property
    def sole_stands(self) -> tuple[Stand, ...]:
        """When heels and toes stand, as `stands_of`."""
        frame_time = self.clip.motion.frame_time
        return tuple(stands_of(self.tracks, self.anatomy, up=self.up, first=self.first, frame_time=frame_time))

    @cached_property
    def plants(self) -> tuple[Plant, ...]:
        """The same as plants, as `plants_of`."""
        return tuple(planted(self.anatomy, self.sole_stands))

    @cached_property
    def phases(self) -> tuple[Plant, ...]:
        """The plants cut to what a foot can be held for in one place, as `find_phases`."""
        from motionedit.core.feet.phases import find_phases, leg_paths  # edits alone ask for them

        anatomy, frame_time = self.anatomy, self.clip.motion.frame_time
        (legs,) = self.world.gathered(lambda poses: [leg_paths(poses, anatomy)])
        return tuple(find_phases(self.tracks, legs, anatomy, self.sole_stands, up=self.up, frame_time=frame_time))

    @cached_property
    def steps(self) -> Steps:
        """The largest steps of its joints, as `own_steps`."""
        return own_steps(self.clip.motion, first=self.first)

    @property
    def last(self) -> int:
        """The last frame."""
        return len(self.clip.motion) - 1

    def heading_frame(self, at: float | None = None) -> ground.Frame:
        """Return the heading frame at a frame or a part of one; by default the first after the rest pose."""
        return self._frames(at)[0]

    def stands(self, at: float | None = None) -> bool:
        """Return whether both feet are planted at a frame, side by side rather than one before the other."""
        heading, stance = self._frames(at)
        # Plants are the dearer question.
        if stance is None or float(stance.axes[0] @ heading.axes[0]) <= SIDE_BY_SIDE:
            return False
        return self._feet_planted(self.first if at is None else at) == {"left", "right"}

    def line_frame(self, by: Line, at: float | None) -> ground.Frame:
        """Return the frame by the line of hips or feet at a frame (None: the first): without feet by the hips."""
        heading, stance = self._frames(at)
        return heading if stance is None or by == "hips" else stance

    def alignment(self, by: Line, *, heading: bool, position: bool, at: float | None) -> Alignment:
        """Return the alignment of a clip on the ground at a frame (None: the first), by the line of hips or feet."""
        from motionedit.core.timeline.alignment import align_to

        return align_to(self.line_frame(by, at), heading=heading, position=position)

    def refuse_one_frame(self) -> None:
        """Raise a ClipError where one frame is left after the rest pose."""
        if self.last - self.first < 1:
            raise ClipError("has one frame; a motion needs two", file=self.clip.label)

    def _feet_planted(self, when: float) -> set[str]:
        """Return the feet that are planted at a frame: that depends on two seconds around it, no more."""
        frame_time = self.clip.motion.frame_time
        near = round(_AROUND / frame_time)
        begin, end = max(int(when) - near, self.first), min(int(when) + near, self.last) + 1
        tracks = sole_tracks(self.poses.at(slice(begin, end)), self.anatomy)
        found = plants_of(tracks, self.anatomy, up=self.up, first=0, frame_time=frame_time)
        return {plant.foot for plant in found if plant.start + begin <= when <= plant.stop + begin}

    def _frames(self, at: float | None) -> tuple[ground.Frame, ground.Frame | None]:
        """Return the frames of the heading and of the feet, where these have a line; each is asked for again."""
        known = self._known_frames.get(at)
        if known is None:
            poses, frame = self._at(at)
            heading = ground.heading_frame(poses, self.anatomy, up=self.up, frame=frame, travel=self.travel)
            known = heading, ground.stance_frame(poses, self.anatomy, up=self.up, frame=frame)
            self._known_frames[at] = known
        return known

    @cached_property
    def _known_frames(self) -> dict[float | None, tuple[ground.Frame, ground.Frame | None]]:
        """Frames that were asked for."""
        return {}

    def _at(self, at: float | None) -> tuple[WorldPoses, int]:
        """Return poses and a frame of them: the clip's own, or those of one resampled frame."""
        if at is None:
            return self.poses, self.first
        from motionedit.core.timeline.resample import resample

        motion = self.clip.motion
        return kinematics.forward(resample(motion, np.array([at]), frame_time=motion.frame_time)), 0


def facts_of(
    clip: Clip, *, up: str = "auto", keep_rest_pose: bool = False, given: GivenBody = NOTHING_GIVEN
) -> ClipFacts:
    """Return a clip's facts.

    Parameters
    ----------
    up : str
        ``auto``, or an axis' name such as ``y`` or ``-z``, which is taken as given.
    given : GivenBody
        What the user says that joints are.
    """
    motion = clip.motion
    travel = travel_joint(motion)
    (bones, heaped), world = find_bones(motion, travel), Poses(motion)
    poses = world.get()
    anatomy = find_anatomy(bones, poses=poses, given=given)
    anatomy = as_it_turns(bones, anatomy, motion.rotations, given=given)
    first = min(rest_pose_frames(motion, anatomy), len(motion) - 1)
    anatomy = as_it_points(anatomy, poses, first=first, given=given)
    found = find_up(motion, bones, poses, anatomy, first=first, travel=travel)
    axis, warnings = found.axis, list(anatomy.warnings)
    if heaped:
        warnings.append(_HEAPED)
    if up == "auto":
        warnings += [] if found.warning is None else [found.warning]
    else:
        axis = ground.axis_vector(up)
        if found.warning is None and axis @ found.axis < 1.0:
            warnings.append(f"up is given as {up}, but the clip plainly has {ground.axis_name(found.axis)} up")
    return ClipFacts(clip, bones, anatomy, axis, travel, 0 if keep_rest_pose else first, world, tuple(warnings))
