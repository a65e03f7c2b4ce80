"""The skeleton: a tree of joints with offsets, channels and end sites, and the joints grouped by depth."""

from __future__ import annotations

from functools import cached_property, lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class EndSite:
    """The end of a chain: a point fixed in its joint's frame.

    `joint` is the joint's index, `offset` has shape (3,) in clip units.
    """

    joint: int
    offset: FloatArray


@dataclass(frozen=True, eq=False)
class LevelOrder:
    """The joints by depth: `joints` (J,), the `parents` (J,) as places in that order, and the levels below the root.

    `levels` are (start, stop) places; the root's place is 0, and it stands as its own parent.
    """

    joints: IntArray
    parents: IntArray
    levels: tuple[tuple[int, int], ...]


@dataclass(frozen=True, eq=False)
class RotationGroup:
    """G joints with the same A Euler axes: `joints` (G,) and the `columns` (G, A) of their channels, in that order."""

    axes: tuple[int, ...]
    joints: IntArray
    columns: IntArray

    @cached_property
    def in_a_row(self) -> tuple[slice | IntArray, slice | IntArray]:
        """The joints, and all their columns: slices, which numpy copies much faster, where they are in a row."""
        return slice_or_all(self.joints), slice_or_all(self.columns.reshape(-1))


def slice_or_all(indices: IntArray) -> slice | IntArray:
    """Return indices as a slice where they follow each other, as in most files."""
    first, count = int(indices[0]), len(indices)
    return slice(first, first + count) if np.array_equal(indices, np.arange(first, first + count)) else indices


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A tree of J joints in file order, so that a parent stands before its children.

    Attributes
    ----------
    names : J strings
        As in the file; they need not be unique (see `index`).
    parents : shape (J,)
        Index of each joint's parent, -1 for the root.
    offsets : shape (J, 3), clip units
        From the parent's origin, in the parent's frame.
    channels : J tuples
        Such as ``("Xposition", "Zrotation")``, in file order and canonical spelling; may be empty.
    end_sites : tuple of EndSite
        In file order; a joint may have none or several.
    """

    names: tuple[str, ...]
    parents: IntArray
    offsets: FloatArray
    channels: tuple[tuple[str, ...], ...]
    end_sites: tuple[EndSite, ...] = ()

    def __len__(self) -> int:
        return len(self.names)

    def __reduce__(self) -> tuple[Callable[[bytes], Skeleton], tuple[bytes]]:
        # Clips of a folder mostly share one: it goes to another process as bytes by which that finds its own again.
        return _unpacked, (self._packed,)

    @cached_property
    def _packed(self) -> bytes:
        import pickle

        return pickle.dumps((self.names, self.parents, self.offsets, self.channels, self.end_sites))

    @cached_property
    def channel_count(self) -> int:
        """Number of values in a row of the file."""
        return sum(len(names) for names in self.channels)

    @cached_property
    def channel_starts(self) -> IntArray:
        """Column of each joint's first channel, shape (J,)."""
        counts = [len(names) for names in self.channels]
        return frozen(np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.intp))

    @cached_property
    def rotation_axes(self) -> tuple[tuple[int, ...], ...]:
        """Euler axes of each joint in channel order: (2, 0, 1) for ZXY, () for none."""
        return tuple(
            tuple("XYZ".index(name[0]) for name in names if name.endswith("rotation")) for names in self.channels
        )

    @cached_property
    def position_axes(self) -> tuple[tuple[int, ...], ...]:
        """Axes of each joint that position channels replace in OFFSET, in channel order."""
        return tuple(
            tuple("XYZ".index(name[0]) for name in names if name.endswith("position")) for names in self.channels
        )

    def turns_freely(self, joint: int) -> bool:
        """Return whether a joint's channels turn it about three axes."""
        return len(set(self.rotation_axes[joint])) == len("XYZ")

    @cached_property
    def rotation_groups(self) -> tuple[RotationGroup, ...]:
        """The joints with rotation channels, together where their axes are the same."""
        groups: dict[tuple[int, ...], list[int]] = {}
        for j, axes in enumerate(self.rotation_axes):
            if axes:
                groups.setdefault(axes, []).append(j)
        return tuple(
            RotationGroup(
                axes,
                frozen(np.array(joints, dtype=np.intp)),
                frozen(np.array([self.columns(j, "rotation") for j in joints], dtype=np.intp)),
            )
            for axes, joints in groups.items()
        )

    def columns(self, joint: int, kind: str) -> list[int]:
        """Return the columns of a joint's channels of one kind, `rotation` or `position`, in channel order."""
        return self._columns[kind][joint]

    @cached_property
    def _columns(self) -> dict[str, list[list[int]]]:
        """Columns of every joint's channels, by their kinds."""
        starts = self.channel_starts.tolist()
        return {
            kind: [
                [start + c for c, name in enumerate(names) if name.endswith(kind)]
                for start, names in zip(starts, self.channels, strict=True)
            ]
            for kind in ("rotation", "position")
        }

    @cached_property
    def translated(self) -> IntArray:
        """Indices of the P joints that have position channels, shape (P,)."""
        return frozen(np.array([j for j, axes in enumerate(self.position_axes) if axes], dtype=np.intp))

    @cached_property
    def translation_places(self) -> IntArray:
        """Each joint's place among `translated`, shape (J,); -1 where it has no position channels."""
        places = np.full(len(self), -1, dtype=np.int64)
        places[self.translated] = np.arange(len(self.translated))
        return frozen(places)

    @cached_property
    def levels(self) -> tuple[IntArray, ...]:
        """Joint indices by depth, the root first: forward kinematics goes level by level."""
        depth = np.zeros(len(self), dtype=np.intp)
        for j in range(1, len(self)):
            depth[j] = depth[self.parents[j]] + 1
        return tuple(frozen(np.flatnonzero(depth == d)) for d in range(int(depth.max()) + 1))

    @cached_property
    def level_order(self) -> LevelOrder:
        """The joints sorted by depth, so that each level is a slice."""
        order = np.concatenate(self.levels)
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        parents = np.where(order > 0, place[self.parents[order]], 0)
        bounds = np.cumsum([len(level) for level in self.levels]).tolist()
        return LevelOrder(frozen(order), frozen(parents), tuple(pairwise(bounds)))

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """Indices of each joint's children, in file order."""
        lists: list[list[int]] = [[] for _ in self.names]
        for j, parent in enumerate(self.parents):
            if parent >= 0:
                lists[parent].append(j)
        return tuple(map(tuple, lists))

    def chain(self, joint: int) -> IntArray:
        """Return the joints from the root down to `joint`, both in."""
        known = self._chains.get(joint)
        if known is None:
            path = [int(joint)]
            while self.parents[path[-1]] >= 0:
                path.append(int(self.parents[path[-1]]))
            known = self._chains[joint] = frozen(np.array(path[::-1], dtype=np.intp))
        return known

    @cached_property
    def _chains(self) -> dict[int, IntArray]:
        """Chains by their last joint, those that were asked for: of a long chain all would take its square."""
        return {}

    def between(self, start: int, stop: int) -> list[int]:
        """Return the joints below one of a chain down to another, that one in; none where it does not lead there."""
        chain: list[int] = self.chain(stop).tolist()
        return chain[chain.index(start) + 1 :] if start in chain else []

    def indices(self, name: str) -> tuple[int, ...]:
        """Return every joint of that name: none, one, or several where the file repeats a name."""
        return tuple(j for j, other in enumerate(self.names) if other == name)


@lru_cache(maxsize=8)
def _unpacked(packed: bytes) -> Skeleton:
    import pickle

    names, parents, offsets, channels, end_sites = pickle.loads(packed)  # noqa: S301  our own
    return Skeleton(names, frozen(parents), frozen(offsets), channels, end_sites)


def same_skeleton(one: Skeleton, other: Skeleton) -> bool:
    """Return whether two skeletons are the same to the last bit: names, parents, channels, offsets, end sites."""
    if one is other:
        return True
    if (one.names, one.channels) != (other.names, other.channels) or len(one.end_sites) != len(other.end_sites):
        return False
    sites = zip(one.end_sites, other.end_sites, strict=True)
    return (
        np.array_equal(one.parents, other.parents)
        and np.array_equal(one.offsets, other.offsets)
        and all(a.joint == b.joint and np.array_equal(a.offset, b.offset) for a, b in sites)
    )
