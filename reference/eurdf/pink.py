"""Loops as a task of Pink, an inverse kinematics by quadratic programs: ``pip install "eurdf[pink]"``.

Pink lets joints of a Pinocchio model move; this task keeps the loops of the robot closed while they do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.diagnostics.extras import install_command
from eurdf.errors import MissingExtra
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.loading import as_robot

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot
    from eurdf.reading.robot_source import RobotSource

try:
    from pink.tasks import Task
except ImportError as error:
    if (error.name or "").partition(".")[0] != "pink":
        raise
    raise MissingExtra("eurdf.pink needs Pink; install it with: " + install_command("pink"), "pink") from None


class ClosureTask(Task):  # type: ignore[misc]
    """All constraints of a robot, r(q) = 0: closures of every kind, couplings, contacts.

    In ``pink.solve_ik(…, constraints=[ClosureTask(robot)])`` they hold exactly to first order: J Δq = -gain · e, where
    the k rows of J are an orthonormal basis of the velocities that open the loops, and e = J K⁺ r, so that K Δq = -r
    at gain 1. A program with redundant closures therefore has independent rows. Where K has not its full row rank, r
    is reduced as far as K allows. After a step of length d the loops are open by O(d²), which the next step removes.

    Attributes:
        robot: The robot.
        cost: Weight of each row where this is one of the ``tasks`` and no constraint, 1 / rad or 1 / m.
        gain: The part of the opening that a step removes, in (0, 1].
        lm_damping: See ``pink.tasks.Task``.
    """

    def __init__(self, robot: Robot | RobotSource, cost: float = 1.0, gain: float = 1.0, lm_damping: float = 0.0):
        """Take a robot as `eurdf.load` returns it, or what it takes.

        Raises:
            ValueError: ``cost`` or ``lm_damping`` is negative, or ``gain`` is not in (0, 1].
        """
        if not (0.0 <= cost < np.inf and 0.0 <= lm_damping < np.inf and 0.0 < gain <= 1.0):
            raise ValueError(
                f"cost is {cost}, gain {gain}, lm_damping {lm_damping}; cost and lm_damping must be finite and at "
                "least 0, and gain in (0, 1]"
            )
        super().__init__(cost=float(cost), gain=gain, lm_damping=lm_damping)
        self.robot = as_robot(robot, geometry=False)
        self._last: tuple[Any, Vector, Matrix] = None, np.empty(0), np.empty((0, 0))

    def compute_error(self, configuration: Any) -> Vector:
        """The e (k,), rad or m as the velocities, for a ``pink.Configuration`` of ``robot.model``.

        Raises:
            ValueError: The configuration is one of another model.
            NumericalOverflow: r or K is not finite.
        """
        return self._rows(configuration)[0].copy()

    def compute_jacobian(self, configuration: Any) -> Matrix:
        """The J (k, nv), with orthonormal rows; k is the rank of K. It raises as `compute_error`."""
        return self._rows(configuration)[1].copy()

    def _rows(self, configuration: Any) -> tuple[Vector, Matrix]:
        if self._last[0] is configuration.q:  # a configuration has a new array after each step
            return self._last[1:]
        model = self.robot.model
        if configuration.model is not model and configuration.model != model:
            raise ValueError(
                f"the configuration is one of the model '{configuration.model.name}', not of that of the task's "
                f"robot '{model.name}'; make it with pink.Configuration(robot.model, robot.data, q)"
            )
        r, K = residual_and_jacobian(self.robot, configuration.q)
        space = self.robot.cached(TangentSpaces).at(K)
        free = space.basis.shape[1]
        J = np.linalg.qr(space.basis, mode="complete")[0][:, free:].T
        self._last = configuration.q, J @ (space.inverse @ r), J
        return self._last[1:]

    def __repr__(self) -> str:
        return f"ClosureTask('{self.robot.mechanism.name}', cost={self.cost}, gain={self.gain})"
