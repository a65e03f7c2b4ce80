"""What constraints on an effector share: the chain that they recruit, what moves them, and how they are seen."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import Effector, effector_positions
from motionedit.core.priorities.kinds.constraint import Constraint, ConstraintErrors, Displacement, Movable
from motionedit.core.priorities.recruiting import EVERYTHING, RecruitRule, Recruits, recruit_chain, start_of
from motionedit.core.priorities.solver.points import moved_by
from motionedit.core.priorities.task_targets import Targets
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Hashable

    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Scene
    from motionedit.core.priorities.settings import Body
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.skeleton import Skeleton


@dataclass(frozen=True, eq=False, kw_only=True)
class EffectorConstraint(Constraint):
    """A constraint on a point of the body, or on a joint that turns.

    Attributes
    ----------
    effector : Effector
    recruit : RecruitRule
    """

    # The root's shift moves the task.
    shifts: ClassVar[bool] = True

    effector: Effector
    recruit: RecruitRule = EVERYTHING

    @property
    def at(self) -> Effector:
        """The effector."""
        return self.effector

    @property
    def about(self) -> Hashable:
        """The kind, the effector, and what it is measured in."""
        return self.type, self.effector.joint, self.effector.offset.tobytes(), self.measure.key

    @property
    def subjects(self) -> frozenset[Hashable]:
        """Its effector's place, its joint's turn, or both, beside its task."""
        place, turn = ("place", self.effector.joint, self.effector.offset.tobytes()), ("turn", self.effector.joint)
        return super().subjects | frozenset((place,) * self.places_effector + (turn,) * self.turns)

    @property
    def base(self) -> int | None:
        """The joint in whose frame targets are."""
        return self.measure.base

    @cached_property
    def is_plain(self) -> bool:
        """Whether its positions are its joint's in the world."""
        return self.measure.is_world and not self.effector.is_off

    @property
    def own_joint_moves_it(self) -> bool:
        """Whether turning the effector's own joint moves the task."""
        return self.turns or self.effector.is_off

    @property
    def base_turns_it(self) -> bool:
        """Whether turning the base's own joint moves the task."""
        return True

    def recruits(self, movable: Movable) -> Recruits:
        """Return the chain from the effector up, as far as the user lets it."""
        start = start_of(movable.skeleton, self.effector.joint, itself=self.own_joint_moves_it)
        return recruit_chain(movable.skeleton, self.recruit, start=start, travel=movable.travel)

    def moved_by(self, movable: Movable) -> Recruits:
        """Return the ancestors of the effector and of its base, and whether the root's translation moves it."""
        chains = _moves(
            movable.skeleton,
            (self.effector.joint, self.own_joint_moves_it),
            None if self.base is None else (self.base, self.base_turns_it),
            movable.travel,
        )
        return chains if self.shifts else Recruits(chains.joints, root=False)

    def carries(self, body: Body) -> bool:
        """Return whether it places the lower body: to turn is no reason, and what hangs on the chest reaches."""
        return self.places_effector and self.effector.joint not in body.upper

    def looked_at(self) -> frozenset[int]:
        """Return the effector's joint and its base."""
        return frozenset({self.effector.joint} if self.base is None else {self.effector.joint, self.base})

    def words(self, names: tuple[str, ...]) -> str:
        """Return ``position of LeftHand relative to Hips``."""
        base = "" if self.measure.base is None else f" relative to {names[self.measure.base]}"
        return f"{self.type} of {names[self.effector.joint]}{base}"

    def path(self, scene: Scene) -> FloatArray:
        """Return the effector's path in the input, shape (F, 3), as positions are measured."""
        poses = scene.before.poses
        return self.measure.positions(effector_positions(poses, self.effector), poses)

    def own_turns(self, scene: Scene) -> FloatArray:
        """Return the joint's rotations in the input, shape (F, 4), as rotations are measured."""
        poses = scene.before.poses
        return self.measure.rotations(poses.rotations[:, self.effector.joint], poses)

    def reached(self, targets: Targets, after: Sight) -> Targets:
        """Return where the effector is, and how its joint is turned, as they are measured."""
        poses, positions, rotations = after.poses.at(targets.span), targets.positions, targets.rotations
        if positions is not None:
            positions = self.measure.positions(effector_positions(poses, self.effector), poses)
        if rotations is not None:
            rotations = self.measure.rotations(poses.rotations[:, self.effector.joint], poses)
        return Targets(targets.first, targets.last, positions, rotations)

    def displacement(self, scene: Scene) -> Displacement | None:
        """Return how far it wants its effector from the input's place; None where it has no place in the world."""
        if not self.places_effector or self.base is not None:
            return None
        targets, poses = self.targets(scene), scene.before.poses
        places = effector_positions(poses, self.effector)
        here, then = places[targets.span], poses.at(targets.span)
        wanted = self.measure.aimed(self.measure.positions(here, then), targets.all_positions)
        return Displacement(places, targets.span, self.measure.in_world(wanted, then) - here, self.measure.rows)

    def goal(self, targets: Targets) -> tuple[int, FloatArray] | None:
        """Return the joint and its places in the world, where the effector is a joint and all of its place is asked."""
        if not self.places_effector or not self.measure.is_whole or self.effector.is_off:
            return None
        return self.effector.joint, targets.all_positions @ self.measure.axes

    def errors(self, targets: Targets, after: Sight, *, reference: Motion) -> ConstraintErrors:
        """Return how far the effector is from its targets' positions, and its joint from their rotations."""
        del reference
        if targets.positions is not None and targets.rotations is None and self.is_plain:
            # Most are: a joint's place in the world is its position.
            place = after.poses.positions[targets.first : targets.last + 1, self.effector.joint]
            return ConstraintErrors(targets.first, rot.length(place - targets.positions), None, targets.positions)
        poses = after.poses.at(targets.span)
        lengths = angles = places = None
        if targets.rotations is not None:
            turn = self.measure.rotations(poses.rotations[:, self.effector.joint], poses)
            angles = rot.angle_between(turn, targets.rotations)
        if targets.positions is not None:
            place = self.measure.positions(effector_positions(poses, self.effector), poses)
            wanted = self.measure.aimed(place, targets.positions)
            lengths = rot.length(place - wanted)
            places = self.measure.in_world(wanted, poses)
        return ConstraintErrors(targets.first, lengths, angles, places)


@lru_cache(maxsize=256)
def _moves(skeleton: Skeleton, end: tuple[int, bool], base: tuple[int, bool] | None, travel: int) -> Recruits:
    """Return what moves a point against its base: each a joint, and whether turning that joint itself does."""
    moved = moved_by(skeleton, end[0], itself=end[1])
    if base is not None:
        # What moves both alike moves neither against the other.
        both = moved_by(skeleton, end[0], itself=False) & moved_by(skeleton, base[0], itself=False)
        moved = (moved | moved_by(skeleton, base[0], itself=base[1])) & ~both
    ends = [each[0] for each in (end, base) if each is not None]
    # The root's translation moves it where it moves one end alone.
    shifted = [travel in skeleton.chain(joint) for joint in ends].count(True) == 1
    return Recruits(frozenset(map(int, np.flatnonzero(moved))), shifted)
