"""The job by pink: tasks of Pinocchio's kinematics in one quadratic program, as in pink's examples."""

from __future__ import annotations

import numpy as np
import pink
import pinocchio as pin
import protocol
from pink.exceptions import NoSolutionFound
from pink.tasks import ComTask, FrameTask, Task

# It decides what is left over. A posture task would do so too, but weighs against the lowest level.
DAMPING = 1e-8


class PointTask(Task):
    """A frame's origin at a place in the world: the position rows of pink's frame task alone."""

    def __init__(self, frame: int, cost: float, damping: float) -> None:
        super().__init__(cost=np.full(3, cost), lm_damping=damping)
        self.frame, self.target = frame, np.zeros(3)

    def __repr__(self) -> str:
        """Return what it is."""
        return f"PointTask({self.frame})"

    def compute_error(self, configuration: pink.Configuration) -> np.ndarray:
        """Return where it is, less where it shall be, shape (3,)."""
        return configuration.data.oMf[self.frame].translation - self.target

    def compute_jacobian(self, configuration: pink.Configuration) -> np.ndarray:
        """Return d(place)/d(velocity), shape (3, n)."""
        world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        return pin.getFrameJacobian(configuration.model, configuration.data, self.frame, world)[:3]


class Pink:
    """A configuration and its tasks."""

    def __init__(self, job: protocol.Job) -> None:
        self.job, self.starts = job, job.configurations((1, 2, 3, 0))
        self.model = pin.buildModelFromMJCF(job.robot)
        # The reader of MJCF keeps the root within a metre of the origin.
        self.model.lowerPositionLimit[:], self.model.upperPositionLimit[:] = -np.inf, np.inf
        self.configuration = pink.Configuration(self.model, self.model.createData(), self.starts[0])
        self.frames = [j if j == protocol.COM else self.model.getFrameId(job.names[j], pin.BODY) for j in job.joints]
        self.tasks = [self._task(i) for i in range(len(job.joints))]
        self.soft: list[Task] = []
        self.hard: list[Task] = []

    def _task(self, i: int) -> Task:
        name, kind, cost = self.job.names[self.job.joints[i]], self.job.kinds[i], self.job.costs[i]
        damping = self.job.damping
        if kind == "com":
            return ComTask(cost=cost, lm_damping=damping)
        if kind == "frame":
            return FrameTask(name, position_cost=cost, orientation_cost=cost, lm_damping=damping)
        return PointTask(self.frames[i], cost, damping)

    def begin(self, frame: int) -> None:
        """Take the frame's start and targets."""
        self.configuration.update(self.starts[frame])
        self.soft, self.hard = [], []
        for i in np.flatnonzero(self.job.active[frame]):
            task, target = self.tasks[i], self.job.targets[frame, i]
            if isinstance(task, PointTask):
                task.target = target
            elif isinstance(task, ComTask):
                task.set_target(target)
            else:
                w, x, y, z = self.job.turns[frame, i]
                task.set_target(pin.SE3(pin.Quaternion(w, x, y, z).matrix(), target))
            if self.job.kinds[i] != "none":
                (self.hard if self.job.exact(i) else self.soft).append(task)

    def step(self) -> None:
        """Make one iteration."""
        try:
            velocity = pink.solve_ik(
                self.configuration,
                self.soft,
                1.0,
                self.job.qp,
                damping=DAMPING,
                limits=[],
                constraints=self.hard or None,
                safety_break=False,
            )
        except NoSolutionFound as error:
            raise protocol.SolveError from error
        self.configuration.integrate_inplace(velocity, 1.0)

    def places(self) -> np.ndarray:
        """Return where the tasks' points are now."""
        configuration = self.configuration
        model, data = configuration.model, configuration.data
        return np.array(
            [
                pin.centerOfMass(model, data, configuration.q) if frame == protocol.COM else data.oMf[frame].translation
                for frame in self.frames
            ]
        )


if __name__ == "__main__":
    protocol.run(Pink, ("pin-pink", "pin", "qpsolvers", "daqp", "quadprog", "proxsuite"))
