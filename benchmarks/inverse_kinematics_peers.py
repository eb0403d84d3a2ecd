"""Pink and mink, with the loops of a robot as constraints of their quadratic programs; both are optional."""

from __future__ import annotations

import contextlib
import logging
from abc import ABC, abstractmethod
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.mujoco_model import MuJoCoRobot
from benchmarks.plain_newton import AT_TARGET, CLOSED, Matrix, PlainNewton, Vector

try:
    import mink
    import pink

    logging.disable(logging.WARNING)  # Pink warns of each limit, in the time that is measured
except ImportError:
    mink = pink = None  # type: ignore[assignment, unused-ignore]

#: Steps at most, and those without progress.
MOST_STEPS, IDLE = 50, 5

# Of the loops, where they cannot be constraints.
_COST = 100.0

_PROGRAM: dict[str, Any] = {"dt": 1.0, "solver": "daqp", "damping": 1e-12, "limits": []}


class Peer(ABC):
    """Inverse kinematics of a frame.

    Attributes:
        errors: How far the loops are open, and the frame is from its target, at the end of the last solution (m, rad).
    """

    errors = np.inf, np.inf

    def solve(self, target: pin.SE3, q0: Vector) -> None:
        """Take steps until both errors are small enough, or have not fallen for some."""
        with contextlib.suppress(Exception):  # its program has no solution with the loops as constraints
            return self._descend(target, q0, True)
        return self._descend(target, q0, False)

    def _descend(self, target: pin.SE3, q0: Vector, constrained: bool) -> None:
        self._start(target, q0)
        least, idle = np.inf, 0
        for _ in range(MOST_STEPS):
            self.errors = loops, frame = self._errors()
            idle = 0 if loops + frame < 0.5 * least else idle + 1
            least = min(least, loops + frame)
            if (loops <= CLOSED and frame <= AT_TARGET) or idle > IDLE:
                return
            self._step(constrained)

    @abstractmethod
    def _start(self, target: pin.SE3, q0: Vector) -> None: ...

    @abstractmethod
    def _errors(self) -> tuple[float, float]: ...

    @abstractmethod
    def _step(self, constrained: bool) -> None: ...

    def _with_loops(self, task: Any, loops: Any, constrained: bool) -> dict[str, Any]:
        return {**_PROGRAM, "tasks": [task, *([] if constrained else [loops])], "constraints": [loops] * constrained}


def _sizes(loops: Vector, frame: Vector) -> tuple[float, float]:
    return float(np.abs(loops).max(initial=0.0)), float(max(np.linalg.norm(frame[:3]), np.linalg.norm(frame[3:])))


class PinkPeer(Peer):
    """Pink, with the rows of plain Newton."""

    def __init__(self, robot: eurdf.Robot, newton: PlainNewton, frame: str) -> None:
        class Loops(pink.Task):  # type: ignore[misc]
            rows: tuple[Vector, Matrix]

            def compute_error(self, configuration: Any) -> Vector:
                return self.rows[0]

            def compute_jacobian(self, configuration: Any) -> Matrix:
                return self.rows[1]

            def __repr__(self) -> str:
                return "Loops"

        self._newton, self._frame, self._loops = newton, pink.FrameTask(frame, 1.0, 1.0), Loops(_COST)
        self._configuration = pink.Configuration(robot.model, newton.data, robot.tree.neutral(), copy_data=False)

    def _start(self, target: pin.SE3, q0: Vector) -> None:
        self._frame.set_target(target)
        self._configuration.update(q0)

    def _errors(self) -> tuple[float, float]:
        self._loops.rows = self._newton.closures(self._configuration.q)
        error = self._frame.compute_error(self._configuration)
        return _sizes(self._loops.rows[0], error)

    def _step(self, constrained: bool) -> None:
        program = self._with_loops(self._frame, self._loops, constrained)
        velocity = pink.solve_ik(self._configuration, safety_break=False, **program)
        self._configuration.integrate_inplace(velocity, 1.0)


class MinkPeer(Peer):
    """Mink, with the equalities of the MJCF."""

    def __init__(self, robot: eurdf.Robot, newton: PlainNewton, frame: str) -> None:
        self._robot = MuJoCoRobot(robot)
        self._robot.model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE  # mink reads no other
        self._configuration = mink.Configuration(self._robot.model)
        self._frame = mink.FrameTask(frame, "body", 1.0, 1.0)
        self._loops = mink.EqualityConstraintTask(self._robot.model, _COST)

    def _start(self, target: pin.SE3, q0: Vector) -> None:
        self._frame.set_target(mink.SE3.from_matrix(target.homogeneous))
        self._configuration.update(self._robot.qpos(q0))

    def _errors(self) -> tuple[float, float]:
        error = self._frame.compute_error(self._configuration)
        return _sizes(self._loops.compute_error(self._configuration), error)

    def _step(self, constrained: bool) -> None:
        velocity = mink.solve_ik(self._configuration, **self._with_loops(self._frame, self._loops, constrained))
        self._configuration.integrate_inplace(velocity, 1.0)


#: The peers that are installed.
PEERS: dict[str, type[Any]] = {} if pink is None else {"Pink": PinkPeer, "mink": MinkPeer}
