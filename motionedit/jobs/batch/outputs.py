"""What a command may write to: no file that it reads, or twice, none of another kind, and not what is to stay."""

from __future__ import annotations

import os
import re
import stat
from typing import TYPE_CHECKING

from motionedit.errors import UsageError
from motionedit.jobs.batch.files import Places, number_of, status_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

# Endings that nobody who types one means for a file of another kind, or for a folder.
_KINDS = re.compile(
    r"\.(abc|amc|asf|blend|bvh|c3d|csv|dae|fbx|gif|glb|gltf|html|jpg|json|mp4|np[yz]|obj|png|svg|trc|txt|usd[acz]?|xml|ya?ml|zip)",
    re.IGNORECASE,
)


def is_of_another_kind(output: Path, own: str) -> bool:
    """Tell whether an output's name ends as files of a known kind do, and not as those that are written (`own`)."""
    return output.suffix.lower() != own and _KINDS.fullmatch(output.suffix) is not None


def refuse_existing(outputs: Iterable[Path | None]) -> None:
    """Raise the UsageError of --no-overwrite where any of the outputs exists.

    Standard output, which is ``-`` or None, is no file, and devices and pipes lose nothing that they hold.
    """
    files = [path for path in outputs if path is not None and str(path) != "-" and os.path.lexists(path)]
    refuse_paths([path for path in files if not _is_stream(path)], "exists, and --no-overwrite is given")


def refuse_clashes(outputs: Iterable[tuple[str, Path | None]], inputs: Iterable[Path | None]) -> None:
    """Raise a UsageError where an output is an input, by whatever name or link, or the output of something else.

    Parameters
    ----------
    outputs
        What each is, as in "the report and ... would both be written to", and where it goes. Standard output, which is
        ``-`` or None, is no file.
    inputs
        All files that are read; None is standard input.
    """
    places = Places()
    files = [
        (what, path, places.of(path), status_of(path))
        for what, path in outputs
        if path is not None and str(path) != "-"
    ]
    taken = {places.identity(path) for path in inputs if path is not None}
    refuse_paths(
        [path for _, path, place, status in files if (number_of(status) or place) in taken],
        "is an input of this run, and an input is never overwritten; write to another file or folder",
    )
    first: dict[str, tuple[str, Path]] = {}
    for what, path, place, status in files:
        if status is not None and not stat.S_ISREG(status.st_mode):
            continue  # a device takes any number of outputs; a folder is refused where it is written
        other, _ = first.setdefault(place, (what, path))
        if other is not what:
            raise UsageError(f"{other} and {what} would both be written to {path}")
    folders = {one for folder in {path.parent for _, path, _, _ in files} for one in (folder, *folder.parents)}
    both = [first[one][1] for one in map(places.of, sorted(folders)) if one in first]
    refuse_paths(both, "would be a file and the folder of other outputs; write to another file or folder")


def _is_stream(path: Path) -> bool:
    return path.is_char_device() or path.is_fifo()


def refuse_paths(paths: Sequence[Path], reason: str) -> None:
    """Raise a UsageError with the first of these paths, if any, and the number of the others."""
    if paths:
        others = f" (and {len(paths) - 1} more)" if len(paths) > 1 else ""
        raise UsageError(reason + others, file=str(paths[0]))
