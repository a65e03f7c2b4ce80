"""What joints are called: words for legs, arms, heads, ends, and for what only hangs on a body."""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import takewhile

# Found anywhere in a name: real rigs write LeftUpLeg, l_thigh and upperarm01.L.
_LEG = re.compile(r"thigh|leg|knee|calf|shin|ankle|foot|toe|femur|tibia|hip|足|脚|腿|膝|ひざ|つま先")
_ARM = re.compile(r"arm|elbow|wrist|hand|finger|thumb|clavicle|collar|shoulder|humerus|radius|腕|肘|ひじ|手|肩")
_HAND_OR_FOOT = re.compile(r"wrist|hand|ankle|foot|feet|足首|手首")
_TOE = re.compile(r"toe|ball|bale|つま先")
_HEAD = re.compile(r"^head(?!gear|band|phone|set|rest|light)|(?<!fore)head$|^skull$|^頭$")
_FRONT = {"front", "fore"}
_ENDS = {"end", "top", "nub", "site", "tip", "leaf"}
# Whole words of a name. What hangs on a body looks like a limb to whoever sees bones alone.
_HANGING = frozenset(
    word
    for words in (
        "hair bang bangs braid ponytail pigtail tail 髪 尾",
        "skirt dress cape cloak coat scarf ribbon cloth sleeve hood belt strap bag backpack",
        "wing wings feather fin horn antenna antler ear ears tentacle",
        "eye eyes eyelid brow eyebrow jaw tongue teeth lip cheek breast bust boob",
        "sword weapon gun rifle blade shield staff spear axe knife stick club racket bat whip rope chain",
        "ski skis skate wheel board prop",
        "ik pole target ctrl sec phys dyn dynamic spring jiggle",
    )
    for word in words.split()
)
# The longest of them also where a name is written in one word: leftskirt, hair01.
_HANGING_ENDS = re.compile(
    r"(?:hair|tail|skirt|dress|cape|cloak|scarf|ribbon|sleeve|(?<!s)wing|sword|weapon|breast)\d*$"
)
_NAMESPACE = re.compile(r"^.*[:|]")
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^\W\d_a-zA-Z]+")


@lru_cache(maxsize=8)
def bare_names(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return names without namespaces (``mixamorig:``) and without what all begin with, which says nothing of a joint.

    A character called Bat makes no body of wings.
    """
    cut = [_NAMESPACE.sub("", name) or name for name in names]
    # What the first and the last in order share, all share.
    shared = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(min(cut), max(cut), strict=False)))
    while shared and not (len(cut) > 2 and all(_begins_a_word(name, shared) for name in cut)):
        shared -= 1
    return tuple(name[shared:] for name in cut)


def _begins_a_word(name: str, at: int) -> bool:
    return at < len(name) and (not name[at - 1].isalnum() or name[at].isupper())


@lru_cache(maxsize=4096)
def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case: ``J_Sec_HairTip1_L`` is j, sec, hair, tip, l."""
    return tuple(word.lower() for word in _WORD.findall(name))


def hangs_on(name: str) -> bool:
    """Tell whether a name speaks of hair, tail, skirt, wing, prop or the like, which is no limb."""
    words = words_of(name)
    return any(word in _HANGING or _HANGING_ENDS.search(word) for word in words)


def is_end(name: str) -> bool:
    """Tell whether a name speaks of an end of a chain, where nothing bends: ``HeadTop_End``, ``ToeNub``."""
    words = words_of(name)
    return any(word in _ENDS or word.endswith(("nub", "_end")) for word in words)


def is_head(name: str) -> bool:
    """Tell whether a joint is called head, alone and not by side, and is not the end above one."""
    words = [word for word in words_of(name) if word not in ("l", "r", "left", "right")]
    return len(words) == len(words_of(name)) and not is_end(name) and any(_HEAD.search(word) for word in words)


def is_twist(name: str) -> bool:
    """Tell whether a name speaks of a joint that only shares the twist of a bone."""
    return any(word.startswith(("twist", "roll")) or word.endswith(("twist", "roll")) for word in words_of(name))


def is_hand_or_foot(name: str) -> bool:
    """Tell whether a name speaks of where a limb ends: hand, wrist, foot, ankle."""
    return _HAND_OR_FOOT.search(name.casefold()) is not None and not hangs_on(name)


def is_toe(name: str) -> bool:
    """Tell whether a name speaks of toes or the ball of the foot."""
    return _TOE.search(name.casefold()) is not None and not is_end(name)


def leg_or_arm(names: tuple[str, ...], joints: tuple[int, ...]) -> int:
    """Return how many more names in a chain speak of a leg than of an arm; a front leg is an arm."""
    total = 0
    for joint in joints:
        name = names[joint].casefold()
        leg, arm = bool(_LEG.search(name)), bool(_ARM.search(name))
        front = leg and not _FRONT.isdisjoint(words_of(names[joint]))
        total += -1 if front else leg - arm
    return total
