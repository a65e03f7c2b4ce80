"""What a spec names and a clip lacks, as the spec's own command would say it."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from motionedit.dataclass import dataclass, replace
from motionedit.jobs.clip import resolve

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from motionedit.core.body.anatomy import GivenBody
    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.spec.load import LoadedSpec


@dataclass(frozen=True)
class SpecCheck:
    """A spec of `command` that clips are held against; `others` are all of them, as event files call them."""

    command: str
    loaded: LoadedSpec[Any]
    others: tuple[str, ...] = ()

    def body_in(self, clip: Clip, task: ClipTask) -> GivenBody:
        """Return what the spec says that joints of a clip are.

        Raises
        ------
        SpecError, MotionEditErrors
            The clip lacks them.
        """
        place = resolve.Place(self.loaded, ("body",), task.label)
        return resolve.body(self.loaded.model.body, clip.motion.skeleton, place)

    def refuse_lacking(self, facts: ClipFacts, task: ClipTask) -> None:
        """Raise the errors of all that the spec names and the clip lacks.

        Raises
        ------
        MotionEditError
            As the spec's own command.
        """
        holds: dict[str, Callable[[], None]] = {
            "normalize": partial(self._measure, facts.clip, task),
            "fit-pca": partial(self._exclude, facts.clip, task),
            "edit-pc": partial(self._place_goals, facts, task),
            "edit-prioritized": partial(self._place_constraints, facts.clip, task),
        }
        holds[self.command]()

    def _measure(self, clip: Clip, task: ClipTask) -> None:
        from motionedit.jobs.normalize.measures import MeasureClip

        MeasureClip(self.loaded, lenient=False, others=self.others)(replace(task, clip=clip))

    def _exclude(self, clip: Clip, task: ClipTask) -> None:
        from motionedit.jobs.fit_pca.excluded import excluded_joints

        excluded_joints(self.loaded, clip.motion, task.label)

    def _place_goals(self, facts: ClipFacts, task: ClipTask) -> None:
        from motionedit.jobs.edit_pc.without_model import refuse_lacking

        refuse_lacking(self.loaded, facts, task, others=self.others)

    def _place_constraints(self, clip: Clip, task: ClipTask) -> None:
        from motionedit.jobs.edit_prioritized.job import EditByPriorities

        EditByPriorities(self.loaded, self.others).resolved(clip, task)


def spec_check(spec: Path) -> SpecCheck:
    """Return what holds clips against a spec, which is read whole.

    Raises
    ------
    MotionEditError
        Its faults.
    """
    from motionedit.spec import SPEC_COMMANDS
    from motionedit.spec.load import load_spec, spec_command

    command = spec_command(spec, SPEC_COMMANDS)
    return SpecCheck(command, load_spec(spec, command))  # type: ignore[call-overload]  # one of them
