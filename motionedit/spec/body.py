"""What a body's joints are, where a spec says it: a head, legs, arms, which the tool then need not find."""

from collections.abc import Iterator, Mapping
from typing import Any

from motionedit.spec import kinds, values
from motionedit.spec.faults import Fault, faulty, show
from motionedit.spec.model import Context, Kind, SpecModel, spec_key

_PAIRS = (("left_leg", "right_leg"), ("left_arm", "right_arm"))
# What a part is that the body does not have.
NONE = "none"


def _limb(words: str) -> Kind:
    def parse(value: object, _context: Context) -> tuple[str, ...]:
        if value == NONE:
            return ()
        if not isinstance(value, list) or len(value) not in {3, 4}:
            raise faulty(f"must be {words}, or none; not {show(value)}")
        return values.parse_joints(value)

    json = {"type": "array", "items": kinds.JOINT.json, "minItems": 3, "maxItems": 4, "uniqueItems": True}
    return Kind(parse, f"{words}, or none", {"anyOf": [json, {"const": NONE}]})


LEG = _limb("a leg's joints [thigh, knee, ankle] or [thigh, knee, ankle, toe]")
ARM = _limb("an arm's joints [shoulder, elbow, wrist] or [clavicle, shoulder, elbow, wrist]")


class BodySpec(SpecModel):
    """Which joint is what, where names and lengths do not tell; `none` is what the body does not have."""

    head: str | None = spec_key(kinds.JOINT, default=None, description="The joint at the base of the skull, or none.")
    left_leg: tuple[str, ...] | None = spec_key(
        LEG, default=None, description="Thigh, knee, ankle, and the toe if there is one."
    )
    right_leg: tuple[str, ...] | None = spec_key(LEG, default=None, description="The other leg.")
    left_arm: tuple[str, ...] | None = spec_key(
        ARM, default=None, description="Shoulder, elbow, wrist, with the clavicle before them if there is one."
    )
    right_arm: tuple[str, ...] | None = spec_key(ARM, default=None, description="The other arm.")

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        for pair in _PAIRS:
            for key, other in (pair, pair[::-1]):
                if data.get(key) is not None and data.get(other) is None:
                    yield Fault(f"stands without {other}; limbs come in pairs", (key,))
            left, right = (data.get(key) for key in pair)
            if left is not None and right is not None and (left == NONE) != (right == NONE):
                yield Fault(f"must be none where {pair[1]} is: limbs come in pairs", (pair[0],))

    @property
    def plain(self) -> dict[str, Any]:
        """What is given, as a spec has it."""
        given = {key: value for key, value in self.attributes() if value is not None}
        return {
            key: NONE if value == () else list(value) if isinstance(value, tuple) else value
            for key, value in given.items()
        }
