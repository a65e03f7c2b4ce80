"""A problem on two arms, for what the compiled solver does with its frames and its buffers."""

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.bends import turns_about
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds.position import PositionTask
from motionedit.core.priorities.solver.layered import prepare_problem, solve_layers
from motionedit.core.priorities.solver.points import Columns, Point, Recruited
from motionedit.core.priorities.solver.problem import HingeColumns, LayeredSolution, Problem, Reference, WeightedTask
from motionedit.core.skeleton import Skeleton


def arms_of(seed, frames=8):
    """Return a problem whose rows depend on each other in some frames alone: many points on one arm, between them one
    on another arm, whose hinge is on its limit here and there."""
    rng = np.random.default_rng(seed)
    rotation = ("Zrotation", "Xrotation", "Yrotation")
    channels = (("Xposition", "Yposition", "Zposition", *rotation), *(rotation for _ in range(6)))
    parents = frozen(np.array([-1, 0, 1, 2, 0, 4, 5]))
    skeleton = Skeleton(tuple("OABCXYZ"), parents, frozen(rng.normal(scale=0.3, size=(7, 3))), channels)
    turns = rng.normal(scale=0.6, size=(1, 7, 3)) + rng.normal(scale=0.05, size=(frames, 7, 3))
    motion = Motion(skeleton, rot.exp(turns), np.zeros((frames, 1, 3)), 0.01)
    columns = Columns(skeleton, np.arange(1, 7), 0)
    first, second = (Recruited(np.arange(6) // 3 == arm, root=False) for arm in (0, 1))

    def point(effector, recruited, shift):
        targets = effector_positions(forward(motion), effector) + shift
        task = PositionTask(Point(columns, effector, recruited), targets)
        return WeightedTask(task, float(rng.uniform(0.7, 1.3)))

    shift = rng.normal(scale=0.1, size=(frames, 3))
    tasks = [point(Effector(3, rng.normal(scale=0.1, size=3)), first, shift) for _ in range(4)]
    tasks.insert(2, point(Effector(5, np.zeros(3)), second, rng.normal(scale=0.05, size=(frames, 3))))
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    side = np.cross(axis, np.roll(axis, 1))
    side /= np.linalg.norm(side)
    angles = turns_about(axis, side, rot.rotate(motion.rotations[:, 4], np.tile(side, (frames, 1))))
    limits = np.array([[angles.min() - 0.05, angles.max() + 0.05], [-3.0, 3.0]])
    axes, sides = np.stack([axis, axis]), np.stack([side, side])
    hinges = HingeColumns(np.array([3, 4]), axes, sides, sides, limits, np.zeros(2, dtype=bool))
    return Problem(
        columns,
        moves_root=False,
        layers=(tuple(tasks),),
        hinges=hinges,
        attraction=1.0,
        max_iterations=12,
        mobility=np.ones(7),
        softness=np.zeros((frames, 1)),
    ), motion


def solved(problem, motion, frames, *, levels=None, **how):
    """Return a copy of a motion, solved at some frames, and how that went."""
    own = Motion(motion.skeleton, motion.rotations.copy(), motion.translations.copy(), motion.frame_time)
    levels = np.arange(len(problem.layers)) if levels is None else np.array(levels)
    told = len(own), int(levels.max()) + 1
    solution = LayeredSolution(
        own,
        np.zeros(len(own), dtype=np.int64),
        np.zeros(len(own), dtype=bool),
        np.zeros(told, dtype=np.int64),
        np.zeros(told),
    )
    reference = Reference(motion.rotations.copy(), None)
    solve_layers(solution, prepare_problem(problem), reference, frames, levels=levels, **how)
    return solution
