"""An edited clip, as both edits return it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from motionedit.core.bvh import parse_clip
from motionedit.dataclass import dataclass
from motionedit.library.inputs import path_of
from motionedit.library.outputs import contents_of, sources_of, write_files
from motionedit.report.record import plain

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.batch.run import BatchResult
    from motionedit.library.inputs import AnyPath


@dataclass(frozen=True, eq=False)
class Edited:
    """An edited clip.

    Attributes
    ----------
    clip : Clip
        As the command line would have written it: `clip.motion` holds F frames (`rotations`, unit quaternions w, x, y,
        z, shape (F, J, 4), and `translations`, clip units), `clip.values` the numbers of the file, shape (F, C). It can
        be given to any function of this module. Its label is that of the clip it was made from.
    report : dict
        The clip's entry in the JSON report (`docs/files.md`), plain values: `status`, `message`, `metrics`, and
        `goals` or `constraints`. `output` is None.
    warnings : tuple of str
        The lines that the command prints after ``motionedit: warning:``.
    inputs : tuple of Path
        The files that it was made from: `write` overwrites none of them.
    """

    clip: Clip
    report: dict[str, Any]
    warnings: tuple[str, ...]
    inputs: tuple[Path, ...]

    def write(self, path: AnyPath) -> Path:
        """Write the clip, whole or not at all, and return the file.

        Parameters
        ----------
        path : path-like
            A name ending in ``.bvh`` is that file; anything else is a folder, for a file of the clip's own name.
            Folders on the way are made; a file that exists is replaced.

        Raises
        ------
        MotionEditError
            The file is an input of the edit, or cannot be written.
        """
        target = path_of(path)
        if not target.name.lower().endswith(".bvh"):
            target /= PurePath(self.clip.label).name
        write_files({target: self.clip.text.data}, inputs=self.inputs)
        return target

    def __repr__(self) -> str:
        return f"<Edited {self.clip.label!r}: {self.report['status']}, {len(self.clip.motion)} frames>"


def edited(task: ClipTask, result: BatchResult, *, files: Sequence[Path]) -> Edited:
    """Return what the run over one task came to; `files` are what it read beside the clip."""
    (content,) = contents_of(result)
    if task.clip is not None and content is task.clip.text.data:
        clip = task.clip
    else:
        # Lenient, as the input may have been: an edit that changes nothing keeps its bytes.
        clip = replace(parse_clip(content, label=task.label, lenient=True), source=task.source)
    return Edited(clip, plain(result.records[0]), tuple(result.warnings), (*sources_of([task]), *files))
