"""How a database was normalized, as its list and the model keep it: the border where these rules are checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from motionedit.core.plain_values import mapping, switch, text

if TYPE_CHECKING:
    from collections.abc import Collection


def checked_rules(value: object, *, events: Collection[str]) -> dict[str, Any]:
    """Return rules that have all that an edit asks of them.

    What stands in an event's rule and in `body` is checked by the spec that takes them.

    Raises
    ------
    ValueError
        They are no such rules.
    """
    rules = mapping(value)
    align = mapping(rules["align"])
    switch(align["heading"])
    switch(align["position"])
    if align["at"] is not None and text(align["at"]) not in events:
        raise ValueError("aligned at an event that there is not")
    if align["by"] not in ("feet", "hips") or rules["rest_pose"] not in ("drop", "keep"):
        raise ValueError("no such rule")
    for name, rule in mapping(rules["events"]).items():
        if name not in events:
            raise ValueError("a rule for an event that there is not")
        if rule is not None:
            mapping(rule)
    return rules
