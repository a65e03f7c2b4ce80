"""The reference of a clip: another version of it, whose plants and paths constraints keep or follow."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.skeleton import same_skeleton
from motionedit.dataclass import replace
from motionedit.errors import ClipError
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.plan import ClipTask, folder_clips
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.facts import facts_of

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec

_SAME_TIME = 1e-6  # s


def refuse_unfit_reference(loaded: LoadedSpec[EditPrioritizedSpec]) -> None:
    """Refuse a reference that is not there, one that nothing is taken from, and one that is lacking.

    Raises
    ------
    SpecError
        There is no such file or folder; a constraint follows a reference, and none is given; or nothing uses it.
    """
    reference, constraints = loaded.model.reference, loaded.model.constraints
    if reference is None:
        for each in constraints:
            if each.follow == "reference":
                message = "there is no reference to follow; give reference: or --reference, or follow: input"
                raise loaded.error((*each.keys, "follow"), message)
    elif not reference.exists():
        raise loaded.error(("reference",), f"there is no clip or folder {reference}")
    elif not any(each.uses_reference for each in constraints):
        message = "nothing is taken from it: no constraint says follow: reference or is of type footplants"
        raise loaded.error(("reference",), f"{message}; say so in one, or leave it out")


def reference_files(reference: Path | None) -> list[Path]:
    """Return the files of a reference: none of them is ever overwritten, and outputs depend on them."""
    if reference is None:
        return []
    if not reference.is_dir():
        return [reference]
    return [clip.source for clip in folder_clips(reference) if clip.source]


def reference_facts(loaded: LoadedSpec[EditPrioritizedSpec], clip: Clip, task: ClipTask) -> ClipFacts | None:
    """Return the facts of a clip's reference: the file itself, or the clip of the same relative name in a folder.

    None where the spec gives none.

    Raises
    ------
    ClipError
        It is not there, cannot be read, or is no version of the clip: another skeleton, frame count or rate.
    """
    spec = loaded.model
    reference = spec.reference
    if reference is None:
        return None
    path = reference / task.relative if reference.is_dir() else reference
    if not path.is_file():
        raise ClipError(f"has no reference: there is no {path}", file=task.label)
    other = read_task(ClipTask(path, str(path), None, task.relative), lenient=False)
    mine, theirs = clip.motion, other.motion
    if not same_skeleton(mine.skeleton, theirs.skeleton):
        raise ClipError(f"its reference {path} has another skeleton", file=task.label)
    if len(mine) != len(theirs) or abs(mine.frame_time - theirs.frame_time) > _SAME_TIME:
        raise ClipError(
            f"its reference {path} has {len(theirs)} frames at {theirs.frame_rate:.6g} Hz, not {len(mine)} at "
            f"{mine.frame_rate:.6g} Hz",
            file=task.label,
        )
    given = resolve.body(spec.body, mine.skeleton, resolve.Place(loaded, ("body",), task.label))
    return facts_of(replace(other, label=str(path)), up=spec.up, given=given)
