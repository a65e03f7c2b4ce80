"""The job behind `motionedit fit-pca`: normalized clips in, a motion PCA model out ([PC] 4.1)."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.anatomy import find_anatomy
from motionedit.core.body.ground import axis_vector, travel_joint
from motionedit.core.pca.database import DatabaseMotion, FitSettings, build_model
from motionedit.core.pca.fit import AllTheSameError, ComponentCount, TooFewComponentsError
from motionedit.core.pca.model import DatabaseClip
from motionedit.core.pca.model_file import model_bytes
from motionedit.core.pca.streaming import MOST_COMPONENTS
from motionedit.core.skeleton_match import match_joints
from motionedit.dataclass import dataclass
from motionedit.errors import ClipError, ModelError, MotionEditError, MotionEditErrors
from motionedit.jobs.batch.files import atomic_write, clean_leftovers
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.plan import ClipTask
from motionedit.jobs.batch.run import values_in_order
from motionedit.jobs.clip import resolve
from motionedit.jobs.normalize.normalization_file import NAME, Normalization, NormalizedClip, read_normalization
from motionedit.spec.fit_pca import FitPcaSpec

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from motionedit.core.motion import Motion
    from motionedit.core.pca.database import FittedModel
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.batch.plan import RunOptions
    from motionedit.spec.load import LoadedSpec

HEADINGS = ("component", "variance", "share %", "sum %")


@dataclass(frozen=True)
class FitReport:
    """What a fit came to: the explained-variance `table` (headings, rows), the report's `record`, lines to print."""

    table: tuple[Sequence[str], Sequence[Sequence[object]]]
    record: dict[str, Any]
    warnings: list[str]
    notes: list[str]


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
    first = next(database)
    try:
        fitted = build_model(
            chain((first,), database),
            len(normalization.clips),
            timeline=normalization.timeline,
            travel=travel_joint(first.motion),
            up=axis_vector(normalization.up),
            leg_length=find_anatomy(first.motion.skeleton).leg_length,
            settings=FitSettings(
                representation="centred" if spec.rotation == "centred" else "exponential",
                root_weight=spec.root_weight,
                excluded=_excluded(loaded, first, str(folder)),
                components=ComponentCount(spec.components, spec.explained_variance),
            ),
            rules=normalization.rules,
        )
    except TooFewComponentsError as error:
        raise _too_few(loaded, spec, len(normalization.clips), error.available) from None
    except AllTheSameError as error:
        raise ModelError(f"{error}: there is nothing to learn; give clips that differ", file=str(folder)) from error
    clean_leftovers([output.parent])
    output.parent.mkdir(parents=True, exist_ok=True)
    atomic_write(output, model_bytes(fitted.model))
    return _report(fitted, spec)


def _database(folder: Path, normalization: Normalization, options: RunOptions) -> Iterator[DatabaseMotion]:
    """Yield the clips one by one, none after one that cannot be used; all that cannot are named together at the end."""
    items = [_Listed(folder / each.clip, each, normalization.timeline.frames) for each in normalization.clips]
    errors: list[MotionEditError] = []
    reference: Skeleton | None = None
    height = 0.0
    for item, value in zip(items, values_in_order(_read, items, options), strict=True):
        if isinstance(value, MotionEditError):
            errors.append(value)
            continue
        if reference is None:
            reference = value.skeleton
            height = find_anatomy(reference).height
        try:
            against = str(items[0].path)
            joint_map = match_joints(reference, value.skeleton, height=height, label=str(item.path), against=against)
        except ClipError as error:
            errors.append(error)
            continue
        if not errors:
            listed = item.listed
            clip = DatabaseClip(_stem(listed.clip), listed.digest, tuple(listed.events.items()))
            yield DatabaseMotion(clip, value, joint_map)
    if errors:
        raise errors[0] if len(errors) == 1 else MotionEditErrors("clips cannot be used", errors)


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


def _too_few(loaded: LoadedSpec[FitPcaSpec] | None, spec: FitPcaSpec, clips: int, available: int) -> MotionEditError:
    message = f"{clips} clips have {available} components, not {spec.components}"
    if available == MOST_COMPONENTS:
        message = f"of {clips} clips at most {available} components are kept, not {spec.components}"
    return ModelError(message) if loaded is None else loaded.error(("components",), message)


def _report(fitted: FittedModel, spec: FitPcaSpec) -> FitReport:
    model = fitted.model
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
        for each in fitted.windings
    ]
    if spec.explained_variance is not None and sums[-1] < spec.explained_variance - 1e-9:
        warnings.append(
            f"the first {len(shares)} components explain {100 * sums[-1]:.2f} % of the variance, not "
            f"{100 * spec.explained_variance:g} %; no more are kept of so many clips"
        )
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
    notes = []
    if fitted.streamed is not None:
        streamed = fitted.streamed
        record["streamed"] = {"passes": streamed.passes, "residual": streamed.residual}
        kept = f"the first {len(shares)} components"
        if spec.components is None and spec.explained_variance is None:
            kept += " (set components or explained_variance for another number)"
        notes = [
            (
                f"{len(model.clips)} clips, streamed from a scratch file: {kept}, in {streamed.passes} passes, each to "
                f"{streamed.residual:.0e} of the first's variance"
            )
        ]
    return FitReport((HEADINGS, rows), record, warnings, notes)
