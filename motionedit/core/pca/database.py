"""From normalized clips to a motion PCA model: one pose space, consistent tracks, principal components."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.pca.coordinates import (
    PoseSpace,
    Representation,
    consistent_tracks,
    other_windings,
    pose_rows,
    rotation_tracks,
    rotations_in_space,
    space_joints,
)
from motionedit.core.pca.fit import fit_components
from motionedit.core.pca.model import DatabaseClip, MotionModel
from motionedit.core.timeline.alignment import NO_ALIGNMENT, travel_path

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.timeline.warp import Timeline

# Every default solve takes lengths as if the leg were this long (m).
LEG_METRES = 0.85


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
    """

    representation: Representation = "centred"
    root_weight: float = 1.0
    excluded: frozenset[int] = frozenset()


def build_model(
    database: Sequence[DatabaseMotion],
    *,
    timeline: Timeline,
    travel: int,
    up: FloatArray,
    leg_length: float,
    settings: FitSettings,
    rules: dict[str, Any],
) -> tuple[MotionModel, list[OtherWinding]]:
    """Return the model of M >= 2 normalized motions with all its components, and the tracks that wind otherwise.

    Parameters
    ----------
    travel : int
        Joint of the first clip's skeleton.
    leg_length : float
        In clip units.
    rules : dict
        How the clips were normalized, for the model to keep.

    Raises
    ------
    ValueError
        If the motions are all the same.
    """
    skeleton = database[0].motion.skeleton
    joints = space_joints(database[0].motion, travel=travel, excluded=settings.excluded)
    paths = [travel_path(each.motion, int(each.joint_map[travel])) for each in database]
    turns = [
        rotations_in_space(each.motion, each.joint_map[joints], path=path, alignment=NO_ALIGNMENT)
        for each, path in zip(database, paths, strict=True)
    ]
    if settings.representation == "centred":
        references = rot.mean(np.concatenate(turns))
    else:
        references = np.tile(rot.IDENTITY, (len(joints), 1))
    space = PoseSpace(frozen(joints), frozen(references), LEG_METRES / leg_length, settings.root_weight)
    tracks = consistent_tracks([rotation_tracks(q, references) for q in turns])
    motions = np.stack(
        [
            pose_rows(track, space, path=path, alignment=NO_ALIGNMENT).ravel()
            for track, path in zip(tracks, paths, strict=True)
        ]
    )
    clips = tuple(each.clip for each in database)
    windings = [
        OtherWinding(clips[m].name, skeleton.names[joints[k]], float(np.degrees(stray)))
        for m, k, stray in other_windings(tracks)
    ]
    model = MotionModel(skeleton, space, timeline, travel, frozen(up), fit_components(motions), clips, rules)
    return model, windings
