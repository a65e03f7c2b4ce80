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
from motionedit.jobs.batch.values import map_tasks, values_in_order
from motionedit.jobs.normalize.normalization_file import NAME, Normalization, NormalizedClip, read_normalization

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from motionedit.core.motion import Motion
    from motionedit.core.pca.database import DatabaseSpace, DatabaseVector
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


class Motions:
    """The motions that a database lists: the `first`, then the vectors of all.

    Raises
    ------
    MotionEditError
        Why each of them cannot be used, where none can.
    """

    def __init__(self, database: Database, options: RunOptions) -> None:
        frames = database.normalization.timeline.frames
        listed = zip(database.tasks, database.normalization.clips, strict=True)
        self._items = [_Listed(task, each, frames) for task, each in listed]
        few = bytes_of(task.source for task in database.tasks) <= _FEW_BYTES and options.scheduler is None
        self._options = replace(options, jobs=1) if few else options
        self._errors: list[MotionEditError] = []
        self._rest = iter(self._items)
        for item in self._rest:
            value = map_tasks(_read, [item], self._options)[0]
            if not isinstance(value, MotionEditError):
                self.first: Motion = value
                return
            self._errors.append(value)
        raise self._unusable()

    def vectors(self, space: DatabaseSpace) -> Iterator[DatabaseVector]:
        """Yield the vectors one by one, none after a motion that cannot be used; all these are named at the end."""
        vector_of = _VectorOf(space, anatomy_of(self.first).height, self._items[0].task.label)
        rest = list(self._rest)
        if not self._errors:
            yield vector_of.motion(self.first, self._items[0])
        for value in values_in_order(vector_of, rest, self._options):
            if isinstance(value, MotionEditError):
                self._errors.append(value)
            elif not self._errors:
                yield value
        if self._errors:
            raise self._unusable()

    def _unusable(self) -> MotionEditError:
        return together("clips cannot be used", self._errors)


@dataclass(frozen=True)
class _VectorOf:
    """What makes the vector of a clip of the list, by the joints of the first that can be read."""

    space: DatabaseSpace
    height: float
    against: str

    def __call__(self, item: _Listed) -> DatabaseVector:
        """Return the vector of a clip, which is read."""
        return self.motion(_read(item), item)

    def motion(self, motion: Motion, item: _Listed) -> DatabaseVector:
        """Return the vector of a clip's motion."""
        joint_map = match_joints(
            self.space.skeleton, motion.skeleton, height=self.height, label=item.task.label, against=self.against
        )
        listed = item.listed
        clip = DatabaseClip(_stem(listed.clip), listed.digest, tuple(listed.events.items()))
        return self.space.vector(DatabaseMotion(clip, motion, joint_map))


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
