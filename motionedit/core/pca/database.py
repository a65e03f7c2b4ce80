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
from motionedit.core.pca.tracks import make_consistent, products_of
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


@dataclass(frozen=True, eq=False)
class DatabaseVector:
    """A motion's vector (D,), with v = log(q), and the sums of its rotations' q q^T over frames, shape (K, 4, 4)."""

    clip: DatabaseClip
    vector: FloatArray
    products: FloatArray


@dataclass(frozen=True, eq=False)
class DatabaseSpace:
    """What makes vectors of motions: the first one's `skeleton`, its joint that carries the `travel`, and a `space`.

    The space is about the identity: what a database's rotations lie about is known when all have been seen.
    """

    skeleton: Skeleton
    travel: int
    space: PoseSpace

    def vector(self, each: DatabaseMotion) -> DatabaseVector:
        """Return the vector of a motion."""
        path = travel_path(each.motion, int(each.joint_map[self.travel]))
        joints = each.joint_map[self.space.joints]
        q = rotations_in_space(each.motion, joints, path=path, alignment=NO_ALIGNMENT)
        rows = pose_rows(rot.log(q), self.space, path=path, alignment=NO_ALIGNMENT)
        return DatabaseVector(each.clip, rows.reshape(-1), products_of(q))


def database_space(first: Motion, *, travel: int, leg_length: float, settings: FitSettings) -> DatabaseSpace:
    """Return the space of a database whose first motion is given; `leg_length` in clip units."""
    joints = space_joints(first, travel=travel, excluded=settings.excluded)
    identity = np.tile(rot.IDENTITY, (len(joints), 1))
    space = PoseSpace(frozen(joints), frozen(identity), STANDARD_LEG / leg_length, settings.root_weight)
    return DatabaseSpace(first.skeleton, travel, space)


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
    database: Iterable[DatabaseVector],
    count: int,
    *,
    of: DatabaseSpace,
    timeline: Timeline,
    up: FloatArray,
    settings: FitSettings,
    rules: dict[str, Any],
) -> FittedModel:
    """Return the model of M >= 2 normalized motions, whose vectors are taken one by one.

    Up to `vectors.MOST_IN_MEMORY` motions their vectors are held and fitted by the Gram matrix, with all components
    unless `settings` say how many. More wait in a scratch file and are streamed, never all in memory.

    Parameters
    ----------
    count : int
        M, how many motions the database will give.
    of : DatabaseSpace
        What made the vectors.
    rules : dict
        How the clips were normalized, for the model to keep.

    Raises
    ------
    ValueError
        If the motions are all the same (`AllTheSameError`), or there are not as many components as asked for
        (`TooFewComponentsError`).
    """
    with motion_vectors(count) as vectors:
        space, clips = _gather(database, vectors, of.space, settings)
        strays = make_consistent(vectors, space.references, frames=timeline.frames)
        components, streamed = _components(vectors, settings)
    names = of.skeleton.names
    windings = [OtherWinding(clips[m].name, names[space.joints[k]], float(np.degrees(stray))) for m, k, stray in strays]
    model = MotionModel(of.skeleton, space, timeline, of.travel, frozen(up), components, clips, rules)
    return FittedModel(model, windings, streamed)


def _gather(
    database: Iterable[DatabaseVector], vectors: MotionVectors, plain: PoseSpace, settings: FitSettings
) -> tuple[PoseSpace, tuple[DatabaseClip, ...]]:
    """Write the motions' vectors, with v = log(q), and return the pose space, and the clips."""
    clips: list[DatabaseClip] = []
    products = np.zeros((len(plain.joints), 4, 4))
    for each in database:
        products += each.products
        vectors.write(len(clips), each.vector[None])
        clips.append(each.clip)
    centred = settings.representation == "centred"
    space = replace(plain, references=frozen(rot.mean_of_products(products))) if centred else plain
    return space, tuple(clips)


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
