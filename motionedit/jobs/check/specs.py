"""Whether a spec fits clips, as the spec's own command would say it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from motionedit.core.body.whole import path_joint
from motionedit.dataclass import dataclass, replace
from motionedit.errors import MotionEditError, UsageError
from motionedit.jobs.clip import resolve

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from motionedit.core.body.anatomy import GivenBody
    from motionedit.core.bvh import Clip
    from motionedit.core.pca.model import MotionModel
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.normalize.measures import ClipMeasure
    from motionedit.spec.load import LoadedSpec


@dataclass(frozen=True, eq=False)
class SpecCheck:
    """A spec of `command` that clips are held against.

    `others` are all of them, as event files call them; `model` is that of edit-pc, and `model_label` its file.
    """

    command: str
    loaded: LoadedSpec[Any]
    model: MotionModel | None = None
    model_label: str = ""
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

    @property
    def takes_all(self) -> bool:
        """Whether the spec's command makes one thing of all clips."""
        return self.command in ("normalize", "fit-pca")

    def refuse_unfit(self, facts: ClipFacts, task: ClipTask) -> ClipMeasure | None:
        """Raise the errors by which the spec's own command would refuse a clip; return what normalize measures of it.

        Raises
        ------
        MotionEditError
            As the spec's own command.
        """
        ways: Mapping[str, Callable[[ClipFacts, ClipTask], ClipMeasure | None]] = {
            "normalize": self._measured,
            "fit-pca": self._refuse_joints,
            "edit-pc": self._refuse_goals,
            "edit-prioritized": self._refuse_constraints,
        }
        return ways[self.command](facts, task)

    def unfit_together(self, clips: Sequence[tuple[ClipTask, ClipMeasure | None]]) -> dict[str, MotionEditError]:
        """Return why clips do not fit that fit each by itself, by their labels: what one command makes of all."""
        try:
            return self._out_of_line([(task, measure) for task, measure in clips if measure is not None])
        except MotionEditError as error:
            return {task.label: error for task, _ in clips}

    def _out_of_line(self, clips: Sequence[tuple[ClipTask, ClipMeasure]]) -> dict[str, MotionEditError]:
        if self.command == "fit-pca" and len(self.others) > 1:
            from motionedit.jobs.fit_pca.asked import refuse_too_many_components

            refuse_too_many_components(self.loaded, len(self.others))
        if self.command != "normalize" or not clips:
            return {}
        from motionedit.jobs.normalize.common_timeline import common_timeline, events_out_of_order
        from motionedit.jobs.normalize.measures import sound_measures

        measures, failures = sound_measures(*zip(*clips, strict=True))
        timeline, _ = common_timeline(self.loaded, measures)
        return failures | events_out_of_order(self.loaded, measures, timeline)

    def _measured(self, facts: ClipFacts, task: ClipTask) -> ClipMeasure:
        from motionedit.jobs.normalize.measures import MeasureClip

        return MeasureClip(self.loaded, lenient=False, others=self.others)(replace(task, clip=facts.clip))

    def _refuse_joints(self, facts: ClipFacts, task: ClipTask) -> None:
        from motionedit.jobs.fit_pca.asked import excluded_joints

        skeleton = facts.clip.motion.skeleton
        travel = path_joint(skeleton, facts.anatomy, travel=facts.travel)
        excluded_joints(self.loaded, skeleton, task.label, travel=travel)

    def _refuse_goals(self, facts: ClipFacts, task: ClipTask) -> None:
        if self.model is None:
            from motionedit.jobs.edit_pc.without_model import refuse_lacking

            refuse_lacking(self.loaded, facts, task, others=self.others)
        else:
            from motionedit.jobs.edit_pc.job import edit_by_components

            edit_by_components(self.loaded, self.model, self.model_label, self.others).ready(facts.clip, task)

    def _refuse_constraints(self, facts: ClipFacts, task: ClipTask) -> None:
        from motionedit.jobs.edit_prioritized.job import EditByPriorities

        EditByPriorities(self.loaded, self.others).ready(facts.clip, task)


def spec_check(spec: Path, model: Path | None = None, reference: str | None = None) -> SpecCheck:
    """Return what holds clips against a spec, which is read whole.

    `model` is that of edit-pc, `reference` that of edit-prioritized, as its option has it.

    Raises
    ------
    MotionEditError
        Its faults, whatever the clips are.
    UsageError
        A model or a reference stands beside a spec of another command.
    """
    from motionedit.spec import SPEC_COMMANDS
    from motionedit.spec.load import load_spec, spec_command, with_reference

    command = spec_command(spec, SPEC_COMMANDS)
    loaded: LoadedSpec[Any] = load_spec(spec, command)  # type: ignore[call-overload]  # one of them
    for option, value, owner in (("-m", model, "edit-pc"), ("--reference", reference, "edit-prioritized")):
        if value is not None and command != owner:
            raise UsageError(f"{option} {value}: {spec} is a spec of {command}; it goes with one of {owner}")
    if reference is not None:
        loaded = with_reference(loaded, reference)
    if command == "edit-prioritized":
        from motionedit.jobs.edit_prioritized.reference import refuse_unfit_reference

        refuse_unfit_reference(loaded)
    if model is None:
        return SpecCheck(command, loaded)
    from motionedit.core.pca.model_file import read_model
    from motionedit.jobs.edit_pc.job import edit_by_components

    read = read_model(model)
    edit_by_components(loaded, read, str(model), ())
    return SpecCheck(command, loaded, read, str(model))
