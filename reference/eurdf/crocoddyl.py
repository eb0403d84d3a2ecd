"""Closed loops in Crocoddyl, a library for optimal control: ``pip install "eurdf[crocoddyl]"``.

Crocoddyl has contacts, but no loops. This action model has all constraints of a robot, with exact derivatives.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.array import Vector
from eurdf.diagnostics.extras import install_command
from eurdf.errors import EurdfError, MissingExtra
from eurdf.kinematics.applied_force import AppliedForce
from eurdf.kinematics.derivatives import DerivativesTask, derivatives_at
from eurdf.kinematics.dynamics import forward_dynamics
from eurdf.loading import as_robot

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot
    from eurdf.reading.robot_source import RobotSource

try:
    import crocoddyl
except ImportError as error:
    if (error.name or "").partition(".")[0] != "crocoddyl":
        raise
    message = "eurdf.crocoddyl needs Crocoddyl; install it with: " + install_command("crocoddyl")
    raise MissingExtra(message, "crocoddyl") from None

#: Pinocchio 4.1 has members of its model before the frames that Crocoddyl's wheels of 3.2.1 do not know.
_FRAMES_MISREAD = tuple(map(int, pin.__version__.split(".")[:2])) >= (4, 1) and crocoddyl.__version__ == "3.2.1"


class DifferentialActionModelLoopFwdDynamics(crocoddyl.DifferentialActionModelAbstract):  # type: ignore[misc]
    """v̇ = a(q, v, u) of `eurdf.forward_dynamics`, with closures of every kind, couplings, contacts, and any costs.

    The state x = (q, v) is that of the spanning tree, and u are the motor torques, N·m and N. Loops are not rows of the
    problem: a keeps them closed, and the gains close what an integrator opens. The derivatives are those of
    `eurdf.dynamics_derivatives`. The bounds ``u_lb`` and ``u_ub`` are the narrower of the effort limits of the URDF and
    the control ranges of the description; only some solvers use them.

    In the data of an action, ``forces`` are λ of each constraint, also by name, as in `eurdf.results.ForwardDynamics`.

    Attributes:
        robot: The robot.
        costs: The costs.
        gains: Baumgarte gains kp (1/s²) and kd (1/s).
        dissipation: Whether damping and dry friction act.
    """

    def __init__(
        self,
        robot: Robot | RobotSource,
        costs: Any,
        gains: tuple[float, float],
        *,
        dissipation: bool = False,
    ) -> None:
        """Take a robot as `eurdf.load` returns it, or what it takes.

        Args:
            robot: The robot, with its contacts.
            costs: A ``crocoddyl.CostModelSum`` on ``crocoddyl.StateMultibody(robot.model)``, for as many controls as
                the robot has motors. Its residuals are of the state, of controls, of frames, of the centre of mass and
                of the centroidal momentum; Crocoddyl raises on those of its own contacts and actuations.
            gains: As in `eurdf.forward_dynamics`. With kp = ((1 - p) / dt)² and kd = (1 - p²) / dt, n steps of
                ``crocoddyl.IntegratedActionModelEuler`` of dt reduce an opening as n pⁿ, with p in [0, 1).
            dissipation: As in `eurdf.forward_dynamics`. The derivative of dry friction is taken as zero.

        Raises:
            ValueError: The costs are for another model or another number of controls, or the gains are not finite.
            UndeterminedMotion: A joint without inertia can move.
        """
        self.robot = as_robot(robot, geometry=False)
        self.costs, self.gains, self.dissipation = costs, gains, dissipation
        model, motors = self.robot.model, self.robot.actuation
        if getattr(costs.state, "pinocchio", None) != model or costs.nu != len(motors.idx_v):
            raise ValueError(
                f"the costs are for another state or for {costs.nu} controls; make them with crocoddyl.CostModelSum("
                f"crocoddyl.StateMultibody(robot.model), {len(motors.idx_v)}) for '{self.robot.mechanism.name}'"
            )
        super().__init__(costs.state, costs.nu, costs.nr)
        self.u_lb = np.maximum(model.lowerEffortLimit[motors.idx_v], motors.control[:, 0])
        self.u_ub = np.minimum(model.upperEffortLimit[motors.idx_v], motors.control[:, 1])
        # Wrong gains and joints without inertia are errors here: in a solver, an exception would end the process.
        q = self.robot.configurations.get("assembled", self.robot.tree.neutral())
        forward_dynamics(self.robot, q, np.zeros(model.nv), gains=gains)
        # One for all actions, which `calc` and `calcDiff` fill anew: it takes 64 nv³ bytes.
        self._data = model.createData()

    def createData(self) -> Any:  # noqa: N802 - Crocoddyl's name
        """What an action computes.

        Raises:
            ValueError: A residual would be wrong; the message says why.
        """
        mimics = len(self.robot.model.mimicking_joints) > 0
        for name, item in self.costs.costs.todict().items():
            kind = type(getattr(item.cost, "residual", None))
            if _FRAMES_MISREAD and kind.__module__.startswith("crocoddyl.") and "Frame" in kind.__name__:
                raise ValueError(
                    f"cost '{name}': Crocoddyl {crocoddyl.__version__} is compiled for Pinocchio 4.0, and reads wrong "
                    f"frames with {pin.__version__}; use eurdf.crocoddyl.ResidualModelFramePlacement, or Pinocchio 4.0"
                )
            if mimics and any(each in kind.__name__ for each in ("FrameVelocity", "CentroidalMomentum")):
                raise ValueError(f"cost '{name}': Pinocchio has no derivatives of {kind.__name__} with mimic joints")
        return _ActionData(self, self._data)

    def calc(self, data: Any, x: Vector, u: Vector | None = None) -> None:
        """Acceleration, forces and cost; the cost alone without u, at the end.

        What overflows or is not finite is NaN, by which solvers see that a step is too long: an error would end the
        process.
        """
        q, v = self._kinematics(x)
        if u is None:
            self.costs.calc(data.costs, x)
        else:
            try:
                found = forward_dynamics(self.robot, q, v, u, gains=self.gains, dissipation=self.dissipation)
                data.xout, data.forces = found
            except (EurdfError, ValueError):
                data.xout = np.full(len(v), np.nan)
            self.costs.calc(data.costs, x, u)
        data.cost = data.costs.cost

    def calcDiff(self, data: Any, x: Vector, u: Vector | None = None) -> None:  # noqa: N802 - Crocoddyl's name
        """Derivatives of what `calc` has computed.

        Where redundant rows contradict each other, as those of a spherical linkage that is open, they lack how this
        changes.
        """
        q, v = self._kinematics(x)
        if not len(self.robot.model.mimicking_joints):
            pin.computeRNEADerivatives(self.robot.model, self._data, q, v, np.zeros_like(v))  # for those of momentum
        if u is None:
            self.costs.calcDiff(data.costs, x)
            return
        try:
            force = AppliedForce(self.robot, None, self.dissipation).total(q, v, u, None)
            task = DerivativesTask(self.robot, self.gains, self.dissipation, closed=False)
            _, _, *by, by_u, _ = derivatives_at(task, q[None], v[None], force[None])[:6]
            data.Fx, data.Fu = np.concatenate(by, axis=2)[0], by_u[0]
        except (EurdfError, ValueError):
            data.Fx, data.Fu = (np.full_like(each, np.nan) for each in (data.Fx, data.Fu))
        self.costs.calcDiff(data.costs, x, u)

    def _kinematics(self, x: Vector) -> tuple[Vector, Vector]:
        """Compute what the costs need of q and v, and return both."""
        model, data = self.robot.model, self._data
        q, v = pin.normalize(model, x[: model.nq]), x[model.nq :]
        pin.forwardKinematics(model, data, q, v)
        pin.updateFramePlacements(model, data)
        pin.jacobianCenterOfMass(model, data, q)  # and of joints
        pin.computeCentroidalMomentum(model, data, q, v)
        return q, v


class _ActionData(crocoddyl.DifferentialActionDataAbstract):  # type: ignore[misc]
    """What an action computes, with the data of its costs."""

    def __init__(self, model: DifferentialActionModelLoopFwdDynamics, data: pin.Data) -> None:
        super().__init__(model)
        self._kept = data, crocoddyl.DataCollectorMultibody(data)
        self.costs = model.costs.createData(self._kept[1])
        self.costs.shareMemory(self)


class ResidualModelFramePlacement(crocoddyl.ResidualModelAbstract):  # type: ignore[misc]
    """log6 of the pose of a frame in its goal, (6,) m and rad: Crocoddyl's own, right with every Pinocchio.

    Attributes:
        id: Index of the frame.
        reference: Its goal, in the world.
    """

    def __init__(self, state: Any, id: int, pref: pin.SE3, nu: int) -> None:  # noqa: A002 - Crocoddyl's names
        """Take what Crocoddyl's own takes: a ``crocoddyl.StateMultibody``, index and goal of the frame, and nu.

        Raises:
            ValueError: The model has no such frame.
        """
        if not 0 <= id < state.pinocchio.nframes:
            raise ValueError(f"id is {id}; '{state.pinocchio.name}' has frames 0 to {state.pinocchio.nframes - 1}")
        super().__init__(state, 6, nu, True, False, False)
        self._model, self.id, self.reference = state.pinocchio, id, pref

    def calc(self, data: Any, x: Vector, u: Vector | None = None) -> None:
        """The residual."""
        data.r = pin.log6(self.reference.actInv(data.shared.pinocchio.oMf[self.id])).vector

    def calcDiff(self, data: Any, x: Vector, u: Vector | None = None) -> None:  # noqa: N802 - Crocoddyl's name
        """Its derivative by x."""
        found = data.shared.pinocchio
        J = pin.getFrameJacobian(self._model, found, self.id, pin.LOCAL)
        by_q = pin.Jlog6(self.reference.actInv(found.oMf[self.id])) @ J
        data.Rx = np.concatenate((by_q, np.zeros_like(by_q)), axis=1)
