"""The spec of edit-pc: goals at single frames, met in the space of motion principal coefficients, [PC] 4.2-4.3."""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal

from motionedit.spec import kinds
from motionedit.spec.document import Document
from motionedit.spec.faults import Fault
from motionedit.spec.items import (
    EFFECTOR_KEYS,
    NOT_TWO_FRAMES,
    EffectorItem,
    measure_faults,
    repeated_names,
    taken_apart,
    without,
)
from motionedit.spec.model import SpecModel, mappings_in, spec_key
from motionedit.spec.nested import list_of, mapping
from motionedit.spec.scalars import Vector
from motionedit.spec.times import Time
from motionedit.spec.values import UNITS, OrientationSpec, Tolerance, Unit

DEFAULT_PLAUSIBILITY = 3.0


class PcGoal(EffectorItem):
    """Where an effector shall be at one frame."""

    at_least_one = (("position", "shift", "orientation", "turn"),)
    at_most_one = (("position", "shift"), ("orientation", "turn"))
    foreign_keys: ClassVar[Mapping[str, str]] = {
        **EFFECTOR_KEYS,
        **dict.fromkeys(
            ("points", "hold", "during"), "belongs to edit-prioritized; a goal is at one instant, as at: TIME"
        ),
    }
    between_keys = (
        NOT_TWO_FRAMES,
        {"if": {"required": ["axes"]}, "then": {"anyOf": [{"required": [key]} for key in ("position", "shift")]}},
        {
            "if": {"not": {"anyOf": [{"required": [key]} for key in ("orientation", "turn")]}},
            "then": {"properties": {"tolerance": without("angle")}},
        },
    )

    at: Time = spec_key(kinds.TIME, description="The instant of the goal.")
    position: Vector | None = spec_key(
        kinds.VECTOR,
        default=None,
        description="Where the effector shall be, in clip units. One of position, shift, orientation, turn is needed.",
    )
    shift: Vector | None = spec_key(
        kinds.VECTOR,
        default=None,
        description="How far the effector shall move from where it is at that frame, in clip units.",
    )
    orientation: OrientationSpec | None = spec_key(
        kinds.ORIENTATION,
        default=None,
        description="How the effector's joint shall be turned, in degrees; alone or beside position or shift.",
    )
    turn: OrientationSpec | None = spec_key(
        kinds.ORIENTATION,
        default=None,
        description="By how much the effector's joint shall be turned from its own rotation at that frame, about the "
        "axes of frame: or relative_to:, in degrees; instead of orientation.",
    )
    frame: kinds.Frame = spec_key(
        kinds.FRAME,
        default="world",
        description="Axes of position, shift, orientation and turn: world, or the character's heading.",
    )
    relative_to: str | None = spec_key(
        kinds.JOINT, default=None, description="Measure in this joint's frame instead of the world's."
    )
    axes: tuple[int, ...] = spec_key(
        kinds.AXES, default=(0, 1, 2), description="Axes that count for position or shift; default: all of [x, y, z]."
    )
    weight: float = spec_key(
        kinds.number(above=0.0), default=1.0, description="Weight among goals of the same priority."
    )
    priority: int = spec_key(
        kinds.whole(), default=1, description="Larger is more important; goals of equal priority are weighted together."
    )
    tolerance: Tolerance | None = spec_key(
        kinds.TOLERANCE,
        default=None,
        description="How near is met: clip units (degrees for an orientation alone), {position, angle}, or off; "
        "default 1 mm and 0.1 degree at leg length 0.85 m.",
    )

    @property
    def wants_position(self) -> bool:
        """Whether the goal has a position or shift, else an orientation alone."""
        return self.position is not None or self.shift is not None

    @property
    def met_within(self) -> Tolerance:
        """The tolerance, a bare number in degrees where the goal is an orientation alone."""
        tolerance = self.tolerance or Tolerance()
        return tolerance if self.wants_position else tolerance.as_angle()

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        placed, turned = "position" in data or "shift" in data, "orientation" in data or "turn" in data
        if "axes" in data and turned and not placed:
            yield Fault("belongs to position or shift; an orientation has all its axes", ("axes",))
        yield from measure_faults(data)
        tolerance = data.get("tolerance")
        if isinstance(tolerance, dict):
            if "angle" in tolerance and not turned:
                yield Fault("belongs to a goal with an orientation or turn", ("tolerance", "angle"))
            if "position" in tolerance and turned and not placed:
                yield Fault("belongs to a goal with a position or shift", ("tolerance", "position"))


_DAMPED_KEYS = ("damping", "damping_unit", "max_iterations", "tolerance")


class PcSolver(SpecModel):
    """How the coefficients are found."""

    between_keys = (
        {
            "if": {"properties": {"method": {"const": "damped"}}, "required": ["method"]},
            "else": {"not": {"anyOf": [{"required": [key]} for key in _DAMPED_KEYS]}},
        },
    )

    method: Literal["map", "gauss-newton", "damped"] = spec_key(
        kinds.word("map", "gauss-newton", "damped"),
        default="map",
        description="map: the likeliest change, components as a prior beside a pose residual that fades; gauss-newton: "
        "the components alone; damped: the paper's Algorithm 1, which needs unit:.",
    )
    damping: float = spec_key(
        kinds.number(at_least=0.0),
        default=10.0,
        description="damped only: the damping xi, in damping_unit; 0 is a plain pseudo-inverse.",
    )
    damping_unit: Unit = spec_key(
        kinds.UNIT, default=Unit("cm", UNITS["cm"]), description="damped only: the unit the solver works in, as unit:."
    )
    max_iterations: int | None = spec_key(
        kinds.whole(at_least=1, null=True, largest=1_000_000),
        default=1500,
        description="damped only: iterations at most; null for no bound.",
    )
    tolerance: float = spec_key(
        kinds.number(above=0.0),
        default=1.0,
        description="damped only: the solver stops when the error is below this, in damping_unit.",
    )

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        method = data.get("method", "map")
        if method in ("map", "gauss-newton"):
            for key in data:
                if key in _DAMPED_KEYS:
                    yield Fault(f"belongs to method: damped; {method} needs no settings", (key,))


def _goals_apart(goals: tuple[PcGoal, ...], _others: Mapping[str, Any]) -> tuple[PcGoal, ...]:
    return taken_apart(goals, "goals")


class EditPcSpec(Document):
    """Everything edit-pc is told."""

    at_most_one = (("components", "explained_variance"),)
    # An event may be the model's own.
    knows_other_events: ClassVar[bool] = True

    schema_id: str = spec_key(
        kinds.schema_id("edit-pc"), default="motionedit/edit-pc/v1", name="schema", description="Which spec this is."
    )
    components: int | None = spec_key(
        kinds.components(), default=None, description="How many of the model's components are used; default: all."
    )
    explained_variance: float | None = spec_key(
        kinds.number(above=0.0, at_most=1.0),
        default=None,
        description="Use as many components as explain this share of the variance, 0 to 1.",
    )
    goals: tuple[PcGoal, ...] = spec_key(
        list_of(mapping(PcGoal)),
        after=_goals_apart,
        description="What shall be where, at which frame; [] changes nothing.",
    )
    solver: PcSolver = spec_key(mapping(PcSolver), default=PcSolver(), description="How the coefficients are found.")
    residual_share: float | str = spec_key(
        kinds.either(("auto",), kinds.number(at_least=0.0, at_most=1.0)),
        default="auto",
        description="method: map; the share of a change that may leave the components, 0 to 1; auto: from the share of "
        "an unseen clip that the model does not explain, and from what goals at several frames ask for.",
    )
    feet: Literal["keep", "move", "off"] | None = spec_key(
        kinds.or_off(kinds.word("keep", "move", "off")),
        default=None,
        description="Planted feet: keep stands them where the input's stand, move where the edit takes each plant as a "
        "whole, off leaves them to the solver; default keep (off with the other methods, residual: drop and timing: "
        "normalized).",
    )
    hands: Literal["keep", "off"] | None = spec_key(
        kinds.or_off(kinds.word("keep", "off")),
        default=None,
        description="Hands that hold one thing in the input: keep brings them together again as they were there, by "
        "both arms, off leaves them to the solver; default keep (off where feet are by default).",
    )
    hinges: Literal["auto", "off"] | None = spec_key(
        kinds.or_off(kinds.word("auto", "off")),
        default=None,
        description="Knees and elbows: auto bends them no further than a body does, or the input, neither back nor "
        "shut, and the rest of the body meets the goals; off leaves them to the solver; default auto (off where feet "
        "are by default).",
    )
    plausibility: float | str | None = spec_key(
        kinds.or_off(kinds.either(("off",), kinds.number(above=0.0))),
        default=None,
        description="Bound, or off; default 3. map: on the change from the input, in standard deviations of the "
        "database, times what makes of one of its clips another; gauss-newton: on the coefficients' Mahalanobis norm, "
        "times the database's largest; damped: off, its iterations bound it.",
    )
    coefficients: Literal["constant", "per_goal"] = spec_key(
        kinds.word("constant", "per_goal"),
        default="constant",
        description="constant: one change of coefficients for the whole clip; per_goal: each frame with goals is "
        "solved by itself, the coefficients between are interpolated over time.",
    )
    residual: Literal["keep", "drop"] = spec_key(
        kinds.word("keep", "drop"),
        default="keep",
        description="keep what the model cannot express of the clip, or drop it (the paper's eq. 3 alone).",
    )
    timing: Literal["original", "normalized"] = spec_key(
        kinds.word("original", "normalized"),
        default="original",
        description="Timing of the edited clip: the input's own, or the model's timeline.",
    )

    @property
    def plausibility_bound(self) -> float | None:
        """The bound in force, None for none."""
        if self.plausibility is None:
            return None if self.solver.method == "damped" else DEFAULT_PLAUSIBILITY
        return None if isinstance(self.plausibility, str) else self.plausibility

    @property
    def feet_in_force(self) -> Literal["keep", "move", "off"]:
        """What becomes of planted feet: keep, move or off."""
        return self.feet or ("keep" if self._is_plain else "off")

    @property
    def hands_in_force(self) -> Literal["keep", "off"]:
        """What becomes of hands that hold one thing: keep or off."""
        return self.hands or ("keep" if self._is_plain else "off")

    @property
    def hinges_in_force(self) -> Literal["auto", "off"]:
        """What becomes of knees and elbows that are bent too far: auto or off."""
        return self.hinges or ("auto" if self._is_plain else "off")

    @property
    def _is_plain(self) -> bool:
        """Whether the output is the input but for a likely change, so that what stood or held shall do so."""
        return self.solver.method == "map" and self.residual == "keep" and self.timing == "original"

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        yield from repeated_names(data, "goals")
        solver = data.get("solver")
        method = solver.get("method", "map") if isinstance(solver, dict) else "map"
        if method != "map":
            yield from _differing_priorities(data)
            if "residual_share" in data:
                yield Fault(f"belongs to method: map; {method} has the components alone", ("residual_share",))
        for key, value in (("residual", "drop"), ("timing", "normalized")):
            for what, own in (("feet", "plants"), ("hinges", "bends"), ("hands", "grips")):
                if data.get(key) == value and data.get(what) in ("keep", "move", "auto"):
                    yield Fault(f"the clip's own {own} say nothing of an output with {key}: {value}", (what,))
        if isinstance(solver, dict) and solver.get("method") == "damped":
            if "unit" not in data:
                yield Fault("needs unit: in the spec, such as unit: cm; damped works in lengths", ("solver", "method"))
            if "plausibility" in data and data["plausibility"] not in ("off", False):
                yield Fault(
                    "belongs to the other methods; the paper's mode is bounded by its max_iterations",
                    ("plausibility",),
                )


def _differing_priorities(data: Mapping[str, Any]) -> Iterator[Fault]:
    first: object = None
    for i, goal in mappings_in(data, "goals"):
        priority = goal.get("priority", 1)
        if first is None:
            first = priority
        elif priority != first and isinstance(priority, int):
            yield Fault(
                f"goals of differing priority (here {priority}, above {first}) need method: map; use weight",
                ("goals", i, "priority"),
            )
