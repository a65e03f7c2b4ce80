"""Feet put back after edit-pc, on strokes left out of the database that edits them, measured in the written files.

Each stroke's joint is asked to be, at the frame of the hit, where another stroke has it when both stand with their hips
in one place and one heading; then `configs/feet-back.yaml` puts the feet back where the input has them.

Run: python -m studies.feet_back FOLDER JOINT FRAME [PAIRS]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml

import motionedit
from motionedit.core.body.contacts import sole_tracks
from motionedit.core.body.quality import jerk_rms
from motionedit.core.units import STANDARD_LEG
from motionedit.jobs.clip.facts import ClipFacts, facts_of
from studies.lab import Lab, print_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray

PAIRS = 24
FARTHEST = 25.0  # clip units: how far the joint is from where it is asked to be, at most
HELD = {"constraints": [{"type": "footplants"}]}
FEET_BACK = Path(__file__).parents[1] / "configs" / "feet-back.yaml"
COLUMNS = {
    "drift in the input's plants (mm)": 3,
    "drift in plants (mm)": 3,
    "plants off the input's, held (mm)": 3,
    "joint off its goal (mm)": 3,
    "hands off the edit's (mm)": 3,
    "jerk, x the edit's": 2,
    "jerk, x the input's": 2,
}


def on_hips(facts: ClipFacts, frame: int) -> tuple[FloatArray, FloatArray]:
    """Return where the hips are on the ground at a frame, shape (3,), and the axes of their line: left, up, front."""
    hips = facts.poses.positions[frame, [leg.thigh for leg in facts.anatomy.legs or ()]]
    left = hips[0] - hips[1]
    left = left - (left @ facts.up) * facts.up
    left = left / np.linalg.norm(left)
    place = hips.mean(axis=0)
    return place - (place @ facts.up) * facts.up, np.stack((left, facts.up, np.cross(left, facts.up)))


def places(strokes: Sequence[ClipFacts], joint: int, frame: int) -> FloatArray:
    """Return where the joint of each stroke is at the hit, seen from its hips, shape (n, 3)."""
    seen = []
    for facts in strokes:
        origin, axes = on_hips(facts, frame)
        seen.append(axes @ (facts.poses.positions[frame, joint] - origin))
    return np.array(seen)


def farthest(ways: FloatArray) -> float:
    """Return the longest of ways, shape (n, 3)."""
    return float(np.linalg.norm(ways, axis=1).max())


def measured(clips: Sequence[ClipFacts], joint: int, frame: int, goal: FloatArray) -> list[float]:
    """Return the numbers of a row from the input, the edited, the final clip, and the input with feet held.

    mm at a leg of 0.85 m, and ratios. A plant of the input that slides has no place; held, it has one.
    """
    before = clips[0]
    millimetres = 1000.0 * STANDARD_LEG / before.anatomy.leg_length
    places = [facts.poses.positions for facts in clips]
    tracks = [sole_tracks(facts.poses, before.anatomy) for facts in clips]
    slid, drift, off = 0.0, 0.0, 0.0
    for plant in before.phases:
        given, _, mine, held = (track[plant.start : plant.stop + 1, plant.point] for track in tracks)
        slid = max(slid, farthest(given - given.mean(axis=0)))
        drift = max(drift, farthest(mine - mine.mean(axis=0)))
        off = max(off, farthest(mine - held))
    hands = [arm.wrist for arm in before.anatomy.arms or ()]
    jerks = [jerk_rms(each, frame_time=before.clip.motion.frame_time, first=before.first) for each in places]
    return [
        millimetres * slid,
        millimetres * drift,
        millimetres * off,
        millimetres * float(np.linalg.norm(places[2][frame, joint] - goal)),
        millimetres * float(np.linalg.norm(places[2][:, hands] - places[1][:, hands], axis=-1).max(initial=0.0)),
        jerks[2] / jerks[1],
        jerks[2] / jerks[0],
    ]


def rows(folder: Path, name: str, frame: int, count: int) -> list[list[float]]:
    """Return the numbers of each pair of strokes."""
    files = sorted(folder.glob("*.bvh"))
    strokes = [facts_of(motionedit.read(file)) for file in files]
    joint = strokes[0].clip.motion.skeleton.names.index(name)
    seen = places(strokes, joint, frame)
    far = np.linalg.norm(seen[:, None] - seen, axis=-1)
    pairs = np.argwhere((far <= FARTHEST) & ~np.eye(len(far), dtype=np.bool_))
    found = []
    with tempfile.TemporaryDirectory() as scratch:
        lab = Lab(Path(scratch))
        for i, j in pairs[np.unique(np.linspace(0, len(pairs) - 1, min(count, len(pairs))).astype(int))]:
            others = [file for k, file in enumerate(files) if k not in (i, j)]
            model = lab.model(others, {"events": {"hit": {"frames": {file.stem: frame for file in others}}}})
            origin, axes = on_hips(strokes[i], frame)
            goal = origin + seen[j] @ axes
            asked = {"effector": name, "at": "hit", "position": goal.tolist()}
            edited = lab.edit(files[i], model, {"unit": "cm", "events": {"hit": frame}, "goals": [asked]}).path
            final = lab.edit_prioritized(edited, feet_back(strokes[i], files[i])).path
            held = lab.edit_prioritized(files[i], HELD).path
            clips = [strokes[i], *(facts_of(motionedit.read(path)) for path in (edited, final, held))]
            found.append(measured(clips, joint, frame, goal))
    return found


def feet_back(facts: ClipFacts, reference: Path) -> dict[str, Any]:
    """Return the spec that is shipped, its hands those of a clip."""
    spec: dict[str, Any] = yaml.safe_load(FEET_BACK.read_text())
    hands = [facts.clip.motion.skeleton.names[arm.wrist] for arm in facts.anatomy.arms or ()]
    constraints = [{**each, "effector": hands} if "effector" in each else each for each in spec["constraints"]]
    return {**spec, "constraints": constraints, "reference": str(reference)}


def main(arguments: Sequence[str]) -> int:
    """Print the median, the 95th percentile and the largest of each number over the pairs."""
    if len(arguments) not in (3, 4):
        print(__doc__, file=sys.stderr)
        return 2
    folder, joint, frame, *count = arguments
    table = np.array(rows(Path(folder), joint, int(frame), int(count[0]) if count else PAIRS))
    lines = [("", "median", "p95", "largest")]
    for (word, digits), values in zip(COLUMNS.items(), table.T, strict=True):
        numbers = (np.median(values), np.percentile(values, 95), values.max())
        lines.append((word, *(f"{number:.{digits}f}" for number in numbers)))
    print_table(f"Feet put back after edit-pc: {len(table)} pairs of {Path(folder).name}", lines)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
