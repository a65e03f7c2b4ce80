"""Where constraints shall be: the targets of all of them, those first that do not wait for others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.again import once
from motionedit.core.blocks import frame_blocks
from motionedit.core.priorities.far_turns import arcs_of
from motionedit.core.priorities.groups import Asked, seen_by
from motionedit.core.priorities.kinds.constraint import ConstraintErrors, Scene
from motionedit.core.priorities.task_targets import Targets, between, moved
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.priorities.settings import Body, LayeredSettings
    from motionedit.core.priorities.sight import Sight


@dataclass(frozen=True, eq=False)
class Follows:
    """Whose paths constraints follow, where it is not those of the motion that is edited: see `Constraint.follow`."""

    input: Motion | None = None
    reference: Motion | None = None


NOBODY = Follows()


def with_targets(
    motion: Motion,
    constraints: Sequence[Constraint],
    recruits: Sequence[Recruits],
    body: Body,
    settings: LayeredSettings,
    *,
    solve: Callable[[Asked], Motion],
    follows: Follows = NOBODY,
) -> Asked:
    """Return all that is asked of a motion, with the targets of every constraint, which `follows` others' paths.

    `solve` returns what constraints make of the motion.
    """
    here = seen_by(constraints, motion, body)
    before = here if follows.input is None else seen_by(constraints, follows.input, body)
    theirs = before if follows.reference is None else seen_by(constraints, follows.reference, body)
    seen = [theirs if each.follow == "reference" else before for each in constraints]
    stays = not any(each.carries(body) for each in constraints)
    free = [i for i, each in enumerate(constraints) if not each.waits_for_others]
    # Most follow the same motion.
    scenes = {each: Scene.of_input(each, settings.curve) for each in (before, theirs)}
    found = {i: _ramped(constraints[i], scenes[seen[i]], here) for i in free}

    def others() -> Sight:
        """Return what is seen of the motion that those which do not wait ask for, solved once."""
        if not free:
            return before
        own = [constraints[i] for i in free], [recruits[i] for i in free], [found[i] for i in free]
        asked = replace(Asked.of(motion, *own, body, settings), pulls_root=stays)
        return seen_by(constraints, solve(asked), body)

    goals, made = once(lambda: _goals(constraints, found, len(motion))), once(others)
    targets = tuple(
        found[i] if i in found else _ramped(each, Scene(seen[i], settings.curve, goals, made), here)
        for i, each in enumerate(constraints)
    )
    arcs = tuple(
        None if there.rotations is None else arcs_of(there, each.reached(there, here))
        for each, there in zip(constraints, targets, strict=True)
    )
    return replace(Asked.of(motion, constraints, recruits, targets, body, settings), arcs=arcs, pulls_root=stays)


def _ramped(constraint: Constraint, scene: Scene, here: Sight) -> Targets:
    """Return a constraint's targets, its ramps led from and to the motion that is edited, seen `here`."""
    targets = constraint.targets(scene)
    if not constraint.points or (scene.before is here and not constraint.waits_for_others):
        return targets
    left = 1.0 - constraint.share(len(here.motion))[targets.span]
    return moved(targets, constraint.unasked(targets, scene), constraint.reached(targets, here), left)


def errors_of(asked: Asked, motion: Motion, *, poses: WorldPoses | None = None) -> tuple[ConstraintErrors, ...]:
    """Return what an edited motion leaves of every constraint, by forward kinematics; its `poses` may be known."""
    parts: list[list[ConstraintErrors]] = [[] for _ in asked.constraints]
    # Block by block: what is seen of a long motion takes a third of its file.
    for block in frame_blocks(len(motion)):
        here = motion, asked.motion
        if len(motion) > block.stop - block.start:
            here, poses = (motion.at(block), asked.motion.at(block)), None
        after = seen_by(asked.constraints, here[0], asked.body, poses=poses)
        for each, targets, found in zip(asked.constraints, asked.targets, parts, strict=True):
            first, stop = max(targets.first, block.start), min(targets.last + 1, block.stop)
            if first < stop:
                is_whole = block.start == 0 and stop == targets.last + 1
                part = targets if is_whole else targets.within(slice(first, stop)).since(block.start)
                found.append(each.errors(part, after, reference=here[1]))
    return tuple(_joined(found, targets.first) for found, targets in zip(parts, asked.targets, strict=True))


def lefts_of(asked: Asked, motion: Motion) -> list[FloatArray]:
    """Return what is left of each constraint at every frame, metres or radians, shape (F,); 0 where it is idle."""
    lefts = []
    for errors, targets in zip(errors_of(asked, motion), asked.targets, strict=True):
        left = np.zeros(len(motion))
        left[targets.span] = errors.largest
        lefts.append(left)
    return lefts


def reached(asked: Asked, i: int, motion: Motion) -> Targets:
    """Return where a motion has a constraint's task."""
    constraint = asked.constraints[i]
    return constraint.reached(asked.targets[i], seen_by([constraint], motion, asked.body))


def reached_within(asked: Asked, i: int, motion: Motion, frames: slice) -> Targets | None:
    """Return where a motion has a constraint's task at some frames; None where that is no place to go back to."""
    constraint, here = asked.constraints[i], asked.targets[i].within(frames).since(frames.start)
    part = motion.at(frames)
    there = constraint.reached(here, seen_by([constraint], part, asked.body))
    return None if there is here else there.since(-frames.start)


def toward(
    asked: Asked, original: tuple[Targets, ...], shares: Mapping[int, FloatArray], motion: Motion
) -> tuple[Targets, ...]:
    """Return targets on the way from the original ones to where a motion has them, so much of it each, shape (F,)."""
    found = list(original)
    for k, share in shares.items():
        span = original[k].span
        inside = np.flatnonzero(share[span])
        if not len(inside):
            continue
        frames = slice(int(span.start + inside[0]), int(span.start + inside[-1] + 1))
        there = reached_within(asked, k, motion, frames)
        if there is not None:
            found[k] = original[k].with_part(between(original[k].within(frames), there, share[frames]))
    return tuple(found)


def _joined(parts: Sequence[ConstraintErrors], first: int) -> ConstraintErrors:
    """Return what is left of a constraint from frame `first` on, of parts that follow one another."""
    if len(parts) == 1 and parts[0].first == first:
        return parts[0]

    def whole(name: str) -> FloatArray | None:
        arrays = [array for array in (getattr(part, name) for part in parts) if array is not None]
        return np.concatenate(arrays) if len(arrays) > 1 else arrays[0] if arrays else None

    return ConstraintErrors(first, whole("positions"), whole("angles"), whole("places"))


def _goals(constraints: Sequence[Constraint], found: dict[int, Targets], frames: int) -> dict[int, FloatArray]:
    """Return where constraints put joints in the world, shape (F, 3), nan where none does.

    Of several for a joint the most important stands; of equals the one of the larger weight, then the last.
    """
    goals: dict[int, FloatArray] = {}
    for i in sorted(found, key=lambda i: (constraints[i].priority, constraints[i].weight)):
        targets = found[i]
        goal = constraints[i].goal(targets)
        if goal is not None:
            joint, places = goal
            goals.setdefault(joint, np.full((frames, 3), np.nan))[targets.span] = places
    return goals
