"""The page of an edit: what `--preview` has written next to each clip."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.one_clip import Outcome, Work
    from motionedit.jobs.batch.plan import ClipTask, RunOptions


def with_page(work: Work, spec: Mapping[str, Any], options: RunOptions) -> Work:
    """Return the work with a page next to each clip that is written, where the run is to have pages."""
    return WithPage(work, spec) if options.preview and not options.dry_run else work


@dataclass(frozen=True)
class WithPage:
    """Another work, whose outcomes get a page; `spec` is the spec with `--set` applied."""

    work: Work
    spec: Mapping[str, Any]

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        """Return the work's outcome with the page of the input, the clip written, and what was asked for."""
        from motionedit.jobs.preview.job import edit_page

        outcome = self.work(clip, task)
        record = {"status": outcome.status, **outcome.record}
        return replace(outcome, page=partial(edit_page, clip, task, record, self.spec))
