"""`motionedit.edit_prioritized`: constraints in strict layers, every frame deformed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.jobs.edit_prioritized import job
from motionedit.library.edited import edited
from motionedit.library.file_errors import file_errors
from motionedit.library.inputs import events_of, options_of, spec_of, task_of
from motionedit.spec.load import load_spec

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.library.edited import Edited
    from motionedit.library.inputs import AnyClip, AnySpec


@file_errors()
def edit_prioritized(
    clip: AnyClip, spec: AnySpec, *, events: Mapping[str, int] | None = None, threads: int = 1
) -> Edited:
    """Return a clip edited by constraints in priority layers ([PRIO]), as `motionedit edit-prioritized` writes it.

    Parameters
    ----------
    clip : path-like or Clip
        The clip.
    spec : path-like or mapping
        As for `normalize`: constraints over intervals.
    events : mapping, optional
        Frames of this clip's events, 0-based, in place of those of the spec: one spec serves many clips.
    threads : int
        Threads of the compiled solver; 0 means all cores. The result is the same for any number.

    Returns
    -------
    Edited
        A constraint that was not met is no error: see `report["status"]` and `warnings`.

    Raises
    ------
    MotionEditError
        Faults of the spec, all together; a clip that cannot be read, or lacks what the spec names.

    Examples
    --------
    >>> edit = motionedit.edit_prioritized("data/walk.bvh", "configs/stairs.yaml")
    >>> edit.report["status"]
    'ok'
    >>> path = edit.write("walk-stairs.bvh")
    """
    loaded = load_spec(spec_of(spec), "edit-prioritized", events=events_of(events))
    task = task_of(clip)
    result = job.edit(loaded, [task], options=options_of(jobs=threads))
    return edited(task, result, files=loaded.files)
