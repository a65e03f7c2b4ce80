"""From normalized clips to a motion PCA model: one pose space, consistent tracks, principal components."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.pca.coordinates import (
    PoseSpace,
    Representation,
    pose_rows,
    rotations_in_space,
    space_joints,
)
from motionedit.core.pca.fit import ALL, ComponentCount, PrincipalComponents, fit_centred
from motionedit.core.pca.model import DatabaseClip, MotionModel
from motionedit.core.pca.streaming import Streamed, stream_components
from motionedit.core.pca.tracks import MeanRotations, make_consistent
from motionedit.core.pca.vectors import CentredVectors, MotionVectors, VectorsInFile, VectorsInMemory, motion_vectors
from motionedit.core.timeline.alignment import NO_ALIGNMENT, travel_path
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Iterable

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton
    from motionedit.core.timeline.warp import Timeline


@dataclass(frozen=True, eq=False)
class DatabaseMotion:
    """One normalized motion, and which of its joints stands for each of the first clip's, shape (J,)."""

    clip: DatabaseClip
    motion: Motion
    joint_map: IntArray


@dataclass(frozen=True)
class OtherWinding:
    """A joint that a clip turns the other way round than the database's median; `degrees` is how far off."""

    clip: str
    joint: str
    degrees: float


@dataclass(frozen=True)
class FitSettings:
    """What the user may choose of a fit.

    Attributes
    ----------
    representation
        ``centred``: about the Markley mean of all frames and clips; ``exponential``: about the identity, as the paper.
    root_weight : float
        Factor on the travel (metres at leg length 0.85 m) beside the rotations (radians).
    excluded : frozenset of int
        Joints of the first clip that stay out of the model, and are copied through by edits.
    components : ComponentCount
        How many are kept.
    threads : int
        The model is the same for any number of them.
    """

    representation: Representation = "centred"
    root_weight: float = 1.0
    excluded: frozenset[int] = frozenset()
    components: ComponentCount = ALL
    threads: int = 1


@dataclass(frozen=True, eq=False)
class FittedModel:
    """A `model`, the tracks that wind otherwise, and how the components were `streamed` where they were."""

    model: MotionModel
    windings: list[OtherWinding]
    streamed: Streamed | None


def build_model(
    database: Iterable[DatabaseMotion],
    count: int,
    *,
    timeline: Timeline,
    travel: int,
    up: FloatArray,
    leg_length: float,
    settings: FitSettings,
    rules: dict[str, Any],
) -> FittedModel:
    """Return the model of M >= 2 normalized motions, taken one by one.

    Up to `vectors.MOST_IN_MEMORY` motions their vectors are held and fitted by the Gram matrix, with all components
    unless `settings` say how many. More wait in a scratch file and are streamed, never all in memory.

    Parameters
    ----------
    count : int
        M, how many motions the database will give.
    travel : int
        Joint of the first clip's skeleton.
    leg_length : float
        In clip units.
    rules : dict
        How the clips were normalized, for the model to keep.

    Raises
    ------
    ValueError
        If the motions are all the same (`AllTheSameError`), or there are not as many components as asked for
        (`TooFewComponentsError`).
    """
    with motion_vectors(count) as vectors:
        scale = STANDARD_LEG / leg_length
        skeleton, space, clips = _gather(database, vectors, travel=travel, scale=scale, settings=settings)
        strays = make_consistent(vectors, space.references, frames=timeline.frames)
        components, streamed = _components(vectors, settings)
    windings = [
        OtherWinding(clips[m].name, skeleton.names[space.joints[k]], float(np.degrees(stray))) for m, k, stray in strays
    ]
    model = MotionModel(skeleton, space, timeline, travel, frozen(up), components, clips, rules)
    return FittedModel(model, windings, streamed)


def _gather(
    database: Iterable[DatabaseMotion],
    vectors: MotionVectors,
    *,
    travel: int,
    scale: float,
    settings: FitSettings,
) -> tuple[Skeleton, PoseSpace, tuple[DatabaseClip, ...]]:
    """Write the motions' vectors, with v = log(q), and return the first's skeleton, the pose space, and the clips."""
    clips: list[DatabaseClip] = []
    for each in database:
        if not clips:
            skeleton = each.motion.skeleton
            joints = space_joints(each.motion, travel=travel, excluded=settings.excluded)
            plain = PoseSpace(
                frozen(joints), frozen(np.tile(rot.IDENTITY, (len(joints), 1))), scale, settings.root_weight
            )
            center = MeanRotations(len(joints))
        path = travel_path(each.motion, int(each.joint_map[travel]))
        q = rotations_in_space(each.motion, each.joint_map[joints], path=path, alignment=NO_ALIGNMENT)
        center.add(q)
        vector = pose_rows(rot.log(q), plain, path=path, alignment=NO_ALIGNMENT).reshape(1, -1)
        vectors.write(len(clips), vector)
        clips.append(each.clip)
    centred = settings.representation == "centred"
    space = replace(plain, references=frozen(center.mean())) if centred else plain
    return skeleton, space, tuple(clips)


def _components(
    vectors: VectorsInMemory | VectorsInFile, settings: FitSettings
) -> tuple[PrincipalComponents, Streamed | None]:
    mean = sum(block.sum(axis=0) for _, block in vectors.blocks()) / vectors.count
    if isinstance(vectors, VectorsInFile):
        streamed = stream_components(CentredVectors(vectors, mean), count=settings.components)
        return streamed.components, streamed
    X = vectors.matrix
    X -= mean
    return fit_centred(X, mean, count=settings.components, threads=settings.threads), None
