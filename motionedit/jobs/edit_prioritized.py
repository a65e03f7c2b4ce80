"""The job behind `motionedit edit-prioritized`: constraints in strict layers, every frame deformed ([PRIO])."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core import kinematics
from motionedit.core.bvh import edited_bytes, unedited_bytes
from motionedit.core.center_of_mass import center_of_mass
from motionedit.core.compiled import solver_name
from motionedit.core.editing.prioritized_edit import (
    LayeredSettings,
    PaperFilter,
    Passes,
    PrioritizedEdit,
    RecruitingError,
    edit_by_priorities,
)
from motionedit.core.motion import Motion
from motionedit.jobs import resolve
from motionedit.jobs.batch import Outcome, plan, run_batch
from motionedit.jobs.clip_facts import facts_of
from motionedit.jobs.collected import Faults
from motionedit.jobs.edit_metrics import edit_metrics
from motionedit.jobs.edit_page import WithPage
from motionedit.jobs.events import event_frames
from motionedit.jobs.pool import threads_within
from motionedit.jobs.prioritized_body import sized_clip
from motionedit.jobs.prioritized_constraints import clip_constraints
from motionedit.jobs.prioritized_record import edit_record
from motionedit.jobs.prioritized_recruits import breach_error, breach_warnings, layer_lines

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.core.editing.constraints import Constraint
    from motionedit.jobs.batch import BatchResult, ClipTask, RunOptions
    from motionedit.jobs.prioritized_body import SizedClip
    from motionedit.jobs.prioritized_constraints import ClipConstraint
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec

# Kinds of constraints that keep an effector in place, and how far (metres at leg length 0.85 m) is a visible way.
_HOLDS = frozenset({"position", "pose"})
_LOOSE = 0.01


def run(
    loaded: LoadedSpec[EditPrioritizedSpec], clips: Sequence[Path], output: str, options: RunOptions
) -> BatchResult:
    """Edit clips by constraints in priority layers, and write them.

    Raises
    ------
    UsageError
        As `plan`.
    """
    tasks = plan(clips, output, options=options, depends=loaded.files)
    others = tuple(task.relative for task in tasks)
    work = EditByPriorities(loaded, others, threads_within(len(tasks), options))
    return run_batch(tasks, WithPage(work, loaded.data) if options.preview and not options.dry_run else work, options)


@dataclass(frozen=True)
class EditByPriorities:
    """The work on one clip."""

    loaded: LoadedSpec[EditPrioritizedSpec]
    others: tuple[str, ...]
    threads: int = 1

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        """Return the edited clip, and how near each constraint came."""
        sized, constraints = self.resolved(clip, task)
        if not constraints:
            record = {**self._about(sized, sized.facts.poses), "constraints": []}
            return Outcome(
                unedited_bytes(clip), record, warnings=sized.warnings, details=("no constraints: the same bytes",)
            )
        settings = self.settings(clip)
        try:
            edit = edit_by_priorities(sized.motion, [c.constraint for c in constraints], sized.body, settings)
        except RecruitingError as error:
            asked = [c.constraint for c in constraints]
            raise breach_error(self.loaded, error.breach, asked, sized.facts) from None
        return self._outcome(sized, constraints, edit, settings)

    def resolved(self, clip: Clip, task: ClipTask) -> tuple[SizedClip, list[ClipConstraint]]:
        """Return a clip in normalised metres, and the spec's constraints in it.

        Raises
        ------
        MotionEditErrors
            Everything that the spec names and the clip lacks.
        """
        faults = Faults()
        sized = sized_clip(self.loaded, facts_of(clip, up=self.loaded.model.up), faults)
        constraints = self._constraints(sized, task, faults)
        faults.raise_all(f"what the spec names and {task.label} lacks")
        return sized, constraints

    def _constraints(self, sized: SizedClip, task: ClipTask, faults: Faults) -> list[ClipConstraint]:
        spec = self.loaded.model
        place = resolve.Place(self.loaded, ("events",), task.label)
        none: dict[str, float] = {}

        def frames() -> dict[str, float]:
            explicit = resolve.explicit_events(self.loaded, task.relative, others=self.others)
            known = {name: float(frame) for name, frame in explicit.items()}
            return event_frames(spec.events, sized.facts, place, known=known)

        events = faults.get(frames, otherwise=none)
        return clip_constraints(self.loaded, sized.facts, events, scale=sized.scale, faults=faults)

    def settings(self, clip: Clip) -> LayeredSettings:
        """Return how the spec wants a clip solved."""
        spec = self.loaded.model
        smoothing = spec.smoothing
        return LayeredSettings(
            smoothing=PaperFilter(smoothing.pass_count, smoothing.cutoff)
            if smoothing.method == "paper"
            else Passes(smoothing.pass_count, smoothing.sigma.in_frames(clip.motion.frame_time)),
            curve=spec.curve,
            attraction=spec.attraction,
            max_iterations=spec.solver.max_iterations,
            recruiting_rule=spec.recruiting_rule,
            threads=self.threads,
        )

    def _outcome(
        self, sized: SizedClip, constraints: Sequence[ClipConstraint], edit: PrioritizedEdit, settings: LayeredSettings
    ) -> Outcome:
        facts, spec = sized.facts, self.loaded.model
        clip = facts.clip
        changed = bool(edit.touched.any() or edit.moved.any())
        motion = _in_clip_units(clip.motion, edit, sized) if changed else clip.motion
        after = kinematics.forward(motion) if changed else facts.poses
        result = edit_record(edit, constraints, facts, scale=sized.scale, settings=settings)
        about = {
            **self._about(sized, after),
            "solver": solver_name(),
            **result.record,
            "passes": spec.smoothing.pass_count,
        }
        asked = [each.constraint for each in constraints]
        breaches = breach_warnings(edit.breaches, asked, facts, rule=spec.recruiting_rule)
        return Outcome(
            _content(clip, motion, edit, facts.travel) if changed else unedited_bytes(clip),
            {"message": result.message, **about},
            result.status,
            (*sized.warnings, *breaches, *_loose_feet(sized, asked, about["metrics"]), *result.warnings),
            motion=motion if changed else None,
            details=(*layer_lines(asked, edit.recruits, sized.body.hinges, facts), *breaches),
        )

    def _about(self, sized: SizedClip, after: kinematics.WorldPoses) -> dict[str, Any]:
        unit = self.loaded.model.unit
        metrics = edit_metrics(sized.facts, after.positions)
        shift = center_of_mass(after, sized.masses) - center_of_mass(sized.facts.poses, sized.masses)
        metrics["com_shift_max"] = float(np.linalg.norm(shift, axis=1).max())
        return {"unit": None if unit is None else unit.name, "metrics": metrics}


def _loose_feet(sized: SizedClip, constraints: Sequence[Constraint], metrics: dict[str, Any]) -> list[str]:
    """Return a warning where planted feet were dragged along and no constraint is about them: it is easily forgotten.

    With the root recruited and nothing to hold it, the cheapest way to raise a hand is to raise the whole body.
    """
    facts, drift = sized.facts, metrics["foot_drift_max"]
    ankles = {leg.ankle for leg in facts.anatomy.legs or ()}
    skeleton = facts.clip.motion.skeleton
    held = any(ankles & set(map(int, skeleton.chain(c.effector.joint))) for c in constraints if c.kind in _HOLDS)
    if held or drift is None or drift * sized.scale < _LOOSE:
        return []
    return [f"planted feet move by up to {drift:.3g}, and no constraint holds them"]


def _in_clip_units(before: Motion, edit: PrioritizedEdit, sized: SizedClip) -> Motion:
    """Return the edited motion in clip units: what was not touched is the input's own, bit for bit."""
    rotations = np.where(edit.touched[..., None], edit.motion.rotations, before.rotations)
    travels = before.skeleton.translated == sized.facts.travel
    moved = (edit.moved[:, None] & travels)[..., None]
    translations = np.where(moved, edit.motion.translations / sized.scale, before.translations)
    return Motion(before.skeleton, rotations, translations, before.frame_time)


def _content(clip: Clip, motion: Motion, edit: PrioritizedEdit, travel: int) -> bytes:
    moved = edit.moved[:, None] & (clip.motion.skeleton.translated == travel)
    return edited_bytes(clip, motion, touched=edit.touched, moved=moved)
