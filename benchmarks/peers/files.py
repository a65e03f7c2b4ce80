"""The table on BVH files: pybvh beside us, and what is left of clips that are read and written without an edit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.bvh_files import FRAMES, made_motion
from benchmarks.clock import best_of, duration
from benchmarks.peers.others import PeerError, ask, versions
from motionedit.core.bvh import new_bytes, read_clip, unedited_bytes
from motionedit.errors import MotionEditError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from benchmarks.peers.tables import Table

ROOT = Path(__file__).resolve().parents[2]
ROUNDS = 3
HEADINGS = ("what", "motionedit", "pybvh", "ours is")


def table(folder: Path) -> tuple[Table, dict[str, str]]:
    """Return the table and pybvh's version."""
    long = folder / "long.bvh"
    long.write_bytes(new_bytes(made_motion(FRAMES)))
    clips = sorted((ROOT / "data").rglob("*.bvh"))
    copies = [folder / f"{name}-{clip.name}" for name in ("own", "pybvh") for clip in clips]
    own, theirs = copies[: len(clips)], copies[len(clips) :]
    for clip, copy in zip(clips, own, strict=True):
        copy.write_bytes(unedited_bytes(read_clip(clip)))
    pairs = [path for pair in zip(clips, theirs, strict=True) for path in pair]
    best: dict[str, float] = {}
    answer: dict[str, Any] | None = None
    complaint = ""
    for _ in range(ROUNDS):
        _keep_least(best, best_of(_ours(long, folder / "own-long.bvh"), rounds=1))
        try:
            answer = ask("pybvh", long, folder / "pybvh-long.bvh", *pairs)
        except PeerError as error:
            complaint = str(error)
            break
        _keep_least(best, {f"pybvh {what}": answer[what] for what in ("read", "write")})
    rows = [HEADINGS, *(_speed_row(what, best, complaint) for what in ("read", "write"))]
    kept = (_fidelity(clips, own), _fidelity(clips, theirs) if answer else ("", "", ""))
    texts = ("the same bytes", "the same frame time", "angles and places as they were, in double precision")
    for i, text in enumerate(texts):
        rows.append((f"copies of data/ without an edit: {text}", kept[0][i], kept[1][i] or complaint, ""))
    return rows, {"pybvh": versions(answer)} if answer else {}


def _speed_row(what: str, best: dict[str, float], complaint: str) -> tuple[str, ...]:
    text = f"{what} {FRAMES:,} frames x 31 joints"
    peer = best.get(f"pybvh {what}")
    if peer is None:
        return text, duration(best[what]), complaint, ""
    return text, duration(best[what]), duration(peer), f"{peer / best[what]:.1f} x faster"


def _ours(path: Path, out: Path) -> dict[str, Callable[[], object]]:
    motion = read_clip(path).motion
    return {"read": lambda: read_clip(path), "write": lambda: out.write_bytes(new_bytes(motion))}


def _keep_least(best: dict[str, float], seconds: dict[str, float]) -> None:
    for key, value in seconds.items():
        best[key] = min(value, best.get(key, np.inf))


def _fidelity(clips: Sequence[Path], copies: Sequence[Path]) -> tuple[str, str, str]:
    """Return on how many clips the bytes, the frame time and the values are kept."""
    kept = np.zeros(3, dtype=int)
    for clip, copy in zip(clips, copies, strict=True):
        if not copy.exists():
            continue
        before = read_clip(clip)
        try:
            after = read_clip(copy)
        except MotionEditError:
            continue
        values = [np.concatenate((m.rotations.ravel(), m.translations.ravel())) for m in (before.motion, after.motion)]
        kept += (
            clip.read_bytes() == copy.read_bytes(),
            before.motion.frame_time == after.motion.frame_time,
            np.array_equal(*values),
        )
    return tuple(f"{n} of {len(clips)}" for n in kept)  # type: ignore[return-value]
