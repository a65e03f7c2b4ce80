"""The job behind `motionedit preview`: clips in, one page or contact sheet out."""

from __future__ import annotations

import os
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from motionedit.dataclass import replace
from motionedit.errors import MotionEditError, UsageError, together
from motionedit.jobs.batch.files import clean_leftovers
from motionedit.jobs.batch.one_clip import read_task, write_file
from motionedit.jobs.batch.outputs import refuse_clashes
from motionedit.jobs.batch.plan import find_clips
from motionedit.jobs.preview.report_file import matches, read_report

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from motionedit.core.body.anatomy import GivenBody
    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.preview.marks import Figure
    from motionedit.jobs.preview.report_file import EditReport, Match
    from motionedit.report.preview.body import Body
    from motionedit.report.preview.marks import Edit

_PAGES = (".html",)
_SHEETS = (".png", ".svg")
# Clips whose legs differ by more than this are of different units (centimetres and metres), not of different people.
_LIKE_SIZE = 2.0
# Clips in one picture: of more a sheet is taller than any program shows, and laid over each other they are a blot.
_MOST_CLIPS = 100


def run(
    clips: Sequence[Path], output: Path, *, report: Path | None = None, up: str = "auto", lenient: bool = False
) -> list[Path]:
    """Write the picture of the clips and return the paths written, which is `output`.

    Parameters
    ----------
    clips
        Files, folders, or ``-``.
    output
        A name ending in ``.html`` (the page), ``.png`` or ``.svg`` (a contact sheet).
    report
        The JSON report of the edit that wrote some of the clips: the page shows its goals and constraints.
    up
        The axis that is up, or ``auto``.

    Raises
    ------
    UsageError
        Another ending, a clip that does not exist, an output that is an input; a sheet without matplotlib, or with a
        report; a report that cannot be read, or that fits none of the clips; more than 100 clips.
    ClipError, MotionEditErrors
        Clips that cannot be read: nothing is written; or a picture that cannot be.
    """
    kind = output.suffix.lower()
    if kind not in _PAGES + _SHEETS:
        raise UsageError("a preview is a .html page, or a .png or .svg sheet; give such a name", file=str(output))
    if report is not None and kind in _SHEETS:
        raise UsageError("--report is shown on a page; give a name ending in .html", file=str(output))
    tasks = find_clips(clips)
    refuse_clashes([("the preview", output)], [*(task.source for task in tasks), report])
    if len(tasks) > _MOST_CLIPS:
        raise UsageError(f"{len(tasks)} clips are too many for one picture; give {_MOST_CLIPS} of them at most")
    if kind in _SHEETS:
        from motionedit.report.sheet import need_matplotlib

        need_matplotlib()
    read = None if report is None else read_report(report)
    found = [] if read is None else matches(read, tasks)
    spec = {} if read is None else read.spec
    said = {**spec, "up": up} if up != "auto" else spec
    figures = _figures(_clips(tasks, lenient=lenient), _labels(tasks), said)
    edits = [] if read is None else _edits(read, found, figures)
    content = _page(figures, edits) if kind in _PAGES else _sheet(figures, kind)
    clean_leftovers([output.parent])
    write_file(output, content)
    return [output]


def edit_page(clip: Clip, task: ClipTask, record: Mapping[str, Any], spec: Mapping[str, Any]) -> bytes:
    """Return the page of one edit: the input, the clip that the task has written, and the report's `record` of it.

    The same bytes as those that `run` would write of the two files and the report.
    """
    output = str(task.output)
    written = read_task(replace(task, source=task.output, label=output), lenient=True)
    return page_of_edit(replace(clip, label=task.label), written, record, spec)


def page_of_edit(before: Clip, after: Clip, record: Mapping[str, Any], spec: Mapping[str, Any]) -> bytes:
    """Return the page of one edit: the clip that it was made from, the edited one, and the report's `record` of it."""
    from motionedit.jobs.preview.marks import edit_of
    from motionedit.report.record import plain

    figures = _figures([before, after], short_labels([before.label, after.label]), spec)
    edit = edit_of(plain(record), figures, edited=1, before=0, masses=spec.get("masses") or {}, report="--preview")
    return _page(figures, [edit])


def _page(figures: Sequence[Figure], edits: Sequence[Edit]) -> bytes:
    from motionedit.report.preview.page import page

    return page([figure.body for figure in figures], title=_title([f.body.label for f in figures]), edits=edits)


def _edits(report: EditReport, found: Sequence[Match], figures: Sequence[Figure]) -> list[Edit]:
    from motionedit.jobs.preview.marks import edit_of

    name, given = report.name, report.spec.get("masses")
    masses = given if isinstance(given, dict) else {}
    return [
        edit_of(one.record, figures, edited=one.edited, before=one.before, masses=masses, report=name) for one in found
    ]


def _sheet(figures: Sequence[Figure], kind: str) -> bytes:
    from motionedit.report.sheet import sheet

    return sheet([figure.body for figure in figures], "png" if kind == ".png" else "svg")


def _labels(tasks: Sequence[ClipTask]) -> list[str]:
    return short_labels([task.label for task in tasks])


def _clips(tasks: Sequence[ClipTask], *, lenient: bool) -> list[Clip]:
    clips: list[Clip] = []
    errors: list[MotionEditError] = []
    for task in tasks:
        try:
            clips.append(read_task(task, lenient=lenient))
        except MotionEditError as error:
            errors.append(error)
    if errors:
        raise together("clips that cannot be shown", errors)
    return clips


def _figures(clips: Sequence[Clip], labels: Sequence[str], spec: Mapping[str, Any]) -> list[Figure]:
    """Return the clips with their bodies, all at the size of the first; up and body as the spec of an edit says."""
    from motionedit.core.body.up import SIGNED_AXES
    from motionedit.jobs.clip.facts import facts_of
    from motionedit.jobs.preview.bodies import body_of
    from motionedit.jobs.preview.marks import Figure

    up = spec.get("up")
    found = [facts_of(clip, up=up if up in SIGNED_AXES else "auto", given=_body(clip, spec)) for clip in clips]
    bodies = [body_of(facts, label=label) for facts, label in zip(found, labels, strict=True)]
    return [Figure(facts, _like(bodies[0], body)) for facts, body in zip(found, bodies, strict=True)]


def _body(clip: Clip, spec: Mapping[str, Any]) -> GivenBody:
    """Return what a spec says that a clip's joints are; nothing where it says that of another skeleton."""
    from motionedit.core.body.anatomy import NOTHING_GIVEN
    from motionedit.jobs.clip.kept_rules import kept_body

    try:
        return kept_body(spec, clip.motion.skeleton, label="", clip=clip.label) if spec.get("body") else NOTHING_GIVEN
    except (MotionEditError, ValueError):
        return NOTHING_GIVEN


def _like(first: Body, body: Body) -> Body:
    """Return the body, brought to the first one's size where it is in another unit."""
    ratio = first.size / body.size
    if 1.0 / _LIKE_SIZE <= ratio <= _LIKE_SIZE:
        return body
    return replace(
        body,
        positions=body.positions * ratio,
        limbs=tuple(replace(limb, radii=(limb.radii[0] * ratio, limb.radii[1] * ratio)) for limb in body.limbs),
        hulls=tuple(replace(hull, radii=tuple(ratio * radius for radius in hull.radii)) for hull in body.hulls),
        balls=tuple(replace(ball, radius=ball.radius * ratio) for ball in body.balls),
        size=body.size * ratio,
        floor=body.floor * ratio,
        scale=ratio,
    )


def short_labels(labels: Sequence[str]) -> list[str]:
    """Return labels without suffix and without the folders that are not needed to tell them apart.

    Clips given twice keep the same label.
    """
    parts = [PurePath(os.path.normpath(label)).with_suffix("").parts for label in labels]
    deepest = max(map(len, parts))
    for depth in range(1, deepest + 1):
        short = ["/".join(names[-depth:]) for names in parts]
        if len(set(short)) == len(set(parts)):
            return short
    return list(labels)


def _title(labels: Sequence[str]) -> str:
    shown = ", ".join(labels[:2]) + (f" and {len(labels) - 2} more" if len(labels) > 2 else "")
    return f"{shown} - motionedit preview"
