"""The job behind `motionedit preview`: clips in, one page or contact sheet out."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING

from motionedit.errors import MotionEditError, MotionEditErrors, UsageError
from motionedit.jobs.batch import read_task
from motionedit.jobs.files import atomic_write
from motionedit.jobs.plan import find_clips, refuse_overwriting

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.jobs.plan import ClipTask
    from motionedit.report.preview.body import Body

_PAGES = (".html",)
_SHEETS = (".png", ".svg")
# Clips whose legs differ by more than this are of different units (centimetres and metres), not of different people.
_LIKE_SIZE = 2.0


def run(clips: Sequence[Path], output: Path, *, lenient: bool = False) -> list[Path]:
    """Write the picture of the clips and return the paths written, which is `output`.

    Parameters
    ----------
    clips
        Files, folders, or ``-``.
    output
        A name ending in ``.html`` (the page), ``.png`` or ``.svg`` (a contact sheet).

    Raises
    ------
    UsageError
        Another ending, a clip that does not exist, an output that is an input; a sheet without matplotlib.
    ClipError, MotionEditErrors
        Clips that cannot be read: nothing is written.
    """
    kind = output.suffix.lower()
    if kind not in _PAGES + _SHEETS:
        raise UsageError("a preview is a .html page, or a .png or .svg sheet; give such a name", file=str(output))
    tasks = find_clips(clips)
    refuse_overwriting([output], [task.source for task in tasks if task.source is not None])
    if kind in _SHEETS:
        from motionedit.report.sheet import need_matplotlib

        need_matplotlib()
    bodies = _bodies(tasks, lenient=lenient)
    try:
        atomic_write(output, _drawn(bodies, kind))
    except OSError as error:
        raise UsageError(f"cannot be written: {error.strerror or error}", file=str(output)) from error
    return [output]


def _drawn(bodies: Sequence[Body], kind: str) -> bytes:
    if kind in _PAGES:
        from motionedit.report.preview.page import page

        return page(bodies, title=_title([body.label for body in bodies]))
    from motionedit.report.sheet import sheet

    return sheet(bodies, "png" if kind == ".png" else "svg")


def _bodies(tasks: Sequence[ClipTask], *, lenient: bool) -> list[Body]:
    from motionedit.jobs.bodies import body_of
    from motionedit.jobs.clip_facts import facts_of

    bodies: list[Body] = []
    errors: list[MotionEditError] = []
    for task, label in zip(tasks, short_labels([task.label for task in tasks]), strict=True):
        try:
            bodies.append(body_of(facts_of(read_task(task, lenient=lenient)), label=label))
        except MotionEditError as error:
            errors.append(error)
    if len(errors) == 1:
        raise errors[0]
    if errors:
        raise MotionEditErrors("clips that cannot be shown", errors)
    return [_like(bodies[0], body) for body in bodies]


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
