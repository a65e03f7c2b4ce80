"""What the reports of normalize, info and diff say of a clip, and that of fit-pca of a model."""

from __future__ import annotations

from report_schema.forms import (
    CLIP,
    INTEGER,
    MESSAGE,
    NUMBER,
    OUTPUT,
    POINT,
    STRING,
    UNIT,
    VERIFY,
    WARNINGS,
    Schema,
    count,
    flag,
    list_of,
    map_of,
    measures,
    number,
    obj,
    or_null,
    part,
    point,
    text,
    text_or_null,
    word,
)

MODEL: Schema = {
    "frames": count("of the timeline"),
    "frame_rate": number("of the timeline, Hz"),
    "degrees_of_freedom": count("values a frame"),
    "explained_variance": list_of(NUMBER, "of each component"),
    "explained_variance_ratio": list_of(NUMBER, "its share of the whole variance"),
    "database": list_of(part("database_clip"), "the clips that the model was fitted to"),
    "left_out": obj(
        "each clip left out in turn and looked for by the others",
        {
            "share": number("share of an unseen clip that the database does not explain, 0 to 1"),
            "furthest": text("the clip of which the others leave the most"),
            "clips": list_of(
                obj(
                    "a clip of the database",
                    {
                        "clip": text("its name"),
                        "share": number("share of it that the others do not explain, 0 to 1"),
                        "times": number("how much of it they leave, as a length, over the median of all"),
                    },
                ),
                "in the database's order",
            ),
        },
    ),
    "streamed": obj(
        "how components of more than 2,000 clips were found",
        {"passes": count("over the clips"), "residual": number("the largest, over the first variance")},
    ),
    **WARNINGS,
}

_NORMALIZED_CLIP = {
    **CLIP,
    **OUTPUT,
    "status": {"const": "ok", "description": "it was written"},
    **MESSAGE,
    **UNIT,
    "frames": list_of(INTEGER, "frames before and after", 2),
    "first_frame": count("the first frame of the input that counts, after a rest pose or by from:"),
    "clip_sha256": text("SHA-256 of the normalized clip"),
    "events": map_of(NUMBER, "each event's frame in the input, to a part of a frame"),
    **WARNINGS,
    **VERIFY,
}

_UNIT = obj(
    "the unit that makes a leg nearest 0.85 m",
    {"name": text("such as cm"), "leg": number("the leg, m"), "likely": flag("that leg is a human's")},
)
_HINGE = obj(
    "A joint that bends about one axis.",
    {
        "joint": text("its name"),
        "axis": point("about which it bends, in its parent's frame"),
        "limits": list_of(
            NUMBER, "to which angles hinges: auto lets it bend, degrees: 3 and 150, or as far as the clip bends it", 2
        ),
    },
)
_DEFECT = obj(
    "A joint that jumps.",
    {
        "joint": text("its name"),
        "frames": list_of(INTEGER, "the frames into which it jumps"),
        "frame": count("the frame of the largest jump"),
        "angle": number("how far it jumps there, degrees"),
        "flips": flag("it jumps to and fro"),
    },
)
_CONTACT = obj(
    "A point of a foot that stands.",
    {
        "foot": word("which", "left", "right"),
        "part": word("of it", "heel", "toe"),
        "joint": text("its ankle or toe; the ankle where its end site is the toe"),
        "frames": list_of(INTEGER, "from, to, both in", 2),
        "seconds": number("how long: as many frames, seconds"),
        "height": number("where it stands along up, the median, clip units"),
    },
)
_SPAN = list_of(INTEGER, "from, to, both in", 2)
_PLANT = obj(
    "A foot that stands.",
    {
        "foot": word("which", "left", "right"),
        "frames": _SPAN,
        "seconds": number("how long: as many frames, seconds"),
        "heel": list_of(_SPAN, "the phases in which its heel stands"),
        "toe": list_of(_SPAN, "the phases in which its toe stands"),
        "held": obj(
            "when footplants hold them in one place",
            {which: list_of(_SPAN, f"of its {which}") for which in ("heel", "toe")},
        ),
    },
)
_CHECKED_CLIP = {
    **CLIP,
    "status": word("unfit where a limit is passed or the spec does not fit", "ok", "unfit"),
    **MESSAGE,
    "frame_rate": number("Hz"),
    "up": text("the up axis with its sign, such as y or -z"),
    "unit": or_null(_UNIT, "null where the skeleton has no length"),
    "found": list_of(word("a part of the body", "legs", "arms", "head"), "what of a body was found"),
    "measures": map_of(NUMBER, "what limits are set on, by name, in the units of `info`'s metrics"),
    "passed": list_of(STRING, "the measures whose limit is passed"),
    "spec_errors": list_of(STRING, "what the spec names and the clip lacks, a line each"),
    **WARNINGS,
}
_SHOWN_CLIP = {
    **CLIP,
    "status": word("failed where it lacks a time or a joint that was asked for", "ok", "failed"),
    **MESSAGE,
    "frames": count("how many"),
    "frame_rate": number("Hz"),
    "frame_time": number("seconds from frame to frame"),
    "duration": number("seconds from the first frame to the last"),
    "up": text("the up axis with its sign, such as y or -z"),
    "heading": number("where the character faces, degrees, at the first frame after a rest pose"),
    "rest_pose_frames": count("frames of a rest pose in front of the take"),
    "travel_joint": text("the joint whose translation carries the travel"),
    "leg_length": number("from the top of a leg to its ankle, clip units"),
    "height": number("the skeleton's longest way from end to end along its bones, clip units"),
    "unit": or_null(_UNIT, "null where the skeleton has no length"),
    "anatomy": map_of(
        {"anyOf": [map_of({"type": ["string", "null"]}, "the joint of each part"), STRING, {"type": "null"}]},
        "which joints are head, legs and arms; null where they were not found",
    ),
    "joints": list_of(part("joint"), "in the file's order"),
    "channels": count("values in a row"),
    "hinges": list_of(_HINGE, "joints that bend about one axis"),
    "defects": list_of(_DEFECT, "what looks like a fault of the capture"),
    "metrics": measures("of the clip as it is", number, step="a joint against its parent"),
    **WARNINGS,
    "contacts": list_of(_CONTACT, "with --contacts: heels and toes, each by itself"),
    "plants": list_of(_PLANT, "with --contacts: whole feet"),
    "poses": list_of(part("pose"), "with --at and --joint"),
}


def _transform(about: str) -> Schema:
    return obj(
        about,
        {
            "position": point("of the effector, clip units"),
            "euler": point("about x, y, z, degrees"),
            "order": text("of the angles, as BVH channels"),
            "quaternion": list_of(NUMBER, "w, x, y, z", 4),
        },
    )


def _difference(about: str, unit: str) -> Schema:
    keys = {
        "value": number(f"how large it is, {unit}"),
        "frame": count("where"),
        "joint": text("of which joint"),
        "tolerance": number(f"above which it counts, {unit}"),
    }
    return or_null(obj("The largest difference.", keys), about)


_FAILED_STATUS = {"const": "failed", "description": "nothing came of it"}

OTHER_PARTS: Schema = {
    "failed": obj(
        "A clip that failed.",
        {**CLIP, **OUTPUT, "status": _FAILED_STATUS, "message": text("why")},
        optional=("output",),
    ),
    "normalized_clip": obj("A clip that was normalized.", _NORMALIZED_CLIP, optional=("verify",)),
    "database_clip": obj(
        "A clip of a model's database.",
        {"clip": text("its name"), "coefficients": list_of(NUMBER, "its principal coefficients alpha")},
    ),
    "shown_clip": obj("A clip that info tells of.", _SHOWN_CLIP, optional=("contacts", "plants", "poses")),
    "checked_clip": obj("A clip that was checked.", _CHECKED_CLIP),
    "joint": obj(
        "A joint of a skeleton.",
        {
            "name": text("as in the file"),
            "parent": text_or_null("null for a root"),
            "depth": count("joints above it"),
            "channels": list_of(STRING, "in the file's order"),
            "offset": point("from its parent, clip units"),
            "end_sites": list_of(POINT, "offsets of its end sites, clip units"),
        },
    ),
    "pose": obj(
        "Where an effector is.",
        {
            "at": count("the frame"),
            "seconds": number("its time, seconds"),
            "effector": {"type": ["string", "object"], "description": "as a spec says it"},
            "world": _transform("in the world"),
            "heading": _transform("in the heading frame"),
        },
    ),
    "compared_clip": obj(
        "A pair of clips that diff compared.",
        {
            "clip": text("the path below the two folders, or B's"),
            "status": word("what came of it", "same", "different", "missing", "not_comparable"),
            **MESSAGE,
            "position": _difference("of joints' world positions; null where nothing was compared", "clip units"),
            "angle": _difference("of joints' angles; null where nothing was compared", "degrees"),
        },
    ),
}
