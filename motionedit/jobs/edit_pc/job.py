"""The job behind `motionedit edit-pc`: goals at single frames, the whole clip follows ([PC] 4.2, 4.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import kinematics
from motionedit.core.body.ground import axis_name
from motionedit.core.bvh import edited_bytes, resampled_bytes, unedited_bytes
from motionedit.core.coefficients.edit import CoefficientEdit, Damped, GaussNewton, edit_by_coefficients
from motionedit.core.coefficients.projection import Projection, project, project_resampled
from motionedit.core.pca.fit import components_for
from motionedit.core.pca.model_file import read_model
from motionedit.core.skeleton_match import match_joints
from motionedit.core.timeline import round_half_up
from motionedit.core.timeline.warp import make_warp
from motionedit.dataclass import dataclass
from motionedit.errors import ClipError
from motionedit.jobs.batch.one_clip import Outcome
from motionedit.jobs.batch.plan import plan
from motionedit.jobs.batch.run import run_batch
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.clip.metrics import edit_metrics, feet_of
from motionedit.jobs.edit_pc.goals import ClipGoal, clip_goal
from motionedit.jobs.edit_pc.model_events import events_for_model, refuse_unknown_events
from motionedit.jobs.edit_pc.record import edit_record, goal_line, largest_norm
from motionedit.jobs.preview.with_page import WithPage

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.arrays import IntArray
    from motionedit.core.bvh import Clip
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.pca.model import MotionModel
    from motionedit.jobs.batch.plan import ClipTask, RunOptions
    from motionedit.jobs.batch.run import BatchResult
    from motionedit.jobs.clip.facts import ClipFacts
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
    tasks = plan(clips, output, options=options, depends=(*loaded.files, model))
    full = read_model(model)
    refuse_unknown_events(loaded, full)
    cut = full.truncated(_component_count(loaded, full))
    others = tuple(task.relative for task in tasks)
    work = _Edit(loaded, cut, str(model), others)
    return run_batch(tasks, WithPage(work, loaded.data) if options.preview and not options.dry_run else work, options)


def _component_count(loaded: LoadedSpec[EditPcSpec], model: MotionModel) -> int:
    spec, available = loaded.model, len(model.components.explained_variance)
    if spec.explained_variance is not None:
        return components_for(model.components.explained_variance_ratio, spec.explained_variance)
    if spec.components is not None and spec.components > available:
        message = f"the model has {available} components, not {spec.components}"
        raise loaded.error(("components",), message)
    return spec.components or available


@dataclass(frozen=True)
class _Edit:
    """The work on one clip."""

    loaded: LoadedSpec[EditPcSpec]
    model: MotionModel
    model_label: str
    others: tuple[str, ...]

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        spec, model = self.loaded.model, self.model
        facts = facts_of(clip, up=axis_name(model.up), keep_rest_pose=model.rules["rest_pose"] == "keep")
        if facts.last - facts.first < 1:
            raise ClipError("has one frame; a motion needs two", file=task.label)
        joint_map = match_joints(
            model.skeleton,
            clip.motion.skeleton,
            height=facts.anatomy.height,
            label=task.label,
            against=f"the model {self.model_label}",
        )
        events = events_for_model(self.loaded, model, facts, task, model_label=self.model_label, others=self.others)
        projection = self._projection(facts, task, events, joint_map)
        goals, poses = self._goals(facts, projection, task, events)
        edit = edit_by_coefficients(
            projection,
            model,
            [goal.request for goal in goals],
            solver=self._solver(projection),
            residual="keep" if spec.residual == "keep" else "drop",
            first=facts.first if spec.timing == "original" else 0,
        )
        return self._outcome(facts, projection, edit, goals, before=poses)

    def _projection(
        self, facts: ClipFacts, task: ClipTask, events: dict[str, float], joint_map: IntArray
    ) -> Projection:
        model, motion = self.model, facts.clip.motion
        warp = make_warp(model.timeline, first=facts.first, last=facts.last, events=events, label=task.label)
        align = model.rules["align"]
        alignment = facts.alignment(
            align["by"],
            heading=align["heading"],
            position=align["position"],
            at=None if align["at"] is None else events[align["at"]],
        )
        view = project if self.loaded.model.timing == "original" else project_resampled
        return view(motion, model, joint_map=joint_map, alignment=alignment, warp=warp)

    def _goals(
        self, facts: ClipFacts, projection: Projection, task: ClipTask, events: dict[str, float]
    ) -> tuple[list[ClipGoal], WorldPoses]:
        """Return the goals in the frames that are edited, and these frames' world transforms."""
        spec, motion = self.loaded.model, facts.clip.motion
        retimed = spec.timing == "normalized"
        poses = kinematics.forward(projection.motion) if retimed else facts.poses
        goals = []
        for i, goal in enumerate(spec.goals):
            place = resolve.Place(self.loaded, ("goals", i), task.label)
            frame = resolve.frame(
                goal.at, place.at("at"), frames=len(motion), frame_time=motion.frame_time, events=events
            )
            if retimed:
                frame = self._frame_on_timeline(goal.at.event, goal.at.text, frame, facts, events)
            found = clip_goal(
                goal,
                facts,
                place,
                frame=frame,
                poses=poses,
                scale=self.model.space.scale,
                least_tolerance=self._solver_tolerance(),
            )
            goals.append(found)
        return goals, poses

    def _frame_on_timeline(
        self, event: str | None, text: str, frame: int, facts: ClipFacts, events: dict[str, float]
    ) -> int:
        timeline = self.model.timeline
        if event is not None and text == event and event in dict(timeline.events):
            return dict(timeline.events)[event]
        warp = make_warp(timeline, first=facts.first, last=facts.last, events=events, label=facts.clip.label)
        return round_half_up(float(warp.to_timeline(np.array([float(frame)]))[0]))

    def _solver(self, projection: Projection) -> GaussNewton | Damped:
        spec, model = self.loaded.model, self.model
        if spec.solver.method == "damped":
            return Damped(
                damping=spec.solver.damping,
                tolerance=spec.solver.tolerance,
                max_iterations=spec.solver.max_iterations,
                unit=self._damping_unit() * model.space.scale,
            )
        return GaussNewton(self._bound(projection))

    def _damping_unit(self) -> float:
        """Return the damping unit in clip units."""
        spec = self.loaded.model
        return spec.solver.damping_unit.metres / (spec.unit.metres if spec.unit is not None else 1.0)

    def _solver_tolerance(self) -> float:
        """Return what the solver calls near enough, clip units."""
        solver = self.loaded.model.solver
        return solver.tolerance * self._damping_unit() if solver.method == "damped" else 0.0

    def _bound(self, projection: Projection) -> float | None:
        factor = self.loaded.model.plausibility_bound
        if factor is None:
            return None
        return max(factor * largest_norm(self.model), float(self.model.mahalanobis(projection.coefficients)))

    def _outcome(
        self,
        facts: ClipFacts,
        projection: Projection,
        edit: CoefficientEdit,
        goals: Sequence[ClipGoal],
        *,
        before: WorldPoses,
    ) -> Outcome:
        retimed = self.loaded.model.timing == "normalized"
        changed = bool(edit.touched.any() or edit.moved.any())
        after = kinematics.forward(edit.motion) if changed else before
        unit = self.loaded.model.unit
        about = {
            "unit": None if unit is None else unit.name,
            "metrics": edit_metrics(facts, feet_of(facts, [facts.poses]), None if retimed else feet_of(facts, [after])),
        }
        result = edit_record(self.model, projection, edit, goals, poses=after, bound=self._bound(projection))
        return Outcome(
            self._content(facts.clip, projection, edit, changed=changed),
            {"message": result.message, **about, **result.record},
            result.status,
            result.warnings,
            motion=edit.motion if changed or retimed else None,
            details=tuple(goal_line(goal, before) for goal in goals),
        )

    def _content(self, clip: Clip, projection: Projection, edit: CoefficientEdit, *, changed: bool) -> bytes:
        if self.loaded.model.timing == "normalized":
            return resampled_bytes(clip, edit.motion)
        if not changed:
            return unedited_bytes(clip)
        moved = np.zeros((len(edit.motion), len(clip.motion.skeleton.translated)), dtype=np.bool_)
        moved[:, clip.motion.skeleton.translated == projection.travel] = edit.moved[:, None]
        return edited_bytes(clip, edit.motion, touched=edit.touched, moved=moved)
