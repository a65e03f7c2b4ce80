"""Reading and writing a long clip, beside bvhio."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.clock import Row, best_of, faster

with warnings.catch_warnings():
    warnings.simplefilter("ignore", PendingDeprecationWarning)
    import bvhio

from motionedit.core import rotations as rot
from motionedit.core.bvh import edited_bytes, new_bytes, read_clip, unedited_bytes
from motionedit.core.motion import Motion
from motionedit.core.skeleton import EndSite, Skeleton

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from motionedit.core.bvh import Clip

FRAMES = 10_000
# bvhio takes minutes to make its hierarchy of all of them.
HIERARCHY_FRAMES = 1_000
# Of five chains that leave a root: 31 joints with 96 channels.
CHAINS = (6, 6, 6, 6, 6)
MEGABYTE = 1e6


def made_motion(frames: int) -> Motion:
    """Return a smooth motion of 31 joints, every channel of which changes at every frame."""
    rng = np.random.default_rng(7)
    parents, ends = [-1], []
    for length in CHAINS:
        for n in range(length):
            parents.append(0 if n == 0 else len(parents) - 1)
        ends.append(EndSite(len(parents) - 1, np.array([0.0, 4.0, 0.0])))
    turning = ("Zrotation", "Xrotation", "Yrotation")
    skeleton = Skeleton(
        names=tuple(f"Joint{j}" for j in range(len(parents))),
        parents=np.array(parents),
        offsets=rng.normal(scale=10.0, size=(len(parents), 3)),
        channels=(("Xposition", "Yposition", "Zposition", *turning), *(turning,) * (len(parents) - 1)),
        end_sites=tuple(ends),
    )
    time = np.arange(frames)[:, None, None] / 120.0
    sway = rng.uniform(0.2, 1.0, (len(parents), 3)) * np.sin(
        rng.uniform(0.5, 6.0, (len(parents), 3)) * time + rng.uniform(0.0, 6.0, (len(parents), 3))
    )
    translations = 100.0 * np.cumsum(rng.normal(scale=0.01, size=(frames, 1, 3)), axis=0)
    return Motion(skeleton, rot.exp(sway), translations, 1.0 / 120.0)


def rows(folder: Path) -> list[Row]:
    """Return the table's rows on BVH files."""
    path, out = folder / "long.bvh", folder / "out.bvh"
    path.write_bytes(new_bytes(made_motion(FRAMES)))
    clip = read_clip(path)
    size = path.stat().st_size / MEGABYTE
    name = f"{FRAMES:,} frames x {len(clip.motion.skeleton)} joints, {size:.0f} MB"
    best = best_of(_ours(clip, path, out) | _bvhio(path, out), rounds=4)
    found = [
        faster(f"BVH read, {name}", best["read"], best["bvhio read"], aim=60, than="bvhio readAsBvh"),
        faster(
            "BVH write, all values of an edit (edited_bytes)",
            best["edit"],
            best["bvhio write"],
            aim=60,
            than="bvhio writeBvh",
        ),
        faster("BVH write, a new file (new_bytes)", best["new"], best["bvhio write"], aim=60, than="bvhio writeBvh"),
        Row("BVH read", f"{size / best['read']:.0f} MB/s"),
        Row("BVH read and write without an edit", f"{size / best['copy']:.0f} MB/s"),
    ]
    short = folder / "short.bvh"
    short.write_bytes(new_bytes(made_motion(HIERARCHY_FRAMES)))
    best |= best_of({"short": lambda: read_clip(short), "tree": lambda: bvhio.readAsHierarchy(str(short))}, rounds=3)
    what = f"BVH read, {HIERARCHY_FRAMES:,} frames, with the joints' tree"
    return [*found, faster(what, best["short"], best["tree"], aim=None, than="bvhio readAsHierarchy")]


def _ours(clip: Clip, path: Path, out: Path) -> dict[str, Callable[[], object]]:
    motion = clip.motion
    small = rot.exp(np.full(3, 0.01))
    edited = Motion(
        motion.skeleton, rot.multiply(motion.rotations, small), motion.translations + 0.5, motion.frame_time
    )
    touched = np.ones((len(motion), len(motion.skeleton)), dtype=np.bool_)
    moved = np.ones((len(motion), len(motion.skeleton.translated)), dtype=np.bool_)
    return {
        "read": lambda: read_clip(path),
        "edit": lambda: out.write_bytes(edited_bytes(clip, edited, touched=touched, moved=moved)),
        "new": lambda: out.write_bytes(new_bytes(edited)),
        "copy": lambda: out.write_bytes(unedited_bytes(read_clip(path))),
    }


def _bvhio(path: Path, out: Path) -> dict[str, Callable[[], object]]:
    container = bvhio.readAsBvh(str(path))
    return {
        "bvhio read": lambda: bvhio.readAsBvh(str(path)),
        "bvhio write": lambda: bvhio.writeBvh(str(out), container),
    }
