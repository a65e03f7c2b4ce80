"""The job behind `motionedit edit-pc`: goals at single frames, the whole clip follows ([PC] 4.2, 4.3)."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import kinematics
from motionedit.core.body.ground import axis_name
from motionedit.core.body.steps import change_steps
from motionedit.core.bvh import edited_bytes, resampled_bytes, unedited_bytes
from motionedit.core.coefficients.projection import project, project_resampled
from motionedit.core.pca.fit import components_for
from motionedit.core.pca.model_file import read_model
from motionedit.core.pca.rules import checked_rules
from motionedit.core.skeleton_match import match_joints
from motionedit.dataclass import dataclass
from motionedit.errors import ModelError
from motionedit.jobs.batch.one_clip import Outcome
from motionedit.jobs.batch.plan import plan
from motionedit.jobs.batch.run import run_batch
from motionedit.jobs.batch.verdicts import run_key, verdicts_in
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.crop import cropped
from motionedit.jobs.clip.events import clip_warp
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.clip.kept_rules import body_said, refuse_another_up
from motionedit.jobs.clip.metrics import edit_metrics, feet_of
from motionedit.jobs.clip.roughness import rough_lines, snap_line
from motionedit.jobs.clip.unit import unit_doubts
from motionedit.jobs.edit_pc.goals import clip_goals, numbers_of
from motionedit.jobs.edit_pc.model_events import events_for_model, refuse_unknown_events
from motionedit.jobs.edit_pc.record import Judged, edit_record, goal_line
from motionedit.jobs.edit_pc.solver import plausibility_bound, residual_share
from motionedit.jobs.edit_pc.solving import Solving
from motionedit.jobs.edit_pc.unexplained import unexplained
from motionedit.jobs.preview.with_page import with_page

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.pca.model import MotionModel
    from motionedit.jobs.batch.plan import ClipTask, RunOptions
    from motionedit.jobs.batch.run import BatchResult
    from motionedit.jobs.batch.verdicts import Verdicts
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_pc.goals import ClipGoal
    from motionedit.jobs.edit_pc.holding import Holding
    from motionedit.spec.edit_pc import EditPcSpec
    from motionedit.spec.load import LoadedSpec


def run(
    loaded: LoadedSpec[EditPcSpec], clips: Sequence[Path], output: str, model: Path, options: RunOptions
) -> BatchResult:
    """Edit clips within the style of a model, and write them.

    Raises
    ------
    ModelError
        The model cannot be read.
    SpecError
        The spec asks for more components than there are, or names an event that neither it nor the model has.
    UsageError
        As `plan`.
    """
    read = read_model(model)
    key = run_key("edit-pc", loaded.data, files=(*loaded.model.event_files, model), more=options.lenient)
    verdicts = verdicts_in(output, key, update=options.update, dry_run=options.dry_run)
    tasks = plan(clips, output, options=options, depends=(*loaded.files, model), verdicts=verdicts)
    return edit(loaded, tasks, model=read, label=str(model), options=options, verdicts=verdicts)


def edit(
    loaded: LoadedSpec[EditPcSpec],
    tasks: Sequence[ClipTask],
    *,
    model: MotionModel,
    label: str,
    options: RunOptions,
    verdicts: Verdicts | None = None,
) -> BatchResult:
    """Edit the clips of tasks, and write those that have an output; `label` is what messages call the model.

    What becomes of the clips `verdicts` are told.

    Raises
    ------
    SpecError
        As `run`.
    """
    work = edit_by_components(loaded, model, label, tuple(task.relative for task in tasks))
    return run_batch(tasks, with_page(work, loaded.data, options), options, verdicts=verdicts)


def edit_by_components(
    loaded: LoadedSpec[EditPcSpec], model: MotionModel, label: str, others: tuple[str, ...]
) -> EditByComponents:
    """Return the work on one clip; `others` are all clips of the run, as event files call them.

    Raises
    ------
    ModelError
        The model is damaged.
    SpecError
        The spec asks for what the model has not.
    """
    _refuse_damaged_rules(model, label)
    refuse_another_up(loaded, axis_name(model.up), by=label)
    refuse_unknown_events(loaded, model)
    return EditByComponents(loaded, model.truncated(_component_count(loaded, model)), label, others)


def _refuse_damaged_rules(model: MotionModel, label: str) -> None:
    try:
        checked_rules(model.rules, events=dict(model.timeline.events))
    except (KeyError, ValueError) as error:
        message = "its rules are damaged; make it again with 'motionedit fit-pca'"
        raise ModelError(message, file=label) from error


def _component_count(loaded: LoadedSpec[EditPcSpec], model: MotionModel) -> int:
    spec, available = loaded.model, len(model.components.explained_variance)
    if spec.explained_variance is not None:
        return components_for(model.components.explained_variance_ratio, spec.explained_variance)
    if spec.components is not None and spec.components > available:
        message = f"the model has {available} components, not {spec.components}"
        raise loaded.error(("components",), message)
    return spec.components or available


@dataclass(frozen=True, eq=False)
class Ready:
    """A clip in a model's coordinates, its goals, and the world transforms of the motion that is edited."""

    facts: ClipFacts
    projection: Projection
    goals: list[ClipGoal]
    poses: WorldPoses


@dataclass(frozen=True)
class EditByComponents:
    """The work on one clip."""

    loaded: LoadedSpec[EditPcSpec]
    model: MotionModel
    model_label: str
    others: tuple[str, ...]

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        """Return the edited clip, and how near each goal came."""
        spec, model = self.loaded.model, self.model
        ready = self.ready(clip, task)
        facts, projection, goals = ready.facts, ready.projection, ready.goals
        bound = plausibility_bound(spec, model, projection.coefficients, asked=_asked_together(spec, goals))
        held = Solving(spec, model, facts, projection, tuple(goal.request for goal in goals), bound).edit()
        return self._outcome(facts, projection, held, goals, before=ready.poses, bound=bound)

    def ready(self, clip: Clip, task: ClipTask) -> Ready:
        """Return a clip that can be solved.

        Raises
        ------
        MotionEditError
            All that an edit of the clip is refused for.
        """
        spec, model = self.loaded.model, self.model
        facts = facts_of(
            clip,
            up=axis_name(model.up),
            keep_rest_pose=model.rules["rest_pose"] == "keep",
            given=body_said(self.loaded, model.rules, clip.motion.skeleton, label=self.model_label, clip=task.label),
        )
        facts.refuse_one_frame()
        projection, events = self._projection(facts, task)
        poses = kinematics.forward(projection.motion) if spec.timing == "normalized" else facts.poses
        return Ready(facts, projection, clip_goals(self.loaded, model, facts, events=events, poses=poses), poses)

    def _projection(self, facts: ClipFacts, task: ClipTask) -> tuple[Projection, dict[str, float]]:
        """Return a clip in the model's coordinates, and the frames of its events."""
        model, motion = self.model, facts.clip.motion
        joint_map = match_joints(
            model.skeleton,
            motion.skeleton,
            height=facts.anatomy.height,
            label=task.label,
            against=f"the model {self.model_label}",
        )
        events = events_for_model(self.loaded, model, facts, task, model_label=self.model_label, others=self.others)
        crop = model.rules.get("crop", {})
        first, last = cropped(crop, facts, resolve.Place(self.loaded, (), task.label), events=events)
        warp = clip_warp(self.loaded, model.timeline, first=first, last=last, events=events, label=task.label)
        align = model.rules["align"]
        begins = None if first == facts.first else float(first)
        alignment = facts.alignment(
            align["by"],
            heading=align["heading"],
            position=align["position"],
            at=begins if align["at"] is None else events[align["at"]],
        )
        view = partial(project, first=facts.first) if self.loaded.model.timing == "original" else project_resampled
        return view(motion, model, joint_map=joint_map, alignment=alignment, warp=warp), events

    def _outcome(
        self,
        facts: ClipFacts,
        projection: Projection,
        held: Holding,
        goals: Sequence[ClipGoal],
        *,
        before: WorldPoses,
        bound: float | None,
    ) -> Outcome:
        spec, motion, edit = self.loaded.model, facts.clip.motion, held.edit
        retimed = spec.timing == "normalized"
        changed = bool(edit.touched.any() or edit.moved.any())
        after = kinematics.forward(edit.motion) if changed else before
        traces = (feet_of(facts, [facts.poses]), None if retimed else feet_of(facts, [after]))
        steps = None if retimed else change_steps(motion, edit.motion, first=facts.first)
        odd, strange = unexplained(projection, self.model, seconds=projection.seconds)
        rough = [*strange, *held.rough]
        if traces[1] is not None and steps is not None and changed:
            turned = np.asarray(edit.touched.any(axis=0))
            rough += rough_lines(
                facts,
                edit.motion,
                touched=turned,
                steps=steps,
                traces=(traces[0], traces[1]),
                bends=facts.bends,
            )
            snap = snap_line(facts, edit.motion, touched=turned)
            rough += [] if snap is None else [snap]
        about = {
            "unit": None if spec.unit is None else spec.unit.name,
            "metrics": edit_metrics(facts, *traces, steps=steps),
        }
        share = residual_share(spec, self.model) if spec.solver.method == "map" else None
        if share is not None and self.model.components.left_out is None and spec.residual_share == "auto":
            odd.append(f"the model has no left-out error, so residual_share is {share:g}; make it again with fit-pca")
        verdicts = Judged(
            bound, share, (*facts.warnings, *unit_doubts(facts.anatomy.leg_length, spec.unit), *odd), rough
        )
        result = edit_record(self.model, projection, edit, goals, poses=after, verdicts=verdicts)
        return Outcome(
            resampled_bytes(facts.clip, edit.motion) if retimed else _edited_bytes(facts.clip, projection, edit),
            {"message": result.message, **about, **result.record, "hands": held.record},
            result.status,
            result.warnings,
            motion=edit.motion if changed or retimed else None,
            details=tuple(goal_line(goal, before) for goal in goals),
        )


def _asked_together(spec: EditPcSpec, goals: Sequence[ClipGoal]) -> int:
    """Return how many numbers goals ask for that are solved together, the most of any frame where each is by itself."""
    numbers = dict.fromkeys((goal.request.frame for goal in goals), 0)
    for goal in goals:
        numbers[goal.request.frame] += numbers_of(goal.request)
    return max(numbers.values(), default=0) if spec.coefficients == "per_goal" else sum(numbers.values())


def _edited_bytes(clip: Clip, projection: Projection, edit: CoefficientEdit) -> bytes:
    if not (edit.touched.any() or edit.moved.any()):
        return unedited_bytes(clip)
    moved = np.zeros((len(edit.motion), len(clip.motion.skeleton.translated)), dtype=np.bool_)
    moved[:, clip.motion.skeleton.translated == projection.travel] = edit.moved[:, None]
    return edited_bytes(clip, edit.motion, touched=edit.touched, moved=moved)
