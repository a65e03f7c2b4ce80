"""How a database was normalized, as its list and the model keep it: the border where these rules are checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from motionedit.core.plain_values import mapping, switch, text

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence


def checked_rules(value: object, *, events: Collection[str]) -> dict[str, Any]:
    """Return rules that have all that an edit asks of them.

    What stands in an event's rule, in `crop` and in `body` is checked by the spec that takes them.

    Parameters
    ----------
    events : collection of str
        Those of the timeline. An event that a crop's time begins with may have a rule, too, and lies at an end of it.

    Raises
    ------
    ValueError
        They are no such rules.
    """
    rules = mapping(value)
    align = mapping(rules["align"])
    switch(align["heading"])
    switch(align["position"])
    crops = [text(time).strip() for time in mapping(rules.get("crop", {})).values()]
    if align["at"] is not None and not _is_known(text(align["at"]), events, crops):
        raise ValueError("aligned at an event that there is not")
    if align["by"] not in ("feet", "hips") or rules["rest_pose"] not in ("drop", "keep"):
        raise ValueError("no such rule")
    for name, rule in mapping(rules["events"]).items():
        if not _is_known(name, events, crops):
            raise ValueError("a rule for an event that there is not")
        if rule is not None:
            mapping(rule)
    return rules


def _is_known(name: str, events: Collection[str], crops: Sequence[str]) -> bool:
    return name in events or any(crop.startswith(name) for crop in crops)
