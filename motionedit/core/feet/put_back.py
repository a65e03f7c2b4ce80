"""Feet put back after an edit: where a whole foot stands in the reference it goes as it goes there, place and turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen, runs
from motionedit.core.feet.goals import Ground
from motionedit.core.feet.keep import onto_stances
from motionedit.core.feet.legs import turns_freely
from motionedit.core.feet.stance import Stance, feet_of, foot_path
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import FootPlant
    from motionedit.core.feet.stance import Foot, FootPath

# Seconds: a foot with a goal so shortly before it stands, or after, does not stand where it did. Put back there, it
# would swing far out on its way.
NEARBY = 0.15
# Seconds before a foot is lifted, and after, in which it does not stand: a walker's is in the air for half a second.
LIFTS = 0.25

# T and D of plants that go alike: seconds between them, and metres at leg length 0.85 m. Feet side by side are about so
# far apart, the steps of a walk more than twice as far.
_TOGETHER, _BESIDE = 0.3, 0.3

_ROUNDING = 1e-12  # of quaternions: a leg that is turned by no more stays as it is, to the bit


@dataclass(frozen=True)
class Fixed:
    """A joint that is where the edit put it at a frame, and `turned` as the edit turned it, too.

    One that is `lifted` takes its foot off the ground there, and no plant along.
    """

    joint: int
    frame: int
    turned: bool = False
    lifted: bool = False


@dataclass(frozen=True, eq=False)
class StandingFoot:
    """A foot and when it stands: `intervals` of frames, both ends in; what of its leg is `fixed` stays as edited.

    Of n plants each goes by its way, shape (n, 3); None: it stays where it is.
    """

    foot: Foot
    intervals: tuple[tuple[int, int], ...]
    fixed: tuple[Fixed, ...] = ()
    ways: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class PutBack:
    """The motion with its feet put back, and what was changed: `touched` (F, J) joints, `moved` (F,) travel."""

    motion: Motion
    touched: BoolArray
    moved: BoolArray


def standing_feet(
    motion: Motion,
    anatomy: Anatomy,
    plants: Sequence[FootPlant],
    *,
    fixed: Collection[Fixed] = (),
    left_alone: Collection[int] = (),
) -> list[StandingFoot]:
    """Return the feet of a body whose legs can be turned freely, with their plants.

    Parameters
    ----------
    fixed : collection of Fixed
        A plant goes as a whole to where its foot is fixed; one in which a knee is, or the foot at several frames, is
        left alone, and so is one that begins or ends within 0.15 s of such a frame. One in which the foot is lifted
        stands where it does, but for 0.25 s before and after.
    left_alone : collection of int
        Joints that stay as they are; a leg with one of them is not turned.
    """
    nearby, away = round(NEARBY / motion.frame_time), round(LIFTS / motion.frame_time)
    found = []
    for foot in feet_of(anatomy):
        if not turns_freely(motion.skeleton, foot.leg, left_alone=left_alone):
            continue
        own = [each for each in fixed if foot.leg.thigh in motion.skeleton.chain(each.joint)]
        parts = [part for p in plants if p.foot == foot.side for part in _parts(p, own, away=away)]
        intervals = tuple(part for part in parts if _stands_whole(*part, own, foot, nearby=nearby))
        found.append(StandingFoot(foot, intervals, tuple(sorted(own, key=lambda each: (each.frame, each.joint)))))
    return found


def _parts(plant: FootPlant, fixed: Sequence[Fixed], *, away: int) -> list[tuple[int, int]]:
    """Return the parts of a plant, both ends in, that are farther away from the frames at which its foot is lifted."""
    frames = np.arange(plant.start, plant.stop + 1)
    lifts = np.array([each.frame for each in fixed if each.lifted], dtype=np.intp)
    down = (np.abs(frames[:, None] - lifts) > away).all(axis=1)
    return [(plant.start + first, plant.start + last) for first, last in runs(down)]


def _stands_whole(start: int, stop: int, fixed: Sequence[Fixed], foot: Foot, *, nearby: int) -> bool:
    inside = [each for each in fixed if start <= each.frame <= stop]
    bent = any(each.joint in (foot.leg.thigh, foot.leg.knee) for each in inside)
    several = len({each.frame for each in inside}) > 1
    near = any(min(abs(each.frame - start), abs(each.frame - stop)) <= nearby for each in fixed)
    return not (bent or several or near)


def carried(
    feet: Sequence[StandingFoot], edited: Motion, reference: Motion, anatomy: Anatomy, *, up: FloatArray
) -> list[StandingFoot]:
    """Return feet whose plants an edit takes along on the ground, each as a whole.

    A plant goes by the mean of its frames, and of those of others as much as they are near: exp(-(g / T)^2 / 2 -
    (d / D)^2 / 2), g the time between both and d how far apart they are. Or a foot that comes down again where it was,
    or stands beside the other, would hop away from there. Plants that are fixed do not count.
    """
    before, now = forward(reference), forward(edited)
    theirs, mine = ([foot_path(poses, each.foot).ankle for each in feet] for poses in (before, now))
    stands = [(k, slice(start, stop + 1)) for k, each in enumerate(feet) for start, stop in each.intervals]
    if not stands:
        return list(feet)
    places = np.array([theirs[k][span].mean(axis=0) for k, span in stands])
    own = np.array([(mine[k][span] - theirs[k][span]).mean(axis=0) for k, span in stands])
    frames = np.array([span.stop - span.start for _, span in stands])
    free = [not any(span.start <= each.frame < span.stop for each in feet[k].fixed) for k, span in stands]
    after = np.array([[max(one.start - other.stop + 1, 0) for _, other in stands] for _, one in stands])
    between = np.maximum(after, after.T) * (edited.frame_time / _TOGETHER)
    apart = rot.length(places[:, None] - places) * (STANDARD_LEG / (anatomy.leg_length * _BESIDE))
    share = np.exp(-0.5 * (between**2 + apart**2)) * np.where(free, frames, 0)
    ways = share @ own / np.maximum(share.sum(axis=1), np.finfo(float).tiny)[:, None]
    level = ways - (ways @ up)[:, None] * up
    parts = np.split(level, np.cumsum([len(each.intervals) for each in feet])[:-1])
    return [replace(each, ways=frozen(part)) for each, part in zip(feet, parts, strict=True)]


def put_back(
    edited: Motion,
    reference: Motion,
    feet: Sequence[StandingFoot],
    anatomy: Anatomy,
    *,
    up: FloatArray,
    travel: int,
    first: int = 0,
) -> PutBack:
    """Return an edited motion whose feet stand where the reference's stand, or by their ways from there.

    Heels stay down as long as they do in the reference, slips and all; the pelvis is lowered where legs are short: see
    `onto_stances`.

    Parameters
    ----------
    edited, reference : Motion
        Of one skeleton, frame by frame; clip units.
    up : shape (3,)
    travel : int
        The joint that carries the travel.
    first : int
        Frames before this one are a rest pose and stay as they are.
    """
    before, now = forward(reference), forward(edited)
    stances = [(each.foot, _stance(each, foot_path(before, each.foot), foot_path(now, each.foot))) for each in feet]
    # Lifted before it comes down, a leg that is nearly straight would kick: what the edit makes of the air is kept.
    ground = Ground(up, None, np.inf, anatomy.leg_length)
    kept = onto_stances(edited, now, stances, anatomy, ground, travel=travel, first=first)
    touched = np.abs(kept.motion.rotations - edited.rotations).max(axis=-1) > _ROUNDING
    rotations = np.where(touched[..., None], kept.motion.rotations, edited.rotations)
    motion = Motion(edited.skeleton, frozen(rotations), kept.motion.translations, edited.frame_time)
    return PutBack(motion, touched, kept.lowered > 0.0)


def _stance(standing: StandingFoot, theirs: FootPath, now: FootPath) -> Stance:
    """Return where a foot stands: flat as it goes in the reference, and where the edit has it at its fixed frames."""
    down, whole = np.zeros(len(now.ankle), dtype=np.bool_), np.full(len(now.ankle), -1)
    heel, toe, turn = now.ankle.copy(), now.toe_place.copy(), now.turn.copy()
    for stand, (start, stop) in enumerate(standing.intervals):
        span = slice(start, stop + 1)
        heel[span], toe[span], turn[span] = theirs.ankle[span], theirs.toe_place[span], theirs.turn[span]
        inside = [each for each in standing.fixed if start <= each.frame <= stop]
        if inside:
            f = inside[0].frame
            if any(each.turned for each in inside):
                about, Q = theirs.ankle[f], rot.multiply(now.turn[f], rot.conjugate(theirs.turn[f]))
                heel[span], toe[span] = (about + rot.rotate(Q, each[span] - about) for each in (heel, toe))
                turn[span] = rot.multiply(Q, turn[span])
            at_toe = standing.foot.leg.ankle not in [each.joint for each in inside]
            way = now.toe_place[f] - toe[f] if at_toe else now.ankle[f] - heel[f]
        else:
            way = np.zeros(3) if standing.ways is None else standing.ways[stand]
        heel[span], toe[span] = heel[span] + way, toe[span] + way
        down[span], whole[span] = True, stand
    free = sorted({each.frame for each in standing.fixed if not down[each.frame]})
    down[free], whole[free] = True, len(standing.intervals) + np.arange(len(free))
    return Stance(down, down, heel, toe, turn, whole)
