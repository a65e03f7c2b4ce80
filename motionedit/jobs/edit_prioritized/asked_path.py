"""Where positions that are asked of the root take the body: the path that plants `at: path` follow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.whole import whole_joints
from motionedit.core.feet.path import NewPath, new_path
from motionedit.core.priorities.kinds.constraint import Scene
from motionedit.core.priorities.sight import sight_of
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.priorities.trajectories.positions import Curve
    from motionedit.jobs.edit_prioritized.body import SizedClip
    from motionedit.jobs.edit_prioritized.constraints import ClipConstraint


def asked_path(sized: SizedClip, constraints: Sequence[ClipConstraint], curve: Curve) -> NewPath | None:
    """Return where positions of the root take the body, clip units; None where none is asked for.

    Those are the positions, in the world or by heading, of the joints that turn the whole body or of points fixed in
    them. Along axes that do not count the body stays. Of several that count the same axis the last holds.
    """
    facts, travel = sized.facts, sized.facts.travel
    whole = whole_joints(facts.bones, facts.anatomy, travel=travel)
    scene = Scene.of_input(sight_of(sized.motion, lambda: whole, None), curve)
    places = scene.before.poses.positions[:, travel]
    asks = [each.constraint for each in constraints]
    asks = [ask for ask in asks if not ask.stands and ask.at is not None and ask.at.joint in whole]
    asked = [displaced for displaced in (ask.displacement(scene) for ask in asks) if displaced is not None]
    if not asked:
        return None
    shift, arm = np.zeros(places.shape), asked[0].places - places
    for each in asked:
        shift[each.span] += each.shift - shift[each.span] @ each.counted.T @ each.counted
        arm[each.span] = (each.places - places)[each.span]
    shift, arm = shift / sized.scale, arm / sized.scale
    path = new_path(
        facts.poses.positions[:, travel],
        shift,
        up=facts.up,
        leg=facts.anatomy.leg_length,
        frame_time=facts.clip.motion.frame_time,
        first=facts.first,
    )
    # A body that turns with the path turns about the point that is asked to be somewhere.
    return replace(path, shift=shift + arm - rot.rotate(path.turns, arm)) if np.any(arm) else path
