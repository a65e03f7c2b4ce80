"""Feet held, put on a floor, taken along a bent path and a turned one: all clips of a folder, as they are written.

Run: python -m studies.feet FOLDER
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import motionedit
from motionedit.core import rotations as rot
from motionedit.core.body.contacts import sole_tracks
from motionedit.core.body.quality import jerk_rms
from motionedit.core.feet.measures import foot_measures
from motionedit.core.kinematics import forward
from motionedit.core.units import STANDARD_LEG
from motionedit.jobs.clip.facts import ClipFacts, facts_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from motionedit.core.arrays import FloatArray

BENDS = 7  # frames at which a turned path is told
FEET = {"name": "feet", "type": "footplants", "priority": 10}
HEADINGS = ("clip", "plants", "drift mm", "drift mm", "slide %", "slide %", "under %", "under %", "jerk x")
COLUMNS = (*HEADINGS, "body cm", "median", "frames/s")


def specs(facts: ClipFacts) -> dict[str, list[dict[str, Any]]]:
    """Return the constraints of each edit: feet held, on a floor, on a path bent by 20 cm or turned."""
    aside = np.zeros(3)
    aside[int(np.argmin(np.abs(facts.up)))] = 0.2 / STANDARD_LEG * facts.anatomy.leg_length
    bent = {facts.first: np.zeros(3), (facts.first + facts.last) // 2: aside, facts.last: np.zeros(3)}
    return {
        "feet": [FEET],
        "floor": [{**FEET, "height": 0}, {"name": "floor", "type": "floor", "priority": 9}],
        "bent": [{**FEET, "at": "path"}, along(facts, bent)],
        "turned": [{**FEET, "at": "path"}, along(facts, turned(facts, 30.0))],
        "turned by 45": [{**FEET, "at": "path"}, along(facts, turned(facts, 45.0))],
    }


def turned(facts: ClipFacts, degrees: float) -> dict[int, FloatArray]:
    """Return the shifts, by frame, of a path turned evenly from its first frame to its last."""
    way, shifts = facts.poses.positions[:, facts.travel], {}
    frames = np.linspace(facts.first, facts.last, BENDS)
    for frame, angle in zip(frames, np.radians(np.linspace(0.0, degrees, BENDS)), strict=True):
        from_start = way[round(frame)] - way[facts.first]
        shifts[round(frame)] = rot.rotate(rot.exp(angle * facts.up), from_start) - from_start
    return shifts


def along(facts: ClipFacts, shifts: Mapping[int, FloatArray]) -> dict[str, Any]:
    """Return the constraint that shifts the root's path at frames."""
    points = [{"at": frame, "shift": shift.tolist()} for frame, shift in shifts.items()]
    root = facts.clip.motion.skeleton.names[facts.travel]
    return {"type": "position", "effector": root, "priority": 5, "points": points}


def measured(before: ClipFacts, after: ClipFacts, seconds: float) -> list[float]:
    """Return the numbers of a row: lengths at a leg of 0.85 m, shares in percent, before and after."""
    scale = STANDARD_LEG / before.anatomy.leg_length
    frame_time, first = before.clip.motion.frame_time, before.first
    one, other = forward(before.clip.motion), forward(after.clip.motion)
    mine, theirs = (
        foot_measures(
            sole_tracks(poses, before.anatomy),
            before.phases,
            before.anatomy,
            up=before.up,
            first=first,
            frame_time=frame_time,
        )
        for poses in (one, other)
    )
    legs = {j for leg in before.anatomy.legs or () for j in leg.joints}
    skeleton = before.clip.motion.skeleton
    body = [j for j in range(len(skeleton)) if not legs & set(map(int, skeleton.chain(j)))]
    moved = scale * 100.0 * np.linalg.norm(other.positions[first:, body] - one.positions[first:, body], axis=-1)
    jerks = [jerk_rms(poses.positions, frame_time=frame_time, first=first) for poses in (one, other)]
    return [
        *(1000.0 * each.drift_max for each in (mine, theirs)),
        *(100.0 * each.sliding_share for each in (mine, theirs)),
        *(100.0 * each.penetration_share for each in (mine, theirs)),
        jerks[1] / jerks[0],
        float(moved.max()),
        float(np.median(moved)),
        len(before.clip.motion) / seconds,
    ]


def rows(clips: Sequence[Path], which: str, folder: Path) -> Iterator[tuple[str, int, list[float]]]:
    """Yield name, number of plants and measures of each clip that has plants, edited and read back."""
    for path in clips:
        before = facts_of(motionedit.read(path))
        if not before.phases:
            continue
        spec = {"constraints": specs(before)[which]}
        began = time.perf_counter()
        edit = motionedit.edit_prioritized(path, spec)
        seconds = time.perf_counter() - began
        after = facts_of(motionedit.read(edit.write(folder / f"{path.stem}-{which}.bvh")))
        yield path.stem, len(before.phases), measured(before, after, seconds)


def main(arguments: Sequence[str]) -> int:
    """Print a table for each edit: a row a clip, then the worst and the median."""
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    clips = sorted(Path(arguments[0]).rglob("*.bvh"))
    with tempfile.TemporaryDirectory() as folder:
        for which in ("feet", "floor", "bent", "turned", "turned by 45"):
            print(f"\n{which}\n" + f"{COLUMNS[0]:<30}" + "".join(f"{word:>10}" for word in COLUMNS[1:]))
            found = list(rows(clips, which, Path(folder)))
            for name, plants, values in found:
                print(f"{name[:29]:<30}{plants:10d}" + "".join(f"{value:10.3g}" for value in values))
            table = np.array([values for _, _, values in found])
            worst = np.append(table[:, :-1].max(axis=0), table[:, -1].min())
            for word, values in (("worst", worst), ("median", np.median(table, axis=0))):
                print(f"{word:<40}" + "".join(f"{value:10.3g}" for value in values))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
