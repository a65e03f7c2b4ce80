"""The job by placo: its kinematics solver with hard and soft tasks, as in placo's examples."""

from __future__ import annotations

from typing import Any

import numpy as np
import placo
import protocol


class Placo:
    """A robot with one solver for each set of active tasks, since tasks cannot be switched off."""

    def __init__(self, job: protocol.Job) -> None:
        self.job, self.starts = job, job.configurations((1, 2, 3, 0))
        self.robot = placo.RobotWrapper(job.robot, placo.Flags.mjcf | placo.Flags.ignore_collisions)
        self.solvers: dict[bytes, tuple[Any, list[tuple[int, Any]]]] = {}
        self.solver: Any = None

    def _solver(self, active: np.ndarray) -> tuple[Any, list[tuple[int, Any]]]:
        solver, tasks = placo.KinematicsSolver(self.robot), []
        solver.enable_joint_limits(False)  # noqa: FBT003
        solver.enable_velocity_limits(False)  # noqa: FBT003
        for i in map(int, np.flatnonzero(active)):
            kind, joint = self.job.kinds[i], self.job.joints[i]
            # Its weights are those of squared errors.
            priority, weight = "hard" if self.job.exact(i) else "soft", self.job.costs[i] ** 2
            if kind == "com":
                task = solver.add_com_task(np.zeros(3))
            elif kind == "frame":
                task = solver.add_frame_task(self.job.names[joint], np.eye(4))
            elif kind == "point":
                task = solver.add_position_task(self.job.names[joint], np.zeros(3))
            else:
                continue
            task.configure(f"task {i}", priority, *([weight, weight] if kind == "frame" else [weight]))
            tasks.append((i, task))
        solver.add_regularization_task(self.job.damping)
        return solver, tasks

    def begin(self, frame: int) -> None:
        """Take the frame's start and targets."""
        key = self.job.active[frame].tobytes()
        if key not in self.solvers:
            self.solvers[key] = self._solver(self.job.active[frame])
        self.solver, tasks = self.solvers[key]
        self.robot.state.q = self.starts[frame]
        self.robot.update_kinematics()
        for i, task in tasks:
            if self.job.kinds[i] == "frame":
                task.T_world_frame = _transform(self.job.turns[frame, i], self.job.targets[frame, i])
            else:
                task.target_world = self.job.targets[frame, i]

    def step(self) -> None:
        """Make one iteration."""
        try:
            self.solver.solve(True)  # noqa: FBT003
        except RuntimeError as error:
            raise protocol.SolveError from error
        self.robot.update_kinematics()

    def places(self) -> np.ndarray:
        """Return where the tasks' points are now."""
        robot, names = self.robot, self.job.names
        return np.array(
            [
                robot.com_world() if joint == protocol.COM else robot.get_T_world_frame(names[joint])[:3, 3]
                for joint in self.job.joints
            ]
        )


def _transform(turn: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Return the matrix of a quaternion w, x, y, z and a place, shape (4, 4)."""
    w, x, y, z = turn
    T = np.eye(4)
    T[:3, 3] = place
    T[:3, :3] += 2.0 * np.array(
        [
            [-y * y - z * z, x * y - w * z, x * z + w * y],
            [x * y + w * z, -x * x - z * z, y * z - w * x],
            [x * z - w * y, y * z + w * x, -x * x - y * y],
        ]
    )
    return T


if __name__ == "__main__":
    protocol.run(Placo, ("placo", "pin"))
