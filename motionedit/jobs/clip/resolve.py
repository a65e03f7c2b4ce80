"""What a spec names, found in a clip: joints, effectors, frames, events; each error with the spec's line."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Protocol

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.kinematics import Effector
from motionedit.dataclass import dataclass
from motionedit.spec.faults import did_you_mean, listed

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.skeleton import Skeleton
    from motionedit.errors import MotionEditError
    from motionedit.spec.document import Document
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.times import Interval, Time
    from motionedit.spec.values import EffectorSpec, OrientationSpec


class Source(Protocol):
    """What a place is in: a spec, or rules that a model has kept of one."""

    def has(self, keys: Sequence[str | int]) -> bool:
        """Return whether the key is given."""

    def error(self, keys: Sequence[str | int], message: str) -> MotionEditError:
        """Return an error at a key."""


@dataclass(frozen=True)
class Place:
    """A key of a spec, looked at for one clip: where an error is, and the clip's name in it."""

    loaded: Source
    keys: tuple[str | int, ...]
    clip: str

    def at(self, *keys: str | int) -> Place:
        """Return the place of a key below this one; where the spec does not give it, this one."""
        below = (*self.keys, *keys)
        return Place(self.loaded, below if self.loaded.has(below) else self.keys, self.clip)

    def error(self, message: str) -> MotionEditError:
        """Return an error at this place."""
        return self.loaded.error(self.keys, message)


def joint(name: str, skeleton: Skeleton, place: Place) -> int:
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
    names = tuple(dict.fromkeys(skeleton.names))
    # A rig's prefix ("mixamorig:") hides likeness from the general search.
    ending = [other for other in names if other.rpartition(":")[2] == name]
    hint = f"did you mean '{ending[0]}'?" if ending else did_you_mean(name, names, otherwise="")
    raise place.error(f"no joint '{name}' in {place.clip}; {hint or f'its joints are {listed(names)}'}")


def joints(names: Sequence[str], skeleton: Skeleton, place: Place) -> tuple[int, ...]:
    """Return the indices of the joints of those names; `place` is the list's."""
    return tuple(joint(name, skeleton, place.at(i)) for i, name in enumerate(names))


def effector(spec: EffectorSpec, skeleton: Skeleton, place: Place) -> Effector:
    """Return the point of the skeleton that an effector names.

    Raises
    ------
    SpecError
        Where the joint, or the end site of that number, is not in the clip.
    """
    if not spec.end_site:
        index = joint(spec.joint, skeleton, place.at("joint"))
        return Effector(index, frozen(np.array(spec.offset or (0.0, 0.0, 0.0))))
    index = joint(spec.joint, skeleton, place.at("end_site"))
    sites = [site for site in skeleton.end_sites if site.joint == index]
    if spec.index >= len(sites):
        has = {0: "no end site", 1: "one end site, index 0"}.get(
            len(sites), f"{len(sites)} end sites, index 0 to {len(sites) - 1}"
        )
        raise place.at("index").error(f"'{spec.joint}' in {place.clip} has {has}; not index {spec.index}")
    return Effector(index, frozen(np.array(sites[spec.index].offset, dtype=float)))


def orientation(spec: OrientationSpec) -> FloatArray:
    """Return the unit quaternion of an orientation, shape (4,); Euler values are about x, y, z in any order."""
    values = np.array(spec.values)
    if spec.order is not None:
        axes = rot.euler_axes(spec.order)
        return rot.from_euler(np.radians(values)[list(axes)], axes)
    return rot.exp(np.radians(values)) if spec.kind == "rotation_vector" else rot.normalize(values)


def frame(time: Time, place: Place, *, frames: int, frame_time: float, events: Mapping[str, float]) -> int:
    """Return the frame of a time in a clip.

    Raises
    ------
    SpecError
        Where the time is outside the clip or names an event that is not known for it.
    """
    try:
        return time.frame(frames=frames, frame_time=frame_time, events=events)
    except ValueError as error:
        raise place.error(f"in {place.clip}: {error}") from None


def frame_range(
    interval: Interval, place: Place, *, frames: int, frame_time: float, events: Mapping[str, float]
) -> tuple[int, int]:
    """Return the first and last frame of an interval in a clip, with the errors of `frame`."""
    try:
        return interval.frame_range(frames=frames, frame_time=frame_time, events=events)
    except ValueError as error:
        raise place.error(f"in {place.clip}: {error}") from None


def recruit_place(constraint: Place) -> Place:
    """Return the place of a constraint's recruiting, which may be the spec's defaults."""
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
    SpecError
        Where the clip lacks a joint, or another joint's translation is named.
    """
    found: list[int] = []
    translation = False
    for i, name in enumerate(names):
        base, dot, ending = name.rpartition(".")
        if not (dot and ending == "position") or name in skeleton.names:
            found.append(joint(name, skeleton, place.at(i)))
        elif base == "ROOT" or joint(base, skeleton, place.at(i)) in (0, travel):
            translation = True
        else:
            root = skeleton.names[0]
            raise place.at(i).error(f"only the root has a position to recruit: {root}.position, not {name}")
    return tuple(found), translation


def explicit_events(loaded: LoadedSpec[Document], relative: str, *, others: Collection[str] = ()) -> dict[str, int]:
    """Return the frames that the spec itself gives for a clip's events.

    Parameters
    ----------
    relative : str
        The clip's path below the given folder, or its name.
    others : collection of str
        The same of all clips of the run, so that a stem that two of them share is refused.

    Raises
    ------
    SpecError
        Where a stem is not unique.
    """
    found: dict[str, int] = {}
    for name, event in loaded.model.events.items():
        if event.frames is None:
            continue
        value = event.frames.every
        if value is None:
            place = Place(loaded, ("events", name, "frames"), relative)
            key = _clip_key(event.frames.by_clip, relative, others, place)
            if key is None:
                continue
            value = event.frames.by_clip[key]
        found[name] = value
    return found


def _clip_key(by_clip: Mapping[str, int], relative: str, others: Collection[str], place: Place) -> str | None:
    """Return the key that means a clip: its path or its name, each with or without .bvh."""
    path = _posix(relative)
    keys = {_posix(key): key for key in by_clip}
    for whole_path in (path, _without_suffix(path)):
        if whole_path in keys:
            return keys[whole_path]
    for name in _names(path):
        if name not in keys:
            continue
        paths = [_posix(other) for other in others if _posix(other) != path]
        if any(name in (other, _without_suffix(other)) for other in paths):
            # It is the whole path of another clip.
            return None
        twins = [other for other in paths if name in _names(other)]
        if twins:
            message = f"'{keys[name]}' may be {path} or {twins[0]}; give the clip's path"
            raise place.at(keys[name]).error(message)
        return keys[name]
    return None


def _names(path: str) -> tuple[str, str]:
    name = PurePosixPath(path).name
    return name, _without_suffix(name)


def _posix(path: str) -> str:
    return str(PurePosixPath(path.replace("\\", "/")))


def _without_suffix(path: str) -> str:
    return path[:-4] if path.casefold().endswith(".bvh") else path
