"""The table on Blender: the reach as an edit of a file, by IK constraints that are baked, as a whole process."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.clock import best_of, duration, process
from benchmarks.peers.jobs import COM, places
from benchmarks.peers.others import PeerError, ask, command, versions
from motionedit.core.body.center_of_mass import find_masses
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.trajectories.positions import ControlPoint, position_targets
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benchmarks.peers.tables import Table
    from motionedit.core.arrays import FloatArray

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = (Path(sys.executable).with_name("motionedit"), "edit-prioritized")
WALK = ROOT / "data" / "walk.bvh"
LONG = 2752
ROUNDS = 3
# The first and last frame of the reach, and where it stands still, in each repetition; centimetres.
REACH, HELD, SHIFT = (50, 88), (66, 72), (26.0, 52.0, 17.0)
FEET = ("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase")
# Bones whose tails are at ankles and wrist, and the lengths of their chains: to the hip joints, to the lower back.
CHAINS = (("LeftLeg", 3), ("RightLeg", 3), ("LeftForeArm", 6))
HEADINGS = ("what", "motionedit", "Blender", "ours is")


@dataclass(frozen=True)
class Edit:
    """One clip with the same edit for both: the clip, our spec, Blender's constraints, the hand's path (F, 3)."""

    clip: Path
    spec: Path
    constraints: Path
    hand: FloatArray


def table(folder: Path) -> tuple[Table, dict[str, str]]:
    """Return the table and Blender's version.

    Where Blender is not there, or fails, the table says so beside our own times.
    """
    short, long = (_edit(folder, frames) for frames in (len(read_clip(WALK).motion), LONG))
    rows: Table = [HEADINGS]
    found = {}
    for edit in (short, long):
        rows += _times(edit, folder)
    try:
        answer = ask("bpy", short.clip, folder / "blender.bvh", short.constraints)
        found["Blender"] = versions(answer)
        rows += _faults(short, folder / "ours.bvh", folder / "blender.bvh")
        rows += _untouched(folder)
    except PeerError as error:
        rows.append(("errors of the edit", "", str(error), ""))
    return rows, found


def _times(edit: Edit, folder: Path) -> Table:
    frames = f"{len(edit.hand):,} frames"
    contenders = {"ours": process([*PROGRAM, edit.clip, "-s", edit.spec, "-o", folder / "ours.bvh"], ROOT)}
    bake, blender = "", "cannot be installed here"
    try:
        line = command("bpy", (edit.clip, folder / "blender.bvh", edit.constraints))
        bake = duration(ask("bpy", *line[2:])["seconds"])
        contenders["blender"] = process(line, ROOT)
    except PeerError as error:
        blender = str(error)
    best = best_of(contenders, rounds=ROUNDS)
    ratio = ""
    if "blender" in best:
        blender, ratio = duration(best["blender"]), f"{best['blender'] / best['ours']:.1f} x faster"
    rows = [(f"the reach, file to file, a process, {frames}", duration(best["ours"]), blender, ratio)]
    return [*rows, (f"of this the bake, {frames}", "", bake, "")] if bake else rows


def _edit(folder: Path, frames: int) -> Edit:
    """Write a clip of the walk, repeated as often as it takes, and the reach in it for both programs."""
    motion = _repeated(read_clip(WALK).motion, frames)
    clip, spec, constraints = (folder / f"walk-{frames}.{kind}" for kind in ("bvh", "yaml", "json"))
    clip.write_bytes(new_bytes(motion))
    period = len(read_clip(WALK).motion)
    starts = [start for start in range(0, frames, period) if start + REACH[1] < frames]
    hand = forward(motion).positions[:, motion.skeleton.names.index("LeftHand")]
    first, targets = position_targets(hand, _points(starts), ease_in=0.0, ease_out=0.0, curve="time")
    hand = hand.copy()
    hand[first : first + len(targets)] = targets
    points: list[dict[str, Any]] = []
    for start in starts:
        points += [
            {"at": start + REACH[0], "shift": [0, 0, 0]},
            {"hold": [start + HELD[0], start + HELD[1]], "shift": list(SHIFT)},
            {"at": start + REACH[1], "shift": [0, 0, 0]},
        ]
    spec.write_text(json.dumps(_spec(points)))
    paths = [{"bone": bone, "chain": length, "path": None} for bone, length in CHAINS]
    paths[-1]["path"] = hand.tolist()
    constraints.write_text(json.dumps(paths))
    return Edit(clip, spec, constraints, hand)


def _points(starts: Sequence[int]) -> tuple[ControlPoint, ...]:
    still, shift = np.zeros(3), np.array(SHIFT)
    return tuple(
        point
        for start in starts
        for point in (
            ControlPoint("at", start + REACH[0], start + REACH[0], shift=still),
            ControlPoint("hold", start + HELD[0], start + HELD[1], shift=shift),
            ControlPoint("at", start + REACH[1], start + REACH[1], shift=still),
        )
    )


def _spec(points: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "schema": "motionedit/edit-prioritized/v1",
        "unit": "cm",
        "defaults": {"ease_in": 0, "ease_out": 0},
        "constraints": [
            {"name": "feet", "type": "position", "effector": list(FEET), "priority": 10},
            {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 4, "points": points},
            {"name": "balance", "type": "com", "priority": 2, "relative_to": "world"},
        ],
    }


def _repeated(motion: Motion, frames: int) -> Motion:
    """Return the walk again and again, each time from where it ended."""
    count = -(-frames // len(motion))
    rotations = np.concatenate([motion.rotations] * count)[:frames]
    stride = motion.translations[-1, 0] - motion.translations[0, 0]
    stride[1] = 0.0
    translations = np.concatenate([motion.translations + n * stride for n in range(count)])[:frames]
    return Motion(motion.skeleton, rotations, translations, motion.frame_time)


def _faults(edit: Edit, ours: Path, theirs: Path) -> Table:
    """Return what each edit left of what was asked for, in millimetres at a leg of 0.85 m."""
    process([*PROGRAM, edit.clip, "-s", edit.spec, "-o", ours], ROOT)()
    before = read_clip(edit.clip).motion
    measured = [_off(before, read_clip(path).motion, edit.hand) for path in (ours, theirs)]
    texts = (
        "hand from its path, worst (mm)",
        "feet from theirs, worst (mm)",
        "center of mass from its own, worst (mm)",
    )
    return [(text, *(f"{off[i]:.3f}" for off in measured), "") for i, text in enumerate(texts)]


def _off(before: Motion, after: Motion, hand: FloatArray) -> tuple[float, float, float]:
    if after.skeleton.names != before.skeleton.names:
        raise PeerError("the joints come back in another order")
    anatomy = anatomy_of(before)
    masses = find_masses(before.skeleton, anatomy)
    there = before.skeleton.names.index
    joints = [there("LeftHand"), *(there(name) for name in FEET), COM]
    was, now = places(forward(before), masses, joints), places(forward(after), masses, joints)
    was[:, 0] = hand
    off = 1e3 * STANDARD_LEG / anatomy.leg_length * np.linalg.norm(now - was, axis=2)
    # Smoothing lets the hand leave its path a little before the reach, and return a little after.
    return float(off[REACH[0] : REACH[1] + 1, 0].max()), float(off[:, 1:5].max()), float(off[:, 5].max())


def _untouched(folder: Path) -> Table:
    """Return how much of the walk's file each program writes anew when nothing is asked for."""
    none, copy = folder / "none.json", folder / "copy.bvh"
    none.write_text("[]")
    ask("bpy", WALK, copy, none)
    before, after = (_rows(path) for path in (WALK, copy))
    same = sum(one == other for one, other in zip(before, after, strict=False))
    spec, own = folder / "none.yaml", folder / "own.bvh"
    spec.write_text(
        json.dumps({"schema": "motionedit/edit-prioritized/v1", "constraints": _spec([])["constraints"][:1]})
    )
    process([*PROGRAM, WALK, "-s", spec, "-o", own], ROOT)()
    kept = sum(one == other for one, other in zip(before, _rows(own), strict=False))
    text = "lines of motion that stay as they were without an edit"
    return [(text, f"{kept} of {len(before)}", f"{same} of {len(before)}", "")]


def _rows(path: Path) -> list[bytes]:
    lines = path.read_bytes().splitlines()
    return lines[lines.index(b"MOTION") + 3 :]
