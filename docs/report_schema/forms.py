"""Forms of values in a JSON Schema, each with what it means, and the keys that clips of several commands have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

Schema = dict[str, Any]

NUMBER: Schema = {"type": "number"}
POINT: Schema = {"type": "array", "items": NUMBER, "minItems": 3, "maxItems": 3}
STRING: Schema = {"type": "string"}
INTEGER: Schema = {"type": "integer"}


def obj(about: str, keys: Schema, optional: tuple[str, ...] = ()) -> Schema:
    """Return an object of exactly these keys; `optional` ones may be left out."""
    required = [key for key in keys if key not in optional]
    return {
        "type": "object",
        "description": about,
        "properties": keys,
        "required": required,
        "additionalProperties": False,
    }


def number(about: str) -> Schema:
    """Return a number."""
    return {"type": "number", "description": about}


def point(about: str) -> Schema:
    """Return three numbers."""
    return {**POINT, "description": about}


def count(about: str) -> Schema:
    """Return a whole number from 0."""
    return {"type": "integer", "minimum": 0, "description": about}


def text(about: str) -> Schema:
    """Return a text."""
    return {"type": "string", "description": about}


def flag(about: str) -> Schema:
    """Return true or false."""
    return {"type": "boolean", "description": about}


def word(about: str, *words: str) -> Schema:
    """Return one of some words."""
    return {"enum": list(words), "description": about}


def list_of(items: Schema, about: str, size: int | None = None) -> Schema:
    """Return a list, of `size` items where one is given."""
    sized = {} if size is None else {"minItems": size, "maxItems": size}
    return {"type": "array", "items": items, "description": about, **sized}


def or_null(schema: Schema, about: str) -> Schema:
    """Return another form, or null."""
    return {"anyOf": [schema, {"type": "null"}], "description": about}


def part(name: str) -> Schema:
    """Return a reference to a form in `$defs`."""
    return {"$ref": f"#/$defs/{name}"}


def map_of(items: Schema, about: str) -> Schema:
    """Return an object whose keys are names, such as those of events."""
    return {"type": "object", "additionalProperties": items, "description": about}


def number_or_null(about: str) -> Schema:
    """Return a number, or null."""
    return or_null(NUMBER, about)


def text_or_null(about: str) -> Schema:
    """Return a text, or null."""
    return or_null(STRING, about)


def numbers_or_null(about: str) -> Schema:
    """Return a list of numbers (null: not finite), or null."""
    return or_null({"type": "array", "items": {"type": ["number", "null"]}}, about)


def measures(about: str, form: Callable[[str], Schema], *, step: str) -> Schema:
    """Return how a motion's feet slide and how smooth it is, numbers of this form; `step` says whose steps are told."""
    return obj(
        about,
        {
            "foot_slide_max": form(
                "a held ankle's or toe's fastest way on the ground from frame to frame, clip units per second"
            ),
            "foot_skate_mean": form(
                "mean speed of toes from a frame to the next, both below 5 cm, m/s at leg length 0.85 m"
            ),
            "foot_skate_ratio": form("share of such steps of a toe that are faster than 0.2 m/s"),
            "foot_sliding_share": form("share of a held toe's steps from frame to frame that are faster than 1 cm/s"),
            "foot_drift_max": form("how far a held point is from its mean place, m at leg length 0.85 m"),
            "floor_penetration_share": form("share of frames in which a heel or toe is more than 1 cm below up = 0"),
            "floor_penetration_max": form("how deep below up = 0, m at leg length 0.85 m"),
            "foot_floating_max": form(
                "the mean height above up = 0 of the held toe that is highest, m at leg length 0.85 m"
            ),
            "jerk_rms": form("root mean square third difference of all joints over time, clip units per second cubed"),
            "step_max": form(f"the largest turn of {step} from frame to frame, degrees in a sixtieth of a second"),
            "step_frame": or_null(INTEGER, "the frame into which it steps; null where nothing does"),
            "step_joint": text_or_null("the joint that steps; null where none does"),
        },
    )


CLIP = {"clip": text("the clip as it was named on the command line, or found in a folder")}
OUTPUT = {"output": text_or_null("what was written; null for standard output and where nothing was")}
MESSAGE = {"message": text_or_null("why, in words; null where all is well")}
WARNINGS = {"warnings": list_of({"type": "string"}, "what was warned of, one line each")}
UNIT = {"unit": text_or_null("the spec's unit")}
VERIFY = {
    "verify": obj(
        "what bvhio, an independent reader, found in the file (--verify)",
        {
            "distance": number("the largest distance of a joint from its place, clip units"),
            "frames_skipped": count("frames at gimbal lock, which bvhio reads wrongly"),
        },
    )
}
