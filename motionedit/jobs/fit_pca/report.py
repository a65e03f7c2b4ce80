"""What a fit is said to have come to: its table of explained variance, the report's record, warnings and notes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.dataclass import dataclass
from motionedit.report.table import MOST_ROWS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.pca.database import FittedModel
    from motionedit.core.pca.fit import PrincipalComponents
    from motionedit.core.pca.model import MotionModel
    from motionedit.spec.fit_pca import FitPcaSpec

# A clip this many times as far from the others as the median clip is worth a word: real strokes of one player have come
# to 1.6.
ODD = 2.0
# Of the variance: what is left of it where all components are kept is rounding.
_NOTHING = 1e-9
HEADINGS = ("component", "variance", "share %", "sum %")


@dataclass(frozen=True)
class FitReport:
    """What a fit came to: the explained-variance `table` (headings, rows), the report's `record`, lines to print.

    Of many components the first have a row, unless more is asked for; a note then says what the rest explain.
    """

    table: tuple[Sequence[str], Sequence[Sequence[object]]]
    record: dict[str, Any]
    warnings: list[str]
    notes: list[str]


def fit_report(fitted: FittedModel, spec: FitPcaSpec, *, doubts: Sequence[str] = (), verbosity: int = 0) -> FitReport:
    """Return what is to be said of a fit; `doubts` are warnings of its clips."""
    model, pca = fitted.model, fitted.model.components
    record = {
        "frames": model.timeline.frames,
        "frame_rate": model.timeline.frame_rate,
        "degrees_of_freedom": model.space.size,
        "explained_variance": pca.explained_variance,
        "explained_variance_ratio": pca.explained_variance_ratio,
        "database": [
            {"clip": clip.name, "coefficients": a} for clip, a in zip(model.clips, pca.coefficients, strict=True)
        ],
    }
    left_out = pca.left_out
    if left_out is not None:
        record["left_out"] = {
            "share": left_out.share,
            "furthest": model.clips[left_out.furthest].name,
            "clips": [
                {"clip": clip.name, "share": share, "times": times}
                for clip, share, times in zip(model.clips, left_out.shares, left_out.times, strict=True)
            ],
        }
    if fitted.streamed is not None:
        record["streamed"] = {"passes": fitted.streamed.passes, "residual": fitted.streamed.residual}
    warnings = [*doubts, *_warnings(fitted, spec)]
    record["warnings"] = warnings
    rows = _rows(pca)
    shown = rows if verbosity > 0 else rows[:MOST_ROWS]
    notes = [*_rest_note(pca, len(shown)), *_notes(fitted, spec)]
    return FitReport((HEADINGS, shown), record, warnings, notes)


def _rows(pca: PrincipalComponents) -> list[tuple[object, ...]]:
    shares = pca.explained_variance_ratio
    return [
        (i + 1, float(variance), f"{100 * share:.2f}", f"{100 * total:.2f}")
        for i, (variance, share, total) in enumerate(
            zip(pca.explained_variance, shares, np.cumsum(shares), strict=True)
        )
    ]


def _rest_note(pca: PrincipalComponents, shown: int) -> list[str]:
    """Return what the components that have no row explain."""
    rest = pca.explained_variance_ratio[shown:]
    if not len(rest):
        return []
    more = f"{len(rest)} more components explain {100.0 * float(rest.sum()):.3g} % of the variance"
    return [
        f"{more}; -v lists them, and with components or explained_variance in the spec edits have fewer to solve for"
    ]


def _warnings(fitted: FittedModel, spec: FitPcaSpec) -> list[str]:
    warnings = [
        f"{each.clip}: '{each.joint}' turns the other way round than in most clips ({each.degrees:.0f} degrees off); "
        "if that is a capture defect, leave it out with exclude_joints"
        for each in fitted.windings
    ]
    warnings += _odd_clip(fitted.model)
    shares = fitted.model.components.explained_variance_ratio
    explained = float(np.cumsum(shares)[-1])
    if spec.explained_variance is not None and explained < spec.explained_variance - 1e-9:
        warnings.append(
            f"the first {len(shares)} components explain {100 * explained:.2f} % of the variance, not "
            f"{100 * spec.explained_variance:g} %; no more are kept of so many clips"
        )
    if spec.events:
        warnings.append("events: nothing is taken from them; a model has the events of its normalized clips")
    return warnings


def _odd_clip(model: MotionModel) -> list[str]:
    """Return a warning of the clip that lies further from all others than clips of one behaviour do."""
    left_out = model.components.left_out
    if left_out is None or len(model.clips) < 4:
        return []
    times = float(left_out.times[left_out.furthest])
    if times <= ODD:
        return []
    name = model.clips[left_out.furthest].name
    far = f"{name}: {times:.3g} times as far from the others as the median clip"
    return [f"{far}; is it one of them, and were its events found rightly?"]


def _left_out_note(model: MotionModel) -> list[str]:
    """Return what the database says of a clip that it does not hold."""
    left_out = model.components.left_out
    if left_out is None:
        return []
    furthest = model.clips[left_out.furthest].name
    times = left_out.times[left_out.furthest]
    share = f"left out in turn, {100.0 * left_out.share:.3g} % of a clip is not explained by the others"
    gone = 1.0 - float(model.components.explained_variance_ratio.sum())
    kept = f" ({100.0 * gone:.3g} % of the variance is beyond the components kept)" if gone > _NOTHING else ""
    return [f"{share}{kept}; furthest from them: {furthest}, {times:.3g} times the median"]


def _notes(fitted: FittedModel, spec: FitPcaSpec) -> list[str]:
    """Return what the database says of unseen clips and, where it was streamed, in how many passes it was learnt."""
    streamed, model = fitted.streamed, fitted.model
    notes = _left_out_note(model)
    if streamed is None:
        return notes
    kept = f"the first {len(model.components.explained_variance)} components"
    if spec.components is None and spec.explained_variance is None:
        kept += " (set components or explained_variance for another number)"
    passes = f"in {streamed.passes} passes, each to {streamed.residual:.0e} of the first's variance"
    return [*notes, f"{len(model.clips)} clips, streamed from a scratch file: {kept}, {passes}"]
