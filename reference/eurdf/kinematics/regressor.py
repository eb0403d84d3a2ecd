"""The motor torques of the closed mechanism as a linear function of the inertial parameters of its bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.se3 import motion_cross, turned
from eurdf.kinematics.applied_force import AppliedForce
from eurdf.kinematics.closing import start
from eurdf.kinematics.dynamics import inverse_dynamics, norm_of
from eurdf.kinematics.equation_of_motion import EquationOfMotion
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.forward_solver import ForwardSolver
from eurdf.kinematics.named import Named, velocity_of
from eurdf.kinematics.variation import Structure
from eurdf.pinocchio.inertia import body_regressors
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot
    from eurdf.pinocchio.tree_dynamics import TreeDynamics


class InertialRegressor(NamedTuple):
    """The result of `inertial_regressor`: u = Y π + constant.

    Attributes:
        Y: (nu, 10 n), in the order of the actuation.
        parameters: π (10 n) of the model: of each body m (kg), m c (3, kg·m), and Ixx, Ixy, Iyy, Ixz, Iyz, Izz (kg·m²)
            about the origin of its joint, in the axes of the joint, as `pin.Inertia.toDynamicParameters` has them.
        constant: Motor torques (nu,) that do not depend on π, N·m and N: of armature, springs and given forces.
        joints: Names of the joints (n,) of ``robot.model`` that carry the bodies, without the universe.
    """

    Y: Matrix
    parameters: Vector
    constant: Vector
    joints: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<InertialRegressor: of {len(self.constant)} torques, N·m and N, by {len(self.parameters)} parameters>"


@overflow_refused("the regressor")
def inertial_regressor(
    robot: Robot,
    q: Named,
    v: Named,
    a: Named,
    *,
    tau: Named | None = None,
    dissipation: bool = False,
    weights: Named | None = None,
) -> InertialRegressor:
    """How the motor torques of `inverse_dynamics` depend on the inertial parameters π: u = Y π + constant.

    With B the map of `inverse_dynamics` from generalized forces to motor torques, and Yᵢ the regressor of the tree,
    Y = B Yᵢ. It contains gravity. Stack Y of several motions to identify π from measured torques; only combinations of
    π are identifiable, those that the singular values of the stack show.

    If motors do not control every free motion, the equation of the uncontrolled ones, 0 = Uᵀ (M a + h - τ), is no part
    of Y.

    Source of the regressor of a body: Atkeson, An, Hollerbach, *Estimation of inertial parameters of manipulator loads
    and links*, 1986.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed.
        v: Velocity (nv,), with K v = 0.
        a: Acceleration (nv,), with K a + K̇ v = 0, which the motors can produce.
        tau: As in `forward_dynamics`.
        dissipation: As in `forward_dynamics`.
        weights: As in `inverse_dynamics`.

    Raises:
        ValueError: As in `inverse_dynamics`.
        InconsistentMotion: v or a does not keep the closures closed.
        UnderactuatedMotion: The motors cannot produce this motion.
        NumericalOverflow: The result is not finite.
    """
    q, v, a = start(robot, q, "q"), velocity_of(robot, v), velocity_of(robot, a, "a")
    inverse_dynamics(robot, q, v, a, tau=tau, dissipation=dissipation, weights=weights)  # refuses other motions
    norm, model = norm_of(robot, weights), robot.model
    with working_memory(robot, ForwardSolver) as solver:
        dynamics = solver.dynamics(None)
        motion = EquationOfMotion(robot, q, v, dynamics)
        of_tree = _tree_regressor(robot.cached(Structure), dynamics, q, v, a)
    others = model.armature * a - AppliedForce(robot, None, dissipation).total(q, v, None, tau)
    constant = motion.torques(others, norm)
    Y = np.array([motion.torques(each, norm) for each in of_tree.T]).reshape(-1, len(norm)).T
    parameters = np.array([each.toDynamicParameters() for each in list(model.inertias)[1:]]).ravel()
    finite("the regressor", Y, constant)
    return InertialRegressor(Y, parameters, constant, tuple(list(model.names)[1:]))


def _tree_regressor(s: Structure, dynamics: TreeDynamics, q: Vector, v: Vector, a: Vector) -> Matrix:
    """The derivative (nv, 10 n) of the generalized force of the spanning tree by π."""
    poses, J = dynamics.columns(q)
    rates, changes = ((x if s.velocities is None else s.velocities @ x)[:, None] for x in (v, a))
    V = s.moved_by @ (rates * J)
    A = s.moved_by @ (changes * J + rates * turned(motion_cross(V)[s.owner], J)) - s.gravity
    found = s.moved_by[1:, :, None] * (J @ body_regressors(poses[1:], V[1:], A[1:]))
    return np.asarray(s.over_v(found.swapaxes(1, 2)).reshape(-1, len(v)).T)
