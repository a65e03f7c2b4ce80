"""Frames taken block by block: a long motion's world transforms are several times its file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.kinematics import WorldPoses, forward

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from motionedit.core.motion import Motion

# Frames of a block, whose arrays stay near the processor.
BLOCK_FRAMES = 1 << 10


def frame_blocks(frames: int) -> Iterator[slice]:
    """Yield so many frames in blocks."""
    for start in range(0, frames, BLOCK_FRAMES):
        yield slice(start, min(start + BLOCK_FRAMES, frames))


def blocks_of(poses: WorldPoses) -> Iterator[WorldPoses]:
    """Yield world transforms in blocks of frames; views."""
    for block in frame_blocks(len(poses.positions)):
        yield WorldPoses(poses.positions[block], poses.rotations[block])


def forward_blocks(motions: Iterable[Motion]) -> Iterator[WorldPoses]:
    """Yield the world transforms of blocks of a motion."""
    for motion in motions:
        yield forward(motion)
