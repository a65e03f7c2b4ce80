"""The edit by prioritized constraints: every frame deformed, layer by layer, and kept continuous ([PRIO] section 5)."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.editing.balance import com_targets, support_points
from motionedit.core.editing.constraint_errors import ConstraintErrors, errors_of
from motionedit.core.editing.constraints import (
    Constraint,
    Targets,
    aim_targets,
    order_of_layers,
    reach_of,
    recruits_of,
    targets_of,
    task_of,
)
from motionedit.core.editing.continuity import NO_DISPLACEMENT, filtered_root, smoothed_displacement
from motionedit.core.ik.layered_solver import HingeColumns, Problem, WeightedTask, solve_layers
from motionedit.core.ik.recruiting import Breach, Recruits, breaches, expanded
from motionedit.core.ik.tasks import Columns
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.center_of_mass import Masses
    from motionedit.core.hinges import Hinge


@dataclass(frozen=True)
class Passes:
    """The default smoothing: low-pass the displacement map, solve again attracted to it; sigma in frames."""

    count: int = 3
    sigma: float = 1.5


@dataclass(frozen=True)
class PaperFilter:
    """The paper's: eq. (4) start states, an FIR low-pass on the root's translation (Hz), further passes."""

    count: int = 2
    cutoff: float = 3.0


@dataclass(frozen=True)
class LayeredSettings:
    """How an edit is solved: what the spec says beside its constraints."""

    smoothing: Passes | PaperFilter = field(default_factory=Passes)
    curve: Literal["time", "index"] = "time"
    attraction: float = 1.0
    max_iterations: int = 40
    recruiting_rule: Literal["expand", "error", "ignore"] = "expand"


@dataclass(frozen=True, eq=False)
class Body:
    """What the edit knows of the body: its masses, hinges, and the joint that carries the travel."""

    masses: Masses
    hinges: tuple[Hinge, ...]
    travel: int
    first: int


@dataclass(frozen=True, eq=False)
class PrioritizedEdit:
    """What an edit did.

    Attributes
    ----------
    motion : Motion
        In normalised metres, as the input.
    touched : shape (F, J), moved : shape (F,)
        Joints whose rotations, frames at which the root's translation changed.
    errors : tuple of ConstraintErrors
        In the order of the constraints.
    iterations : shape (F,)
        Of the first solve.
    converged : shape (F,)
        Whether the last solve of each frame stopped by itself.
    ranks : shape (F, L)
        Independent rows of each layer of priority, the most important first; 0 where it is not active.
    recruits : tuple of Recruits
        What each constraint may move, after the recruiting rule.
    breaches : tuple of Breach
        Breaches of the recruiting rule that were mended (`expand`) or left (`ignore`).
    """

    motion: Motion
    touched: BoolArray
    moved: BoolArray
    errors: tuple[ConstraintErrors, ...]
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray
    recruits: tuple[Recruits, ...]
    breaches: tuple[Breach, ...]


class RecruitingError(ValueError):
    """A breach of the recruiting rule where the user wants none; `breach` says which."""

    def __init__(self, breach: Breach) -> None:
        super().__init__("recruiting rule")
        self.breach = breach


def recruit(
    constraints: Sequence[Constraint], motion: Motion, body: Body, *, rule: Literal["expand", "error", "ignore"]
) -> tuple[list[Recruits], list[Breach]]:
    """Return what each constraint may move, and the breaches of the recruiting rule.

    Raises
    ------
    RecruitingError
        With ``error``, at the first breach.
    """
    skeleton, frames = motion.skeleton, len(motion)
    turnable = {j for j, axes in enumerate(skeleton.rotation_axes) if len(axes) in {1, 3}}
    massive = _body_joints(body, motion) & turnable
    asked = [recruits_of(c, skeleton, travel=body.travel, body=frozenset(massive)) for c in constraints]
    # A root without all its position channels has no translation that could be moved freely.
    travels = len(skeleton.position_axes[body.travel]) == 3
    asked = [Recruits(frozenset(each.joints & turnable), each.root and travels) for each in asked]
    reaches = [reach_of(c, skeleton, frames=frames, body=frozenset(massive)) for c in constraints]
    priorities = [c.priority for c in constraints]
    if rule == "expand":
        return expanded(priorities, asked, reaches)
    found = breaches(priorities, asked, reaches)
    if found and rule == "error":
        raise RecruitingError(found[0])
    return asked, found


def _body_joints(body: Body, motion: Motion) -> set[int]:
    """Return the joints that carry mass and those above them, from the travel-carrying joint down."""
    skeleton = motion.skeleton
    joints: set[int] = set()
    for j in np.flatnonzero(body.masses.shares > 0.0):
        chain = [int(k) for k in skeleton.chain(int(j))]
        joints.update(chain[chain.index(body.travel) :] if body.travel in chain else chain)
    return joints


def edit_by_priorities(
    motion: Motion, constraints: Sequence[Constraint], body: Body, settings: LayeredSettings
) -> PrioritizedEdit:
    """Return the motion deformed so that the constraints hold, each priority as far as those above it allow.

    Parameters
    ----------
    motion : Motion
        The input, lengths in normalised metres.
    constraints
        Lengths in normalised metres, too.

    Raises
    ------
    RecruitingError
        As `recruit`.
    """
    recruits, found = recruit(constraints, motion, body, rule=settings.recruiting_rule)
    run = _Run(motion, tuple(constraints), tuple(recruits), body, settings, forward(motion))
    if isinstance(settings.smoothing, Passes):
        state = run.solve(motion, reference=motion, pull_root=False)
        iterations = state.iterations.copy()
        for _ in range(settings.smoothing.count):
            smooth = smoothed_displacement(motion, state.motion, sigma=settings.smoothing.sigma, first=body.first)
            state = run.solve(smooth, reference=smooth, pull_root=True, previous=state.motion)
    else:
        state, iterations = run.solve_as_the_paper(settings.smoothing)
    touched, moved = _changes(motion, state.motion, body.travel)
    return PrioritizedEdit(
        motion=state.motion,
        touched=touched,
        moved=moved,
        errors=run.errors(state),
        iterations=iterations,
        converged=state.converged,
        ranks=state.ranks,
        recruits=tuple(recruits),
        breaches=tuple(found),
    )


def _changes(before: Motion, after: Motion, travel: int) -> tuple[BoolArray, BoolArray]:
    angles = rot.log(rot.multiply(rot.conjugate(before.rotations), after.rotations))
    touched: BoolArray = np.abs(angles).max(axis=2) > NO_DISPLACEMENT
    place = np.searchsorted(before.skeleton.translated, travel)
    shifts = (after.translations - before.translations)[:, place : place + 1]
    moved: BoolArray = np.abs(shifts).max(axis=(1, 2), initial=0.0) > NO_DISPLACEMENT
    return touched, moved


@dataclass(frozen=True, eq=False)
class _Solved:
    motion: Motion
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray
    targets: list[Targets]


@dataclass(frozen=True, eq=False)
class _Run:
    """One edit on its way: the input, the constraints, what they recruit."""

    motion: Motion
    constraints: tuple[Constraint, ...]
    recruits: tuple[Recruits, ...]
    body: Body
    settings: LayeredSettings
    poses: WorldPoses

    def targets(self, current: WorldPoses | None) -> list[Targets]:
        """Return all targets; `current` is the edited motion so far, for supports."""
        curve = self.settings.curve
        fixed: dict[int, Targets] = {
            i: targets_of(c, self.poses, curve=curve)
            for i, c in enumerate(self.constraints)
            if c.kind in {"position", "orientation", "pose"}
        }
        result = []
        for i, constraint in enumerate(self.constraints):
            if i in fixed:
                result.append(fixed[i])
            elif constraint.kind == "com":
                support = self._support(constraint, fixed, current)
                result.append(com_targets(constraint, self.poses, self.body.masses, support=support, curve=curve))
            elif constraint.kind == "aim":
                result.append(aim_targets(constraint, self.poses, curve=curve))
            else:
                result.append(Targets(*constraint.active(len(self.motion))))
        return result

    def _support(
        self, constraint: Constraint, fixed: dict[int, Targets], current: WorldPoses | None
    ) -> FloatArray | None:
        """Return mean(A'): where members of the support have goals the goals, else where they are so far."""
        if not constraint.support:
            return None
        goals: dict[int, FloatArray] = {}
        for i, targets in fixed.items():
            other = self.constraints[i]
            whole = other.base is None and other.axes == (0, 1, 2) and not np.any(other.effector.offset)
            if targets.positions is not None and whole and other.effector.joint in constraint.support:
                joint = other.effector.joint
                goals.setdefault(joint, np.full((len(self.motion), 3), np.nan))
                goals[joint][targets.first : targets.last + 1] = targets.positions @ other.measure
        return support_points(constraint, self.poses if current is None else current, goals)

    def groups(self, targets: Sequence[Targets]) -> list[tuple[tuple[int, ...], IntArray]]:
        """Return (constraints, frames): frames at which the same constraints are active are solved together."""
        active = np.zeros((len(self.motion), len(targets)), dtype=np.bool_)
        for i, each in enumerate(targets):
            active[each.first : each.last + 1, i] = True
        found: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for frame, row in enumerate(active):
            found[tuple(map(int, np.flatnonzero(row)))].append(frame)
        return [(key, np.array(frames, dtype=np.intp)) for key, frames in found.items() if key]

    def solve(self, start: Motion, *, reference: Motion, pull_root: bool, previous: Motion | None = None) -> _Solved:
        """Return the motion with every frame solved from `start`, attracted to `reference`."""
        targets = self.targets(None if previous is None else forward(previous))
        count, levels = len(start), order_of_layers([c.priority for c in self.constraints])
        rotations, translations = start.rotations.copy(), start.translations.copy()
        iterations = np.zeros(count, dtype=np.intp)
        converged = np.ones(count, dtype=np.bool_)
        ranks = np.zeros((count, len(levels)), dtype=np.intp)
        for members, frames in self.groups(targets):
            problem = self._problem(members, frames, targets, reference, pull_root=pull_root)
            part = Motion(start.skeleton, start.rotations[frames], start.translations[frames], start.frame_time)
            solution = solve_layers(problem, part)
            rotations[frames] = solution.motion.rotations
            translations[frames] = solution.motion.translations
            iterations[frames], converged[frames] = solution.iterations, solution.converged
            there = [levels.index(p) for p in order_of_layers([self.constraints[i].priority for i in members])]
            ranks[frames[:, None], there] = solution.ranks
        motion = Motion(start.skeleton, rotations, translations, start.frame_time)
        return _Solved(motion, iterations, converged, ranks, targets)

    def _problem(
        self,
        members: Sequence[int],
        frames: IntArray,
        targets: Sequence[Targets],
        reference: Motion,
        *,
        pull_root: bool,
    ) -> Problem:
        joints = np.array(sorted(set().union(*(self.recruits[i].joints for i in members))), dtype=np.intp)
        columns = Columns(self.motion.skeleton, joints, self.body.travel)
        layers = []
        for priority in order_of_layers([self.constraints[i].priority for i in members]):
            tasks = []
            for i in members:
                constraint = self.constraints[i]
                if constraint.priority == priority:
                    task = task_of(
                        constraint,
                        targets[i],
                        frames,
                        columns,
                        self.recruits[i],
                        masses=self.body.masses,
                        reference=self.motion,
                    )
                    tasks.append(WeightedTask(task, constraint.weight))
            layers.append(tuple(tasks))
        place = np.searchsorted(self.motion.skeleton.translated, self.body.travel)
        root = reference.translations[frames, place] if pull_root and reference.translations.shape[1] else None
        return Problem(
            columns=columns,
            layers=tuple(layers),
            hinges=_hinge_columns(self.body.hinges, joints),
            reference_rotations=reference.rotations[frames],
            reference_root=root,
            attraction=self.settings.attraction,
            max_iterations=self.settings.max_iterations,
        )

    def solve_as_the_paper(self, smoothing: PaperFilter) -> tuple[_Solved, IntArray]:
        """Solve frame by frame from eq. (4)'s start states, filter the root, and solve again with the root frozen."""
        targets = self.targets(None)
        state = self._in_order(targets)
        iterations = state.iterations.copy()
        place = int(np.searchsorted(self.motion.skeleton.translated, self.body.travel))
        frozen = replace(self, recruits=tuple(Recruits(each.joints, root=False) for each in self.recruits))
        for number in range(smoothing.count):
            if number == 0:
                filtered = filtered_root(
                    self.motion, state.motion, place, cutoff=smoothing.cutoff, first=self.body.first
                )
                state = replace(state, motion=filtered)
            else:
                state = frozen.solve(state.motion, reference=self.motion, pull_root=False, previous=state.motion)
        return state, iterations

    def _in_order(self, targets: Sequence[Targets]) -> _Solved:
        """Solve the frames one after the other: joints that an active constraint controls start where they were."""
        motion = self.motion
        rotations, translations = motion.rotations.copy(), motion.translations.copy()
        levels = order_of_layers([c.priority for c in self.constraints])
        iterations = np.zeros(len(motion), dtype=np.intp)
        converged = np.ones(len(motion), dtype=np.bool_)
        ranks = np.zeros((len(motion), len(levels)), dtype=np.intp)
        ordered = sorted((int(f), members) for members, frames in self.groups(targets) for f in frames)
        place = int(np.searchsorted(motion.skeleton.translated, self.body.travel))
        before = -2
        for frame, members in ordered:
            controlled = sorted(set().union(*(self.recruits[i].joints for i in members)))
            if before == frame - 1:
                rotations[frame, controlled] = rotations[frame - 1, controlled]
                if any(self.recruits[i].root for i in members):
                    translations[frame, place] = translations[frame - 1, place]
            at = np.array([frame])
            problem = self._problem(members, at, targets, motion, pull_root=False)
            start = Motion(motion.skeleton, rotations[at], translations[at], motion.frame_time)
            solution = solve_layers(problem, start)
            rotations[at], translations[at] = solution.motion.rotations, solution.motion.translations
            iterations[at], converged[at] = solution.iterations, solution.converged
            there = [levels.index(p) for p in order_of_layers([self.constraints[i].priority for i in members])]
            ranks[frame, there] = solution.ranks[0]
            before = frame
        edited = Motion(motion.skeleton, rotations, translations, motion.frame_time)
        return _Solved(edited, iterations, converged, ranks, list(targets))

    def errors(self, solved: _Solved) -> tuple[ConstraintErrors, ...]:
        """Return what is left of every constraint, against the targets of the last pass, by forward kinematics."""
        poses = forward(solved.motion)
        return tuple(
            errors_of(c, t, poses, solved.motion, masses=self.body.masses, reference=self.motion)
            for c, t in zip(self.constraints, solved.targets, strict=True)
        )


def _hinge_columns(hinges: Sequence[Hinge], joints: IntArray) -> HingeColumns:
    here = [hinge for hinge in hinges if hinge.joint in set(map(int, joints))]
    return HingeColumns(
        places=np.searchsorted(joints, np.array([hinge.joint for hinge in here], dtype=np.intp)),
        axes=np.array([hinge.axis for hinge in here]).reshape(-1, 3),
        limits=np.array([hinge.limits for hinge in here]).reshape(-1, 2),
    )
