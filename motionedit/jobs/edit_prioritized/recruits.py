"""What is said of recruiting: breaches of its rule, and for --dry-run the layers in the order they are solved."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from motionedit.core.body.bones import below
from motionedit.core.priorities.edit import RecruitingError, recruit
from motionedit.core.priorities.kinds.constraint import Movable
from motionedit.core.priorities.recruiting import Recruits
from motionedit.core.priorities.solver.problem import order_of_layers
from motionedit.core.priorities.trajectories.lengths import LengthPoint
from motionedit.jobs.clip import resolve

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.priorities.recruiting import Breach
    from motionedit.core.priorities.trajectories.positions import ControlPoint
    from motionedit.core.skeleton import Skeleton
    from motionedit.errors import MotionEditError
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_prioritized.body import SizedClip
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec


def refuse_breaches(
    loaded: LoadedSpec[EditPrioritizedSpec], sized: SizedClip, constraints: Sequence[Constraint]
) -> None:
    """Refuse a breach of the recruiting rule where the spec wants none.

    Raises
    ------
    SpecError
        At the recruiting of the higher constraint.
    """
    rule = loaded.model.recruiting_rule
    if rule != "error" or not constraints:
        return
    try:
        recruit(constraints, sized.motion, sized.body, rule=rule)
    except RecruitingError as error:
        raise _breach_error(loaded, error.breach, constraints, sized.facts) from None


def _breach_error(
    loaded: LoadedSpec[EditPrioritizedSpec], breach: Breach, constraints: Sequence[Constraint], facts: ClipFacts
) -> MotionEditError:
    keys = loaded.model.constraints[breach.higher].keys
    place = resolve.recruit_place(resolve.Place(loaded, keys, facts.clip.label))
    higher, lower = (constraints[i].name for i in (breach.higher, breach.lower))
    names = ", ".join(recruited_names(Recruits(breach.joints, breach.root), facts))
    return place.error(
        f"in {place.clip}: '{higher}' does not recruit {names}, by which '{lower}' moves it; "
        "recruit them, or set recruiting_rule: expand"
    )


def breach_warnings(
    breaches: Sequence[Breach], constraints: Sequence[Constraint], facts: ClipFacts, *, rule: str
) -> list[str]:
    """Return a line for each constraint that moved others against the recruiting rule, and what it moved them by."""
    pairs: dict[tuple[int, int], Recruits] = {}
    for breach in breaches:
        known = pairs.get((breach.higher, breach.lower), Recruits(frozenset(), root=False))
        pairs[breach.higher, breach.lower] = Recruits(known.joints | breach.joints, known.root or breach.root)
    moved: dict[tuple[int, Recruits], list[str]] = {}
    for (higher, lower), by in pairs.items():
        moved.setdefault((lower, by), []).append(constraints[higher].name)
    lines = []
    for (lower, by), highers in moved.items():
        mover, joints, names = constraints[lower].name, ", ".join(recruited_names(by, facts)), ", ".join(highers)
        if rule == "expand":
            lines.append(f"recruiting_rule expand adds {joints} to {names} because {mover} moves them")
        else:
            lines.append(f"{mover} moves {names} by {joints}, not recruited there: its priority may not hold")
    return lines


def immovable_warnings(constraints: Sequence[Constraint], recruits: Sequence[Recruits], facts: ClipFacts) -> list[str]:
    """Return a line for each thing that constraints ask to move and the clip's channels do not let move."""
    given = tuple(constraints), tuple(recruits), facts.clip.motion.skeleton, facts.travel
    # As where they recruit: goals of feet are a clip's own.
    return [*(_immovable if any(each.stands for each in constraints) else _immovable_again)(*given)]


def _immovable(
    constraints: tuple[Constraint, ...], recruits: tuple[Recruits, ...], skeleton: Skeleton, travel: int
) -> list[str]:
    names, carried = skeleton.names, below(skeleton, travel)
    lines: list[str] = []
    wants_root = False
    for constraint, own in zip(constraints, recruits, strict=True):
        asked = constraint.recruits(Movable(skeleton, travel, own.joints))
        rule = getattr(constraint, "recruit", None)
        listed = () if rule is None else rule.joints
        for joint in listed:
            if not carried[joint]:
                why = f"it does not hang on {names[travel]}, which carries the travel"
                lines.append(f"{constraint.name}: {names[joint]} is not recruited: {why}")
            elif not skeleton.rotation_axes[joint]:
                lines.append(f"{constraint.name}: {names[joint]} is not recruited: it has no rotation channels")
        if not own.joints and not own.root:
            lines.append(f"{constraint.name} recruits nothing: no joint on its way has channels to move it by")
        wants_root = wants_root or asked.root
    has = [axis for axis in range(3) if axis in skeleton.position_axes[travel]]
    if wants_root and not has:
        lines.append(f"{names[travel]} has no position channels: the body cannot be shifted")
    elif wants_root and len(has) < 3:
        axes = " and ".join("xyz"[axis] for axis in has)
        lines.append(f"{names[travel]} has position channels for {axes} alone: the body is shifted along those")
    return list(dict.fromkeys(lines))


_immovable_again = lru_cache(maxsize=4)(_immovable)


def layer_lines(constraints: Sequence[Constraint], recruits: Sequence[Recruits], sized: SizedClip) -> list[str]:
    """Return the layers in solving order: each constraint, its interval, its points, and what it may move."""
    facts = sized.facts
    lines = []
    for number, priority in enumerate(order_of_layers([c.priority for c in constraints]), start=1):
        lines.append(f"layer {number}, priority {priority}")
        for constraint, own in zip(constraints, recruits, strict=True):
            if constraint.priority == priority:
                lines.append(f"  {_constraint_line(constraint, own, sized)}")
    names = facts.clip.motion.skeleton.names
    lines.append(f"hinges: {', '.join(names[hinge.joint] for hinge in sized.body.hinges) or 'none'}")
    return lines


def _constraint_line(constraint: Constraint, recruits: Recruits, sized: SizedClip) -> str:
    facts = sized.facts
    skeleton = facts.clip.motion.skeleton
    first, last = constraint.active(len(facts.clip.motion))
    parts = [f"{constraint.name}: {constraint.words(skeleton.names)}, frames {first} to {last}"]
    if constraint.points:
        parts.append(
            ", ".join(_point_words(point, constraint.measure.axes, sized.scale) for point in constraint.points)
        )
    if constraint.weight != 1.0:
        parts.append(f"weight {constraint.weight:g}")
    moved = ", ".join(recruited_names(recruits, facts))
    return f"{'; '.join(parts)}; recruits {moved or 'nothing'}"


def _point_words(point: ControlPoint, axes: FloatArray, scale: float) -> str:
    """Return a point's time and what is asked there, places and shifts in the world or `relative_to`, clip units."""
    words = [point.text]
    for key in ("position", "shift"):
        value = getattr(point, key)
        if value is not None:
            words.append(f"{key} [{', '.join(f'{part / scale + 0.0:.4g}' for part in value @ axes)}]")
    if isinstance(point, LengthPoint) and point.length is not None:
        words.append(f"{point.bound} {point.length / scale:.4g}")
    words += [key for key in ("orientation", "turn") if getattr(point, key) is not None]
    return " ".join(words)


def recruited_names(recruits: Recruits, facts: ClipFacts) -> list[str]:
    """Return joints in the file's order, and the root's translation as a spec would recruit it."""
    names = facts.clip.motion.skeleton.names
    listed = [names[j] for j in sorted(recruits.joints)]
    return [*listed, f"{names[facts.travel]}.position"] if recruits.root else listed
