"""What a run warns of: lines with their clips' names, and the kinds by which those of many clips are counted."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from motionedit.dataclass import dataclass
from motionedit.errors import MISSED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.jobs.batch.one_clip import Done
    from motionedit.jobs.batch.plan import ClipTask

# Not those within names, such as Spine1.
_NUMBER = re.compile(r"(?<!\w)[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True)
class Notice:
    """A warning: its line, and what it has in common with others of its kind; None where it is told in any case."""

    line: str
    kind: str | None = None


def notices_of(
    pairs: Sequence[tuple[ClipTask, Done]], entries: Sequence[dict[str, Any]], *, alone: bool, every: bool
) -> list[Notice]:
    """Return what is to be warned of, clip by clip.

    Two notices are of one kind where they differ in nothing but numbers and the clip's name before them. Why a clip
    missed what was asked is of no kind: each such clip is told of.

    Parameters
    ----------
    entries : sequence of dict
        Of the pairs' clips, in the report.
    alone : bool
        Whether there is one clip: then its name goes without saying.
    every : bool
        Of clips that are current, too: an earlier run told of them.
    """
    found = []
    for place, (task, one) in enumerate(pairs):
        if every or not one.current:
            reason = str(entries[place]["message"]) if one.outcome.status in MISSED else ""
            found += [_notice(task, warning, alone=alone, reason=reason) for warning in one.outcome.warnings]
    return found


def _notice(task: ClipTask, warning: str, *, alone: bool, reason: str) -> Notice:
    line = warning if alone or warning.startswith(task.label) else f"{task.label}: {warning}"
    return Notice(line, None if warning in reason else _NUMBER.sub("#", warning.removeprefix(task.label)))
