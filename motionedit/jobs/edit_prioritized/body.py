"""What an edit by priorities knows of a clip's body: its size, masses and hinges, as the spec has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.bones import below
from motionedit.core.body.center_of_mass import Masses, find_masses, scaled_masses
from motionedit.core.body.gaze import gaze_of
from motionedit.core.body.hinges import OFF_AXIS_ENERGY, Hinge, channel_hinges, find_hinges, hinge_of, with_limits_of
from motionedit.core.body.limits import Limits, Range, given_limits, human_limits
from motionedit.core.body.stiffness import TRAVEL, human_mobility
from motionedit.core.motion import Motion, scaled
from motionedit.core.priorities.settings import Body
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass, replace
from motionedit.errors import ClipError
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.clip.unit import unit_doubts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.bends import Bend
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec


@dataclass(frozen=True, eq=False)
class SizedClip:
    """A clip as it is solved: its motion in normalised metres, its body, and what the user should know of them.

    `scale` is normalised metres (leg length 0.85 m) per clip unit; `masses` are in clip units. `before` is the clip
    itself, where its feet were made to stand before the edit, and `lowered` (F,) how far its pelvis was for that;
    `let_go` tells of the heels that could not be held, a line a foot.
    """

    facts: ClipFacts
    motion: Motion
    body: Body
    masses: Masses
    scale: float
    warnings: tuple[str, ...]
    before: Motion | None = None
    lowered: FloatArray | None = None
    let_go: tuple[str, ...] = ()

    @property
    def input(self) -> Motion:
        """The clip itself in normalised metres."""
        return self.before or self.motion


def sized_clip(loaded: LoadedSpec[EditPrioritizedSpec], facts: ClipFacts, faults: Faults) -> SizedClip:
    """Return a clip ready to be solved; joints that the spec names and the clip lacks go to `faults`.

    Raises
    ------
    ClipError
        The skeleton has no length.
    """
    spec, anatomy, clip = loaded.model, facts.anatomy, facts.clip
    if anatomy.leg_length <= 0.0 and spec.constraints:
        raise ClipError("its bones have no length; a body without length cannot be edited", file=clip.label)
    scale = STANDARD_LEG / (anatomy.leg_length or STANDARD_LEG)
    warnings = [*facts.warnings, *unit_doubts(facts.anatomy.leg_length, spec.unit)]
    masses = _masses(loaded, facts, faults)
    motion = scaled(clip.motion, scale)
    sized = scaled_masses(masses, motion.skeleton, scale)
    mobility, root_mobility = _mobility(loaded, facts, faults)
    bends, hinges, limits = _ranges(loaded, facts, faults, warnings)
    upper = _upper(motion.skeleton, anatomy.chest)
    gaze, legs = gaze_of(motion.skeleton, anatomy, up=facts.up), anatomy.legs or ()
    body = Body(sized, hinges, facts.travel, facts.first, bends, mobility, root_mobility, limits, upper, gaze, legs)
    return SizedClip(facts, motion, body, masses, scale, tuple(warnings))


def _upper(skeleton: Skeleton, chest: int | None) -> frozenset[int]:
    """Return what hangs on the chest."""
    return frozenset() if chest is None else frozenset(np.flatnonzero(below(skeleton, chest)).tolist()) - {chest}


def body_again(loaded: LoadedSpec[EditPrioritizedSpec], facts: ClipFacts, body: Body) -> Body:
    """Return a clip's body as another motion of the same clip has it: only how its joints bend and turn differs."""
    bends, hinges, limits = _ranges(loaded, facts, Faults(), [])
    return replace(body, bends=bends, hinges=hinges, limits=limits)


def _ranges(
    loaded: LoadedSpec[EditPrioritizedSpec], facts: ClipFacts, faults: Faults, warnings: list[str]
) -> tuple[tuple[Bend, ...], tuple[Hinge, ...], Limits]:
    """Return how the joints of a clip bend and turn in it, and how far they may."""
    hinges = _hinges(loaded, facts, facts.bends, faults, warnings)
    return facts.bends, tuple(hinges), _limits(loaded, facts, hinges, faults, warnings)


def _masses(loaded: LoadedSpec[EditPrioritizedSpec], facts: ClipFacts, faults: Faults) -> Masses:
    skeleton, place = facts.clip.motion.skeleton, resolve.Place(loaded, ("masses",), facts.clip.label)
    given: dict[int, float] = {}
    for name, kilograms in loaded.model.masses.items():
        index = resolve.joint_if_there(name, skeleton, place.at(name), faults)
        if index is not None:
            given[index] = kilograms
    try:
        return find_masses(
            facts.bones, facts.anatomy, rotations=facts.clip.motion.rotations[facts.first :], given=given or None
        )
    except ValueError as error:
        raise place.error(str(error)) from None


def _hinges(
    loaded: LoadedSpec[EditPrioritizedSpec],
    facts: ClipFacts,
    bends: Sequence[Bend],
    faults: Faults,
    warnings: list[str],
) -> list[Hinge]:
    """Return the hinges that the spec asks for, and those of joints that have one or two rotation channels."""
    motion, asked = facts.clip.motion, loaded.model.hinges
    by_channel = channel_hinges(motion.skeleton)
    found: dict[int, tuple[Hinge, ...]] = {}
    if asked == "auto":
        found = {hinge.joint: (hinge,) for hinge in find_hinges(bends)}
    elif not isinstance(asked, str):
        place = resolve.Place(loaded, ("hinges",), facts.clip.label)
        joints = [resolve.joint_if_there(name, motion.skeleton, place.at(i), faults) for i, name in enumerate(asked)]
        for joint in joints:
            if joint is not None and joint not in by_channel:
                known = find_hinges([bend for bend in bends if bend.joint == joint])
                hinge = known[0] if known else _asked_hinge(motion, joint, facts.first, warnings)
                found.update({} if hinge is None else {joint: (hinge,)})
    for joint, hinges in by_channel.items():
        found[joint] = with_limits_of(hinges, *found[joint]) if joint in found else hinges
    return [hinge for joint in sorted(found) for hinge in found[joint]]


def _mobility(loaded: LoadedSpec[EditPrioritizedSpec], facts: ClipFacts, faults: Faults) -> tuple[FloatArray, float]:
    """Return how readily the joints turn, shape (J,), and the root shifts, as the spec's stiffness has it."""
    skeleton, asked = facts.clip.motion.skeleton, loaded.model.stiffness
    if asked == "human":
        return human_mobility(facts.bones, facts.anatomy, travel=facts.travel), TRAVEL
    mobility = np.ones(len(skeleton))
    if not isinstance(asked, str):
        place = resolve.Place(loaded, ("stiffness",), facts.clip.label)
        for name, stiffness in asked.items():
            joint = resolve.joint_if_there(name, skeleton, place.at(name), faults)
            if joint is not None:
                mobility[joint] = 1.0 / stiffness
    return mobility, 1.0


def _limits(
    loaded: LoadedSpec[EditPrioritizedSpec],
    facts: ClipFacts,
    hinges: Sequence[Hinge],
    faults: Faults,
    warnings: list[str],
) -> Limits:
    """Return the cones that joints keep to, as the spec's limits have them."""
    motion, asked = facts.clip.motion, loaded.model.limits
    if asked == "human":
        return human_limits(motion, facts.poses, facts.anatomy, travel=facts.travel, first=facts.first)
    given = {}
    place = resolve.Place(loaded, ("limits",), facts.clip.label)
    for name, half in {} if isinstance(asked, str) else asked.items():
        joint = resolve.joint_if_there(name, motion.skeleton, place.at(name), faults)
        if joint is not None:
            given[joint] = Range(half.swing, half.twist)
        if joint in {hinge.joint for hinge in hinges}:
            warnings.append(f"limits of {name} say nothing: it bends about an axis, within its hinge's own range")
    return given_limits(motion, facts.poses, given, first=facts.first)


def _asked_hinge(motion: Motion, joint: int, first: int, warnings: list[str]) -> Hinge | None:
    hinge, name = hinge_of(motion, joint, first=first), motion.skeleton.names[joint]
    if hinge is None:
        warnings.append(f"hinges: {name} does not bend in the input, so it has no axis to keep to; it stays free")
    elif hinge.off_axis >= OFF_AXIS_ENERGY:
        warnings.append(
            f"hinges: {name} is no hinge in the input ({100.0 * hinge.off_axis:.2g} % of its turning is off its main "
            "axis); what the edit adds keeps to that axis"
        )
    return hinge
