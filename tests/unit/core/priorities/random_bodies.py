"""Random skeletons that ask for what has limits, and both solvers' ways with them."""

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.center_of_mass import Masses
from motionedit.core.body.hinges import plain_hinge
from motionedit.core.compiled import CHOICE, compiled
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.core.measure import Level
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds import CenterOfMass, Distance, Floor, Orientation, Position, Posture
from motionedit.core.priorities.settings import Body
from motionedit.core.priorities.solver import compiled_solver
from motionedit.core.priorities.trajectories.lengths import LengthPoint
from motionedit.core.priorities.trajectories.positions import ControlPoint
from motionedit.core.skeleton import Skeleton

FRAMES = 5
# What the solvers may differ by (rad, m) where everything can be met, and where something cannot.
FEASIBLE, INFEASIBLE = 1e-9, 1e-8


def by_numpy(monkeypatch, function):
    """Return what a function returns with the compiled part kept out."""
    with monkeypatch.context() as patch:
        patch.setenv(CHOICE, "numpy")
        assert compiled() is None
        return function()


def others_are_same(monkeypatch, function, edit):
    """Hold an edit, made by the widest solver that the processor has, to a function's by each of the others."""
    for name in compiled().solvers[:-1]:
        with monkeypatch.context() as patch:
            patch.setattr(compiled_solver, "compiled", lambda name=name: Other(name))
            same_bits(function(), edit)


class Other:
    """The compiled part with another one of its solvers."""

    def __init__(self, solver):
        self.solver = solver

    def solve(self, *arguments):
        compiled().solve(*arguments, self.solver)

    def __getattr__(self, name):
        return getattr(compiled(), name)


def same_bits(one, other):
    """Hold two edits to each other, to the bit."""
    np.testing.assert_array_equal(one.motion.rotations, other.motion.rotations)
    np.testing.assert_array_equal(one.motion.translations, other.motion.translations)
    for each in ("ranks", "iterations", "converged"):
        np.testing.assert_array_equal(getattr(one, each), getattr(other, each))


def assert_no_neighbour_changes_a_bit(monkeypatch, edit_with):
    """Hold an edit, made by ``edit_with(threads)``, to that of every other width and to that of frames one by one."""
    wide = edit_with(1)
    others_are_same(monkeypatch, lambda: edit_with(1), wide)
    with monkeypatch.context() as parted:
        parted.setattr(compiled_solver, "_LEAST_SHARE", 1)
        same_bits(edit_with(FRAMES), wide)


def difference(one, other):
    """Return how far two edits are from each other (rad, m)."""
    angles = rot.angle_between(one.motion.rotations, other.motion.rotations).max()
    return max(angles, np.abs(one.motion.translations - other.motion.translations).max())


def is_met(edit):
    """Return whether all that an edit was asked for is as good as reached."""
    return max(e.max() for each in edit.errors for e in (each.positions, each.angles) if e is not None) < 1e-3


def motion_of(rng, joints, frames=FRAMES):
    """Return a random skeleton that sways a little."""
    parents = np.array([-1, *(int(rng.integers(max(0, j - 4), j)) for j in range(1, joints))])
    offsets = rng.normal(scale=0.25, size=(joints, 3))
    rotation = ("Zrotation", "Xrotation", "Yrotation")
    channels = (("Xposition", "Yposition", "Zposition", *rotation), *(rotation for _ in range(joints - 1)))
    skeleton = Skeleton(tuple(f"J{j}" for j in range(joints)), frozen(parents), frozen(offsets), channels)
    turns = rng.normal(scale=0.5, size=(1, joints, 3)) + rng.normal(scale=0.05, size=(frames, joints, 3))
    return Motion(skeleton, rot.exp(turns), rng.normal(scale=0.1, size=(frames, 1, 3)), 0.01)


def body_of(rng, motion):
    """Return masses, one or two hinges with limits near their angles, and how readily each joint turns."""
    skeleton, joints = motion.skeleton, len(motion.skeleton)
    shares = rng.uniform(size=joints) + 0.1
    masses = Masses(skeleton, frozen(shares / shares.sum()), frozen(rng.normal(scale=0.1, size=(joints, 3))), True)
    hinges = []
    for joint in sorted(rng.choice(np.arange(1, joints), size=min(2, joints - 1), replace=False)):
        axis = unit(rng)
        angles, spread = rot.log(motion.rotations[:, joint]) @ axis, rng.uniform(0.02, 1.0)
        hinges.append(plain_hinge(int(joint), axis, (angles.min() - spread, angles.max() + spread)))
    return Body(masses, tuple(hinges), 0, 0, mobility=rng.uniform(0.4, 1.0, size=joints), root_mobility=0.5)


def unit(rng):
    """Return a direction."""
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def effector_of(rng, skeleton):
    """Return a joint below the root, or a point of it."""
    return Effector(int(rng.integers(1, len(skeleton))), rng.normal(scale=0.1, size=3) * (rng.uniform() < 0.5))


def floor_of(rng, motion, reach, **common):
    """Return a floor near the lowest of a few points, somewhere they are below it."""
    points, up = tuple(effector_of(rng, motion.skeleton) for _ in range(int(rng.integers(1, 5)))), unit(rng)
    poses = forward(motion)
    lowest = min((effector_positions(poses, each) @ up).min() for each in points)
    return Floor(effector=points, height=Level(up, lowest + reach * rng.uniform(-1.0, 1.0)), **common)


def distance_of(rng, motion, reach, **common):
    """Return two points that come nearer or part, or may not."""
    one, to = effector_of(rng, motion.skeleton), effector_of(rng, motion.skeleton)
    if one.joint == to.joint:
        to = Effector(0, to.offset)
    poses = forward(motion)
    own = np.linalg.norm(effector_positions(poses, one) - effector_positions(poses, to), axis=1).mean()
    bound = ("distance", "at_least", "at_most")[int(rng.integers(3))]
    length = own + reach * rng.uniform(-1.0, 1.0)
    point = LengthPoint("hold", 0, FRAMES - 1, length=float(max(length, 0.01)), bound=bound)
    return Distance(effector=one, to=to, points=(point,), **common)


def constraints_of(rng, motion, reach, count):
    """Return a floor, a distance, and more, in layers as they come."""
    skeleton = motion.skeleton

    def common(i):
        return {"name": f"c{i}", "priority": int(rng.integers(1, 5)), "weight": float(rng.uniform(0.3, 3.0))}

    def hold(**what):
        return (ControlPoint("hold", 0, FRAMES - 1, **what),)

    def shift():
        return hold(shift=rng.normal(scale=reach, size=3))

    makers = (
        lambda own: floor_of(rng, motion, reach, **own),
        lambda own: distance_of(rng, motion, reach, **own),
        lambda own: Position(effector=effector_of(rng, skeleton), points=shift(), **own),
        lambda own: Orientation(effector=Effector(len(skeleton) - 1, np.zeros(3)), points=hold(), **own),
        lambda own: CenterOfMass(points=shift(), **own),
        lambda own: Posture(joints=(int(rng.integers(1, len(skeleton))),), **own),
    )
    kinds = [0, 1, *rng.integers(len(makers), size=count)]
    return [makers[kind](common(i)) for i, kind in enumerate(kinds)]
