"""The job by mink: tasks of MuJoCo's kinematics in one quadratic program, by daqp, as in mink's examples."""

from __future__ import annotations

import mink
import mujoco
import numpy as np
import protocol

# It decides what is left over. A posture task would do so too, but weighs against the lowest level.
DAMPING = 1e-8


class PointTask(mink.Task):
    """A body's origin at a place in the world: the position rows of mink's frame task alone."""

    def __init__(self, body: int, cost: float, damping: float) -> None:
        super().__init__(cost=np.full(3, cost), lm_damping=damping)
        self.body, self.target = body, np.zeros(3)

    def compute_error(self, configuration: mink.Configuration) -> np.ndarray:
        """Return where it is, less where it shall be, shape (3,)."""
        return configuration.data.xpos[self.body] - self.target

    def compute_jacobian(self, configuration: mink.Configuration) -> np.ndarray:
        """Return d(place)/d(velocity), shape (3, n)."""
        J = np.empty((3, configuration.model.nv))
        mujoco.mj_jacBody(configuration.model, configuration.data, J, None, self.body)
        return J


class Mink:
    """A configuration and its tasks."""

    def __init__(self, job: protocol.Job) -> None:
        self.job, self.starts = job, job.configurations((0, 1, 2, 3))
        self.model = mujoco.MjModel.from_xml_path(job.robot)
        self.configuration = mink.Configuration(self.model)
        self.tasks = [self._task(i) for i in range(len(job.joints))]
        self.bodies = [j if j == protocol.COM else self.model.body(job.names[j]).id for j in job.joints]
        self.soft, self.hard = [], []

    def _task(self, i: int) -> mink.Task:
        name, kind, cost = self.job.names[self.job.joints[i]], self.job.kinds[i], self.job.costs[i]
        damping = self.job.damping
        if kind == "com":
            return mink.ComTask(cost=cost, lm_damping=damping)
        if kind == "frame":
            return mink.FrameTask(name, "body", position_cost=cost, orientation_cost=cost, lm_damping=damping)
        return PointTask(self.model.body(name).id, cost, damping)

    def begin(self, frame: int) -> None:
        """Take the frame's start and targets."""
        self.configuration.update(self.starts[frame])
        self.soft, self.hard = [], []
        for i in np.flatnonzero(self.job.active[frame]):
            task, target = self.tasks[i], self.job.targets[frame, i]
            if isinstance(task, PointTask):
                task.target = target
            elif isinstance(task, mink.ComTask):
                task.set_target(target)
            else:
                turn = mink.SO3(self.job.turns[frame, i])
                task.set_target(mink.SE3.from_rotation_and_translation(turn, target))
            if self.job.kinds[i] != "none":
                (self.hard if self.job.exact(i) else self.soft).append(task)

    def step(self) -> None:
        """Make one iteration."""
        try:
            velocity = mink.solve_ik(
                self.configuration,
                self.soft,
                1.0,
                self.job.qp,
                damping=DAMPING,
                limits=[],
                constraints=self.hard or None,
            )
        except mink.NoSolutionFound as error:
            raise protocol.SolveError from error
        self.configuration.integrate_inplace(velocity, 1.0)

    def places(self) -> np.ndarray:
        """Return where the tasks' points are now."""
        data = self.configuration.data
        return np.array([data.subtree_com[1] if body == protocol.COM else data.xpos[body] for body in self.bodies])


if __name__ == "__main__":
    protocol.run(Mink, ("mink", "mujoco", "daqp"))
