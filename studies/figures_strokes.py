"""The accuracy figures of real strokes, each edited by a model of the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.bvh import read_clip
from studies.figures_rows import HEADINGS, counts, goal_misses, row, side_effects, told
from studies.lab import DIRECTIONS, effector_path, jerk, joint_positions

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.arrays import FloatArray
    from studies.lab import Edited, Lab


def wrist_goal(shift: FloatArray, hit: int) -> dict[str, Any]:
    """Return an edit-pc spec that shifts the right wrist at the hit."""
    goal = {"name": "wrist", "at": "hit", "effector": "RightWrist", "shift": list(map(float, shift))}
    return {"unit": "cm", "events": {"hit": hit}, "goals": [goal]}


def left_out(
    lab: Lab, clips: Sequence[Path], hits: dict[str, int], directions: FloatArray
) -> list[tuple[Path, Edited, FloatArray]]:
    """Return 10 cm edits of every clip with a model of the others."""
    edits = []
    for clip in clips:
        others = [other for other in clips if other != clip]
        model = lab.model(others, {"events": {"hit": {"frames": {c.stem: hits[c.stem] for c in others}}}})
        edits += [(clip, lab.edit(clip, model, wrist_goal(10 * d, hits[clip.stem])), 10 * d) for d in directions]
    return edits


def stroke_rows(edits: Sequence[tuple[Path, Edited, FloatArray]]) -> list[tuple[str, ...]]:
    """Return the figures of 10 cm edits of real strokes."""
    jerks = [
        jerk(effector_path(edit.path, "RightWrist")) / jerk(effector_path(clip, "RightWrist"))
        for clip, edit, _ in edits
    ]
    norms = [edit.record["change"]["norm"] / edit.record["change"]["bound"] for _, edit, _ in edits]
    feet, _ = side_effects(edits)
    return [
        HEADINGS,
        row(
            "edits: worst miss in the written file (mm)",
            float(goal_misses(edits, "RightWrist", end_site=False).max()),
            0.1,
        ),
        row("iterations, most", max(edit.record["iterations"] for _, edit, _ in edits), 12),
        row("the change over its bound, worst", max(norms), 1.0),
        row("wrist jerk, output over input, median", float(np.median(jerks)), 1.1),
        row("wrist jerk, 95th percentile", float(np.percentile(jerks, 95)), 1.5),
        told("status", counts(edits)),
        row("feet at the hit move, median (cm)", float(np.median(feet)), 0.5),
    ]


def smashes(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit the eleven cut smashes in six directions each."""
    clips = sorted((strokes / "smash_mrios").glob("*.bvh"))
    return stroke_rows(left_out(lab, clips, {clip.stem: 110 for clip in clips}, DIRECTIONS))


def cut_smashes(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit the same smashes, cut from the whole take at lengths of our own."""
    take = read_clip(strokes / "takes" / "mrios_Remate.bvh")
    clips, hits = [], {}
    lines = (strokes / "events.tsv").read_text().splitlines()[1:]
    impacts = [int(line.split("\t")[2]) for line in lines if "smash_mrios" in line]
    for number, impact in enumerate(impacts):
        start = max(impact - 80 - 7 * (number % 4), 0)
        name = f"smash{number + 1:02d}"
        clips.append(lab.cut(take, start, impact + 50 + 6 * (number % 3), f"{name}.bvh"))
        hits[name] = impact - start
    return stroke_rows(left_out(lab, clips, hits, DIRECTIONS))


def serves(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit the eight serves, whose arm is stretched at the hit: up is the hard way."""
    clips = sorted((strokes / "serve_jsgiraldo").glob("*.bvh"))
    edits = left_out(lab, clips, {clip.stem: 140 for clip in clips}, DIRECTIONS)
    level = [edit for edit in edits if edit[2][1] == 0.0]
    up = [edit for edit in edits if edit[2][1] > 0.0]
    down = [edit for edit in edits if edit[2][1] < 0.0]
    return [
        HEADINGS,
        row("10 cm sideways: worst miss (mm)", float(goal_misses(level, "RightWrist", end_site=False).max()), 0.1),
        row("10 cm sideways: iterations, most", max(edit.record["iterations"] for _, edit, _ in level), 20),
        told("10 cm up: status", counts(up)),
        told("10 cm down: status", counts(down)),
    ]


def to_others(lab: Lab, strokes: Path) -> list[tuple[str, ...]]:
    """Edit strokes to where another met the ball, and look how near to that stroke they come: below 1 is nearer."""
    rows: list[tuple[str, ...]] = [("strokes", "method", "edited over unedited", "further away", "feet (cm)")]
    for name, folder, hit in (("smash", "smash_mrios", 110), ("serve", "serve_jsgiraldo", 140)):
        clips = sorted((strokes / folder).glob("*.bvh"))
        for method, spec in (("map", {}), ("gauss-newton", {"solver": {"method": "gauss-newton"}})):
            found = [_to_other(lab, clips, i, (i + 3) % len(clips), hit, spec) for i in range(len(clips))]
            edited, unedited, feet = np.array(found).T
            ratio = np.sqrt(np.mean(edited**2) / np.mean(unedited**2))
            further = f"{np.count_nonzero(edited > unedited)} of {len(found)}"
            rows.append((name, method, f"{ratio:.3f}", further, f"{np.median(feet):.2f}"))
    return rows


def _to_other(
    lab: Lab, clips: Sequence[Path], one: int, other: int, hit: int, spec: dict[str, Any]
) -> tuple[float, float, float]:
    """Return the distance of an edited stroke to another, that of the unedited one, and how far its feet drift (cm).

    The hips of both are laid over each other at the hit.
    """
    rest = [clip for i, clip in enumerate(clips) if i not in {one, other}]
    model = lab.model(rest, {"events": {"hit": {"frames": {clip.stem: hit for clip in rest}}}})
    names = list(read_clip(clips[one]).motion.skeleton.names)
    wrist, hips = names.index("RightWrist"), [names.index("LeftHip"), names.index("RightHip")]
    own, theirs = (joint_positions(clips[i]) for i in (one, other))
    turn, origin = _by_hips(own[hit, hips])
    turn_there, origin_there = _by_hips(theirs[hit, hips])
    theirs = (theirs - origin_there) @ turn_there.T @ turn + origin
    goal = {"name": "contact", "at": hit, "effector": "RightWrist", "position": theirs[hit, wrist].tolist()}
    edit = lab.edit(clips[one], model, {"unit": "cm", "events": {"hit": hit}, "goals": [goal], **spec})
    near = slice(hit - 90, hit + 66)
    apart = [
        float(np.sqrt(np.mean(np.sum((body[near] - theirs[near]) ** 2, axis=-1))))
        for body in (joint_positions(edit.path), own)
    ]
    return apart[0], apart[1], float(edit.record["metrics"]["foot_drift_max"])


def _by_hips(hips: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the turn about y that brings the line of the hips onto x, and the point below their middle."""
    left = hips[0] - hips[1]
    angle = np.arctan2(left[2], left[0])
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return turn, hips.mean(axis=0) * np.array([1.0, 0.0, 1.0])
