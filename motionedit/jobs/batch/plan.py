"""What a run is to do: its options, the clips it takes, and where each of them goes."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

from motionedit.dataclass import dataclass, replace
from motionedit.errors import UsageError
from motionedit.jobs.batch.current import nothing_is_newer, stamp_of
from motionedit.jobs.batch.files import identity
from motionedit.jobs.batch.outputs import is_of_another_kind, refuse_clashes, refuse_existing, refuse_paths

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from contextlib import AbstractContextManager

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.shards import Shard
    from motionedit.jobs.batch.verdicts import Verdict, Verdicts

STDIN_LABEL = "<stdin>"


@contextlib.contextmanager
def no_progress(_length: int) -> Iterator[Callable[[], None]]:
    """Show nothing: the progress of runs that nobody watches."""
    yield lambda: None


@dataclass(frozen=True)
class RunOptions:
    """How a run goes about its clips; what is done to them stands in the spec.

    Attributes
    ----------
    jobs : int
        Clips in parallel; 0 means all cores.
    scheduler : str or None
        Address of a Dask scheduler that takes the place of `jobs`.
    shard : Shard or None
        Work on the clips of this shard alone.
    update : bool
        Leave outputs alone that are newer than all they depend on.
    overwrite : bool
        Outputs and a report that exist are replaced.
    keep_going : bool
        Go on past a clip that fails.
    lenient, verify : bool
        Accept clips with a wrong `Frames:`; read each output back with bvhio.
    strict : bool
        A goal out of tolerance gives exit code 3.
    preview : bool
        A page next to each clip that is written.
    dry_run : bool
        Write nothing.
    verbosity : int
        0 as usual, below it less, above it more; from 2 on an error that is no user's is raised as it is.
    report : Path or None
        The JSON report, a file that is to be neither a clip nor an output.
    report_frames : bool or None
        What is told frame by frame stays in the records; None: where there is one clip alone.
    progress : callable
        Given the number of clips, a context manager whose value is called once per finished clip.
    """

    jobs: int = 1
    scheduler: str | None = None
    shard: Shard | None = None
    update: bool = False
    overwrite: bool = True
    keep_going: bool = True
    lenient: bool = False
    strict: bool = False
    preview: bool = False
    dry_run: bool = False
    verify: bool = False
    verbosity: int = 0
    report: Path | None = None
    report_frames: bool | None = None
    progress: Callable[[int], AbstractContextManager[Callable[[], None]]] = no_progress

    def tells_frames(self, clips: int) -> bool:
        """Tell whether the report of so many clips, those of all shards, has what is told frame by frame."""
        return clips == 1 if self.report_frames is None else self.report_frames


@dataclass(frozen=True)
class ClipTask:
    """One clip of a run.

    Attributes
    ----------
    source : Path or None
        None is standard input.
    label : str
        The clip's path as the user would write it, for messages.
    output : Path or None
        None is standard output (or, from `find_clips`, nowhere).
    relative : str
        Path below the given folder with forward slashes, or the file's name: what event files call the clip.
    current : bool
        With `update`: the output is newer than all it depends on, and stays as it is; and so is its page.
    elsewhere : bool
        With `shard`: it belongs to another shard, and is here for what is asked of all names together.
    page : Path or None
        With `preview`: the page next to the output.
    verdict : Verdict or None
        Of a current output, where verdicts are kept: what the run that made it had to say of it.
    stamp : tuple of int, or None
        Where verdicts are kept: size and time (ns) of the clip's file, before anything was read.
    clip : Clip or None
        The clip itself, where it is in memory already: then nothing is read.
    """

    source: Path | None
    label: str
    output: Path | None
    relative: str
    current: bool = False
    elsewhere: bool = False
    page: Path | None = None
    verdict: Verdict | None = None
    stamp: tuple[int, int] | None = None
    clip: Clip | None = None

    @property
    def outputs(self) -> list[Path]:
        """The files that it writes."""
        return [path for path in (self.output, self.page) if path is not None]


def find_clips(clips: Sequence[Path], *, leave_out: Path | None = None) -> list[ClipTask]:
    """Return the clips that files, folders and ``-`` (standard input) stand for, without outputs.

    A folder stands for every ``*.bvh`` below it, in any case, sorted by path. Hidden files and folders are left
    out, and so is `leave_out`, where the outputs go.

    Raises
    ------
    UsageError
        Something given does not exist, a folder holds no clip, or ``-`` is given twice.
    """
    refuse_missing(clips)
    if sum(str(path) == "-" for path in clips) > 1:
        raise UsageError("standard input ('-') can be read only once")
    return [task for path in clips for task in _expand(path, leave_out)]


def folder_clips(folder: Path, *, leave_out: Path | None = None) -> list[ClipTask]:
    """Return the clips of one folder as `find_clips` does, none where it has none."""
    found = sorted(_clips_below(folder, leave_out))
    if leave_out is not None and os.path.lexists(leave_out) and not leave_out.is_dir():
        # An output of an earlier run inside the folder is no clip, unless it is all there is: then it is refused.
        left_out = identity(leave_out)
        found = [(name, clip) for name, clip in found if identity(clip) != left_out] or found
    return [ClipTask(clip, str(clip), None, name) for name, clip in found]


def shared_out(tasks: list[ClipTask], shard: Shard | None) -> list[ClipTask]:
    """Return tasks with those that belong to other shards marked so; without a shard, as they are.

    Raises
    ------
    UsageError
        One is of standard input, which has no name to go by.
    """
    if shard is None:
        return tasks
    if any(task.source is None for task in tasks):
        raise UsageError("--shard goes by the names of clips: it does not go with '-'")
    return [task if shard.has(task.relative) else replace(task, elsewhere=True) for task in tasks]


def plan(
    clips: Sequence[Path],
    output: str,
    *,
    options: RunOptions,
    depends: Sequence[Path] = (),
    writes: Sequence[tuple[str, Path]] = (),
    verdicts: Verdicts | None = None,
    found: list[ClipTask] | None = None,
) -> list[ClipTask]:
    """Return one task per clip, every rule about files checked before any work.

    Parameters
    ----------
    clips
        Files, folders, or ``-``.
    output
        A name ending in ``.bvh`` is that file, ``-`` is standard output, anything else is a folder.
    depends
        The spec, model and event files: none of them is overwritten, and `update` compares times with them.
    writes
        What the run writes beside clips, pages and report: what it is, and its file.
    verdicts
        What is known of earlier outputs: with `update` those of which nothing is are made again.
    found
        What `find_clips` found of the clips, where that was asked already.

    Raises
    ------
    UsageError
        As `find_clips`; several clips for one output; an output that is an input; an output that exists where
        `overwrite` is off; `update` or `shard` with standard input or output; `scheduler` with standard input;
        `preview` with standard output.
    """
    if found is None:
        found = find_clips(clips, leave_out=None if output == "-" else Path(output))
    if options.update and (output == "-" or any(task.source is None for task in found)):
        raise UsageError("--update compares the times of files: it does not go with '-'")
    if options.scheduler is not None and any(task.source is None for task in found):
        raise UsageError("--scheduler gives files to workers elsewhere: it does not go with '-'")
    if options.preview and output == "-":
        raise UsageError("--preview writes a page next to each clip: it does not go with -o -")
    if options.shard is not None and output == "-":
        raise UsageError("--shard is for many clips: it does not go with -o -")
    sources = [task.source for task in found if task.source is not None]
    broken = [source for source in sources if not {"\n", "\r"}.isdisjoint(str(source))]
    refuse_paths(broken, "a line break in its name: files are listed one a line; rename it")
    tasks = _with_outputs(found, output)
    if options.preview:
        tasks = [replace(task, page=task.output and task.output.with_suffix(".html")) for task in tasks]
    outputs = [(task.label, path) for task in tasks for path in task.outputs]
    inputs = [task.source for task in tasks]
    kept = [] if verdicts is None else [("what --update remembers", verdicts.path)]
    refuse_clashes([("the report", options.report), *writes, *kept, *outputs], [*inputs, *depends])
    # Only now: whether two clips go to one file, every shard says.
    tasks = shared_out(tasks, options.shard)
    if verdicts is not None:
        tasks = [replace(task, stamp=stamp_of(task.source)) for task in tasks]
    if options.update:
        tasks = [_recalled(task, depends, options, verdicts, clips=len(tasks)) for task in tasks]
    if not options.overwrite:
        made = [task for task in tasks if not (task.current or task.elsewhere)]
        written = [path for task in made for path in task.outputs] + [path for _, path in writes if made]
        refuse_existing([*written, options.report])
    return tasks


def refuse_missing(clips: Sequence[Path]) -> None:
    """Raise a UsageError where a clip or folder does not exist; ``-`` always does."""
    refuse_paths([p for p in clips if str(p) != "-" and not p.exists()], "no such file or folder")


def _expand(path: Path, leave_out: Path | None) -> list[ClipTask]:
    if str(path) == "-":
        return [ClipTask(None, STDIN_LABEL, None, STDIN_LABEL)]
    if not path.is_dir():
        return [ClipTask(path, str(path), None, path.name)]
    found = folder_clips(path, leave_out=leave_out)
    if not found:
        raise UsageError("no .bvh file in this folder", file=str(path))
    return found


def _clips_below(top: Path, leave_out: Path | None) -> Iterator[tuple[str, Path]]:
    """Yield the clips of a folder: the path below it with forward slashes, and the whole one."""
    left_out = None if leave_out is None else identity(leave_out)

    def refuse(error: OSError) -> None:
        raise error

    for folder, subfolders, names in os.walk(top, onerror=refuse):
        subfolders[:] = [
            name for name in subfolders if not name.startswith(".") and identity(Path(folder, name)) != left_out
        ]
        here = Path(folder)
        below = "" if here == top else f"{here.relative_to(top).as_posix()}/"
        for name in names:
            if name.lower().endswith(".bvh") and not name.startswith("."):
                yield below + name, here / name


def _with_outputs(tasks: list[ClipTask], output: str) -> list[ClipTask]:
    single = output == "-" or output.lower().endswith(".bvh")
    if single and len(tasks) != 1:
        what = "standard output" if output == "-" else output
        raise UsageError(f"-o {output}: {len(tasks)} clips cannot go to {what}; give a folder")
    if output == "-":
        return tasks
    target = Path(output)
    if single:
        if target.is_dir():
            raise UsageError("is a folder, but its name ends in .bvh: give a file or another folder", file=output)
        return [replace(tasks[0], output=target)]
    if target.exists() and not target.is_dir():
        raise UsageError("is a file; give a folder, or a name ending in .bvh for one clip", file=output)
    if is_of_another_kind(target, ".bvh") and not target.is_dir():
        message = f"clips are written as .bvh, not as {target.suffix}; give such a name, or a folder"
        raise UsageError(message, file=output)
    if any(task.source is None for task in tasks):
        raise UsageError("a clip from standard input has no name: give -o FILE.bvh or -o -")
    return [replace(task, output=target / task.relative) for task in tasks]


def _recalled(
    task: ClipTask, depends: Sequence[Path], options: RunOptions, verdicts: Verdicts | None, *, clips: int
) -> ClipTask:
    """Return a task; current where nothing is newer than its output, and all is known that this run is to say of it."""
    if task.elsewhere or task.output is None or task.source is None:
        return task
    if not nothing_is_newer(task.outputs, [task.source, *depends]):
        return task
    if verdicts is None:
        return replace(task, current=True)
    frames = None if options.report is None else options.tells_frames(clips)
    verdict = verdicts.recall(task.output, stamp=task.stamp, frames=frames, verify=options.verify)
    return replace(task, current=verdict is not None, verdict=verdict)
