"""Floors that no pose of a body reaches: refused before anything is solved, for every frame would be tried in vain."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.priorities.groups import seen_by
from motionedit.core.priorities.kinds.constraint import Scene
from motionedit.jobs.clip.resolve import Place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.priorities.trajectories.positions import Curve
    from motionedit.jobs.edit_prioritized.body import SizedClip
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec


def refuse_floors_out_of_reach(
    loaded: LoadedSpec[EditPrioritizedSpec], sized: SizedClip, constraints: Sequence[Constraint], *, curve: Curve
) -> None:
    """Refuse a floor that is higher above a joint's goal than a body is long, where the goal goes first.

    A body that nothing holds is lifted as a whole, however far that is.

    Raises
    ------
    SpecError
        At the floor's height.
    """
    floors = [(each, each.least) for each in constraints if each.least is not None]
    if not floors or len(floors) == len(constraints):
        return
    length, scene = sized.facts.anatomy.height * sized.scale, None
    for floor, level in floors:
        for each in constraints:
            if each.priority <= floor.priority or each.waits_for_others:
                continue
            if scene is None:
                scene = Scene.of_input(seen_by(constraints, sized.input, sized.body), curve)
            goal = each.goal(each.targets(scene))
            above = 0.0 if goal is None or level is None else -float(level.above(goal[1]).min())
            if above > length:
                (keys,) = {item.keys for item in loaded.model.constraints if item.name == floor.name}
                place, scale = Place(loaded, keys, sized.facts.clip.label).at("height"), sized.scale
                raise place.error(
                    f"in {place.clip}: it is {above / scale:.4g} above where '{each.name}' has its joint, which goes "
                    f"first, and the body is {length / scale:.4g} long: nothing of it reaches so far; lower the floor, "
                    "or give it the larger priority"
                )
