"""The jobs that all solvers are given: the reaching clip, a foot asked for too much, a hand that cannot reach."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.peers.robot import mjcf
from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.bones import travel_joint
from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.body.hinges import find_hinges
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import Effector, WorldPoses, forward
from motionedit.core.motion import Motion, scaled
from motionedit.core.priorities.edit import PrioritizedEdit, edit_by_priorities, prepare
from motionedit.core.priorities.frames import solve_frames
from motionedit.core.priorities.kinds import CenterOfMass, Position
from motionedit.core.priorities.settings import Body, LayeredSettings, Passes
from motionedit.core.priorities.trajectories.positions import ControlPoint, position_targets
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.priorities.kinds.constraint import Constraint

# Stands for a joint where a task is the center of mass, as in protocol.py.
COM = -1
WALK = Path(__file__).resolve().parents[2] / "data" / "walk.bvh"
# The reach: where the wrist is to be in the room (the file's unit), the frames in which it stands still there, and
# frames to either side.
PLACE, HELD, EASE = (58.0, 150.0, 322.0), (66, 72), 17.5
# Metres: a task is met when it is as near.
TOLERANCE = 1e-3
CAP = 40
# Metres: how far heel and toe of one foot contradict each other.
CONTRADICTION = 1e-4
# Metres: where the hand that cannot reach shall go, from where it is.
FAR = np.array([0.0, 3.0, 0.0])
FAR_ITERATIONS = 250
# Every so many frames of the clip are asked for it.
FAR_STRIDE = 12


@dataclass(frozen=True, eq=False)
class Job:
    """A motion in metres, constraints on it, and the same as targets (F, T, 3) with where they are active (F, T)."""

    motion: Motion
    body: Body
    constraints: tuple[Constraint, ...]
    targets: FloatArray
    active: BoolArray
    tolerance: float = TOLERANCE
    cap: int = CAP

    @property
    def joints(self) -> list[int]:
        """The point of each task, or COM."""
        return [COM if each.at is None else each.at.joint for each in self.constraints]

    @property
    def carried(self) -> list[bool]:
        """Whether a task's point is fixed to the joint of another: a toe's base to the foot."""
        parents = self.motion.skeleton.parents
        return [j != COM and int(parents[j]) in self.joints for j in self.joints]

    @property
    def levels(self) -> list[int]:
        """The level of each task, 0 the most important."""
        order = sorted({c.priority for c in self.constraints}, reverse=True)
        return [order.index(c.priority) for c in self.constraints]

    def solve(self, body: Body | None = None) -> PrioritizedEdit:
        """Return the edit by this project, the first solve alone."""
        settings = LayeredSettings(smoothing=Passes(0, 1.0), max_iterations=self.cap)
        return edit_by_priorities(self.motion, self.constraints, body or self.body, settings)

    def solver(self, body: Body | None = None) -> Callable[[], object]:
        """Return a function that solves every frame by this project; as the peers', its targets are made before."""
        settings = LayeredSettings(smoothing=Passes(0, 1.0), max_iterations=self.cap)
        run, _ = prepare(self.motion, self.constraints, body or self.body, settings)
        return lambda: solve_frames(run, self.motion, reference=self.motion, pull_root=False)

    def errors(self, edit: PrioritizedEdit) -> FloatArray:
        """Return how far the edit is from its targets, shape (F, T), in metres, NaN where not active."""
        off = np.linalg.norm(places(forward(edit.motion), self.body.masses, self.joints) - self.targets, axis=2)
        return np.where(self.active, off, np.nan)


def places(poses: WorldPoses, masses: Masses, joints: Sequence[int]) -> FloatArray:
    """Return where the points of tasks are, shape (F, T, 3)."""
    return np.stack([center_of_mass(poses, masses) if j == COM else poses.positions[:, j] for j in joints], axis=1)


def reach() -> Job:
    """Return the reaching clip: four foot points over the left wrist over the center of mass."""
    clip = read_clip(WALK)
    anatomy = anatomy_of(clip.motion)
    motion = scaled(clip.motion, STANDARD_LEG / anatomy.leg_length)
    masses = find_masses(motion.skeleton, anatomy_of(motion))
    bends = find_bends(motion.skeleton, forward(motion), anatomy, first=0)
    body = Body(masses, tuple(find_hinges(bends)), travel_joint(motion), 0, bends)
    here = np.zeros(3)
    feet = [Position(name=name, priority=10, effector=Effector(j, here)) for name, j in anatomy.foot_points]
    wrist = Effector(motion.skeleton.names.index("LeftHand"), here)
    point = ControlPoint("hold", *HELD, position=STANDARD_LEG / anatomy.leg_length * np.array(PLACE))
    hand = Position(name="hand", priority=4, effector=wrist, points=(point,), ease_in=EASE, ease_out=EASE)
    return _job(motion, body, [*feet, hand, CenterOfMass(name="balance", priority=2)])


def reach_alone(whole: Job) -> Job:
    """Return the frames of the reaching clip at which the hand leaves its path."""
    hand = next(i for i, c in enumerate(whole.constraints) if c.points)
    return _given(whole, np.flatnonzero(whole.active[:, hand]), whole.targets)


def contradicting(whole: Job) -> Job:
    """Return the clip without the hand, the left toe's goal further from the ankle's by the contradiction."""
    feet = np.array([not c.points for c in whole.constraints])
    whole = replace(
        whole,
        constraints=tuple(c for c, kept in zip(whole.constraints, feet, strict=True) if kept),
        targets=whole.targets[:, feet],
        active=whole.active[:, feet],
    )
    heel, toe = whole.targets[:, 0], whole.targets[:, 1]
    along = (toe - heel) / np.linalg.norm(toe - heel, axis=1, keepdims=True)
    targets = whole.targets.copy()
    targets[:, 1] += CONTRADICTION * along
    return replace(_given(whole, np.arange(len(targets)), targets), tolerance=0.0, cap=10)


def unreachable(whole: Job) -> Job:
    """Return some frames of the clip with the hand's goal far out of reach."""
    hand = next(i for i, c in enumerate(whole.constraints) if c.points)
    poses = forward(whole.motion)
    targets, frames = whole.targets.copy(), np.arange(0, len(whole.motion), FAR_STRIDE)
    targets[:, hand] = poses.positions[:, whole.joints[hand]] + FAR
    everywhere = replace(whole, active=np.ones_like(whole.active))
    return replace(_given(everywhere, frames, targets), tolerance=0.0, cap=FAR_ITERATIONS)


def _job(motion: Motion, body: Body, constraints: Sequence[Constraint]) -> Job:
    """Return the job of constraints whose points, if any, are places of joints."""
    poses = forward(motion)
    targets = places(poses, body.masses, [COM if each.at is None else each.at.joint for each in constraints])
    active = np.ones(targets.shape[:2], dtype=np.bool_)
    for i, c in enumerate(constraints):
        if c.points:
            path = targets[:, i].copy()
            first, moved = position_targets(path, c.points, ease_in=c.ease_in, ease_out=c.ease_out, curve="time")
            active[:, i] = False
            span = slice(first, first + len(moved))
            targets[span, i], active[span, i] = moved, True
    return Job(motion, body, tuple(constraints), targets, active)


def _given(job: Job, frames: IntArray, targets: FloatArray) -> Job:
    """Return the job at some frames, every target given frame by frame as an instant of its own."""
    motion = job.motion
    part = motion.at(frames)
    here, active = targets[frames], job.active[frames]
    constraints = []
    for i, c in enumerate(job.constraints):
        at = np.flatnonzero(active[:, i]).tolist()
        points = tuple(ControlPoint("at", n, n, position=here[n, i]) for n in at)
        constraints.append(replace(c, points=points, ease_in=0.0, ease_out=0.0))
    return replace(job, motion=part, constraints=tuple(constraints), targets=here, active=active)


@dataclass(frozen=True)
class Way:
    """How a peer is asked: see protocol.Job for what the words mean."""

    hard: str
    ratio: float
    damping: float
    qp: str = "daqp"

    @property
    def text(self) -> str:
        """How a table names it."""
        if self.hard == "no":
            return f"by weights {self.ratio**-2:g} : 1" if self.ratio < 1.0 else "by equal weights"
        return {"points": "hard, heel and toe", "frames": "hard, one frame a foot"}[self.hard]


def write(job: Job, folder: Path, way: Way, *, seconds: float) -> None:
    """Write the job as a peer's script reads it: `robot.xml`, `arrays.npz`, `settings.json`."""
    folder.mkdir(parents=True, exist_ok=True)
    skeleton, poses = job.motion.skeleton, forward(job.motion)
    (folder / "robot.xml").write_text(mjcf(skeleton, job.body.masses))
    np.savez(
        folder / "arrays.npz",
        rotations=rot.normalize(job.motion.rotations),
        translations=job.motion.translations[:, 0],
        targets=job.targets,
        start=places(poses, job.body.masses, job.joints),
        turns=poses.rotations[:, job.joints],
        active=job.active,
    )
    settings = {
        "names": skeleton.names,
        "joints": job.joints,
        "levels": job.levels,
        "carried": job.carried,
        **asdict(way),
        "tolerance": job.tolerance,
        "cap": job.cap,
        "seconds": seconds,
    }
    (folder / "settings.json").write_text(json.dumps(settings))
