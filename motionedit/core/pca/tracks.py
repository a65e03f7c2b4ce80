"""The rotation tracks of a database made consistent, block by block: one centre, one winding, and who strays from it.

Rows of motion vectors come with v = log(q) and leave with v = log(q_ref^-1 q), unwrapped and relabelled.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.pca.coordinates import rotation_tracks
from motionedit.core.rotation_vectors import relabelled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import FloatArray
    from motionedit.core.pca.vectors import MotionVectors

# A track this far (rad) from the database's winds the other way round.
OTHER_WINDING = 2.5
# Values of tracks that are gathered at a time for their median.
_MOST_GATHERED = 1 << 24


def products_of(q: FloatArray) -> FloatArray:
    """Return the sums of q q^T over frames, shape (K, 4, 4), of rotations (F, K, 4): their Markley mean's matrix."""
    parts = np.moveaxis(q, 0, -1)
    products: FloatArray = parts @ np.swapaxes(parts, 1, 2)
    return products


def make_consistent(vectors: MotionVectors, references: FloatArray, *, frames: int) -> list[tuple[int, int, float]]:
    """Change rows of log(q) into tracks about `references`, unwrapped, relabelled to their running mean in two passes.

    Returns
    -------
    list of (motion, joint, rad)
        Where a track strays further than 2.5 rad from the median of all motions'.

    Parameters
    ----------
    references : shape (K, 4)
    frames : int
        F; a vector has F rows of 3 + 3 K values.
    """
    total = np.zeros((frames, len(references), 3))
    for motion, vector, track in _tracks(vectors, frames):
        turned = rotation_tracks(rot.exp(track), references)
        track[:] = relabelled(turned, total / motion)[0] if motion else turned
        vectors.write(motion, vector[None])
        total += track
    mean = total / vectors.count
    farthest, squares = np.zeros(total.shape[:2]), np.zeros(total.shape)
    total[:] = 0.0
    for motion, vector, track in _tracks(vectors, frames):
        chosen, turns = relabelled(track, mean)
        if turns.any():
            track[:] = chosen
            vectors.write(motion, vector[None])
        off = chosen - mean
        total += off
        off *= off
        squares += off
        # Part by part: a sum over a short last axis takes several times as long.
        np.maximum(farthest, off[..., 0] + off[..., 1] + off[..., 2], out=farthest)
    # A median lies within a standard deviation of the mean, coordinate by coordinate.
    shift = total / vectors.count
    spread = np.maximum(squares / vectors.count - shift * shift, 0.0)
    bound = np.sqrt(farthest) + np.linalg.norm(np.sqrt(spread) + np.abs(shift), axis=-1)
    return other_windings(vectors, np.flatnonzero((bound > OTHER_WINDING).any(axis=0)).tolist(), frames=frames)


def other_windings(vectors: MotionVectors, joints: list[int], *, frames: int) -> list[tuple[int, int, float]]:
    """Return (motion, joint, rad) where a track of these joints strays further than 2.5 rad from the median."""
    step = max(_MOST_GATHERED // (vectors.count * frames * 3), 1)
    found = []
    for start in range(0, len(joints), step):
        some = joints[start : start + step]
        gathered = np.empty((vectors.count, frames, len(some), 3))
        for motion, _, track in _tracks(vectors, frames):
            gathered[motion] = track[:, some]
        gathered -= np.median(gathered, axis=0)
        stray = np.sqrt(np.einsum("mfki,mfki->mfk", gathered, gathered).max(axis=1))
        found += [(int(m), some[int(k)], float(stray[m, k])) for m, k in np.argwhere(stray > OTHER_WINDING)]
    return sorted(found)


def _tracks(vectors: MotionVectors, frames: int) -> Iterator[tuple[int, FloatArray, FloatArray]]:
    """Yield (motion, its vector, its tracks of shape (F, K, 3)), the tracks a view of the vector."""
    for first, block in vectors.blocks():
        for m, vector in enumerate(block):
            yield first + m, vector, vector.reshape(frames, -1)[:, 3:].reshape(frames, -1, 3)
