"""The spec of edit-prioritized: constraints in strict layers of priority, [PRIO]."""

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple

from motionedit.spec import kinds, scalars, values
from motionedit.spec.constraint_types import CONSTRAINT
from motionedit.spec.constraints import ConstraintItem, Defaults
from motionedit.spec.document import Document
from motionedit.spec.faults import Fault, faulty, show
from motionedit.spec.items import repeated_names, taken_apart
from motionedit.spec.model import Context, Kind, SpecModel, spec_key
from motionedit.spec.nested import list_of, mapping
from motionedit.spec.times import Duration

# Passes of each method of smoothing where the spec does not say.
_PASSES = {"passes": 3, "paper": 2}


class Smoothing(SpecModel):
    """How the edit is kept continuous in time, section 5."""

    between_keys = (
        {
            "if": {"properties": {"method": {"const": "paper"}}, "required": ["method"]},
            "then": {"not": {"required": ["sigma"]}},
            "else": {"not": {"required": ["cutoff"]}},
        },
    )

    method: Literal["passes", "paper"] = spec_key(
        kinds.word("passes", "paper"),
        default="passes",
        description="passes: low-pass the displacement and solve again; paper: eq. (4) and a filter on the root.",
    )
    passes: int | None = spec_key(
        kinds.whole(at_least=0, largest=1000),
        default=None,
        description="Passes after the first solve; default 3, with method: paper 2.",
    )
    sigma: Duration = spec_key(
        kinds.DURATION,
        default=Duration("0.062s", 0.062, is_seconds=True),
        description="passes only: width of the Gaussian low-pass.",
    )
    cutoff: float = spec_key(
        kinds.number(above=0.0, smallest=0.01),
        default=3.0,
        description="paper only: cutoff of the root's low-pass, Hz.",
    )

    @property
    def pass_count(self) -> int:
        """Passes after the first solve."""
        return _PASSES[self.method] if self.passes is None else self.passes

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        method = data.get("method", "passes")
        if method == "passes" and "cutoff" in data:
            yield Fault("belongs to method: paper; passes has sigma", ("cutoff",))
        if method == "paper" and "sigma" in data:
            yield Fault("belongs to method: passes; paper has cutoff", ("sigma",))


class LayeredSolver(SpecModel):
    """Settings of the layered solver, section 3."""

    max_iterations: int = spec_key(
        kinds.whole(at_least=1, largest=100_000),
        default=40,
        description="Iterations at most for each frame and pass; as many again where joints are beyond their limits.",
    )


def _masses(value: object, _context: Context) -> dict[str, float]:
    if not isinstance(value, dict):
        raise faulty(f"must be a mapping from joints to kilograms, not {show(value)}")
    found = values.read_keys(value, dict.fromkeys(value, lambda item: scalars.number(item, at_least=0.0)))
    return {joint: scalars.number(mass) for joint, mass in found.items()}


MASSES = Kind(
    _masses,
    "a mapping from joints to kilograms",
    {"type": "object", "additionalProperties": {"type": "number", "minimum": 0, "maximum": scalars.LARGEST}},
)


def _stiffness(value: object, _context: Context) -> str | dict[str, float]:
    if isinstance(value, str) and value in {"human", "none"}:
        return str(value)
    if not isinstance(value, dict):
        raise faulty(f"must be human, none, or a mapping from joints to numbers, not {show(value)}")
    found = values.read_keys(value, dict.fromkeys(value, lambda item: scalars.number(item, above=0.0)))
    return {joint: scalars.number(stiffness) for joint, stiffness in found.items()}


STIFFNESS = Kind(
    _stiffness,
    "human, none, or a mapping from joints to numbers",
    {
        "anyOf": [
            {"enum": ["human", "none"]},
            {"type": "object", "additionalProperties": {"type": "number", "exclusiveMinimum": 0}},
        ]
    },
)


class JointRange(NamedTuple):
    """Half of a joint's range of motion, degrees."""

    swing: float
    twist: float


_HALF_TURN = 180.0


def _range(value: object) -> JointRange:
    if not isinstance(value, dict):
        raise faulty(f"must be a mapping of swing and twist in degrees, not {show(value)}")
    angle = partial(scalars.number, at_least=0.0, at_most=_HALF_TURN)
    found = values.read_keys(value, {"swing": angle, "twist": angle})
    return JointRange(scalars.number(found.get("swing", _HALF_TURN)), scalars.number(found.get("twist", _HALF_TURN)))


def _limits(value: object, _context: Context) -> str | dict[str, JointRange]:
    if isinstance(value, str) and value in {"human", "off"}:
        return str(value)
    if not isinstance(value, dict):
        raise faulty(f"must be human, off, or a mapping from joints to {{swing, twist}}, not {show(value)}")
    found: dict[str, Any] = values.read_keys(value, dict.fromkeys(value, _range))
    return found


_HALF = {"type": "number", "minimum": 0, "maximum": _HALF_TURN}
LIMITS = Kind(
    _limits,
    "human, off, or a mapping from joints to {swing, twist} in degrees",
    {
        "anyOf": [
            {"enum": ["human", "off"]},
            {
                "type": "object",
                "additionalProperties": {
                    "type": "object",
                    "properties": {"swing": _HALF, "twist": _HALF},
                    "additionalProperties": False,
                },
            },
        ]
    },
)


# Each is solved for itself with those above it, and smoothed, wherever something is out of reach.
_MOST_LAYERS = 20


def _constraints_apart(
    constraints: tuple[ConstraintItem, ...], others: Mapping[str, Any]
) -> tuple[ConstraintItem, ...]:
    # Absent where it is faulty itself; then the spec is refused whatever stands here.
    defaults = others.get("defaults", Defaults())
    parts = taken_apart([item.with_defaults(defaults) for item in constraints], "constraints")
    layers = len({part.priority for part in parts})
    if layers > _MOST_LAYERS:
        raise faulty(f"have {layers} priorities; one spec has {_MOST_LAYERS} at most: let some share one")
    return parts


def _reference(value: object, context: Context) -> Path:
    path = Path(scalars.name(value, what="a clip or a folder"))
    return path if context.folder is None else context.folder / path


REFERENCE = Kind(_reference, "a clip or a folder", {"type": "string", "minLength": 1})


class EditPrioritizedSpec(Document):
    """Everything edit-prioritized is told."""

    schema_id: str = spec_key(
        kinds.schema_id("edit-prioritized"),
        default="motionedit/edit-prioritized/v1",
        name="schema",
        description="Which spec this is.",
    )
    defaults: Defaults = spec_key(
        mapping(Defaults), default=Defaults(), description="What constraints use that do not say otherwise."
    )
    constraints: tuple[ConstraintItem, ...] = spec_key(
        list_of(CONSTRAINT),
        after=_constraints_apart,
        description="What shall hold, and how important it is; [] changes nothing.",
    )
    masses: dict[str, float] = spec_key(
        MASSES,
        default={},
        description="Kilograms by joint: they replace the whole table, so a joint that is not listed weighs nothing; "
        "default: an anthropometric table laid on the skeleton.",
    )
    hinges: str | tuple[str, ...] = spec_key(
        kinds.or_off(kinds.either(("auto", "off"), kinds.JOINTS)),
        default="auto",
        description="Joints that bend about one axis only: auto (knees and elbows), off, or a list of joints.",
    )
    stiffness: str | dict[str, float] = spec_key(
        STIFFNESS,
        default="human",
        description="How little joints give: human (a table laid on the skeleton), none (all alike, as in the paper), "
        "or numbers by joint: larger gives less, 1 is as the others.",
    )
    limits: str | dict[str, JointRange] = spec_key(
        kinds.or_off(LIMITS),
        default="human",
        description="How far joints turn from where the clip has them: human (ranges laid on the skeleton, never "
        "tighter than what the clip does), off (as in the paper), or swing and twist by joint, degrees.",
    )
    attraction: float = spec_key(
        kinds.number(at_least=0.0, largest=10.0),
        default=1.0,
        description="Pull towards the input where the layers leave freedom: the vector z of eq. (1).",
    )
    smoothing: Smoothing = spec_key(
        mapping(Smoothing), default=Smoothing(), description="How the edit is kept continuous in time."
    )
    curve: Literal["time", "index"] = spec_key(
        kinds.word("time", "index"),
        default="time",
        description="Parameter of the trajectory S: time, or the paper's index with piecewise-linear T(t).",
    )
    solver: LayeredSolver = spec_key(
        mapping(LayeredSolver), default=LayeredSolver(), description="Settings of the solver."
    )
    reference: Path | None = spec_key(
        REFERENCE,
        default=None,
        description="Another version of the clip, or a folder with clips of the same relative names: footplants take "
        "plants and places from it, and constraints that say follow: reference their paths.",
    )
    recruiting_rule: Literal["expand", "error", "ignore"] = spec_key(
        kinds.word("expand", "error", "ignore"),
        default="expand",
        description="What a breach of eq. (2) leads to: expand the layer above, an error, or nothing.",
    )

    @property
    def event_files(self) -> tuple[Path, ...]:
        """Files that frames of events, and plants, were read from."""
        given = (getattr(each, "plants", None) for each in self.constraints)
        return (*super().event_files, *(plants.file for plants in given if plants is not None and plants.file))

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        yield from repeated_names(data, "constraints")
