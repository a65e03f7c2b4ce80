"""The text of `motionedit info`: a clip's record laid out for a person, poses as YAML to paste into a spec."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from motionedit.report.table import padded, width_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

_PLAIN_NAME = re.compile(r"[A-Za-z_][\w.-]*", re.ASCII)
# Plain in our specs, or not, but another value to some YAML reader.
_YAML_WORDS = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"}
_ZERO_FACES = {"y": "+z", "-y": "-z", "z": "-y", "-z": "+y", "x": "-z", "-x": "+z"}
_MOST_FRAMES = 8  # of a defect, before the rest is counted


def describe(record: dict[str, Any], told: dict[tuple[str, ...], str]) -> str:
    """Return the text of one clip's record, ending in a line's end.

    `told` has the joint trees of clips before it, each with its first clip, which is named in place of the same tree.
    """
    tree = _tree(record)
    first = told.setdefault(tuple(tree), record["clip"])
    sections = [_facts(record), tree if first == record["clip"] else [f"{tree[0]}, as in {first}"]]
    if "plants" in record:
        sections.append(_plants(record["plants"]))
    if record.get("poses"):
        sections.append(_poses(record["poses"]))
    lines = [record["clip"]]
    for section in sections:
        lines += [*section, ""]
    return "\n".join(lines)


def _facts(record: dict[str, Any]) -> list[str]:
    facts = [
        ("frames", f"{record['frames']}, numbered 0 to {record['frames'] - 1}"),
        ("rate", f"{record['frame_rate']:.6g} Hz ({record['frame_time']:.6g} s a frame)"),
        ("duration", f"{record['duration']:.6g} s"),
        ("rest pose", _rest_pose(record["rest_pose_frames"])),
        ("up", record["up"]),
        ("heading", _heading(record)),
        ("travel", f"carried by {record['travel_joint']}"),
        ("leg length", f"{record['leg_length']:.6g} (end to end {record['height']:.6g})"),
        ("unit", _unit(record["unit"])),
        *_anatomy(record["anatomy"]),
        ("hinges", _hinges(record["hinges"])),
        ("defects", _defects(record["defects"])),
        *_quality(record["metrics"], stands=record["anatomy"]["left_leg"] is not None),
        *(("warning", warning) for warning in record["warnings"]),
    ]
    return [f"  {name:<12}{line}".rstrip() for name, text in facts for name, line in _labelled(name, text)]


def _labelled(name: str, text: str | list[str]) -> Iterator[tuple[str, str]]:
    """Yield a fact's lines, its name beside the first one only."""
    for i, line in enumerate([text] if isinstance(text, str) else text):
        yield (name if i == 0 else ""), line


def _rest_pose(frames: int) -> str:
    if not frames:
        return "none"
    which = "frame 0" if frames == 1 else f"frames 0 to {frames - 1}"
    return f"{which}, left out of all that follows"


def _heading(record: dict[str, Any]) -> str:
    degrees, frame = _number(record["heading"], 1), record["rest_pose_frames"]
    return f"{degrees} degrees at frame {frame}, 0 faces {_ZERO_FACES[record['up']]}"


def _unit(unit: dict[str, Any] | None) -> str:
    if unit is None:
        return "unknown"
    if not unit["likely"]:
        return f"unclear; the nearest is {unit['name']}, with a leg of {unit['leg']:.3g} m"
    return f"likely {unit['name']} (the leg is {unit['leg']:.2f} m)"


def _quality(metrics: dict[str, float], *, stands: bool) -> Iterator[tuple[str, str]]:
    """Yield how smooth a motion is, and how well its feet stand, where it has any."""
    jerk, slide = metrics["jerk_rms"], metrics["foot_slide_max"]
    feet = f", planted feet slide at up to {slide:.4g} units/s" if stands else ""
    yield "quality", f"jerk {jerk:.6g} units/s^3{feet}"
    if stands:
        yield "feet", _feet(metrics)


def _feet(metrics: dict[str, float]) -> str:
    """Return how well the feet stand, lengths in metres at a leg of 0.85 m."""
    mean, ratio = metrics["foot_skate_mean"], metrics["foot_skate_ratio"]
    sliding, drift = metrics["foot_sliding_share"], metrics["foot_drift_max"]
    under, depth = metrics["floor_penetration_share"], metrics["floor_penetration_max"]
    return (
        f"toes near the floor go at {100.0 * mean:.3g} cm/s, skate in {100.0 * ratio:.3g} %; plants slide in "
        f"{100.0 * sliding:.3g} %, drift by {100.0 * drift:.2g} cm; below the floor in {100.0 * under:.3g} %, "
        f"by {100.0 * depth:.2g} cm (leg 0.85 m)"
    )


def _anatomy(anatomy: dict[str, Any]) -> Iterator[tuple[str, str]]:
    for key, limb in anatomy.items():
        if isinstance(limb, dict):
            yield key.replace("_", " "), " > ".join(name for name in limb.values() if name is not None)
        elif limb is not None:
            yield key, limb


def _hinges(hinges: Sequence[dict[str, Any]]) -> list[str]:
    return [
        f"{hinge['joint']} about {_vector(hinge['axis'], 3)}, "
        f"{_number(hinge['limits'][0], 1)} to {_number(hinge['limits'][1], 1)} degrees"
        for hinge in hinges
    ] or ["none"]


def _defects(defects: Sequence[dict[str, Any]]) -> list[str]:
    return [_defect(defect) for defect in defects] or ["none"]


def _defect(defect: dict[str, Any]) -> str:
    frames = defect["frames"]
    if len(frames) == 1:
        kind = "flips" if defect["flips"] else "jumps"
        return f"{defect['joint']} {kind} by {defect['angle']:.0f} degrees into frame {defect['frame']}"
    shown = ", ".join(map(str, frames[:_MOST_FRAMES])) + (", ..." if len(frames) > _MOST_FRAMES else "")
    kind = f"flips by half a turn {defect['flips']} times" if defect["flips"] else f"jumps {len(frames)} times"
    return f"{defect['joint']} {kind}, by {defect['angle']:.0f} degrees into frame {defect['frame']} (frames {shown})"


def _tree(record: dict[str, Any]) -> list[str]:
    rows = []
    for joint in record["joints"]:
        indent = "  " * joint["depth"]
        rows.append((indent + shown_name(joint["name"]), _channels(joint["channels"]), _vector(joint["offset"])))
        rows += [(f"{indent}  (end site {i})", "", _vector(site)) for i, site in enumerate(joint["end_sites"])]
    title = f"  joints      {len(record['joints'])}, {record['channels']} channels"
    rows = [("", "channels", "offset"), *rows]
    widths = [max(width_of(row[column]) for row in rows) for column in range(2)]
    lines = (f"    {padded(name, widths[0])}  {channels:<{widths[1]}}  {offset}" for name, channels, offset in rows)
    return [title, *(line.rstrip() for line in lines)]


def _channels(channels: Sequence[str]) -> str:
    """Return channels in their order, ``position XYZ, rotation ZXY``, a new word where the kind changes."""
    words: list[str] = []
    for channel in channels:
        axis, kind = channel[0], channel[1:]
        if words and words[-1].startswith(kind):
            words[-1] += axis
        else:
            words.append(f"{kind} {axis}")
    return ", ".join(words) or "none"


def _plants(plants: Sequence[dict[str, Any]]) -> list[str]:
    lines = ["  contacts    " + ("none" if not plants else "frames, both in; seconds")]
    for foot in ("left", "right"):
        for plant in plants:
            if plant["foot"] == foot:
                start, stop = plant["frames"]
                phases = [f"{part} {_spans(plant[part])}" for part in ("heel", "toe") if plant[part]]
                lines.append(f"    {foot:<6}{start:>6} to {stop:>6}  {plant['seconds']:8.3f}  {'; '.join(phases)}")
                held = [f"{part} {_spans(spans)}" for part, spans in plant["held"].items() if spans]
                if held != phases:
                    lines.append(f"    {'held':>32}  {'; '.join(held) or 'nowhere'}")
    return lines


def _spans(spans: Sequence[Sequence[int]]) -> str:
    return ", ".join(f"{start} to {stop}" for start, stop in spans)


def _poses(poses: Sequence[dict[str, Any]]) -> list[str]:
    """Return the poses as YAML, a list of goals; each frame's quaternion is a comment, to be taken instead."""
    lines = ["# Poses, as goals to paste into a spec. An orientation is given twice: keep the one that suits."]
    for pose in poses:
        for frame in ("world", "heading"):
            transform = pose[frame]
            euler = f"euler: {_vector(transform['euler'])}, order: {transform['order']}"
            lines += [
                f"- effector: {flow(pose['effector'])}",
                f"  at: {pose['at']}",
                f"  frame: {frame}",
                f"  position: {_vector(transform['position'])}",
                f"  orientation: {{{euler}}}",
                f"  # orientation: {{quaternion: {_vector(transform['quaternion'])}}}",
            ]
    return lines


def flow(value: object) -> str:
    """Return a name, number, list or mapping as YAML on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(flow, value)) + "]"
    if isinstance(value, str):
        plain = _PLAIN_NAME.fullmatch(value) and value.lower() not in _YAML_WORDS
        return value if plain else json.dumps(value, ensure_ascii=False)
    return _number(float(value), 9) if isinstance(value, (int, float)) else str(value)


def shown_name(name: str) -> str:
    """Return a joint's name as it is, in quotes where blanks at its ends or unprintable characters would not show."""
    return name if name.isprintable() and name == name.strip() else json.dumps(name, ensure_ascii=False)


def _vector(values: Iterable[float], decimals: int = 9) -> str:
    return "[" + ", ".join(_number(value, decimals) for value in values) + "]"


def _number(value: float, decimals: int) -> str:
    """Return a number without needless zeros and never in scientific notation: 14, 0.5, -92.25."""
    text = f"{value:.{decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text in ("-0", "") else text
