"""normalization.json: what normalize did to each clip, and all that fit-pca and edit-pc need to know of it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from motionedit.core.timeline.warp import Timeline
from motionedit.dataclass import dataclass
from motionedit.errors import ModelError

if TYPE_CHECKING:
    from pathlib import Path

NAME = "normalization.json"
SCHEMA = "motionedit/normalization/v1"


@dataclass(frozen=True)
class NormalizedClip:
    """One entry: the normalized file (path below the folder), its source, and the source's events."""

    clip: str
    source: str
    digest: str
    frames: int
    duration: float
    first: int
    events: dict[str, float]
    rotation: tuple[float, ...]
    origin: tuple[float, ...]


@dataclass(frozen=True)
class Normalization:
    """The whole file: the timeline, the rules (as the spec has them), the signed up axis, the clips."""

    timeline: Timeline
    up: str
    rules: dict[str, Any]
    clips: tuple[NormalizedClip, ...]

    def __repr__(self) -> str:
        # Not all its clips, which would fill a screen.
        timeline = self.timeline
        return f"<Normalization: {len(self.clips)} clips, {timeline.frames} frames, {timeline.frame_rate:.4g} Hz>"


def normalization_bytes(normalization: Normalization) -> bytes:
    """Return the file; the same bytes for the same normalization."""
    timeline = normalization.timeline
    content = {
        "schema": SCHEMA,
        "frames": timeline.frames,
        "frame_rate": timeline.frame_rate,
        "events": dict(timeline.events),
        "up": normalization.up,
        "rules": normalization.rules,
        "clips": [
            {
                "clip": each.clip,
                "source": each.source,
                "sha256": each.digest,
                "frames": each.frames,
                "duration": each.duration,
                "first_frame": each.first,
                "events": each.events,
                "alignment": {"rotation": list(each.rotation), "origin": list(each.origin)},
            }
            for each in normalization.clips
        ],
    }
    return (json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def read_normalization(folder: Path) -> Normalization:
    """Return the normalization of a folder that normalize wrote.

    Raises
    ------
    ModelError
        If there is none, or it cannot be read.
    """
    path = folder / NAME
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["schema"] != SCHEMA:
            raise ModelError(f"has schema '{content['schema']}', this version reads '{SCHEMA}'", file=str(path))
        events = tuple((str(name), int(frame)) for name, frame in content["events"].items())
        return Normalization(
            Timeline(int(content["frames"]), float(content["frame_rate"]), events),
            str(content["up"]),
            dict(content["rules"]),
            tuple(_clip(each) for each in content["clips"]),
        )
    except FileNotFoundError as error:
        raise ModelError("not there; 'motionedit normalize' writes it beside the clips", file=str(path)) from error
    except OSError as error:
        raise ModelError(f"cannot be read: {error.strerror or error}", file=str(path)) from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ModelError("damaged; make it again with 'motionedit normalize'", file=str(path)) from error


def _clip(each: dict[str, Any]) -> NormalizedClip:
    return NormalizedClip(
        clip=str(each["clip"]),
        source=str(each["source"]),
        digest=str(each["sha256"]),
        frames=int(each["frames"]),
        duration=float(each["duration"]),
        first=int(each["first_frame"]),
        events={str(name): float(frame) for name, frame in each["events"].items()},
        rotation=tuple(map(float, each["alignment"]["rotation"])),
        origin=tuple(map(float, each["alignment"]["origin"])),
    )
