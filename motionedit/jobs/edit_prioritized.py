"""The job behind `motionedit edit-prioritized`: the spec checked against each clip, each clip edited and written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from motionedit.core.bvh import unedited_bytes
from motionedit.errors import MotionEditErrors, SpecError
from motionedit.jobs import resolve
from motionedit.jobs.batch import Outcome, plan, run_batch
from motionedit.jobs.clip_facts import facts_of
from motionedit.jobs.edit_metrics import edit_metrics

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch import BatchResult, ClipTask, RunOptions
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec


def run(
    loaded: LoadedSpec[EditPrioritizedSpec], clips: Sequence[Path], output: str, options: RunOptions
) -> BatchResult:
    """Edit clips by a spec and write them.

    Raises
    ------
    SpecError
        The spec has constraints, which are not supported yet.
    UsageError
        As `plan`.
    """
    tasks = plan(clips, output, options=options, depends=loaded.files)
    if loaded.model.constraints:
        raise loaded.error(("constraints", 0), "not supported yet; an empty list copies the clips")
    return run_batch(tasks, _Edit(loaded), options)


@dataclass(frozen=True)
class _Edit:
    """The work on one clip: with no constraints, the same bytes."""

    loaded: LoadedSpec[EditPrioritizedSpec]

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        """Return the clip's own bytes."""
        del task
        _check_joints(self.loaded, clip)
        facts = facts_of(clip)
        record: dict[str, Any] = {
            "unit": self.loaded.data.get("unit"),
            "metrics": edit_metrics(facts, facts.poses.positions),
            "constraints": [],
        }
        return Outcome(unedited_bytes(clip), record, details=("no constraints: the same bytes",))


def _check_joints(loaded: LoadedSpec[EditPrioritizedSpec], clip: Clip) -> None:
    """Raise all errors of joints that the spec names and the clip lacks."""
    hinges = loaded.model.hinges
    named: list[tuple[tuple[str | int, ...], str]] = [(("masses", name), name) for name in loaded.model.masses]
    named += [(("hinges", i), name) for i, name in enumerate(hinges) if not isinstance(hinges, str)]
    errors = []
    for keys, name in named:
        try:
            resolve.joint(name, clip.motion.skeleton, resolve.Place(loaded, keys, clip.label))
        except SpecError as error:
            errors.append(error)
    if errors:
        raise MotionEditErrors(f"joints that {clip.label} lacks", errors)
