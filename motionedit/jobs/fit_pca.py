"""The job behind `motionedit fit-pca`: normalized clips in, a motion PCA model out ([PC] 4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.anatomy import find_anatomy
from motionedit.core.ground import axis_vector, travel_joint
from motionedit.core.pca.database import DatabaseMotion, FitSettings, build_model
from motionedit.core.pca.fit import components_for
from motionedit.core.pca.model import DatabaseClip
from motionedit.core.pca.model_file import model_bytes
from motionedit.core.skeleton_match import match_joints
from motionedit.errors import ClipError, ModelError, MotionEditError, MotionEditErrors
from motionedit.jobs import resolve
from motionedit.jobs.batch import ClipTask, atomic_write, clean_leftovers, map_tasks, read_task
from motionedit.jobs.normalization_file import NAME, Normalization, NormalizedClip, read_normalization
from motionedit.spec.fit_pca import FitPcaSpec

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.motion import Motion
    from motionedit.core.pca.database import OtherWinding
    from motionedit.core.pca.model import MotionModel
    from motionedit.jobs.batch import RunOptions
    from motionedit.spec.load import LoadedSpec

HEADINGS = ("component", "variance", "share %", "sum %")


@dataclass(frozen=True)
class FitReport:
    """What a fit came to: the explained-variance `table` (headings, rows), the report's `record`, `warnings`."""

    table: tuple[Sequence[str], Sequence[Sequence[object]]]
    record: dict[str, Any]
    warnings: list[str]


def run(folder: Path, output: Path, loaded: LoadedSpec[FitPcaSpec] | None, options: RunOptions) -> FitReport:
    """Fit a model to the clips that a folder's normalization.json lists, and write it.

    Raises
    ------
    ModelError
        There is no normalization, or nothing to learn from it.
    MotionEditErrors
        Clips that cannot be used.
    SpecError
        The spec names joints or a number of components that are not there.
    """
    spec = FitPcaSpec() if loaded is None else loaded.model
    normalization = read_normalization(folder)
    if len(normalization.clips) < 2:
        count = len(normalization.clips)
        raise ModelError(f"lists {count} clip; a PCA needs two or more", file=str(folder / NAME))
    database = _database(folder, normalization, options)
    skeleton = database[0].motion.skeleton
    try:
        model, windings = build_model(
            database,
            timeline=normalization.timeline,
            travel=travel_joint(database[0].motion),
            up=axis_vector(normalization.up),
            leg_length=find_anatomy(skeleton).leg_length,
            settings=FitSettings(
                representation="centred" if spec.rotation == "centred" else "exponential",
                root_weight=spec.root_weight,
                excluded=_excluded(loaded, database[0], str(folder)),
            ),
            rules=normalization.rules,
        )
    except ValueError as error:
        raise ModelError(f"{error}: there is nothing to learn; give clips that differ", file=str(folder)) from error
    kept = model.truncated(_count(loaded, spec, model))
    clean_leftovers([output.parent])
    output.parent.mkdir(parents=True, exist_ok=True)
    atomic_write(output, model_bytes(kept))
    return _report(kept, windings)


def _database(folder: Path, normalization: Normalization, options: RunOptions) -> list[DatabaseMotion]:
    items = [_Listed(folder / each.clip, each, normalization.timeline.frames) for each in normalization.clips]
    values = map_tasks(_read, items, options)
    errors = [value for value in values if isinstance(value, MotionEditError)]
    database: list[DatabaseMotion] = []
    height = 0.0
    for item, value in zip(items, values, strict=True):
        if isinstance(value, MotionEditError):
            continue
        skeleton = value.skeleton
        if not database:
            height = find_anatomy(skeleton).height
        reference = database[0].motion.skeleton if database else skeleton
        try:
            against = str(items[0].path)
            joint_map = match_joints(reference, skeleton, height=height, label=str(item.path), against=against)
        except ClipError as error:
            errors.append(error)
            continue
        listed = item.listed
        clip = DatabaseClip(_stem(listed.clip), listed.digest, tuple(listed.events.items()))
        database.append(DatabaseMotion(clip, value, joint_map))
    if errors:
        raise errors[0] if len(errors) == 1 else MotionEditErrors("clips cannot be used", errors)
    return database


def _stem(relative: str) -> str:
    return relative[: -len(".bvh")] if relative.casefold().endswith(".bvh") else relative


@dataclass(frozen=True)
class _Listed:
    """A clip of the list, where it should be, and how many frames it should have."""

    path: Path
    listed: NormalizedClip
    frames: int


def _read(item: _Listed) -> Motion:
    clip = read_task(ClipTask(item.path, str(item.path), None, item.listed.clip), lenient=False)
    if len(clip.motion) != item.frames:
        message = f"has {len(clip.motion)} frames, {NAME} says {item.frames}; run 'motionedit normalize' again"
        raise ClipError(message, file=str(item.path))
    return clip.motion


def _excluded(loaded: LoadedSpec[FitPcaSpec] | None, first: DatabaseMotion, folder: str) -> frozenset[int]:
    if loaded is None:
        return frozenset()
    place = resolve.Place(loaded, ("exclude_joints",), folder)
    return frozenset(resolve.joints(loaded.model.exclude_joints, first.motion.skeleton, place))


def _count(loaded: LoadedSpec[FitPcaSpec] | None, spec: FitPcaSpec, model: MotionModel) -> int:
    available = len(model.components.explained_variance)
    if spec.explained_variance is not None:
        return components_for(model.components.explained_variance_ratio, spec.explained_variance)
    if spec.components is None:
        return available
    if spec.components > available and loaded is not None:
        message = f"{len(model.clips)} clips have {available} components, not {spec.components}"
        raise loaded.error(("components",), message)
    return spec.components


def _report(model: MotionModel, windings: Sequence[OtherWinding]) -> FitReport:
    pca = model.components
    shares = pca.explained_variance_ratio
    sums = np.cumsum(shares)
    rows = [
        (i + 1, float(variance), f"{100 * share:.2f}", f"{100 * total:.2f}")
        for i, (variance, share, total) in enumerate(zip(pca.explained_variance, shares, sums, strict=True))
    ]
    warnings = [
        f"{each.clip}: '{each.joint}' turns the other way round than in most clips ({each.degrees:.0f} degrees off); "
        "if that is a capture defect, leave it out with exclude_joints"
        for each in windings
    ]
    record = {
        "frames": model.timeline.frames,
        "frame_rate": model.timeline.frame_rate,
        "degrees_of_freedom": model.space.size,
        "explained_variance": pca.explained_variance,
        "explained_variance_ratio": shares,
        "database": [
            {"clip": clip.name, "coefficients": a} for clip, a in zip(model.clips, pca.coefficients, strict=True)
        ],
    }
    return FitReport((HEADINGS, rows), record, warnings)
