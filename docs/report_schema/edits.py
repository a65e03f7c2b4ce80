"""What the reports of edit-pc and edit-prioritized say of a clip."""

from __future__ import annotations

from motionedit.core.priorities.kinds import KINDS
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
    measures,
    number,
    number_or_null,
    numbers_or_null,
    obj,
    or_null,
    part,
    point,
    text,
    word,
)


def _metrics(more: Schema) -> Schema:
    about = "{} the edit; null where it has another timing"
    steps = {"before": "a joint against its parent", "after": "the change that the edit made of such a turn"}
    sides = {side: measures(about.format(side), number_or_null, step=step) for side, step in steps.items()}
    drift = {"foot_drift_max": number_or_null("how far a held point of the input moved, clip units")}
    return obj("side effects of the edit", {**sides, **drift, **more})


_ASKED = {
    "name": text("its name in the spec"),
    "priority": {"type": "integer", "description": "larger is more important"},
    "error_max": number_or_null("the largest distance from where it was wanted, clip units; null for what only turns"),
    "error_rms": number_or_null("root mean square of these distances, clip units"),
    "error_angle_max": number_or_null("the largest angle from what was wanted, degrees; null where no turn was asked"),
    "frame": count("a goal's frame in what was written, a constraint's worst"),
    "tolerance": number_or_null("up to which distance it counts as met, clip units; null for none"),
    "tolerance_angle": number_or_null("up to which angle it counts as met, degrees; null for none"),
    "status": part("goal_status"),
    "gave_way_to": list_of(STRING, "names of those of the same or a higher priority for which it is missed"),
}

_PC_CLIP = {
    **CLIP,
    **OUTPUT,
    "status": part("edit_status"),
    **MESSAGE,
    **UNIT,
    "metrics": _metrics({}),
    "goals": list_of(part("goal"), "the spec's goals, in its order"),
    "iterations": count("of the solver"),
    "stopped": word("why the solver stopped", "converged", "stalled", "bound", "iterations"),
    "history": list_of(
        NUMBER,
        "the norm of all goals' weighted errors at first and after each iteration, clip units; a radian is 0.3 m "
        "at leg length 0.85 m; by per_goal one frame's after another's",
    ),
    "alpha": obj(
        "the clip's principal coefficients; by per_goal those at the first frame with goals",
        {side: list_of(NUMBER, f"{side} the edit") for side in ("before", "after")},
    ),
    "mahalanobis": obj(
        "the norm of alpha / sqrt(lambda)",
        {
            "before": number("before the edit"),
            "after": number("after the edit"),
            "bound": number_or_null(
                "the largest that is allowed, of the change where a prior measures it; null for any"
            ),
            "database_max": number("the largest of the database's motions"),
        },
    ),
    "change": obj(
        "the change under the prior of method map",
        {
            "norm": number_or_null("in standard deviations of the database; null by another method"),
            "bound": number_or_null("the largest that is allowed, standard deviations; null for any"),
            "residual_share": number_or_null("the share of the change's variance that may leave the components"),
        },
    ),
    "nearest": obj(
        "the clip of the database that is nearest in coefficients",
        {side: text(f"{side} the edit") for side in ("before", "after")},
    ),
    "hands": or_null(
        obj(
            "hands that hold one thing",
            {
                "grips": list_of(
                    obj(
                        "where they do",
                        {"first_frame": count("the first frame"), "last_frame": count("the last one")},
                    ),
                    "in order",
                ),
                "apart_max": number_or_null(
                    "how far the left is left from where the right had it, clip units; null where no grip was kept"
                ),
            },
        ),
        "where hands: keep looked for them, else null",
    ),
    **WARNINGS,
    **VERIFY,
}

_SOLVED = {
    "layers": list_of(part("layer"), "layers of priority, the most important first"),
    "iterations": obj(
        "iterations of the first solve, over the frames that were solved",
        {"median": number("the median"), "max": count("the most")},
    ),
    "frames_solved": count("how many frames any constraint reaches"),
    "frames_not_converged": count("how many frames ran out of iterations in the last solve"),
    "frames": obj(
        "by frame of the clip",
        {
            "iterations": list_of(INTEGER, "of the first solve; 0 where nothing was solved"),
            "stopped": list_of({"enum": ["converged", "iterations", "untouched"]}, "why the last solve stopped"),
        },
    ),
    "passes": count("smoothing passes"),
    "solver": word("what solved the layers: C, or numpy where that could not be compiled", "compiled", "numpy"),
}

_PRIORITIZED_CLIP = {
    **CLIP,
    **OUTPUT,
    "status": part("edit_status"),
    **MESSAGE,
    **UNIT,
    "metrics": _metrics({"com_shift_max": number("how far the center of mass moved, clip units")}),
    "constraints": list_of(part("constraint"), "the spec's constraints, in its order"),
    **_SOLVED,
    **WARNINGS,
    **VERIFY,
}

_CONSTRAINT = {
    "name": _ASKED["name"],
    "type": word("its type in the spec", *KINDS),
    **_ASKED,
    "strict": flag("whether --strict counts it"),
    "first_frame": count("the first frame at which it is active"),
    "last_frame": count("the last one, which is in"),
    "effector": or_null(part("effector"), "what it moves; null where it is about no one point"),
    "points": list_of(part("span"), "its points; none where it rides the input's own trajectory"),
    "recruited": list_of(STRING, "joints that it may move; NAME.position is the root's translation"),
    "frames": obj(
        "by frame from first_frame on",
        {
            "error": numbers_or_null("the distance from where its effector was wanted, clip units"),
            "error_angle": numbers_or_null("the angle from what was wanted, degrees"),
            "target": or_null(
                {"type": "array", "items": POINT},
                "where its effector was wanted, in the world, clip units; along axes that are free, where it is. What "
                "an aim looks at, a com's center of mass; null for what only turns",
            ),
        },
    ),
}

EDIT_PARTS: Schema = {
    "edit_status": word(
        "all goals met; met, but far from the database; met, but a viewer would see the edit; a goal missed; a goal "
        "missed because it is out of reach",
        *("ok", "far", "rough", "out_of_tolerance", "unreachable"),
    ),
    "goal_status": word("met, missed, or out of reach", "ok", "out_of_tolerance", "unreachable"),
    "effector": obj(
        "A point fixed in a joint's frame.",
        {"joint": text("the joint's name"), "offset": point("the point in the joint's frame, clip units")},
    ),
    "span": obj(
        "A point of a constraint.",
        {
            "mode": word("stands still, rides the input's trajectory, or is one instant", "hold", "during", "at"),
            "first": count("its first frame"),
            "last": count("its last frame, which is in"),
        },
    ),
    "goal": obj(
        "A goal of edit-pc.",
        {
            **_ASKED,
            "effector": part("effector"),
            "target": or_null(POINT, "where it was wanted, in the world, clip units; null for what only turns"),
        },
    ),
    "constraint": obj("A constraint of edit-prioritized.", _CONSTRAINT, optional=("frames",)),
    "layer": obj(
        "The constraints of one priority.",
        {
            "priority": {"type": "integer", "description": "theirs"},
            "constraints": list_of(STRING, "their names"),
            "rank": obj(
                "independent rows while any of them is active", {"min": count("the least"), "max": count("the most")}
            ),
            "frames": obj("by frame of the clip", {"rank": list_of(INTEGER, "independent rows")}),
        },
        optional=("frames",),
    ),
    "pc_clip": obj("A clip that edit-pc wrote.", _PC_CLIP, optional=("verify",)),
    "prioritized_clip": obj(
        "A clip that edit-prioritized wrote; where the spec has no constraints nothing is told of a solver.",
        _PRIORITIZED_CLIP,
        optional=("verify", *_SOLVED),
    ),
}
