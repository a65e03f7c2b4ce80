"""Where a constraint's task shall be, frame by frame: its targets, and others on the way from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core import rotations as rot
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Targets:
    """Where a constraint's task shall be: frames `first` to `last`.

    Positions (n, 3), rotations (n, 4), lengths (n,), postures (n, k, 4) of k joints, None of what it has none of.
    """

    first: int
    last: int
    positions: FloatArray | None = None
    rotations: FloatArray | None = None
    lengths: FloatArray | None = None
    postures: FloatArray | None = None

    @property
    def span(self) -> slice:
        """Their frames."""
        return slice(self.first, self.last + 1)

    @property
    def all_positions(self) -> FloatArray:
        """The positions, of targets that have them."""
        if self.positions is None:
            raise ValueError("these targets have no positions")
        return self.positions

    @property
    def all_lengths(self) -> FloatArray:
        """The lengths, of targets that have them."""
        if self.lengths is None:
            raise ValueError("these targets have no lengths")
        return self.lengths

    @property
    def parts(self) -> tuple[FloatArray | None, ...]:
        """Positions, rotations, lengths and postures."""
        return self.positions, self.rotations, self.lengths, self.postures

    def within(self, frames: slice) -> Targets:
        """Return the targets at some of their frames."""
        if frames.start == self.first and frames.stop == self.last + 1:
            return self
        here = slice(frames.start - self.first, frames.stop - self.first)
        return Targets(frames.start, frames.stop - 1, *(None if part is None else part[here] for part in self.parts))

    def since(self, frame: int) -> Targets:
        """Return the same targets of a motion that begins at a frame of this one."""
        return self if frame == 0 else Targets(self.first - frame, self.last - frame, *self.parts)

    def with_part(self, part: Targets) -> Targets:
        """Return the targets with those at some of their frames replaced."""
        here = slice(part.first - self.first, part.last + 1 - self.first)
        parts = [None if own is None else own.copy() for own in self.parts]
        for own, new in zip(parts, part.parts, strict=True):
            if own is not None and new is not None:
                own[here] = new
        return Targets(self.first, self.last, *parts)

    def positions_at(self, frames: IntArray) -> FloatArray:
        """Return the positions at frames of the clip, shape (N, 3)."""
        return _at(self.positions, frames, self.first, "positions")

    def rotations_at(self, frames: IntArray) -> FloatArray:
        """Return the rotations at frames of the clip, shape (N, 4)."""
        return _at(self.rotations, frames, self.first, "rotations")

    def lengths_at(self, frames: IntArray) -> FloatArray:
        """Return the lengths at frames of the clip, shape (N,)."""
        return _at(self.lengths, frames, self.first, "lengths")


def _at(values: FloatArray | None, frames: IntArray, first: int, name: str) -> FloatArray:
    """Return values, those of frames from `first` on, at growing frames; those that follow each other are a view."""
    if values is None:
        raise ValueError(f"these targets have no {name}")
    start, count = int(frames[0]) - first, len(frames)
    if int(frames[-1]) - first == start + count - 1:
        return values[start : start + count]
    at: FloatArray = values[frames - first]
    return at


def between(one: Targets, other: Targets, share: FloatArray) -> Targets:
    """Return targets on the way from one to another of the same frames, so much of it each, shape (n,)."""
    return moved(one, one, other, share)


def moved(targets: Targets, before: Targets, after: Targets, share: FloatArray) -> Targets:
    """Return targets moved along from where one motion has a task to where another has it, so much each, shape (n,)."""
    positions, lengths = targets.positions, targets.lengths
    if positions is not None:
        positions = positions + share[:, None] * (after.all_positions - before.all_positions)
    if lengths is not None:
        lengths = lengths + share * (after.all_lengths - before.all_lengths)
    rotations = _turned(targets.rotations, before.rotations, after.rotations, share[:, None])
    postures = _turned(targets.postures, before.postures, after.postures, share[:, None, None])
    return Targets(targets.first, targets.last, positions, rotations, lengths, postures)


def _turned(
    rotations: FloatArray | None, before: FloatArray | None, after: FloatArray | None, share: FloatArray
) -> FloatArray | None:
    """Return rotations turned by so much of the way from one to another; as they are where one of these is None."""
    if rotations is None or before is None or after is None:
        return rotations
    return rot.multiply(rotations, rot.exp(share * rot.log(rot.between(before, after))))
