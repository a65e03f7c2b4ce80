"""Frames taken block by block: a long motion's world transforms are several times its file."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.kinematics import WorldPoses

# Frames of a block, whose arrays stay near the processor.
BLOCK_FRAMES = 1 << 10


def frame_blocks(frames: int) -> Iterator[slice]:
    """Yield so many frames in blocks."""
    for start in range(0, frames, BLOCK_FRAMES):
        yield slice(start, min(start + BLOCK_FRAMES, frames))


def blocks_of(poses: WorldPoses) -> Iterator[WorldPoses]:
    """Yield world transforms in blocks of frames; views."""
    for block in frame_blocks(len(poses.positions)):
        yield poses.at(block)
