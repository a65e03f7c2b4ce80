"""What a peer's script does with a job: read it, solve it frame by frame against the clock, and print how it went.

It runs in the peer's own interpreter, so it needs NumPy alone. A job is a folder with `robot.xml`, `arrays.npz` and
`settings.json`; the answer is one JSON object on standard output.
"""

from __future__ import annotations

import gc
import json
import sys
import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    Array = np.ndarray[Any, np.dtype[Any]]

Kind = Literal["com", "point", "frame", "none"]

# Stands for a joint where a task is the center of mass.
COM = -1
# Metres: a peer whose forward kinematics is further from ours does not solve the same job.
SAME_PLACE = 1e-6
# The whole clip is solved so often, and for so many seconds, at least; the best counts.
LEAST_TURNS = 2


class SolveError(Exception):
    """The peer's solver gave no step."""


@dataclass(frozen=True)
class Job:
    """F frames with T tasks, in metres.

    Attributes
    ----------
    robot : path of the MJCF
    names : J joints, as the bodies of the MJCF are called
    rotations : shape (F, J, 4), local quaternions w, x, y, z; translations : shape (F, 3), of the root
        Where a solve starts.
    joints : shape (T,)
        The point of each task, or COM.
    levels : shape (T,)
        0 is the most important.
    targets, start : shape (F, T, 3)
        Where the points shall be, and where they are at the start.
    active : shape (F, T)
    turns : shape (F, T, 4)
        Orientations of the points' joints at the start, quaternions w, x, y, z.
    carried : shape (T,)
        Whether the point is fixed to the joint of another task, so that a goal for that one's frame stands for both.
    hard : "no", "points" or "frames"
        How level 0 is said to be exact: not at all, point by point, or by the whole frame of each foot.
    ratio : float
        Cost of a level, as a share of that of the level above.
    damping : float
        Of what the peer has for it: of each task in proportion to its error, or of all velocities.
    qp : str
        The solver of quadratic programs, where the peer has a choice.
    tolerance : float
        A frame is done when all its tasks are as near; 0 takes every iteration.
    cap : int
        Iterations.
    seconds : float
        The clip is solved anew for so long.
    """

    robot: str
    names: tuple[str, ...]
    rotations: Array
    translations: Array
    joints: tuple[int, ...]
    levels: tuple[int, ...]
    targets: Array
    start: Array
    active: Array
    turns: Array
    carried: tuple[bool, ...]
    hard: Literal["no", "points", "frames"]
    ratio: float
    damping: float
    qp: str
    tolerance: float
    cap: int
    seconds: float

    def configurations(self, order: Sequence[int]) -> Array:
        """Return [root position, quaternions] by frame, shape (F, 3 + 4 J), the quaternions' parts in that order."""
        turns = self.rotations[:, :, list(order)].reshape(len(self.rotations), -1)
        return np.concatenate((self.translations, turns), axis=1)

    @property
    def costs(self) -> list[float]:
        """The cost of each task: 1 at level 0."""
        return [self.ratio**level for level in self.levels]

    @property
    def kinds(self) -> list[Kind]:
        """What each task is to the peer."""
        return [self._kind(i) for i in range(len(self.joints))]

    def _kind(self, i: int) -> Kind:
        if self.joints[i] == COM:
            return "com"
        if self.hard != "frames" or self.levels[i] > 0:
            return "point"
        return "none" if self.carried[i] else "frame"

    def exact(self, i: int) -> bool:
        """Whether a task is a constraint of the peer's program, not a part of its cost."""
        return self.hard != "no" and self.levels[i] == 0


def read_job(folder: Path) -> Job:
    """Return the job of a folder."""
    settings = json.loads((folder / "settings.json").read_text())
    with np.load(folder / "arrays.npz") as arrays:
        return Job(
            robot=str(folder / "robot.xml"),
            names=tuple(settings["names"]),
            rotations=arrays["rotations"],
            translations=arrays["translations"],
            joints=tuple(settings["joints"]),
            levels=tuple(settings["levels"]),
            targets=arrays["targets"],
            start=arrays["start"],
            active=arrays["active"],
            turns=arrays["turns"],
            carried=tuple(settings["carried"]),
            **{key: settings[key] for key in ("hard", "ratio", "damping", "qp", "tolerance", "cap", "seconds")},
        )


class Peer(Protocol):
    """A solver with the job's model in it."""

    def begin(self, frame: int) -> None:
        """Take the frame's start and targets."""

    def step(self) -> None:
        """Make one iteration; raise SolveError where there is none."""

    def places(self) -> Array:
        """Return where the tasks' points are now, shape (T, 3)."""


@dataclass(frozen=True)
class Outcome:
    """One solve of the clip: errors (F, T) in metres, NaN where not active; iterations (F,); which frames failed."""

    errors: Array
    iterations: Array
    failed: Array


def solve_clip(peer: Peer, job: Job) -> Outcome:
    """Return how each frame went, solved by itself from its start until its tasks are met."""
    frames = len(job.targets)
    errors, iterations = np.full(job.active.shape, np.nan), np.zeros(frames, dtype=int)
    failed = np.zeros(frames, dtype=bool)
    for frame in range(frames):
        active, targets = job.active[frame], job.targets[frame]
        peer.begin(frame)
        while iterations[frame] < job.cap:
            iterations[frame] += 1
            try:
                peer.step()
            except SolveError:
                failed[frame] = True
                break
            off = peer.places() - targets
            if np.einsum("ij,ij->i", off, off)[active].max() < job.tolerance**2:
                break
        errors[frame, active] = np.linalg.norm(peer.places() - targets, axis=1)[active]
    return Outcome(errors, iterations, failed)


def run(make: Callable[[Job], Peer], packages: Sequence[str]) -> None:
    """Solve the job that the command line names and print the answer."""
    job = read_job(Path(sys.argv[1]))
    peer = make(job)
    _check_model(peer, job)
    best, turns, until = float("inf"), 0, time.perf_counter() + job.seconds
    gc.disable()
    while turns < LEAST_TURNS or time.perf_counter() < until:
        start = time.perf_counter()
        outcome = solve_clip(peer, job)
        best, turns = min(best, time.perf_counter() - start), turns + 1
    print(json.dumps(answer(outcome, seconds=best, versions={name: version(name) for name in packages})))


def answer(outcome: Outcome, *, seconds: float, versions: dict[str, str]) -> dict[str, Any]:
    """Return what goes to the other side: metres, by task."""
    return {
        "versions": versions,
        "seconds": seconds,
        "frames": len(outcome.errors),
        "errors": [[None if np.isnan(e) else float(e) for e in row] for row in outcome.errors],
        "iterations": outcome.iterations.tolist(),
        "failed": outcome.failed.tolist(),
    }


def _check_model(peer: Peer, job: Job) -> None:
    """See that the peer's forward kinematics of the start is ours, the center of mass too."""
    for frame in (0, len(job.start) // 2):
        peer.begin(frame)
        off = np.abs(peer.places() - job.start[frame]).max()
        if off > SAME_PLACE:
            raise SystemExit(f"the peer's own forward kinematics is {off:.3g} m off ours at frame {frame}")
