"""The job behind `motionedit edit-prioritized`: constraints in strict layers, every frame deformed ([PRIO])."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.blocks import frame_blocks
from motionedit.core.body.steps import change_steps
from motionedit.core.bvh import edited_pieces, unedited_bytes
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion, scaled
from motionedit.core.priorities.edit import PrioritizedEdit, edit_by_priorities
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter, Passes
from motionedit.core.priorities.targets import Follows
from motionedit.dataclass import dataclass, replace
from motionedit.jobs.batch.one_clip import Outcome
from motionedit.jobs.batch.plan import plan
from motionedit.jobs.batch.pool import threads_within
from motionedit.jobs.batch.run import run_batch
from motionedit.jobs.batch.verdicts import run_key, verdicts_in
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.events import event_frames, explicit_events
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.clip.metrics import edit_metrics, feet_of
from motionedit.jobs.clip.roughness import rough_lines
from motionedit.jobs.edit_prioritized.body import sized_clip
from motionedit.jobs.edit_prioritized.constraints import clip_constraints
from motionedit.jobs.edit_prioritized.floors import refuse_floors_out_of_reach
from motionedit.jobs.edit_prioritized.record import edit_record
from motionedit.jobs.edit_prioritized.recruits import breach_warnings, immovable_warnings, layer_lines, refuse_breaches
from motionedit.jobs.edit_prioritized.reference import reference_facts, reference_files, refuse_unfit_reference
from motionedit.jobs.edit_prioritized.rest_pose import moved_rest_pose
from motionedit.jobs.edit_prioritized.standing import on_feet
from motionedit.jobs.edit_prioritized.unheld import grips_in, loose_feet, loose_hands
from motionedit.jobs.preview.with_page import with_page

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from motionedit.core.arrays import BoolArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.body.steps import Steps
    from motionedit.core.body.trace import Trace
    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask, RunOptions
    from motionedit.jobs.batch.run import BatchResult
    from motionedit.jobs.batch.verdicts import Verdicts
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_prioritized.body import SizedClip
    from motionedit.jobs.edit_prioritized.constraints import ClipConstraint
    from motionedit.jobs.edit_prioritized.unheld import Grip
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec


def run(
    loaded: LoadedSpec[EditPrioritizedSpec], clips: Sequence[Path], output: str, options: RunOptions
) -> BatchResult:
    """Edit clips by constraints in priority layers, and write them.

    Raises
    ------
    UsageError, SpecError
        As `plan` and `edit`.
    """
    refuse_unfit_reference(loaded)
    references = reference_files(loaded.model.reference)
    files = [*loaded.model.event_files, *references]
    key = run_key("edit-prioritized", loaded.data, files=files, more=options.lenient)
    verdicts = verdicts_in(output, key, update=options.update, dry_run=options.dry_run)
    tasks = plan(clips, output, options=options, depends=(*loaded.files, *references), verdicts=verdicts)
    return edit(loaded, tasks, options=options, verdicts=verdicts)


def edit(
    loaded: LoadedSpec[EditPrioritizedSpec],
    tasks: Sequence[ClipTask],
    *,
    options: RunOptions,
    verdicts: Verdicts | None = None,
) -> BatchResult:
    """Edit the clips of tasks, and write those that have an output; what becomes of them `verdicts` are told.

    Raises
    ------
    SpecError
        The reference is not there, or nothing is taken from it, or it is followed and not given.
    """
    refuse_unfit_reference(loaded)
    others = tuple(task.relative for task in tasks)
    threads = threads_within(sum(not task.elsewhere for task in tasks), options)
    work = EditByPriorities(loaded, others, threads, verify=options.verify, tells_plan=options.dry_run)
    return run_batch(tasks, with_page(work, loaded.data, options), options, verdicts=verdicts)


# Bytes from which a file is not held while its motion is edited.
_LONG = 1 << 25


@dataclass(frozen=True)
class EditByPriorities:
    """The work on one clip; `tells_plan` asks for its details."""

    loaded: LoadedSpec[EditPrioritizedSpec]
    others: tuple[str, ...]
    threads: int = 1
    verify: bool = False
    tells_plan: bool = False

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        """Return the edited clip, and how near each constraint came."""
        if task.clip is None and task.source is not None and len(clip.text.file) > _LONG:
            clip.text.file.let_go(task.source)
        sized, constraints, other = self.ready(clip, task)
        if not constraints:
            return self._unedited(clip, sized)
        settings = self.settings(clip)
        before = feet_of(sized.facts, sized.facts.world.blocks(), masses=sized.masses)
        grips = grips_in(sized)
        # What is read off the input has been read, its phases with it: an edit of a long clip needs the room.
        sized.facts.world.forget_long()
        _ = sized.facts.phases
        sized.facts.world.forget()
        edit = edit_by_priorities(
            sized.motion,
            [c.constraint for c in constraints],
            sized.body,
            settings,
            follows=Follows(sized.input, None if other is None else scaled(other.clip.motion, sized.scale)),
        )
        return self._outcome(sized, constraints, edit, settings, before=before, grips=grips)

    def _unedited(self, clip: Clip, sized: SizedClip) -> Outcome:
        """Return a clip of which nothing is asked, or nothing that is in it."""
        feet = feet_of(sized.facts, sized.facts.world.blocks(), masses=sized.masses)
        still = change_steps(sized.motion, sized.motion, first=sized.facts.first)
        record = {**self._about(sized, feet, feet, still), "constraints": []}
        return Outcome(
            unedited_bytes(clip), record, warnings=sized.warnings, details=("no constraints: the same bytes",)
        )

    def ready(self, clip: Clip, task: ClipTask) -> tuple[SizedClip, list[ClipConstraint], ClipFacts | None]:
        """Return a clip whose feet stand, the constraints that are left to solve, and the facts of its reference.

        Raises
        ------
        MotionEditError
            All that an edit of the clip is refused for.
        """
        curve = self.loaded.model.curve
        sized, constraints = self._resolved(clip, task)
        other = reference_facts(self.loaded, clip, task)
        if any(each.constraint.stands for each in constraints):
            kept = sized.facts if other is None else other
            sized, constraints = on_feet(self.loaded, sized, constraints, kept, curve=curve)
        asked = [each.constraint for each in constraints]
        refuse_floors_out_of_reach(self.loaded, sized, asked, curve=curve)
        refuse_breaches(self.loaded, sized, asked)
        return sized, constraints, other

    def _resolved(self, clip: Clip, task: ClipTask) -> tuple[SizedClip, list[ClipConstraint]]:
        """Return a clip in normalised metres, and the spec's constraints in it.

        Raises
        ------
        MotionEditErrors
            Everything that the spec names and the clip lacks.
        """
        faults = Faults()
        spec = self.loaded.model
        given = resolve.body(spec.body, clip.motion.skeleton, resolve.Place(self.loaded, ("body",), task.label))
        sized = sized_clip(self.loaded, facts_of(clip, up=spec.up, given=given), faults)
        constraints = self._constraints(sized, task, faults)
        faults.raise_all(f"what the spec names and {task.label} lacks")
        return replace(sized, warnings=(*sized.warnings, *_warnings_of(constraints, sized.masses))), constraints

    def _constraints(self, sized: SizedClip, task: ClipTask, faults: Faults) -> list[ClipConstraint]:
        spec = self.loaded.model
        place = resolve.Place(self.loaded, ("events",), task.label)

        def frames() -> dict[str, float]:
            known = explicit_events(self.loaded, sized.facts.clip, relative=task.relative, others=self.others)
            return event_frames(spec.events, sized.facts, place, known=known)

        events = faults.get(frames, otherwise=None)
        found, scale, relative = Faults(), sized.scale, task.relative
        constraints = clip_constraints(
            self.loaded, sized.facts, events or {}, scale=scale, faults=found, relative=relative
        )
        for error in found.errors:
            # Of an event whose frame is at fault itself that has been said.
            if events is not None or not isinstance(error, resolve.NoEventFrameError):
                faults.add(error)
        return constraints

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
        self,
        sized: SizedClip,
        constraints: Sequence[ClipConstraint],
        edit: PrioritizedEdit,
        settings: LayeredSettings,
        *,
        before: Trace,
        grips: Sequence[Grip],
    ) -> Outcome:
        facts, spec = sized.facts, self.loaded.model
        clip = facts.clip
        changed = bool(edit.touched.any() or edit.moved.any())
        after = before
        if changed:
            parts = (_in_clip_units(edit, sized, block) for block in frame_blocks(len(clip.motion)))
            after = feet_of(facts, map(forward, parts), masses=sized.masses)
        steps = change_steps(sized.input, edit.motion, first=facts.first)
        rough = rough_lines(
            facts,
            edit.motion,
            touched=np.asarray(edit.touched.any(axis=0)),
            steps=steps,
            traces=(before, after),
            bends=sized.body.bends,
        )
        asked = [each.constraint for each in constraints]
        # Of both traces, then of every constraint: of a long clip they take the room one after the other.
        about = self._about(sized, before, after, steps)
        loose = [*loose_feet(sized, asked, before, after), *loose_hands(sized, asked, edit.motion, grips)]
        del before, after
        result = edit_record(
            edit, constraints, facts, scale=sized.scale, settings=settings, rough=(*sized.let_go, *rough)
        )
        record = {**about, "solver": edit.solver, **result.record, "passes": spec.smoothing.pass_count}
        breaches = breach_warnings(edit.breaches, asked, facts, rule=spec.recruiting_rule)
        immovable = immovable_warnings(asked, edit.recruits, facts)
        rest = moved_rest_pose(sized.input, edit.motion, asked, first=facts.first, scale=sized.scale)
        return Outcome(
            _content(clip, edit, sized) if changed else unedited_bytes(clip),
            {"message": result.message, **record},
            result.status,
            (*sized.warnings, *immovable, *breaches, *rest, *loose, *result.warnings),
            motion=_in_clip_units(edit, sized, slice(None)) if changed and self.verify else None,
            details=(*layer_lines(asked, edit.recruits, sized), *breaches) if self.tells_plan else (),
        )

    def _about(self, sized: SizedClip, before: Trace, after: Trace, steps: Steps) -> dict[str, Any]:
        unit = self.loaded.model.unit
        metrics = edit_metrics(sized.facts, before, after, steps=steps)
        return {"unit": None if unit is None else unit.name, "metrics": metrics}


def _warnings_of(constraints: Sequence[ClipConstraint], masses: Masses) -> list[str]:
    """Return what the user should know of the constraints before they are solved, each line once."""
    asked = [each.constraint for each in constraints]
    lines = [
        *(masses.warnings if any(each.weighs for each in asked) else ()),
        *(w for c in asked for w in c.warnings()),
    ]
    return list(dict.fromkeys(lines))


def _in_clip_units(edit: PrioritizedEdit, sized: SizedClip, block: slice) -> Motion:
    """Return a block of the edited motion in clip units: what was not touched is the input's own, bit for bit."""
    before, after = sized.facts.clip.motion, edit.motion
    rotations = np.where(edit.touched[block, :, None], after.rotations[block], before.rotations[block])
    moved = _moved(edit, sized)[block, :, None]
    translations = np.where(moved, after.translations[block] / sized.scale, before.translations[block])
    return Motion(before.skeleton, rotations, translations, before.frame_time)


def _moved(edit: PrioritizedEdit, sized: SizedClip) -> BoolArray:
    """Return where joints with position channels are moved, shape (F, P): the one that carries the travel alone."""
    moved: BoolArray = edit.moved[:, None] & (edit.motion.skeleton.translated == sized.facts.travel)
    return moved


def _content(clip: Clip, edit: PrioritizedEdit, sized: SizedClip) -> Iterator[bytes | memoryview]:
    # Only what was touched is read of it, so nothing needs to be put back.
    translations = edit.motion.translations / sized.scale
    motion = Motion(clip.motion.skeleton, edit.motion.rotations, translations, clip.motion.frame_time)
    return edited_pieces(clip, motion, touched=edit.touched, moved=_moved(edit, sized))
