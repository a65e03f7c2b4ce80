"""normalization.json: what normalize did to each clip, and all that fit-pca and edit-pc need to know of it."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from motionedit.core.pca.rules import checked_rules
from motionedit.core.plain_values import items, json_of, mapping, number, positive, text, whole
from motionedit.core.timeline.warp import Timeline
from motionedit.dataclass import dataclass
from motionedit.errors import ModelError
from motionedit.regular_files import read_file

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

NAME = "normalization.json"
SCHEMA = "motionedit/normalization/v1"


@dataclass(frozen=True)
class NormalizedClip:
    """One entry: the normalized file (path below the folder), its source, and the source's events.

    `digest` is the SHA-256 of the source, `written` that of the normalized file: fit-pca takes no other one.
    """

    clip: str
    source: str
    digest: str
    frames: int
    duration: float
    first: int
    events: dict[str, float]
    rotation: tuple[float, ...]
    origin: tuple[float, ...]
    written: str


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
        "clips": [],
    }
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False)
    entries = ",".join(f"\n  {_entry(each)}" for each in normalization.clips)
    return f"{text.removesuffix(_NO_CLIPS)}[{entries}{_END}\n".encode() if entries else f"{text}\n".encode()


# How the file ends, without clips and with them.
_NO_CLIPS, _END = "[]\n}", "\n ]\n}"
# A number or a text on each line: no text has a line break, which JSON escapes.
_LINES = json.JSONEncoder(ensure_ascii=False, allow_nan=False, separators=("\n", ": "))
_BLANK = "\0"


def _entry(each: NormalizedClip) -> str:
    """Return a clip's entry: a form that is filled in, for the library takes ten times as long to indent it."""
    values = (
        *(each.clip, each.written, each.source, each.digest, each.frames, each.duration, each.first),
        *(*each.events.values(), *each.rotation, *each.origin),
    )
    return _form(tuple(each.events)) % tuple(_LINES.encode(values)[1:-1].split("\n"))


@lru_cache(maxsize=2)
def _form(events: tuple[str, ...]) -> str:
    """Return an entry with a place for each number and text, given the names of the events."""
    named = ("clip", "clip_sha256", "source", "sha256", "frames", "duration", "first_frame")
    form = {
        **dict.fromkeys(named, _BLANK),
        "events": dict.fromkeys(events, _BLANK),
        "alignment": {"rotation": [_BLANK] * 4, "origin": [_BLANK] * 3},
    }
    text = json.dumps(form, indent=1, ensure_ascii=False).replace("\n", "\n  ")
    return text.replace("%", "%%").replace(json.dumps(_BLANK), "%s")


def read_normalization(folder: Path) -> Normalization:
    """Return the normalization of a folder that normalize wrote.

    Raises
    ------
    ModelError
        If there is none, or it cannot be read.
    """
    path = folder / NAME
    try:
        content = mapping(json_of(read_file(path)))
        if content["schema"] != SCHEMA:
            raise ModelError(f"has schema '{content['schema']}', this version reads '{SCHEMA}'", file=str(path))
        return _normalization(content)
    except FileNotFoundError as error:
        raise ModelError("not there; 'motionedit normalize' writes it beside the clips", file=str(path)) from error
    except OSError as error:
        raise ModelError(f"cannot be read: {error.strerror or error}", file=str(path)) from error
    except (ValueError, KeyError) as error:
        raise ModelError("damaged; make it again with 'motionedit normalize'", file=str(path)) from error


def _normalization(content: dict[str, Any]) -> Normalization:
    """Return what the file holds; a ValueError or KeyError where that is not as normalize writes it."""
    frames = whole(content["frames"], 2)
    placed = {name: whole(frame, 0, frames - 1) for name, frame in mapping(content["events"]).items()}
    order = list(placed.values())
    # make_warp wants them so, and normalize writes no others.
    if order != sorted(set(order)) or not {0, frames - 1}.isdisjoint(order):
        raise ValueError("events that do not follow each other")
    up = text(content["up"])
    if up.removeprefix("-") not in ("x", "y", "z"):
        raise ValueError("no axis")
    rules = checked_rules(content["rules"], events=placed)
    # Events that clips are cut at lie at an end of the timeline, not on it.
    if not rules["events"].keys() >= placed.keys():
        raise ValueError("an event without a rule")
    return Normalization(
        Timeline(frames, positive(content["frame_rate"]), tuple(placed.items())),
        up,
        rules,
        tuple(_clip(mapping(each), events=rules["events"]) for each in items(content["clips"])),
    )


def _clip(each: dict[str, Any], *, events: Collection[str]) -> NormalizedClip:
    frames = whole(each["frames"], 2)
    alignment = mapping(each["alignment"])
    found = {name: number(frame, 0, frames - 1) for name, frame in mapping(each["events"]).items()}
    if found.keys() != set(events):
        raise ValueError("other events than there are rules of")
    rotation, origin = tuple(map(number, items(alignment["rotation"]))), tuple(map(number, items(alignment["origin"])))
    if (len(rotation), len(origin)) != (4, 3):
        raise ValueError("no rotation, or no origin")
    return NormalizedClip(
        clip=text(each["clip"]),
        source=text(each["source"]),
        digest=text(each["sha256"]),
        frames=frames,
        duration=number(each["duration"], 0.0),
        first=whole(each["first_frame"], 0, frames - 1),
        events=found,
        rotation=rotation,
        origin=origin,
        written=text(each["clip_sha256"]),
    )
