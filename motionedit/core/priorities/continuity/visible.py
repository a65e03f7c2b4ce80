"""What a viewer sees of an edit: joints whose change steps, and frames at which the body jerks."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.blocks import BLOCK_FRAMES, frame_blocks
from motionedit.core.body.quality import STILL, squared_jerks
from motionedit.core.compiled import compiled
from motionedit.core.kinematics import forward
from motionedit.core.priorities.sight import poses_again
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run

# Radians a frame at 60 frames a second: a viewer sees 10 degrees.
_STEP, _RATE = float(np.radians(8.0)), 60.0
# Times the input's jerk that a viewer sees in one frame.
_JERK = 10.0
# Times what the input has in the same frame, where that is more.
_OWN_JERK = 2.0


@dataclass(frozen=True, eq=False)
class Seen:
    """What a viewer sees of an edited motion at each frame: how far joints step, and how much it jerks, shape (F,).

    Both are multiples of the least that is seen, and 0 where that is not reached. `jerk` is all the motion's over all
    the input's, root mean squares. `poses` are the world transforms of a short motion, where they were looked at.
    """

    steps: FloatArray
    jerks: FloatArray
    jerk: float = 1.0
    poses: WorldPoses | None = None

    @property
    def much(self) -> FloatArray:
        """How much is seen, the larger of both, shape (F,)."""
        return np.maximum(self.steps, self.jerks)


def seen_of(run: Run, after: Motion, *, steps: FloatArray | None = None) -> Seen:
    """Return what a viewer sees of an edited motion, of which `steps_at` may be known."""
    poses = forward(after) if len(after) <= BLOCK_FRAMES else None
    steps = steps_at(run, after) if steps is None else steps
    return Seen(steps / _step(run), *jerks_of(run, after, poses=poses), poses)


def _step(run: Run) -> float:
    """Return the least step from frame to frame that is seen, rad."""
    return _STEP * run.motion.frame_time * _RATE


def steps_at(run: Run, after: Motion, *, within: FloatArray | None = None) -> FloatArray:
    """Return the largest step of a joint's change into or out of each frame, rad, shape (F,).

    0 where none is larger than is allowed, and than the joint's own largest step in the input.

    Parameters
    ----------
    within : shape (F,), optional
        Only steps among the frames at which it is not 0 are looked for.
    """
    before, first = run.motion, run.asked.body.first
    limit = _step(run)
    found = np.zeros(len(before))
    looked = np.arange(first, len(before)) if within is None else first + np.flatnonzero(within[first:])
    start, stop = (int(looked[0]), int(looked[-1]) + 1) if len(looked) else (0, 0)
    for block in frame_blocks(stop - start):
        frames = slice(start + block.start, min(start + block.stop + 1, stop))
        one, other = before.rotations[frames], after.rotations[frames]
        for joint in np.flatnonzero(_may_step(one, other, float(np.cos(0.5 * limit)))):
            change = rot.between(one[:, joint], other[:, joint])
            steps = rot.angle_between(change[:-1], change[1:])
            q = before.rotations[first:, joint]
            steps[steps <= max(limit, float(rot.angle_between(q[:-1], q[1:]).max()))] = 0.0
            for side in (slice(frames.start, frames.stop - 1), slice(frames.start + 1, frames.stop)):
                found[side] = np.maximum(found[side], steps)
    return found


def _may_step(before: FloatArray, after: FloatArray, cosine: float) -> BoolArray:
    """Return the joints whose change, before^-1 after, steps so that the cosine of half the step is below one, (J,).

    That costs less than the step, and nearly all are let off by it.
    """
    kernel, (frames, joints) = compiled(), before.shape[:2]
    if kernel is None:
        # All joints: to pick some would cost more than what is known of the others.
        change = rot.between(before, after)
        return np.asarray((rot.half_cosines(change[:-1], change[1:]) < cosine).any(axis=0))
    far = np.empty(joints, dtype=np.bool_)
    kernel.stepping(np.ascontiguousarray(before), np.ascontiguousarray(after), frames, joints, cosine, far)
    return far


def jerks_of(run: Run, after: Motion, *, poses: WorldPoses | None = None) -> tuple[FloatArray, float]:
    """Return by how much of what a viewer sees the body jerks at each frame, and how much all in all times the input.

    The former, shape (F,), is 0 where he does not see it.

    The jerk of a frame is that of all joints, sqrt(mean |p(f+3) - 3 p(f+2) + 3 p(f+1) - p(f)|^2), over ten times the
    root mean square of the input's. `poses` may be known.
    """
    before, first = run.motion, run.asked.body.first
    found, count = np.zeros(len(before)), len(before) - first - 3
    if count < 1:
        return found, 1.0
    is_kept = before.is_fixed and len(before) <= BLOCK_FRAMES
    was = (_jerk_again if is_kept else _jerk)(before, first)
    now = _jerk(after, first) if poses is None else _root_mean_square(poses.positions[first:])
    own = max(float(np.sqrt(np.mean(was * was))), STILL * before.frame_time**3)
    seen = np.where(now > _OWN_JERK * was, now / (_JERK * own), 0.0)
    seen[seen <= 1.0] = 0.0
    # It is seen in the middle of its four frames.
    for middle in (first + 1, first + 2):
        found[middle : middle + count] = np.maximum(found[middle : middle + count], seen)
    return found, float(np.sqrt(np.mean(now * now))) / own


def _jerk(motion: Motion, first: int) -> FloatArray:
    """Return the third difference of all joints over frames, root mean square, metres, shape (F - first - 3,)."""
    parts = []
    for block in frame_blocks(len(motion) - first - 3):
        frames = slice(first + block.start, min(first + block.stop + 3, len(motion)))
        parts.append(_root_mean_square(forward(motion.at(frames)).positions))
    return np.concatenate(parts)


def _root_mean_square(positions: FloatArray) -> FloatArray:
    """Return the third difference of positions (F, J, 3) over frames, root mean square of joints, shape (F - 3,)."""
    root: FloatArray = np.sqrt(squared_jerks(positions)[0] / positions.shape[1])
    return root


@lru_cache(maxsize=2)
def _jerk_again(motion: Motion, first: int) -> FloatArray:
    """Return `_jerk` of an edit's short input, whose poses are looked at again and again."""
    return _root_mean_square(poses_again(motion).positions[first:])
