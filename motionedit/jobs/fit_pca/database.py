"""The clips that a model is fitted to: those that a folder's normalization.json lists, read one by one."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.pca.database import DatabaseMotion
from motionedit.core.pca.model import DatabaseClip
from motionedit.core.skeleton_match import match_joints
from motionedit.dataclass import dataclass, replace
from motionedit.errors import ClipError, ModelError, MotionEditError, UsageError, together
from motionedit.jobs.batch.files import Places, bytes_of
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.plan import ClipTask
from motionedit.jobs.batch.run import values_in_order
from motionedit.jobs.normalize.normalization_file import NAME, Normalization, NormalizedClip, read_normalization

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.batch.plan import RunOptions


# Bytes of clips that are read here before workers have begun, and have sent what they read.
_FEW_BYTES = 1 << 25


@dataclass(frozen=True)
class Database:
    """Normalized clips: what normalize says of them, a task for each, and what messages call the whole and its list."""

    normalization: Normalization
    tasks: Sequence[ClipTask]
    label: str
    list_label: str


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
    places = Places()
    for each in normalization.clips:
        path = PurePath(each.clip)
        if path.is_absolute() or ".." in path.parts:
            raise ModelError(f"lists {each.clip}, which is not below its folder", file=str(folder / NAME))
        name = places.of(folder / path)
        if name in found:
            raise ModelError(f"lists {each.clip} twice; run 'motionedit normalize' again", file=str(folder / NAME))
        found.add(name)


def motions_of(database: Database, options: RunOptions) -> Iterator[DatabaseMotion]:
    """Yield the clips one by one, none after one that cannot be used; all that cannot are named together at the end."""
    frames = database.normalization.timeline.frames
    items = [
        _Listed(task, each, frames) for task, each in zip(database.tasks, database.normalization.clips, strict=True)
    ]
    if bytes_of(task.source for task in database.tasks) <= _FEW_BYTES and options.scheduler is None:
        options = replace(options, jobs=1)
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
