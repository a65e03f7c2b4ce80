"""Other names for one part of a body: who says LeftKnee means the LeftLeg, or the L_Calf, of another rig."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.body.words import bare_names, words_of

if TYPE_CHECKING:
    from collections.abc import Iterable

# A joint is called after the bone that it turns, or after itself: a thigh hangs on a hip, a shin on a knee.
_SIDED = {
    word: part
    for part, words in {
        "thigh": "thigh femur hip upleg upperleg",
        "shin": "shin calf tibia knee leg lowleg loleg lowerleg",
        "foot": "foot ankle",
        "toe": "toe toes toebase ball bale",
        "clavicle": "clavicle collar",
        "shoulder": "shoulder",  # of the arm or of the clavicle
        "upper arm": "humerus arm uparm upperarm",
        "forearm": "forearm radius elbow lowarm loarm lowerarm",
        "hand": "hand wrist",
    }.items()
    for word in words.split()
}
_IN_THE_MIDDLE = {"hips": "hips", "hip": "hips", "pelvis": "hips", "head": "head", "skull": "head"}
_ELSE = {"shoulder": ("upper arm", "clavicle"), "upper arm": ("shoulder",), "clavicle": ("shoulder",)}
_SIDES = {"left": "left", "l": "left", "right": "right", "r": "right"}


def same_part(name: str, names: Iterable[str]) -> str | None:
    """Return the first of other names that is that of the same part on the same side; None where there is none."""
    found = _part(name)
    if found is None:
        return None
    side, part = found
    given = tuple(names)
    parts = [_part(bare) for bare in bare_names(given)]
    for wanted in (part, *_ELSE.get(part, ())):
        if (side, wanted) in parts:
            return given[parts.index((side, wanted))]
    return None


def _part(name: str) -> tuple[str | None, str] | None:
    """Return the side and the part that a name speaks of; its last words say which."""
    words = list(words_of(name))
    if words and words[0] not in _SIDES:
        words[:1] = _begun_by_a_side(words[0])
    side = next((_SIDES[word] for word in words if word in _SIDES), None)
    known = _IN_THE_MIDDLE if side is None else _SIDED
    rest = [word for word in words if word not in _SIDES]
    endings = ("".join(rest[i:]) for i in range(len(rest)))
    part = next((known[ending] for ending in endings if ending in known), None)
    return None if part is None else (side, part)


def _begun_by_a_side(word: str) -> list[str]:
    """Return a word as a side and a part where it is both, as ``lefthand`` and ``lhand`` are."""
    for side in _SIDES:
        if word.startswith(side) and word.removeprefix(side) in _SIDED:
            return [side, word.removeprefix(side)]
    return [word]
