"""What a spec names, found in a clip: joints, effectors, frames; each error with the spec's line."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.anatomy import GivenBody
from motionedit.core.kinematics import Effector
from motionedit.dataclass import dataclass
from motionedit.errors import SpecError
from motionedit.jobs.clip.faults import ITS_JOINTS, Faults
from motionedit.spec.body import NONE
from motionedit.spec.faults import listed, nearest

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton
    from motionedit.errors import MotionEditError
    from motionedit.spec.body import BodySpec
    from motionedit.spec.times import Interval, Time
    from motionedit.spec.values import EffectorSpec, OrientationSpec


class NoEventFrameError(SpecError):
    """A time counts from an event that the spec lists, and that has no frame in the clip."""


class Source(Protocol):
    """What a place is in: a spec, or rules that a model has kept of one."""

    def has(self, keys: Sequence[str | int]) -> bool:
        """Return whether the key is given."""

    def error(self, keys: Sequence[str | int], message: str) -> MotionEditError:
        """Return an error at a key."""


class Where(Protocol):
    """Where a name stands that is looked for in a clip: a key of a spec, or an option of the command line."""

    @property
    def clip(self) -> str:
        """The clip's name in messages."""

    def at(self, *keys: str | int) -> Where:
        """Return the place of a key below this one."""

    def error(self, message: str) -> MotionEditError:
        """Return an error at this place."""


@dataclass(frozen=True)
class Place:
    """A key of a spec, looked at for one clip: where an error is, and the clip's name in it."""

    loaded: Source
    keys: tuple[str | int, ...]
    clip: str

    def at(self, *keys: str | int) -> Place:
        """Return the place of a key below this one; where the spec does not give it, this one."""
        below = (*self.keys, *keys)
        return self.below(below)

    def below(self, keys: tuple[str | int, ...]) -> Place:
        """Return the place of keys from the spec's top, which stand below this one; where they are not given, this."""
        return Place(self.loaded, keys if self.loaded.has(keys) else self.keys, self.clip)

    def error(self, message: str) -> MotionEditError:
        """Return an error at this place."""
        return self.loaded.error(self.keys, message)


def joint(name: str, skeleton: Skeleton, place: Where) -> int:
    """Return the index of the joint of that name.

    Raises
    ------
    SpecError
        Where the clip has none or several; the message names the clip.
    """
    found = skeleton.indices(name)
    if len(found) == 1:
        return found[0]
    if found:
        raise place.error(f"{place.clip} has {len(found)} joints named '{name}'; a spec needs their names to differ")
    from motionedit.core.body.same_part import same_part  # errors alone ask for it

    names = tuple(dict.fromkeys(skeleton.names))
    # A rig's prefix ("mixamorig:") hides likeness from the general search.
    ending = [other for other in names if other.rpartition(":")[2] == name]
    # What others call the same part may be far from it in letters, and near to another part.
    meant = ending[0] if ending else same_part(name, names) or nearest(name, names)
    hint = f"{ITS_JOINTS}{listed(names)}" if meant is None else f"; did you mean '{meant}'?"
    raise place.error(f"no joint '{name}' in {place.clip}{hint}")


def joints(names: Sequence[str], skeleton: Skeleton, place: Where) -> tuple[int, ...]:
    """Return the indices of the joints of those names; `place` is the list's.

    Raises
    ------
    SpecError, MotionEditErrors
        As `joint`, of all names.
    """
    faults = Faults()
    found = [joint_if_there(name, skeleton, place.at(i), faults) for i, name in enumerate(names)]
    faults.raise_all(f"joints that {place.clip} lacks")
    return tuple(index for index in found if index is not None)


def joint_if_there(name: str, skeleton: Skeleton, place: Where, faults: Faults) -> int | None:
    """Return the index of the joint of that name; None where there is none, which is one of the faults then."""
    return faults.get(lambda: joint(name, skeleton, place), otherwise=None)


def joints_if_there(names: Sequence[str], skeleton: Skeleton, place: Where, faults: Faults) -> tuple[int, ...]:
    """Return the indices of the joints of those names; none where one is not there, which is one of the faults then."""
    none: tuple[int, ...] = ()
    return faults.get(lambda: joints(names, skeleton, place), otherwise=none)


def body(spec: BodySpec, skeleton: Skeleton, place: Where) -> GivenBody:
    """Return what a spec says that joints of a clip are; `place` is the key's.

    Raises
    ------
    SpecError, MotionEditErrors
        Where the clip lacks joints, or a limb's joints do not hang on one another in their order.
    """
    faults = Faults()
    for key in ("left_leg", "right_leg", "left_arm", "right_arm"):
        if names := getattr(spec, key):
            joints_if_there(names, skeleton, place.at(key), faults)
    if spec.head not in (None, NONE):
        joint_if_there(spec.head, skeleton, place.at("head"), faults)
    faults.raise_all(f"joints that {place.clip} lacks")
    legs = _limbs({"left_leg": spec.left_leg, "right_leg": spec.right_leg}, skeleton, place)
    arms = _limbs({"left_arm": spec.left_arm, "right_arm": spec.right_arm}, skeleton, place)
    head = None if spec.head is None else -1 if spec.head == NONE else joint(spec.head, skeleton, place.at("head"))
    return GivenBody(head, legs, arms)


def _limbs(
    given: dict[str, tuple[str, ...] | None], skeleton: Skeleton, place: Where
) -> tuple[tuple[int, ...], ...] | None:
    """Return the joints of a left and a right limb, as `GivenBody` has them."""
    limbs = [_limb(names, skeleton, place.at(key)) for key, names in given.items() if names is not None]
    if not all(limbs):
        return ()
    for one, other in pairwise(limbs):
        if one[-1] in skeleton.chain(other[-1]) or other[-1] in skeleton.chain(one[-1]):
            left, right = given
            raise place.at(left).error(f"must part from {right}: neither limb hangs on the other")
    return tuple(limbs) or None


def _limb(names: tuple[str, ...], skeleton: Skeleton, place: Where) -> tuple[int, ...]:
    limb = joints(names, skeleton, place)
    for upper, lower in pairwise(limb):
        if upper not in skeleton.chain(lower):
            raise place.error(f"'{skeleton.names[lower]}' does not hang on '{skeleton.names[upper]}' in {place.clip}")
    return limb


def effector(spec: EffectorSpec, skeleton: Skeleton, place: Where, *, scale: float = 1.0) -> Effector:
    """Return the point of the skeleton that an effector names, its offset times `scale`.

    Raises
    ------
    SpecError
        Where the joint, or the end site of that number, is not in the clip.
    """
    if not spec.end_site:
        index = joint(spec.joint, skeleton, place.at("joint"))
        return Effector(index, frozen(scale * np.array(spec.offset or (0.0, 0.0, 0.0))))
    index = joint(spec.joint, skeleton, place.at("end_site"))
    sites = [site for site in skeleton.end_sites if site.joint == index]
    if spec.index >= len(sites):
        has = {0: "no end site", 1: "one end site, index 0"}.get(
            len(sites), f"{len(sites)} end sites, index 0 to {len(sites) - 1}"
        )
        raise place.at("index").error(f"'{spec.joint}' in {place.clip} has {has}; not index {spec.index}")
    return Effector(index, frozen(scale * np.array(sites[spec.index].offset, dtype=float)))


def orientation(spec: OrientationSpec) -> FloatArray:
    """Return the unit quaternion of an orientation, shape (4,); Euler values are about x, y, z in any order."""
    values = np.array(spec.values)
    if spec.order is not None:
        axes = rot.euler_axes(spec.order)
        return rot.from_euler(np.radians(values)[list(axes)], axes)
    return rot.exp(np.radians(values)) if spec.kind == "rotation_vector" else rot.normalize(values)


def frame(time: Time, place: Where, motion: Motion, *, events: Mapping[str, float]) -> int:
    """Return the frame of a time in a clip's motion.

    Raises
    ------
    SpecError
        Where the time is outside the clip or names an event that is not known for it.
    """
    try:
        return time.frame(frames=len(motion), frame_time=motion.frame_time, events=events)
    except ValueError as error:
        raise _no_frame(place, (time,), events, str(error)) from None


def frame_range(interval: Interval, place: Where, motion: Motion, *, events: Mapping[str, float]) -> tuple[int, int]:
    """Return the first and last frame of an interval in a clip, with the errors of `frame`."""
    try:
        return interval.frame_range(frames=len(motion), frame_time=motion.frame_time, events=events)
    except ValueError as error:
        raise _no_frame(place, (interval.start, interval.stop), events, str(error)) from None


def _no_frame(place: Where, times: Sequence[Time], events: Mapping[str, float], message: str) -> MotionEditError:
    """Return the error of times in a clip: that an event which the spec lists has no frame in it, or what else is."""
    names = [time.event for time in times if time.event is not None and time.event not in events]
    if not names or not isinstance(place, Place) or not place.loaded.has(("events", names[0])):
        return place.error(f"in {place.clip}: {message}")
    error = place.error(f"in {place.clip}: event '{names[0]}' has no frame; add one to its frames, or give it detect")
    return NoEventFrameError(error.message, file=error.file, line=error.line, key=error.key)


def recruit_place(constraint: Place) -> Place:
    """Return the place of a constraint's recruiting, its own or the spec's defaults; of such a place itself."""
    if constraint.keys[-1:] == ("recruit",):
        return constraint
    for keys in ((*constraint.keys, "recruit"), ("defaults", "recruit")):
        if constraint.loaded.has(keys):
            return Place(constraint.loaded, keys, constraint.clip)
    return constraint


def recruited_joints(
    names: Sequence[str], skeleton: Skeleton, place: Place, *, travel: int = 0
) -> tuple[tuple[int, ...], bool]:
    """Return the indices of a list of recruited joints, and whether it names the root's translation.

    Parameters
    ----------
    names : sequence of str
        Joints; ``ROOT.position``, or the name of the root (or of the joint `travel`, which carries the travel)
        with ``.position``, is the translation.
    place : Place
        That of the list.

    Raises
    ------
    SpecError, MotionEditErrors
        Where the clip lacks joints, or another joint's translation is named.
    """
    faults = Faults()
    found = [
        faults.get(partial(_recruited, name, skeleton, place.at(i), travel=travel), otherwise=None)
        for i, name in enumerate(names)
    ]
    faults.raise_all(f"joints that {place.clip} lacks")
    return tuple(index for index in found if index is not None), None in found


def _recruited(name: str, skeleton: Skeleton, place: Where, *, travel: int) -> int | None:
    """Return the index of a recruited joint, None where the root's translation is named."""
    base, dot, ending = name.rpartition(".")
    if not (dot and ending == "position") or name in skeleton.names:
        return joint(name, skeleton, place)
    if base == "ROOT" or joint(base, skeleton, place) in (0, travel):
        return None
    raise place.error(f"only the root has a position to recruit: {skeleton.names[0]}.position, not {name}")
