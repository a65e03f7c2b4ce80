"""The edit by prioritized constraints: frames a second by stage, clip, body and number of layers; both solvers."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.clock import Row, best_of
from motionedit.core.bvh import read_clip
from motionedit.core.compiled import CHOICE, solver_name
from motionedit.core.motion import Motion
from motionedit.core.priorities.continuity.passes import solve_in_passes
from motionedit.core.priorities.edit import PrioritizedEdit, edit_by_priorities, prepare
from motionedit.core.priorities.frames import solve_from_input
from motionedit.core.priorities.settings import Body, LayeredSettings, Passes
from motionedit.core.priorities.solver import numpy_solver
from motionedit.jobs.batch.plan import ClipTask
from motionedit.jobs.edit_prioritized.job import EditByPriorities
from motionedit.spec.load import load_spec
from studies.demonstrations import config, foot_plants, reach

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from motionedit.core.priorities.kinds.constraint import Constraint

ROOT = Path(__file__).resolve().parents[1]
WALK = ROOT / "data" / "walk.bvh"
# Metres and radians: what every layer that can be met has left at most.
MET = 1e-4


@dataclass(frozen=True, eq=False)
class Case:
    """An edit ready to be solved."""

    motion: Motion
    constraints: list[Constraint]
    body: Body
    settings: LayeredSettings

    def edit(self, passes: int) -> PrioritizedEdit:
        """Return the edit from its constraints on, after so many passes."""
        settings = replace(self.settings, smoothing=self._passes(passes))
        return edit_by_priorities(self.motion, self.constraints, self.body, settings)

    def _passes(self, count: int) -> Passes:
        return Passes(count, self.settings.smoothing.sigma if isinstance(self.settings.smoothing, Passes) else 0.0)

    def first_solve(self) -> Callable[[], object]:
        """Return a function that solves every frame once, from the input: targets and layout are made before."""
        run, _ = prepare(self.motion, self.constraints, self.body, self.settings)
        return lambda: solve_from_input(run)

    def solve(self, passes: int) -> Callable[[], object]:
        """Return a function that also lets give way what is missed, and solves again after each pass."""
        run, _ = prepare(self.motion, self.constraints, self.body, self.settings)
        return lambda: solve_in_passes(run, self._passes(passes))

    def tiled(self, times: int) -> Case:
        """Return the edit of the clip repeated; constraints with points act in the first copy, others all through."""
        motion = self.motion
        long = Motion(
            motion.skeleton,
            np.tile(motion.rotations, (times, 1, 1)),
            np.tile(motion.translations, (times, 1, 1)),
            motion.frame_time,
        )
        return replace(self, motion=long)


def case(clip: Path, spec: dict[str, Any], scratch: Path) -> Case:
    """Return the edit of a clip by a spec."""
    path = scratch / "case.yaml"
    path.write_text(json.dumps({"schema": "motionedit/edit-prioritized/v1", **spec}))
    work = EditByPriorities(load_spec(path, "edit-prioritized"), (clip.name,))
    read = read_clip(clip)
    sized, constraints, _ = work.ready(read, ClipTask(clip, clip.name, None, clip.name))
    return Case(sized.motion, [each.constraint for each in constraints], sized.body, work.settings(read))


def reaching(scratch: Path) -> Case:
    """Return the reaching clip: configs/reach.yaml on data/walk.bvh."""
    return case(WALK, config("reach"), scratch)


def rows(scratch: Path) -> list[Row]:
    """Return the table's rows on the layered solver."""
    walk = reaching(scratch)
    found = _reaching_rows(walk)
    if solver_name() == "compiled":
        found += _growth_rows(walk, scratch)
        clips = os.environ.get("MOTIONEDIT_CLIPS")
        if clips:
            found += _real_rows(Path(clips), scratch)
    return found


def only_numpy() -> AbstractContextManager[None]:
    """Keep the compiled solver out."""
    from unittest.mock import patch

    return patch.dict(os.environ, {CHOICE: "numpy"})


def _reaching_rows(walk: Case) -> list[Row]:
    frames = len(walk.motion)
    with only_numpy():
        plain = walk.first_solve()

    def by_numpy() -> object:
        with only_numpy():
            return plain()

    def one_by_one() -> object:
        whole, numpy_solver.BLOCK = numpy_solver.BLOCK, 1
        try:
            return by_numpy()
        finally:
            numpy_solver.BLOCK = whole

    contenders: dict[str, Callable[[], object]] = {"numpy": by_numpy, "one by one": one_by_one}
    if solver_name() == "compiled":
        contenders |= {"solve": walk.first_solve(), "passes": walk.solve(3), "whole": lambda: walk.edit(3)}
    rate = {name: frames / seconds for name, seconds in best_of(contenders, rounds=4).items()}
    numpy_row = Row(
        "reaching, numpy alone: first solve, all frames together",
        f"{rate['numpy']:,.0f} frames/s",
        f"{rate['one by one']:,.0f} frames/s, one by one",
        f"{rate['numpy'] / rate['one by one']:.1f} x",
        ">= 1,000, >= 10 x",
        _verdict(rate["numpy"] >= 1000.0 and rate["numpy"] >= 10.0 * rate["one by one"]),
    )
    if "solve" not in rate:
        return [numpy_row]
    ratio = rate["solve"] / rate["numpy"]
    errors = _left(walk.edit(3))
    return [
        Row(
            "reaching: first solve",
            f"{rate['solve']:,.0f} frames/s",
            f"{rate['numpy']:,.0f} frames/s, numpy",
            f"{ratio:.0f} x",
            ">= 50,000, >= 20 x",
            _verdict(rate["solve"] >= 50_000.0 and ratio >= 20.0),
        ),
        _at_least("reaching: first solve and three passes", rate["passes"], 20_000.0),
        Row("reaching: the same, from the constraints to their errors", f"{rate['whole']:,.0f} frames/s"),
        Row(
            "reaching: most that any layer has left",
            f"{errors:.1e} m",
            aim="<= 1.0e-04 m",
            verdict=_verdict(errors <= MET),
        ),
        numpy_row,
    ]


def _growth_rows(walk: Case, scratch: Path) -> list[Row]:
    cases: dict[str, Case] = {"145 frames": walk, "2,755 frames": walk.tiled(19), "150,075 frames": walk.tiled(1035)}
    constraints = {c["name"]: c for c in config("reach")["constraints"]}
    feet, hand, com = constraints["feet"], constraints["hand"], constraints["balance"]
    below = [
        {"type": "orientation", "effector": "Head", "priority": -1},
        {"type": "position", "effector": "RightHand", "priority": -2, "tolerance": "off"},
        {"type": "posture", "joints": ["Neck"], "priority": -3},
    ]
    whole = {"type": "com", "priority": 2, "relative_to": "world"}
    for count, chosen in enumerate(
        ([feet], [feet, hand], [feet, hand, com], *([feet, hand, whole, *below[:n]] for n in (1, 2, 3))), 1
    ):
        cases[f"{count} layers"] = case(WALK, {"constraints": chosen}, scratch)
    found = []
    for name, each in cases.items():
        solve = each.first_solve()
        seconds = best_of({"solve": solve}, rounds=2)["solve"]
        edit = each.edit(0)
        microseconds = 1e6 * seconds / max(int(edit.iterations.sum()), 1)
        found.append(
            Row(
                f"walk, {name}: first solve",
                f"{len(each.motion) / seconds:,.0f} frames/s",
                f"{edit.iterations.mean():.2f} iterations a frame, {_unknowns(each)} unknowns, rank {_rank(edit)}",
                f"{microseconds:.1f} us an iteration",
            )
        )
    return found


def _real_rows(clips: Path, scratch: Path) -> list[Row]:
    """Return rows on real clips: every frame at work, a body of 100 joints, goals out of reach."""
    walk, big = clips / "motions" / "cmu_12_01_walk.bvh", clips / "motions" / "cmu07" / "cmu_07_04_walk.bvh"
    cases = {
        name: case(clip, {"constraints": [*foot_plants(clip), *reach(clip)]}, scratch)
        for name, clip in (("walk", walk), ("big", big))
    }
    far = [*foot_plants(walk), *reach(walk)]
    far[-2] = {**far[-2], "points": [{"shift": [0.0, 60.0, 0.0], "hold": [10, 500]}]}
    cases["far"] = case(walk, {"constraints": far}, scratch)
    solves = {name: each.first_solve() for name, each in cases.items()}
    passes = {f"{name}, passes": each.solve(3) for name, each in cases.items()}
    best = best_of({**solves, **passes}, rounds=3)
    rate = {name: len(cases[name.partition(",")[0]].motion) / seconds for name, seconds in best.items()}
    share, lost = rate["big"] / rate["walk"], _above_the_unmet(cases["far"].edit(3))
    return [
        _at_least("CMU 12_01, rigid plants, reach, CoM: first solve", rate["walk"], 30_000.0),
        _at_least("CMU 12_01: three passes", rate["walk, passes"], 14_000.0),
        Row(
            "CMU 07_04, the same on 100 joints: first solve",
            f"{rate['big']:,.0f} frames/s",
            f"{rate['walk']:,.0f} frames/s, 31 joints",
            f"{share:.2f} x",
            ">= 0.7 x",
            _verdict(share >= 0.7),
        ),
        Row("CMU 07_04: three passes", f"{rate['big, passes']:,.0f} frames/s"),
        _at_least("CMU 12_01, the hand out of reach: first solve", rate["far"], 5_000.0),
        _at_least("the same, which gives way, in three passes", rate["far, passes"], 1_600.0),
        Row(
            "the layers above it have left at most",
            f"{1000.0 * lost:.4f} mm",
            aim="0.00 mm",
            verdict=_verdict(lost < 5e-6),
        ),
    ]


def _left(edit: PrioritizedEdit) -> float:
    return max(float(e.max()) for each in edit.errors for e in (each.positions, each.angles) if e is not None)


def _above_the_unmet(edit: PrioritizedEdit) -> float:
    """Return what the first constraints, the rigid feet, have left (m)."""
    return max(float(each.positions.max()) for each in edit.errors[:2] if each.positions is not None)


def _unknowns(each: Case) -> int:
    """Return the most unknowns of a frame: three for a joint that turns, one for a hinge, three for the root."""
    run, _ = prepare(each.motion, each.constraints, each.body, each.settings)
    problems = [group.problem for group in run.groups]
    return max(problem.columns.size - 2 * len(problem.hinges.places) for problem in problems)


def _rank(edit: PrioritizedEdit) -> int:
    """Return the most independent rows of a frame, all layers together."""
    return int(edit.ranks.sum(axis=1).max())


def _at_least(what: str, rate: float, aim: float) -> Row:
    return Row(what, f"{rate:,.0f} frames/s", aim=f">= {aim:,.0f}", verdict=_verdict(rate >= aim))


def _verdict(met: bool) -> str:  # noqa: FBT001  the one thing it is about
    return "met" if met else "MISSED"
