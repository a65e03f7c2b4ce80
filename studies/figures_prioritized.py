"""The accuracy figures of edit-prioritized: the demonstrations of [PRIO] on data/ and on real clips."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.body.rest_pose import rest_pose_frames
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from motionedit.core.units import STANDARD_LEG
from studies.demonstrations import config, foot_plants, karate, leg, reach, stairs, step
from studies.lab import jerk

if TYPE_CHECKING:
    from collections.abc import Sequence

    from studies.lab import Edited, Lab

ROOT = Path(__file__).resolve().parents[1]
# Of a leg, which all bodies are scaled to.
MILLIMETRES = 1e3 * STANDARD_LEG
HEADINGS = (
    "edit",
    "met layers (mm)",
    "met angles (deg)",
    "first not met (mm)",
    "holds slide (mm/s)",
    "iterations, median",
    "95 %",
    "most",
    "jerk",
)


def demonstrations(lab: Lab) -> list[tuple[str, ...]]:
    """Return a row for each demonstration on the clips of data/."""
    rows: list[tuple[str, ...]] = [HEADINGS]
    for name, clip in (("reach", "walk"), ("step", "walk"), ("karate", "kick"), ("stairs", "walk"), ("wind", "walk")):
        spec = config(name)
        path = ROOT / "data" / f"{clip}.bvh"
        rows.append(measured(f"{name}, data/{clip}", path, lab.edit_prioritized(path, spec), spec["constraints"]))
    return rows


def real(lab: Lab, clips: Path) -> list[tuple[str, ...]]:
    """Return the same edits, with other numbers, on real captures."""
    walk, kick = clips / "motions" / "cmu_12_01_walk.bvh", clips / "motions" / "karate_mawashi_geri_left_1.bvh"
    climb = clips / "motions" / "cmu07" / "cmu_07_04_walk.bvh"
    rows: list[tuple[str, ...]] = [HEADINGS]
    for what, clip, constraints in (
        ("reach, CMU 12_01", walk, [*foot_plants(walk), *reach(walk)]),
        ("reach, CMU 12_01, CoM's height, too", walk, [*foot_plants(walk), *reach(walk, axes=("x", "y", "z"))]),
        ("step, CMU 12_01", walk, step(walk)),
        ("karate, mawashi-geri", kick, karate(kick)),
        ("stairs, CMU 07_04", climb, stairs(climb)),
    ):
        rows.append(measured(what, clip, lab.edit_prioritized(clip, {"constraints": constraints}), constraints))
    return rows


def measured(what: str, clip: Path, edit: Edited, spec: Sequence[dict[str, Any]]) -> tuple[str, ...]:
    """Return an edit's row, lengths scaled to a leg of 0.85 m."""
    before, after = read_clip(clip).motion, read_clip(edit.path).motion
    anatomy = anatomy_of(before)
    millimetres = MILLIMETRES / anatomy.leg_length
    first = rest_pose_frames(before, anatomy)
    constraints = edit.record["constraints"]
    missed = [c["priority"] for c in constraints if not small(c, millimetres)]
    top = max(missed, default=-np.inf)
    met = [c for c in constraints if c["priority"] > top]
    unmet = [c for c in constraints if c["priority"] == top]
    held = slide(edit.path, spec)
    jerks = [jerk(forward(motion).positions[first:]) for motion in (before, after)]
    return (
        what,
        f"{max((c['error_max'] or 0.0 for c in met), default=0.0) * millimetres:.4f}",
        f"{max((c['error_angle_max'] or 0.0 for c in met), default=0.0):.4f}",
        f"{max((c['error_max'] or 0.0 for c in unmet), default=0.0) * millimetres:.1f}" if unmet else "",
        "" if held is None else f"{held * millimetres:.3f}",
        f"{edit.record['iterations']['median']:g}",
        f"{percentile(edit.record['frames']['iterations'], 95.0):g}",
        f"{edit.record['iterations']['max']:g}",
        f"{jerks[1] / jerks[0]:.2f}",
    )


def percentile(iterations: Sequence[int], share: float) -> float:
    """Return what so many per cent of the frames that were solved do not exceed."""
    solved = np.array(iterations)
    return float(np.percentile(solved[solved > 0], share, method="higher"))


def slide(edited: Path, constraints: Sequence[dict[str, Any]]) -> float | None:
    """Return the fastest speed (clip units / s) of a point inside its holds in the world; None where none is held."""
    motion = read_clip(edited).motion
    positions, names = forward(motion).positions, motion.skeleton.names
    speeds = []
    for constraint in constraints:
        if constraint["type"] not in {"position", "pose"} or "relative_to" in constraint:
            continue
        joints = constraint["effector"] if isinstance(constraint["effector"], list) else [constraint["effector"]]
        for start, stop in (point["hold"] for point in constraint.get("points", []) if "hold" in point):
            path = positions[start : stop + 1, [names.index(joint) for joint in joints]]
            speeds.append(float(np.linalg.norm(np.diff(path, axis=0), axis=-1).max(initial=0.0)) / motion.frame_time)
    return max(speeds, default=None)


def small(constraint: dict[str, Any], millimetres: float) -> bool:
    """Return whether a constraint is met to 0.1 mm and 0.01 degrees."""
    length, angle = constraint["error_max"], constraint["error_angle_max"]
    return (length or 0.0) * millimetres <= 0.1 and (angle or 0.0) <= 0.01


def laws(lab: Lab) -> list[tuple[str, ...]]:
    """Return what holds of any edit: order of priorities, conflicts, units, heading."""
    walk = ROOT / "data" / "walk.bvh"
    spec = config("reach")
    renumbered = {**spec, "constraints": [dict(c) for c in spec["constraints"]]}
    for constraint in renumbered["constraints"]:
        constraint["priority"] = {10: 3, 4: 2, 2: 1}[constraint["priority"]]
    one, other = (lab.edit_prioritized(walk, s).path for s in (spec, renumbered))
    rows = [("what", "measured")]
    rows.append(("priorities {10, 4, 2} and {3, 2, 1}", "the same bytes" if same(one, other) else "other bytes"))
    millimetres = MILLIMETRES / leg(walk)
    for weight in (1, 10):
        record = lab.edit_prioritized(walk, {"constraints": conflict(weight, 300.0 / millimetres)}).record
        errors = " and ".join(f"{c['error_max'] * millimetres:.2f}" for c in record["constraints"])
        rows.append((f"a conflict of 300 mm, weights {weight} and 1: left (mm)", errors))
    met = read_clip(lab.edit_prioritized(walk, {**spec, "constraints": spec["constraints"][:2]}).path).motion
    below = read_clip(one).motion
    feet = [j for _, j in anatomy_of(below).foot_points]
    moved = np.abs(forward(met).positions[:, feet] - forward(below).positions[:, feet]).max()
    rows.append(("the CoM taken away moves the feet by at most (mm)", f"{moved * millimetres:.4f}"))
    rows.append(("nothing asked for", "the input's bytes" if same(walk, nothing(lab, walk)) else "other bytes"))
    return rows


def same(one: Path, other: Path) -> bool:
    """Return whether two files are alike to the byte."""
    return one.read_bytes() == other.read_bytes()


def nothing(lab: Lab, clip: Path) -> Path:
    """Return a clip edited by no constraint."""
    return lab.edit_prioritized(clip, {"constraints": []}).path


def conflict(weight: float, far: float) -> list[dict[str, Any]]:
    """Return two goals of one priority for one hand, so far (clip units) from each other."""
    common = {"type": "position", "effector": "RightHand", "tolerance": "off"}
    return [
        {**common, "name": "here", "weight": weight, "points": [{"hold": [0, 144], "position": [-30, 120, 300]}]},
        {**common, "name": "there", "points": [{"hold": [0, 144], "position": [-30, 120 + far, 300]}]},
    ]
