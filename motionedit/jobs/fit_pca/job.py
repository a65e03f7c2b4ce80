"""The job behind `motionedit fit-pca`: normalized clips in, a motion PCA model out ([PC] 4.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.body.bones import travel_joint
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.body.ground import axis_vector
from motionedit.core.body.whole import path_joint
from motionedit.core.pca.database import FitSettings, build_model, database_space
from motionedit.core.pca.fit import AllTheSameError, ComponentCount, TooFewComponentsError
from motionedit.core.pca.model_file import model_bytes
from motionedit.dataclass import dataclass
from motionedit.errors import ModelError, UsageError
from motionedit.jobs.batch.files import clean_leftovers
from motionedit.jobs.batch.one_clip import write_file
from motionedit.jobs.batch.outputs import is_of_another_kind, refuse_clashes
from motionedit.jobs.batch.pool import threads_within
from motionedit.jobs.clip.kept_rules import body_said, kept_body, refuse_another_up, with_body
from motionedit.jobs.clip.unit import unit_doubts
from motionedit.jobs.fit_pca.asked import excluded_joints, too_few_components
from motionedit.jobs.fit_pca.database import Motions, database_in
from motionedit.jobs.fit_pca.report import fit_report
from motionedit.jobs.normalize.normalization_file import NAME
from motionedit.spec.fit_pca import FitPcaSpec

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.core.body.anatomy import GivenBody
    from motionedit.core.pca.model import MotionModel
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.batch.plan import RunOptions
    from motionedit.jobs.fit_pca.database import Database
    from motionedit.jobs.fit_pca.report import FitReport
    from motionedit.spec.load import LoadedSpec


@dataclass(frozen=True, eq=False)
class Fit:
    """A model, and what is to be said of it."""

    model: MotionModel
    report: FitReport


def run(folder: Path, output: Path, loaded: LoadedSpec[FitPcaSpec] | None, options: RunOptions) -> FitReport:
    """Fit a model to the clips that a folder's normalization.json lists, and write it; see `fit`.

    Raises
    ------
    UsageError
        The output is an input, or has the name of another kind of file.
    """
    database = database_in(folder)
    sources = [task.source for task in database.tasks]
    written = [("the model", output), ("the report", options.report)]
    refuse_clashes(written, [*sources, folder / NAME, *(() if loaded is None else loaded.files)])
    if is_of_another_kind(output, ".npz"):
        message = f"a model is written as .npz, not as {output.suffix}; give such a name"
        raise UsageError(message, file=str(output))
    made = fit(database, loaded, options=options)
    clean_leftovers([output.parent])
    write_file(output, model_bytes(made.model))
    return made.report


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
    motions = Motions(database, options)
    first = motions.first
    if loaded is not None:
        refuse_another_up(loaded, normalization.up, by=database.list_label)
    anatomy = anatomy_of(first, given=_body(loaded, database, first.skeleton))
    travel = path_joint(first.skeleton, anatomy, travel=travel_joint(first))
    settings = FitSettings(
        representation="centred" if spec.rotation == "centred" else "exponential",
        root_weight=spec.root_weight,
        excluded=excluded_joints(loaded, first.skeleton, database.label, travel=travel),
        components=ComponentCount(spec.components, spec.explained_variance),
        threads=threads_within(1, options),
    )
    space = database_space(first, travel=travel, leg_length=anatomy.leg_length, settings=settings)
    try:
        fitted = build_model(
            motions.vectors(space),
            count,
            of=space,
            timeline=normalization.timeline,
            up=axis_vector(normalization.up),
            settings=settings,
            rules=with_body(normalization.rules, spec.body),
        )
    except TooFewComponentsError as error:
        raise too_few_components(loaded, spec, count, error.available) from None
    except AllTheSameError as error:
        raise ModelError(f"{error}: there is nothing to learn; give clips that differ", file=database.label) from error
    doubts = unit_doubts(anatomy.leg_length, spec.unit)
    return Fit(fitted.model, fit_report(fitted, spec, doubts=doubts, verbosity=options.verbosity))


def _body(loaded: LoadedSpec[FitPcaSpec] | None, database: Database, skeleton: Skeleton) -> GivenBody:
    """Return what the spec says that joints are, and of what it does not say what the normalization's rules say."""
    rules, where = database.normalization.rules, {"label": database.list_label, "clip": database.label}
    if loaded is None:
        return kept_body(rules, skeleton, **where)
    return body_said(loaded, rules, skeleton, **where)
