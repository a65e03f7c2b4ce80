"""Goals solved in a clip, and the edit made believable: limbs that bend, feet that stand, hands that hold."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING

from motionedit.core import kinematics
from motionedit.core.body.contacts import foot_plants
from motionedit.core.coefficients.edit import edit_by_coefficients
from motionedit.core.coefficients.methods import Likeliest
from motionedit.core.coefficients.planted_feet import FIRM, LOOSE, planted_feet
from motionedit.core.coefficients.projection import of_another
from motionedit.core.feet.put_back import carried, standing_feet
from motionedit.dataclass import dataclass
from motionedit.jobs.edit_pc.bending import edit_bending
from motionedit.jobs.edit_pc.holding import Holding, edit_holding
from motionedit.jobs.edit_pc.solver import chosen_solver
from motionedit.jobs.edit_pc.standing import edit_standing, fixed_by, plants_without

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.core.coefficients.planted_feet import PlantedFoot
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.feet.put_back import Fixed, StandingFoot
    from motionedit.core.motion import Motion
    from motionedit.core.pca.model import MotionModel
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.spec.edit_pc import EditPcSpec


@dataclass(frozen=True, eq=False)
class Solving:
    """What goals of a clip are solved with; `bound` is that of `plausibility_bound`."""

    spec: EditPcSpec
    model: MotionModel
    facts: ClipFacts
    projection: Projection
    requests: tuple[GoalRequest, ...]
    bound: float | None

    def edit(self) -> Holding:
        """Return the edit as the spec wants it."""
        spec, facts, requests = self.spec, self.facts, self.requests
        edit = self._solved()
        stand = partial(self._stand, feet=self._feet_of(edit))
        if spec.hinges_in_force == "off":
            edit = stand(edit, ())
        else:
            edit = edit_bending(edit, self._again, stand, requests, facts, left_alone=self._left_alone)
        if spec.hands_in_force == "off":
            return Holding(edit)
        return edit_holding(edit, requests, facts, left_alone=self._left_alone)

    def _solved(self) -> CoefficientEdit:
        spec, feet = self.spec, self._feet(self.projection, self.facts.poses, deviation=LOOSE)
        return edit_by_coefficients(
            self.projection,
            self.model,
            self.requests,
            solver=chosen_solver(spec, self.model, bound=self.bound, feet=feet),
            residual="keep" if spec.residual == "keep" else "drop",
            first=self.facts.first if spec.timing == "original" else 0,
            per_goal=spec.coefficients == "per_goal",
        )

    def _again(
        self, motion: Motion, requests: Sequence[GoalRequest], still: Collection[int], *, firm: bool = False
    ) -> Motion:
        """Return a motion with goals met again, as `Again` has it, by the pose at their frames alone."""
        now = of_another(self.projection, self.model, motion)
        feet = self._feet(now, kinematics.forward(motion), deviation=FIRM) if firm else ()
        solver = Likeliest(share=1.0, bound=None, feet=feet, still=tuple(sorted(still)))
        return edit_by_coefficients(
            now, self.model, requests, solver=solver, residual="keep", first=self.facts.first
        ).motion

    def _stand(self, edit: CoefficientEdit, still: Collection[int], *, feet: Sequence[StandingFoot]) -> CoefficientEdit:
        travel = self.projection.travel
        return (
            edit_standing(edit, self._again, self.requests, self.facts, travel=travel, feet=feet, still=still)
            if feet
            else edit
        )

    def _feet_of(self, edit: CoefficientEdit) -> list[StandingFoot]:
        """Return the feet that stand in an edit, and where; none where they are left alone."""
        facts, places = self.facts, self.spec.feet_in_force
        if places == "off":
            return []
        motion, anatomy, plants = facts.clip.motion, facts.anatomy, foot_plants(facts.plants)
        feet = standing_feet(motion, anatomy, plants, fixed=self._fixed, left_alone=self._left_alone)
        return carried(feet, edit.motion, motion, anatomy, up=facts.up) if places == "move" else feet

    @cached_property
    def _left_alone(self) -> frozenset[int]:
        """The joints that the model leaves out: they stay as they are."""
        return frozenset(range(len(self.projection.motion.skeleton))) - {int(j) for j in self.projection.joints}

    @cached_property
    def _fixed(self) -> list[Fixed]:
        return fixed_by(self.requests, self.facts, kept=self.spec.feet_in_force == "keep")

    def _feet(
        self, projection: Projection, poses: kinematics.WorldPoses, *, deviation: float
    ) -> tuple[PlantedFoot, ...]:
        """Return the points of feet that stand; none where they are left alone, or where a goal is about the foot."""
        if self.spec.feet_in_force == "off":
            return ()
        points = [point.effector for point in self.facts.anatomy.sole_points]
        plants = plants_without(self.facts, self._fixed)
        return planted_feet(
            projection, self.model.space, poses=poses, plants=plants, points=points, deviation=deviation
        )
