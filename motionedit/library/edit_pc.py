"""`motionedit.edit_pc`: goals at single frames, within the style of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.pca.model import MotionModel
from motionedit.core.pca.model_file import read_model
from motionedit.jobs.edit_pc import job
from motionedit.library.edited import edited
from motionedit.library.file_errors import file_errors
from motionedit.library.fit_pca import Fitted
from motionedit.library.inputs import events_of, options_of, path_of, spec_of, task_of
from motionedit.spec.load import load_spec

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from motionedit.library.edited import Edited
    from motionedit.library.inputs import AnyClip, AnyPath, AnySpec

# What messages call a model that was never written.
_IN_MEMORY = "(in memory)"


@file_errors()
def edit_pc(
    clip: AnyClip, model: Fitted | MotionModel | AnyPath, spec: AnySpec, *, events: Mapping[str, int] | None = None
) -> Edited:
    """Return a clip edited within the style of a PCA model ([PC] 4.2, 4.3), as `motionedit edit-pc` writes it.

    Parameters
    ----------
    clip : path-like or Clip
        The clip.
    model : path-like, Fitted or MotionModel
        What `fit_pca` returned, or the file that it or the command wrote.
    spec : path-like or mapping
        As for `normalize`: goals at single frames.
    events : mapping, optional
        Frames of this clip's events, 0-based, in place of those of the spec and the model: one spec serves many clips.

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
    loaded = load_spec(spec_of(spec), "edit-pc", events=events_of(events))
    task = task_of(clip)
    full, label, files = _model(model)
    result = job.edit(loaded, [task], model=full, label=label, options=options_of())
    return edited(task, result, files=(*loaded.files, *files))


def _model(model: Fitted | MotionModel | AnyPath) -> tuple[MotionModel, str, tuple[Path, ...]]:
    """Return a model, what messages call it, and its file."""
    if isinstance(model, Fitted):
        return model.model, _IN_MEMORY, model.inputs
    if isinstance(model, MotionModel):
        return model, _IN_MEMORY, ()
    path = path_of(model, wanted="a model, as a path or what fit_pca returned")
    return read_model(path), str(path), (path,)
