"""The files that ship: clips as BVH, the hits, the balls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from data.generator.golf import BALL_HEIGHT, make_swing
from data.generator.kick import make_kick
from data.generator.players import GROUPS, SHIPPED_RATE, shipped_swings
from data.generator.skating import skating
from data.generator.walk import make_walk
from motionedit.core.bvh import new_bytes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

# Enough for a thousandth of a millimetre at the club's head; few enough that the last digit does not hang on the
# machine's arithmetic.
DECIMALS = 5


def shipped_files(*, noise: float = 1.0, rate: float = SHIPPED_RATE) -> Iterator[tuple[str, bytes]]:
    """Yield each file's path below data/ and its bytes.

    Parameters
    ----------
    noise : scale of the golfers' noise; 0 leaves it out
    rate : Hz, of the golf clips
    """
    swings = shipped_swings(noise=noise)
    names = [f"swing{number:02d}" for number in range(1, len(swings) + 1)]
    for name, swing in zip(names, swings, strict=True):
        yield f"golf/{name}.bvh", new_bytes(make_swing(swing, rate=rate), decimals=DECIMALS)
    hits = [f"{name},{round(swing.timing.hit * rate)}\n" for name, swing in zip(names, swings, strict=True)]
    yield "golf/events.csv", ("clip,frame\n" + "".join(hits)).encode()
    balls = [
        f"{name}\t{group + 1}\t{swing.ball[0]:.1f}\t{BALL_HEIGHT:.1f}\t{swing.ball[1]:.1f}\n"
        for name, group, swing in zip(names, GROUPS, swings, strict=True)
    ]
    yield "golf/balls.tsv", ("clip\tstyle\tx\ty\tz\n" + "".join(balls)).encode()
    walk = make_walk()
    yield "walk.bvh", new_bytes(walk, decimals=DECIMALS)
    yield "walk-skating.bvh", new_bytes(skating(walk), decimals=DECIMALS)
    yield "kick.bvh", new_bytes(make_kick(), decimals=DECIMALS)


def write_shipped(folder: Path, *, noise: float = 1.0, rate: float = SHIPPED_RATE) -> Iterator[Path]:
    """Write the files below a folder and yield their paths."""
    for name, content in shipped_files(noise=noise, rate=rate):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        yield path
