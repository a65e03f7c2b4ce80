"""`motionedit.fit_pca`: normalized clips in, a motion PCA model out."""

from __future__ import annotations

from pathlib import Path
from typing import Any, SupportsIndex

from motionedit.core.bvh import Clip
from motionedit.core.pca.model import MotionModel
from motionedit.core.pca.model_file import model_bytes
from motionedit.dataclass import dataclass
from motionedit.errors import UsageError
from motionedit.jobs.batch.plan import ClipTask
from motionedit.jobs.fit_pca import job
from motionedit.jobs.fit_pca.database import Database, database_in
from motionedit.jobs.normalize.normalization_file import NAME
from motionedit.library.file_errors import file_errors
from motionedit.library.mean_clip import mean_clip
from motionedit.library.normalize import Normalized
from motionedit.library.options import options_of
from motionedit.library.outputs import inputs_of, report_of, write_files
from motionedit.library.paths import AnyPath, AnySpec, path_of, spec_of
from motionedit.spec.load import load_spec

# What messages call clips that were never written.
_IN_MEMORY = "normalized clips"


@dataclass(frozen=True, eq=False)
class Fitted:
    """A motion PCA model.

    Attributes
    ----------
    model : MotionModel
        Of M clips, F frames and n degrees of freedom: `model.components` holds `mean`, shape (n F,), `components`,
        shape (m, n F), `explained_variance`, shape (m,), and the clips' `coefficients`, shape (M, m).
    report : dict
        The JSON report, plain values.
    warnings : tuple of str
        The lines that the command prints after ``motionedit: warning:``.
    inputs : tuple of Path
        The files that it was made from, absolute: `write` overwrites none of them.
    """

    model: MotionModel
    report: dict[str, Any]
    warnings: tuple[str, ...]
    inputs: tuple[Path, ...]

    @property
    def clip(self) -> Clip:
        """The database's mean motion on the model's timeline, as a clip called mean.bvh; made anew each time."""
        return mean_clip(self.model)

    def write(self, path: AnyPath) -> Path:
        """Write the model's file (``.npz``), whole or not at all, and return it.

        Raises
        ------
        MotionEditError
            The file is an input of the fit, or cannot be written.
        """
        target = path_of(path)
        if target.is_dir():
            raise UsageError("is a folder; give a name such as model.npz", file=str(target))
        write_files({target: model_bytes(self.model)}, inputs=self.inputs)
        return target

    def __repr__(self) -> str:
        count = len(self.model.components.explained_variance)
        return f"<Fitted: {count} components of {len(self.model.clips)} clips>"


@file_errors()
def fit_pca(normalized: Normalized | AnyPath, spec: AnySpec | None = None, *, jobs: SupportsIndex = 1) -> Fitted:
    """Return a motion PCA model of normalized clips ([PC] 4.1), as `motionedit fit-pca` writes it.

    Parameters
    ----------
    normalized : Normalized, or str or path-like
        What `normalize` returned, or the folder that it or the command wrote.
    spec : str or path-like, or mapping, optional
        A YAML file, or the same as a mapping, in which `schema` may be left out: how many components are kept (all if
        not given), which joints are left out. All keys: `docs/spec.md`, and ``motionedit schema fit-pca``.
    jobs : int
        Clips in parallel processes; 0 means all cores. The result is the same for any number.

    Raises
    ------
    MotionEditError
        Faults of the spec, all together; no normalization.json; clips that cannot be used, or do not differ.

    Examples
    --------
    >>> swings = motionedit.normalize("data/golf", "configs/golf-normalize.yaml")
    >>> fit = motionedit.fit_pca(swings, {"explained_variance": 0.95})
    >>> fit.model.components.explained_variance_ratio.round(2)
    array([0.47, 0.25, 0.12, 0.05, 0.04, 0.02])
    """
    options = options_of(jobs=jobs)
    loaded = None if spec is None else load_spec(spec_of(spec), "fit-pca")
    database, read = _database(normalized)
    made = job.fit(database, loaded, options=options)
    report = report_of("fit-pca", [], spec=None if loaded is None else loaded.data, more=made.report.record)
    files = () if loaded is None else loaded.files
    return Fitted(made.model, report, tuple(made.report.warnings), inputs_of(database.tasks, (*read, *files)))


def _database(normalized: Normalized | AnyPath) -> tuple[Database, tuple[Path, ...]]:
    """Return the clips to learn from, and the files that are read beside them."""
    if isinstance(normalized, Normalized):
        meant = [clip.with_motion(clip.motion) for clip in normalized.clips]
        tasks = [ClipTask(None, clip.label, None, clip.label, clip=clip) for clip in meant]
        return Database(normalized.normalization, tasks, _IN_MEMORY, _IN_MEMORY), normalized.inputs
    folder = path_of(normalized, wanted="what normalize returned, or its folder")
    found = database_in(folder)
    return found, (folder / NAME,)
