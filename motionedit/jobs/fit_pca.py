"""The job behind `motionedit fit-pca`: normalized clips in, a motion PCA model out ([PC] 4.1)."""

from __future__ import annotations

from itertools import chain
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.anatomy import anatomy_of
from motionedit.core.body.bones import travel_joint
from motionedit.core.body.ground import axis_vector
from motionedit.core.pca.database import DatabaseMotion, FitSettings, build_model
from motionedit.core.pca.fit import AllTheSameError, ComponentCount, TooFewComponentsError
from motionedit.core.pca.model import DatabaseClip
from motionedit.core.pca.model_file import model_bytes
from motionedit.core.pca.streaming import MOST_COMPONENTS
from motionedit.core.skeleton_match import match_joints
from motionedit.dataclass import dataclass
from motionedit.errors import ClipError, ModelError, MotionEditError, UsageError, together
from motionedit.jobs.batch.files import clean_leftovers, place
from motionedit.jobs.batch.one_clip import read_task, write_file
from motionedit.jobs.batch.outputs import refuse_clashes
from motionedit.jobs.batch.plan import ClipTask
from motionedit.jobs.batch.run import values_in_order
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.kept_rules import body_said, kept_body, with_body
from motionedit.jobs.normalize.normalization_file import NAME, Normalization, NormalizedClip, read_normalization
from motionedit.spec.fit_pca import FitPcaSpec

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from motionedit.core.body.anatomy import GivenBody
    from motionedit.core.motion import Motion
    from motionedit.core.pca.database import FittedModel
    from motionedit.core.pca.fit import PrincipalComponents
    from motionedit.core.pca.model import MotionModel
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.batch.plan import RunOptions
    from motionedit.spec.load import LoadedSpec

# A clip this many times as far from the others as the median clip is worth a word: real strokes of one player have come
# to 1.6.
ODD = 2.0
HEADINGS = ("component", "variance", "share %", "sum %")


@dataclass(frozen=True)
class FitReport:
    """What a fit came to: the explained-variance `table` (headings, rows), the report's `record`, lines to print."""

    table: tuple[Sequence[str], Sequence[Sequence[object]]]
    record: dict[str, Any]
    warnings: list[str]
    notes: list[str]


@dataclass(frozen=True, eq=False)
class Fit:
    """A model, and what is to be said of it."""

    model: MotionModel
    report: FitReport


@dataclass(frozen=True)
class Database:
    """Normalized clips: what normalize says of them, a task for each, and what messages call the whole and its list."""

    normalization: Normalization
    tasks: Sequence[ClipTask]
    label: str
    list_label: str


def run(folder: Path, output: Path, loaded: LoadedSpec[FitPcaSpec] | None, options: RunOptions) -> FitReport:
    """Fit a model to the clips that a folder's normalization.json lists, and write it; see `fit`."""
    database = database_in(folder)
    sources = [task.source for task in database.tasks]
    written = [("the model", output), ("the report", options.report)]
    refuse_clashes(written, [*sources, folder / NAME, *(() if loaded is None else loaded.files)])
    made = fit(database, loaded, options=options)
    clean_leftovers([output.parent])
    write_file(output, model_bytes(made.model))
    return made.report


def database_in(folder: Path) -> Database:
    """Return the clips that a folder's normalization.json lists.

    Raises
    ------
    UsageError
        It is no folder.
    ModelError
        There is no normalization, or it cannot be read.
    """
    if not folder.is_dir():
        what = "is a file, not a folder" if folder.exists() else "no such folder"
        raise UsageError(f"{what}; give the folder that 'motionedit normalize' wrote", file=str(folder))
    normalization = read_normalization(folder)
    paths = [folder / each.clip for each in normalization.clips]
    _refuse_strangers(normalization, folder)
    tasks = [ClipTask(path, str(path), None, each.clip) for path, each in zip(paths, normalization.clips, strict=True)]
    return Database(normalization, tasks, str(folder), str(folder / NAME))


def _refuse_strangers(normalization: Normalization, folder: Path) -> None:
    """Raise a ModelError where a clip is listed twice, or is none of the folder's."""
    found: set[str] = set()
    for each in normalization.clips:
        path = PurePath(each.clip)
        if path.is_absolute() or ".." in path.parts:
            raise ModelError(f"lists {each.clip}, which is not below its folder", file=str(folder / NAME))
        name = place(folder / path)
        if name in found:
            raise ModelError(f"lists {each.clip} twice; run 'motionedit normalize' again", file=str(folder / NAME))
        found.add(name)


def fit(database: Database, loaded: LoadedSpec[FitPcaSpec] | None, *, options: RunOptions) -> Fit:
    """Return a model of normalized clips.

    Raises
    ------
    ModelError
        There is nothing to learn from them.
    ClipError, MotionEditErrors
        Clips that cannot be used.
    SpecError
        The spec names joints or a number of components that are not there.
    """
    spec = FitPcaSpec() if loaded is None else loaded.model
    normalization, count = database.normalization, len(database.tasks)
    if count < 2:
        raise ModelError(f"lists {count} clip; a PCA needs two or more", file=database.list_label)
    motions = _motions(database, options)
    first = next(motions)
    try:
        fitted = build_model(
            chain((first,), motions),
            count,
            timeline=normalization.timeline,
            travel=travel_joint(first.motion),
            up=axis_vector(normalization.up),
            leg_length=anatomy_of(first.motion, given=_body(loaded, database, first.motion.skeleton)).leg_length,
            settings=FitSettings(
                representation="centred" if spec.rotation == "centred" else "exponential",
                root_weight=spec.root_weight,
                excluded=_excluded(loaded, first, database.label),
                components=ComponentCount(spec.components, spec.explained_variance),
            ),
            rules=with_body(normalization.rules, spec.body),
        )
    except TooFewComponentsError as error:
        raise _too_few(loaded, spec, count, error.available) from None
    except AllTheSameError as error:
        raise ModelError(f"{error}: there is nothing to learn; give clips that differ", file=database.label) from error
    return Fit(fitted.model, _report(fitted, spec))


def _body(loaded: LoadedSpec[FitPcaSpec] | None, database: Database, skeleton: Skeleton) -> GivenBody:
    """Return what the spec says that joints are, and of what it does not say what the normalization's rules say."""
    rules, where = database.normalization.rules, {"label": database.list_label, "clip": database.label}
    if loaded is None:
        return kept_body(rules, skeleton, **where)
    return body_said(loaded, rules, skeleton, **where)


def _motions(database: Database, options: RunOptions) -> Iterator[DatabaseMotion]:
    """Yield the clips one by one, none after one that cannot be used; all that cannot are named together at the end."""
    frames = database.normalization.timeline.frames
    items = [
        _Listed(task, each, frames) for task, each in zip(database.tasks, database.normalization.clips, strict=True)
    ]
    errors: list[MotionEditError] = []
    reference: Skeleton | None = None
    height = 0.0
    for item, value in zip(items, values_in_order(_read, items, options), strict=True):
        if isinstance(value, MotionEditError):
            errors.append(value)
            continue
        if reference is None:
            reference = value.skeleton
            height = anatomy_of(value).height
        try:
            against = items[0].task.label
            joint_map = match_joints(reference, value.skeleton, height=height, label=item.task.label, against=against)
        except ClipError as error:
            errors.append(error)
            continue
        if not errors:
            listed = item.listed
            clip = DatabaseClip(_stem(listed.clip), listed.digest, tuple(listed.events.items()))
            yield DatabaseMotion(clip, value, joint_map)
    if errors:
        raise together("clips cannot be used", errors)


def _stem(relative: str) -> str:
    return relative[: -len(".bvh")] if relative.casefold().endswith(".bvh") else relative


@dataclass(frozen=True)
class _Listed:
    """A clip of the list, where it should be, and how many frames it should have."""

    task: ClipTask
    listed: NormalizedClip
    frames: int


def _read(item: _Listed) -> Motion:
    clip = read_task(item.task, lenient=False)
    if len(clip.motion) != item.frames:
        message = f"has {len(clip.motion)} frames, {NAME} says {item.frames}; run 'motionedit normalize' again"
        raise ClipError(message, file=item.task.label)
    if item.task.clip is None and clip.sha256 != item.listed.written:
        message = f"is not the clip that {NAME} lists (changed since, or of another run)"
        message = f"{message}; run 'motionedit normalize' again"
        raise ClipError(message, file=item.task.label)
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
    model, pca = fitted.model, fitted.model.components
    record = {
        "frames": model.timeline.frames,
        "frame_rate": model.timeline.frame_rate,
        "degrees_of_freedom": model.space.size,
        "explained_variance": pca.explained_variance,
        "explained_variance_ratio": pca.explained_variance_ratio,
        "database": [
            {"clip": clip.name, "coefficients": a} for clip, a in zip(model.clips, pca.coefficients, strict=True)
        ],
    }
    left_out = pca.left_out
    if left_out is not None:
        record["left_out"] = {
            "share": left_out.share,
            "furthest": model.clips[left_out.furthest].name,
            "clips": [
                {"clip": clip.name, "share": share, "times": times}
                for clip, share, times in zip(model.clips, left_out.shares, left_out.times, strict=True)
            ],
        }
    if fitted.streamed is not None:
        record["streamed"] = {"passes": fitted.streamed.passes, "residual": fitted.streamed.residual}
    return FitReport((HEADINGS, _rows(pca)), record, _warnings(fitted, spec), _notes(fitted, spec))


def _rows(pca: PrincipalComponents) -> list[tuple[object, ...]]:
    shares = pca.explained_variance_ratio
    return [
        (i + 1, float(variance), f"{100 * share:.2f}", f"{100 * total:.2f}")
        for i, (variance, share, total) in enumerate(
            zip(pca.explained_variance, shares, np.cumsum(shares), strict=True)
        )
    ]


def _warnings(fitted: FittedModel, spec: FitPcaSpec) -> list[str]:
    warnings = [
        f"{each.clip}: '{each.joint}' turns the other way round than in most clips ({each.degrees:.0f} degrees off); "
        "if that is a capture defect, leave it out with exclude_joints"
        for each in fitted.windings
    ]
    warnings += _odd_clip(fitted.model)
    shares = fitted.model.components.explained_variance_ratio
    explained = float(np.cumsum(shares)[-1])
    if spec.explained_variance is not None and explained < spec.explained_variance - 1e-9:
        warnings.append(
            f"the first {len(shares)} components explain {100 * explained:.2f} % of the variance, not "
            f"{100 * spec.explained_variance:g} %; no more are kept of so many clips"
        )
    return warnings


def _odd_clip(model: MotionModel) -> list[str]:
    """Return a warning of the clip that lies further from all others than clips of one behaviour do."""
    left_out = model.components.left_out
    if left_out is None or len(model.clips) < 4:
        return []
    times = float(left_out.times[left_out.furthest])
    if times <= ODD:
        return []
    name = model.clips[left_out.furthest].name
    far = f"{name}: {times:.3g} times as far from the others as the median clip"
    return [f"{far}; is it one of them, and were its events found rightly?"]


def _left_out_note(model: MotionModel) -> list[str]:
    """Return what the database says of a clip that it does not hold."""
    left_out = model.components.left_out
    if left_out is None:
        return []
    furthest = model.clips[left_out.furthest].name
    times = left_out.times[left_out.furthest]
    share = f"left out in turn, {100.0 * left_out.share:.3g} % of a clip is not explained by the others"
    return [f"{share}; furthest from them: {furthest}, {times:.3g} times the median"]


def _notes(fitted: FittedModel, spec: FitPcaSpec) -> list[str]:
    """Return what the database says of unseen clips and, where it was streamed, in how many passes it was learnt."""
    streamed, model = fitted.streamed, fitted.model
    notes = _left_out_note(model)
    if streamed is None:
        return notes
    kept = f"the first {len(model.components.explained_variance)} components"
    if spec.components is None and spec.explained_variance is None:
        kept += " (set components or explained_variance for another number)"
    passes = f"in {streamed.passes} passes, each to {streamed.residual:.0e} of the first's variance"
    return [*notes, f"{len(model.clips)} clips, streamed from a scratch file: {kept}, {passes}"]
