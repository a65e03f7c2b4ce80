"""The tables on whole-body inverse kinematics: speed on the reaching clip, and what cannot be met."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any
from unittest.mock import patch

import numpy as np

from benchmarks.clock import best_of
from benchmarks.peers import jobs
from benchmarks.peers.jobs import Job, Way
from benchmarks.peers.others import PeerError, ask, versions
from motionedit.core.compiled import CHOICE, solver_name

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    from benchmarks.peers.tables import Table
    from motionedit.core.arrays import FloatArray

ROUNDS = 3
# Seconds that a peer solves the clip again and again in one turn.
TURN = 0.5
# What ours shall be, at least, as a multiple of the peer's rate.
AIMS = {"placo": 15.0, "mink": 20.0, "pink": 40.0}
# The feet point by point and as frames, hard; by weights that are equal, and by such as keep the order. Damping is what
# was found best on this job: of mink and pink in proportion to the error, of placo of all velocities.
LIGHT = {"placo": 1e-6, "mink": 0.1, "pink": 0.1}
WAYS = (("points", 1.0), ("frames", 1.0), ("no", 1.0), ("no", 0.1))
# Those that were found to meet every goal with every peer.
QUICK_WAYS = WAYS[1:3]
# For a goal that is out of reach the peers' documentation advises more of it.
HEAVY = {"placo": {"frames": 10.0, "no": 1.0}, "mink": {"frames": 1.0, "no": 1.0}, "pink": {"frames": 1.0, "no": 1.0}}
HARD_SOLVERS = (("placo", "eiquadprog"), ("mink", "daqp"), ("pink", "daqp"), ("pink", "quadprog"), ("pink", "proxqp"))

SPEED = (
    "system",
    "the feet",
    "frames/s",
    "ours is",
    "aim",
    "",
    "frames not within 1 mm",
    "worst (mm)",
    "iterations",
    "most",
)
CONFLICT = ("system", "frames without a step", "worst foot (mm)", "worst center of mass (mm)")
FAR = ("system", "the feet", "worst foot (mm)", "hand, mean (mm)", "center of mass, mean (mm)")


@dataclass(frozen=True)
class Measured:
    """How a system did on a job: least seconds, errors (F, T) in metres, iterations (F,), frames without a step."""

    seconds: float
    errors: FloatArray
    iterations: FloatArray
    failed: int

    @property
    def rate(self) -> float:
        """Frames per second."""
        return len(self.errors) / self.seconds

    @property
    def missed(self) -> int:
        """Frames that are not within the tolerance."""
        return int(np.count_nonzero(np.nanmax(self.errors, axis=1) > jobs.TOLERANCE))


def speed(job: Job, folder: Path, ways: Sequence[tuple[str, float]]) -> tuple[Table, dict[str, str]]:
    """Return the table of rates on a job that can be met, and the versions of the peers."""
    contenders = {
        (name, way): _written(job, folder / f"{name}-{i}", way, seconds=TURN)
        for name, light in LIGHT.items()
        for i, way in enumerate(Way(hard, ratio, light) for hard, ratio in ways)
    }
    own, theirs, found = _contenders(job), {}, {}
    ours: dict[str, float] = {}
    for _ in range(ROUNDS):
        for key, run in best_of(own, rounds=1).items():
            ours[key] = min(run, ours.get(key, np.inf))
        for key, place in contenders.items():
            if isinstance(theirs.get(key), str):
                continue
            try:
                answer = ask(key[0], place)
            except PeerError as error:
                theirs[key] = str(error)
                continue
            found[key[0]] = versions(answer)
            before = theirs.get(key)
            theirs[key] = _measured(answer, np.inf if before is None else before.seconds)
    return _speed_table(job, ours, theirs), found


def _contenders(job: Job) -> dict[str, Callable[[], object]]:
    """Return our own solves by name: as by default, with free knees and elbows, and without the compiled solver."""
    free = replace(job.body, hinges=())
    found: dict[str, Callable[[], object]] = {
        f"motionedit, {solver_name()}, knees and elbows as hinges": job.solver(),
        f"motionedit, {solver_name()}, ball joints alone": job.solver(free),
    }
    if solver_name() == "compiled":
        with _without_compiled():
            plain = job.solver()

        def by_numpy() -> object:
            with _without_compiled():
                return plain()

        found["motionedit, numpy, knees and elbows as hinges"] = by_numpy
    return found


def _without_compiled() -> AbstractContextManager[object]:
    return patch.dict(os.environ, {CHOICE: "numpy"})


def _speed_table(job: Job, ours: Mapping[str, float], theirs: Mapping[tuple[str, Way], Measured | str]) -> Table:
    rate = len(job.motion) / next(iter(ours.values()))
    rows: Table = [SPEED]
    for name, seconds in ours.items():
        own = _own(job, seconds, hinged="hinges" in name)
        rows.append((name, "strictly above the hand", *_cells(own, f"{rate / own.rate:.2f} x", "", "")))
    for (name, way), measured in theirs.items():
        if isinstance(measured, str):
            rows.append((name, way.text, measured, *[""] * (len(SPEED) - 3)))
            continue
        best = min((m.seconds for (n, _), m in theirs.items() if n == name and _counts(m)), default=None)
        aim = verdict = ""
        if measured.seconds == best:
            aim, verdict = f">= {AIMS[name]:g} x", "met" if rate >= AIMS[name] * measured.rate else "MISSED"
        ratio = f"{rate / measured.rate:.2f} x" if measured.missed == 0 else "-"
        rows.append((name, way.text, *_cells(measured, ratio, aim, verdict)))
    return rows


def _counts(measured: Measured | str) -> bool:
    return isinstance(measured, Measured) and measured.missed == 0 and measured.failed == 0


def _cells(measured: Measured, ratio: str, aim: str, verdict: str) -> tuple[str, ...]:
    missed = str(measured.missed) + (f", {measured.failed} without a step" if measured.failed else "")
    steps = measured.iterations
    # A solver that gives up is done soon.
    rate = "-" if measured.failed else f"{measured.rate:,.0f}"
    worst = f"{1e3 * np.nanmax(measured.errors):.2g}"
    return rate, ratio, aim, verdict, missed, worst, f"{steps.mean():.1f}", f"{steps.max():.0f}"


def conflict(job: Job, folder: Path) -> Table:
    """Return the table of a heel and a toe that contradict each other, both exact where the system has that."""
    own = _own(job, 1.0, hinged=True)
    rows = [CONFLICT, ("motionedit", "0", *_worst(job, own))]
    for name, qp in HARD_SOLVERS:
        place = _written(job, folder / f"conflict-{name}-{qp}", Way("points", 1.0, LIGHT[name], qp), seconds=0.0)
        system = f"{name} ({qp})"
        try:
            measured = _measured(ask(name, place), np.inf)
        except PeerError as error:
            rows.append((system, str(error), "", ""))
            continue
        rows.append((system, f"{measured.failed} of {len(measured.errors)}", *_worst(job, measured)))
    return rows


def _worst(job: Job, measured: Measured) -> tuple[str, ...]:
    worst = 1e3 * np.nanmax(measured.errors, axis=0)
    levels = np.array(job.levels)
    found = worst[levels == 0].max(), worst[levels == levels.max()].max()
    # A program near to singular may send the body far away before it has no step.
    return tuple(f"{off:.3f}" if off < 1e4 else f"{off:.0e}" for off in found)


def far(job: Job, folder: Path) -> Table:
    """Return the table of a hand that cannot reach."""
    rows = [FAR, ("motionedit", "strictly above the hand", *_far_cells(job, _own(job, 1.0, hinged=True)))]
    rows.append(("motionedit, ball joints alone", "the same", *_far_cells(job, _own(job, 1.0, hinged=False))))
    for name, heavy in HEAVY.items():
        for hard, damping in (("frames", heavy["frames"]), ("no", heavy["no"]), ("no", LIGHT[name])):
            way = Way(hard, 0.1, damping)
            place = _written(job, folder / f"far-{name}-{hard}-{damping}", way, seconds=0.0)
            text = f"{way.text}, damping {damping:g}"
            try:
                rows.append((name, text, *_far_cells(job, _measured(ask(name, place), np.inf))))
            except PeerError as error:
                rows.append((name, text, str(error), "", ""))
    return rows


def _far_cells(job: Job, measured: Measured) -> tuple[str, ...]:
    levels, millimetres = np.array(job.levels), 1e3 * measured.errors
    means = millimetres.mean(axis=0)
    return f"{millimetres[:, levels == 0].max():.2f}", *(f"{means[levels == n].max():.1f}" for n in (1, 2))


def _written(job: Job, place: Path, way: Way, *, seconds: float) -> Path:
    jobs.write(job, place, way, seconds=seconds)
    return place


def _own(job: Job, seconds: float, *, hinged: bool) -> Measured:
    edit = job.solve(job.body if hinged else replace(job.body, hinges=()))
    return Measured(seconds, job.errors(edit), edit.iterations.astype(float), 0)


def _measured(answer: dict[str, Any], seconds: float) -> Measured:
    errors = np.array([[np.nan if e is None else e for e in row] for row in answer["errors"]])
    return Measured(
        min(seconds, answer["seconds"]), errors, np.array(answer["iterations"], dtype=float), sum(answer["failed"])
    )
