"""`motionedit.normalize`: clips of one behaviour onto one timeline."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import Any, SupportsIndex

from motionedit.core.bvh import Clip, parse_clip
from motionedit.dataclass import dataclass, replace
from motionedit.errors import UsageError
from motionedit.jobs.normalize import job
from motionedit.jobs.normalize.normalization_file import NAME, Normalization, normalization_bytes
from motionedit.library.clips import AnyClips, clip_tasks
from motionedit.library.file_errors import file_errors
from motionedit.library.options import options_of
from motionedit.library.outputs import contents_of, inputs_of, report_of, text_of, write_files
from motionedit.library.paths import AnyPath, AnySpec, path_of, spec_of
from motionedit.spec.load import load_spec


@dataclass(frozen=True, eq=False)
class Normalized:
    """Clips of one behaviour on one timeline.

    Attributes
    ----------
    clips : tuple of Clip
        One for each input, in order, all with the same skeleton, frames and rate. A label is the clip's path below the
        folder that was given, or its file's name: as `write` calls the files.
    normalization : Normalization
        What normalization.json says: the timeline, the rules, and each clip's source, events and alignment.
    report : dict
        The JSON report, plain values; `report["clips"]` has an entry for each clip.
    warnings : tuple of str
        The lines that the command prints after ``motionedit: warning:``.
    inputs : tuple of Path
        The files that they were made from, absolute: `write` overwrites none of them.
    """

    clips: tuple[Clip, ...]
    normalization: Normalization
    report: dict[str, Any]
    warnings: tuple[str, ...]
    inputs: tuple[Path, ...]

    @property
    def clip(self) -> Clip:
        """The first of `clips`; the others differ from it in their motion alone."""
        return self.clips[0]

    def write(self, folder: AnyPath) -> Path:
        """Write the clips and normalization.json into a folder, each file whole or not at all, and return the folder.

        Raises
        ------
        MotionEditError
            A file is an input, or cannot be written; or `folder` is the name of a file.
        """
        target = path_of(folder)
        if target.name.lower().endswith(".bvh"):
            raise UsageError("several files are written; give a folder", file=str(target))
        texts = [text_of(clip) for clip in self.clips]
        listed = [
            replace(each, written=sha256(text).hexdigest())
            for each, text in zip(self.normalization.clips, texts, strict=True)
        ]
        files = {target / clip.label: text for clip, text in zip(self.clips, texts, strict=True)}
        last = {target / NAME: normalization_bytes(replace(self.normalization, clips=tuple(listed)))}
        write_files(files, inputs=self.inputs, last=last)
        return target

    def __repr__(self) -> str:
        return f"<Normalized: {len(self.clips)} clips of {self.normalization.timeline.frames} frames>"


@file_errors()
def normalize(clips: AnyClips, spec: AnySpec, *, lenient: bool = False, jobs: SupportsIndex = 1) -> Normalized:
    """Return clips of one behaviour on one timeline ([PC] section 5), as `motionedit normalize` writes them.

    Parameters
    ----------
    clips : str or path-like, Clip, Edited, or several of them
        Files, folders (all their ``.bvh``) and clips in memory.
    spec : str or path-like, or mapping
        A YAML file, or the same as a mapping, in which `schema` may be left out: frames, rate, events, alignment. All
        keys: `docs/spec.md`, and ``motionedit schema normalize``.
    lenient : bool
        As for `read`, for clips that are given as paths.
    jobs : int
        Clips in parallel processes; 0 means all cores. The result is the same for any number.

    Raises
    ------
    MotionEditError
        Faults of the spec, all together; clips that cannot be read, or do not belong together: one that fails fails
        all, since each shifts the means.

    Examples
    --------
    >>> swings = motionedit.normalize("data/golf", "configs/golf-normalize.yaml")
    >>> swings.normalization.timeline.frames
    131
    """
    options = options_of(jobs=jobs, lenient=lenient)
    loaded = load_spec(spec_of(spec), "normalize")
    tasks = clip_tasks(clips)
    done = job.normalize(loaded, tasks, options=options)
    contents = contents_of(done.result)
    if done.normalization is None:
        raise AssertionError("a run without failures has a normalization")
    return Normalized(
        clips=tuple(
            parse_clip(content, label=task.relative, source=task.source)
            for task, content in zip(tasks, contents, strict=True)
        ),
        normalization=done.normalization,
        report=report_of("normalize", done.result.records, spec=loaded.data, more=done.result.more),
        warnings=tuple(done.result.warnings),
        inputs=inputs_of(tasks, loaded.files),
    )
