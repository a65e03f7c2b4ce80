"""An edited clip, as both edits return it."""

from __future__ import annotations

from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from motionedit.core.bvh import Clip, parse_clip
from motionedit.dataclass import dataclass, replace
from motionedit.jobs.preview.job import page_of_edit
from motionedit.library.options import switch
from motionedit.library.outputs import contents_of, file_for, inputs_of, text_of, write_files
from motionedit.library.paths import AnyPath
from motionedit.report.record import plain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.batch.run import BatchResult
    from motionedit.spec.document import Document
    from motionedit.spec.load import LoadedSpec


@dataclass(frozen=True, eq=False)
class Edited:
    """An edited clip, which can be given to any function that takes a clip.

    Attributes
    ----------
    clip : Clip
        As the command line would have written it: `clip.motion` holds F frames (`rotations`, unit quaternions w, x, y,
        z, shape (F, J, 4), and `translations`, clip units), `clip.values` the numbers of the file, shape (F, C). Its
        label is that of the clip it was made from.
    before : Clip
        The clip it was made from; `clip` itself where nothing was changed.
    report : dict
        The clip's entry in the JSON report (`docs/files.md`), plain values: `status`, `message`, `metrics`, and
        `goals` or `constraints`. `output` is None.
    warnings : tuple of str
        The lines that the command prints after ``motionedit: warning:``.
    inputs : tuple of Path
        The files that it was made from, absolute: `write` overwrites none of them.
    spec : dict
        The spec, plain values.
    """

    clip: Clip
    before: Clip
    report: dict[str, Any]
    warnings: tuple[str, ...]
    inputs: tuple[Path, ...]
    spec: dict[str, Any]

    def write(self, path: AnyPath, *, page: bool = False) -> Path:
        """Write the clip, whole or not at all, and return the file.

        Parameters
        ----------
        path : str or path-like
            A name ending in ``.bvh`` is that file; anything else is a folder, for a file of the clip's own name.
            Folders on the way are made; a file that exists is replaced.
        page : bool
            Whether the page of `page` is written next to it, NAME.html, as `--preview` of the command does.

        Raises
        ------
        MotionEditError
            A file is an input of the edit, or cannot be written.
        """
        target = file_for(self.clip, path)
        files = {target: text_of(self.clip)}
        if switch(page, "page"):
            files[target.with_suffix(".html")] = self._page(str(target))
        write_files(files, inputs=self.inputs)
        return target

    def page(self) -> bytes:
        """Return the page of the edit, HTML of some 200 kB that needs no network: both clips, goals, errors.

        See `docs/looking-at-edits.md`. In a notebook: ``IPython.display.IFrame`` of a file, from `write`.
        """
        path = PurePath(self.clip.label)
        return self._page(str(path.with_name(f"{path.stem}-edited.bvh")))

    def _page(self, label: str) -> bytes:
        """Return the page with the clip called as a file would be."""
        return page_of_edit(self.before, replace(self.clip, label=label), self.report, self.spec)

    def __repr__(self) -> str:
        return f"<Edited {self.clip.label!r}: {self.report['status']}, {len(self.clip.motion)} frames>"


def edited(
    before: Clip, task: ClipTask, result: BatchResult, loaded: LoadedSpec[Document], files: Sequence[Path] = ()
) -> Edited:
    """Return what the run over one task came to; `files` are what it read beside the clip and the spec."""
    (content,) = contents_of(result)
    clip = before
    if content is not before.text.data:
        # Lenient, as the input may have been: an edit that changes nothing keeps its bytes.
        clip = parse_clip(content, label=task.label, lenient=True, source=task.source)
    inputs = inputs_of([task], (*loaded.files, *files))
    return Edited(clip, before, plain(result.records[0]), tuple(result.warnings), inputs, loaded.data)
