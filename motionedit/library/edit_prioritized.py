"""`motionedit.edit_prioritized`: constraints in strict layers, every frame deformed."""

from __future__ import annotations

from typing import SupportsIndex

from motionedit.jobs.edit_prioritized import job
from motionedit.library.clips import AnyClip, clip_task
from motionedit.library.edited import Edited, edited
from motionedit.library.file_errors import file_errors
from motionedit.library.options import Events, events_of, options_of, refuse_unknown_events
from motionedit.library.paths import AnySpec, spec_of
from motionedit.spec.load import load_spec


@file_errors()
def edit_prioritized(
    clip: AnyClip,
    spec: AnySpec,
    *,
    events: Events | None = None,
    lenient: bool = False,
    threads: SupportsIndex = 1,
) -> Edited:
    """Return a clip edited by constraints in priority layers ([PRIO]), as `motionedit edit-prioritized` writes it.

    Parameters
    ----------
    clip : str or path-like, Clip, or Edited
        The clip: a file, what `read` returned, or what another edit did.
    spec : str or path-like, or mapping
        A YAML file, or the same as a mapping, in which `schema` may be left out: constraints over intervals, of the
        types position, orientation, pose, com, aim, posture, distance, floor and footplants. All keys: `docs/spec.md`,
        and ``motionedit schema edit-prioritized``.
    events : mapping of str to int, optional
        Frames of this clip's events, 0-based, in place of those of the spec: one spec serves many clips. Each is an
        event that the spec lists or names.
    lenient : bool
        As for `read`, where the clip is a file.
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
    options = options_of(threads=threads, lenient=lenient)
    loaded = load_spec(spec_of(spec), "edit-prioritized", events=events_of(events))
    refuse_unknown_events(events, loaded.known_events, where="the spec")
    before, task = clip_task(clip, lenient=options.lenient)
    return edited(before, task, job.edit(loaded, [task], options=options), loaded)
