"""`motionedit.fit_pca`: normalized clips in, a motion PCA model out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from motionedit.core.pca.model_file import model_bytes
from motionedit.dataclass import dataclass
from motionedit.errors import UsageError
from motionedit.jobs import fit_pca as job
from motionedit.jobs.batch.plan import ClipTask
from motionedit.jobs.normalize.normalization_file import NAME
from motionedit.library.file_errors import file_errors
from motionedit.library.inputs import options_of, path_of, spec_of
from motionedit.library.mean_clip import mean_clip
from motionedit.library.normalize import Normalized
from motionedit.library.outputs import report_of, sources_of, write_files
from motionedit.spec.load import load_spec

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.core.pca.model import MotionModel
    from motionedit.library.inputs import AnyPath, AnySpec

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
        The files that it was made from: `write` overwrites none of them.
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
def fit_pca(normalized: Normalized | AnyPath, spec: AnySpec | None = None, *, jobs: int = 1) -> Fitted:
    """Return a motion PCA model of normalized clips ([PC] 4.1), as `motionedit fit-pca` writes it.

    Parameters
    ----------
    normalized : Normalized or path-like
        What `normalize` returned, or the folder that it or the command wrote.
    spec : path-like or mapping, optional
        As for `normalize`; all components if not given.
    jobs : int
        As for `normalize`.

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
    loaded = None if spec is None else load_spec(spec_of(spec), "fit-pca")
    database, sources = _database(normalized)
    made = job.fit(database, loaded, options=options_of(jobs=jobs))
    report = report_of("fit-pca", [], spec=None if loaded is None else loaded.data, more=made.report.record)
    files = () if loaded is None else loaded.files
    return Fitted(made.model, report, tuple(made.report.warnings), (*sources, *files))


def _database(normalized: Normalized | AnyPath) -> tuple[job.Database, tuple[Path, ...]]:
    """Return the clips to learn from, and the files that they are read from."""
    if isinstance(normalized, Normalized):
        tasks = [ClipTask(None, clip.label, None, clip.label, clip=clip) for clip in normalized.clips]
        return job.Database(normalized.normalization, tasks, _IN_MEMORY, _IN_MEMORY), normalized.inputs
    folder = path_of(normalized, wanted="what normalize returned, or its folder")
    found = job.database_in(folder)
    return found, (*sources_of(found.tasks), folder / NAME)
