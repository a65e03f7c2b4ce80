"""`motionedit.edit_pc`: goals at single frames, within the style of a model."""

from __future__ import annotations

from pathlib import Path

from motionedit.core.pca.model import MotionModel
from motionedit.core.pca.model_file import read_model
from motionedit.jobs.edit_pc import job
from motionedit.jobs.edit_pc.model_events import events_of_model
from motionedit.library.clips import AnyClip, clip_task
from motionedit.library.edited import Edited, edited
from motionedit.library.file_errors import file_errors
from motionedit.library.fit_pca import Fitted
from motionedit.library.options import Events, events_of, options_of, refuse_unknown_events
from motionedit.library.paths import AnyPath, AnySpec, path_of, spec_of
from motionedit.spec.load import load_spec

# What messages call a model that was never written.
_IN_MEMORY = "(in memory)"


@file_errors()
def edit_pc(
    clip: AnyClip,
    model: Fitted | MotionModel | AnyPath,
    spec: AnySpec,
    *,
    events: Events | None = None,
    lenient: bool = False,
) -> Edited:
    """Return a clip edited within the style of a PCA model ([PC] 4.2, 4.3), as `motionedit edit-pc` writes it.

    Parameters
    ----------
    clip : str or path-like, Clip, or Edited
        The clip: a file, what `read` returned, or what another edit did.
    model : str or path-like, Fitted, or MotionModel
        What `fit_pca` returned, or the file that it or the command wrote.
    spec : str or path-like, or mapping
        A YAML file, or the same as a mapping, in which `schema` may be left out: goals at single frames, each a
        position, a shift or an orientation of an effector. All keys: `docs/spec.md`, and ``motionedit schema edit-pc``.
    events : mapping of str to int, optional
        Frames of this clip's events, 0-based, in place of those of the spec and the model: one spec serves many clips.
        Each is an event that the spec or the model lists, or that the spec names.
    lenient : bool
        As for `read`, where the clip is a file.

    Returns
    -------
    Edited
        A goal that was not met is no error: see `report["status"]` and `warnings`.

    Raises
    ------
    MotionEditError
        Faults of the spec, all together; a clip or model that cannot be read, or do not fit each other.

    Examples
    --------
    >>> swings = motionedit.normalize("data/golf", "configs/golf-normalize.yaml")
    >>> fit = motionedit.fit_pca(swings)
    >>> ball = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, "shift": [0, 0, 10]}
    >>> edit = motionedit.edit_pc("data/golf/swing04.bvh", fit, {"goals": [ball]})
    >>> edit.report["status"]
    'ok'
    """
    options = options_of(lenient=lenient)
    loaded = load_spec(spec_of(spec), "edit-pc", events=events_of(events))
    before, task = clip_task(clip, lenient=options.lenient)
    full, label, files = _model(model)
    known = loaded.known_events.union(events_of_model(full))
    refuse_unknown_events(events, known, where="the spec or the model")
    return edited(before, task, job.edit(loaded, [task], model=full, label=label, options=options), loaded, files)


def _model(model: Fitted | MotionModel | AnyPath) -> tuple[MotionModel, str, tuple[Path, ...]]:
    """Return a model, what messages call it, and its file."""
    if isinstance(model, Fitted):
        return model.model, _IN_MEMORY, model.inputs
    if isinstance(model, MotionModel):
        return model, _IN_MEMORY, ()
    path = path_of(model, wanted="a model, as a path or what fit_pca returned")
    return read_model(path), str(path), (path,)
