"""What the functions of the face make of a run: its clips or its errors, its report, files."""

from __future__ import annotations

import json
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from motionedit.errors import together
from motionedit.jobs.batch.files import clean_leftovers
from motionedit.jobs.batch.one_clip import write_file
from motionedit.jobs.batch.outputs import refuse_clashes
from motionedit.library.file_errors import file_errors
from motionedit.library.paths import AnyPath, path_of
from motionedit.report.record import report_bytes

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.batch.run import BatchResult


def contents_of(result: BatchResult) -> list[bytes]:
    """Return the clips of a run.

    Raises
    ------
    MotionEditError
        What went wrong with any of them.
    """
    if result.failures:
        raise together("clips failed", result.failures)
    return [content for content in result.contents if content is not None]


def inputs_of(tasks: Iterable[ClipTask], files: Iterable[Path]) -> tuple[Path, ...]:
    """Return the files that clips were read from, and others, by paths that hold wherever the caller goes."""
    sources = [task.source for task in tasks if task.source is not None]
    return tuple(path.absolute() for path in (*sources, *files))


def report_of(
    command: str,
    records: Iterable[dict[str, Any]],
    *,
    spec: Mapping[str, Any] | None,
    more: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return a report as its file would be read back."""
    report: dict[str, Any] = json.loads(report_bytes(command, records, spec=spec, more=more))
    return report


def file_for(clip: Clip, path: AnyPath) -> Path:
    """Return the file of a clip: a name ending in ``.bvh`` itself, in any other folder one of the clip's own name."""
    target = path_of(path)
    return target if target.name.lower().endswith(".bvh") else target / PurePath(clip.label).name


def text_of(clip: Clip) -> bytes:
    """Return the bytes of a clip's file, with the motion that it has now."""
    return clip.with_motion(clip.motion).text.data


@file_errors()
def write_files(
    files: Mapping[Path, bytes], *, inputs: Iterable[Path], last: Mapping[Path, bytes] | None = None
) -> None:
    """Write files, each whole or not at all, after it was seen that none is an input.

    Those of `last` list the others: they are removed first and written last, so that no list is of other files.

    Raises
    ------
    UsageError
        One is.
    MotionEditError
        One cannot be written.
    """
    lists = {} if last is None else dict(last)
    refuse_clashes([(path.name, path) for path in (*files, *lists)], inputs)
    clean_leftovers({path.parent for path in files})
    for path in lists:
        path.unlink(missing_ok=True)
    for path, content in (*files.items(), *lists.items()):
        write_file(path, content)
