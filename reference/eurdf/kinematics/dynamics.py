"""Forward and inverse dynamics of the closed mechanism, and the mass matrix of its spanning tree.

The equation of motion and the second derivative of the closures are

    M(q) a + h(q, v) = S u + τ + τ_s(q) + Kᵀ λ,        K(q) a + K̇(q, v) v = 0,

with τ_s the force of the springs (`eurdf.kinematics.springs`), which always acts and is part of τ in what follows, and
K the derivative of the residual of `eurdf.kinematics.residual`. The forces λ of a closure are conjugate to its
rows: λᵀ K v is their power. At a closed configuration (EU-CLO-008, EU-CLO-009) they are the force (N), and for a 6d
closure also the moment (N·m), that act at frame A on the body of B, in the axes of A. The opposite acts on the body of
A, which is Pinocchio's ``contact_force``. Those of a contact, whose frame A is in the world, act on the robot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector, numbers
from eurdf.diagnostics.wording import meant, quoted
from eurdf.errors import UnderactuatedMotion
from eurdf.kinematics.applied_force import AppliedForce, External
from eurdf.kinematics.closing import start
from eurdf.kinematics.equation_of_motion import EquationOfMotion, by_joint
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.forward_solver import ForwardSolver
from eurdf.kinematics.inverse_solver import InverseSolver
from eurdf.kinematics.named import Named, motor_values_of, velocity_of
from eurdf.kinematics.tolerances import FORCES_SOLVED, MASSLESS
from eurdf.pinocchio.arguments import checked_tolerance
from eurdf.pinocchio.memory import working_memory
from eurdf.pinocchio.tree_dynamics import TreeDynamics

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class Forces(tuple[Vector, ...]):
    """λ of each constraint, in their order: (3,) N of a 3d closure, (6,) N and N·m of a 6d one.

    They are those of the docstring of the module. ``forces["left_sole"]`` is that of a constraint by its name.

    Attributes:
        names: Names of the constraints.
    """

    names: tuple[str, ...] = ()

    @classmethod
    def of(cls, solver: ForwardSolver, lambdas: Vector) -> Forces:
        """Those in λ (nc,)."""
        forces = cls([lambdas[rows] for rows in solver.rows])
        forces.names = solver.names
        return forces

    def __repr__(self) -> str:
        return f"<Forces of {len(self)} constraints, N and N·m: {quoted(self.names, 4) or 'none'}>"

    def __getitem__(self, which: Any) -> Any:
        if not isinstance(which, str):
            return super().__getitem__(which)
        if which not in self.names:
            raise KeyError(f"there is no constraint '{which}'{meant(which, self.names)}")
        return super().__getitem__(self.names.index(which))


class ForwardDynamics(NamedTuple):
    """The result of `forward_dynamics`.

    Attributes:
        a: Acceleration (nv,), rad/s² and m/s².
        forces: λ of each constraint, also by its name.
    """

    a: Vector
    forces: Forces

    def __repr__(self) -> str:
        return f"<ForwardDynamics: a {numbers(self.a)} rad/s² or m/s²; {len(self.forces)} forces, N and N·m>"


class InverseDynamics(NamedTuple):
    """The result of `inverse_dynamics`.

    Attributes:
        u: Motor torques (nu,), in the order of the actuation, N·m and N.
        forces: λ of each constraint, also by its name.
    """

    u: Vector
    forces: Forces

    def __repr__(self) -> str:
        return f"<InverseDynamics: u {numbers(self.u)} N·m or N; {len(self.forces)} forces, N and N·m>"


def forward_dynamics(
    robot: Robot,
    q: Named,
    v: Named,
    u: Named | None = None,
    *,
    tau: Named | None = None,
    external: External | None = None,
    dissipation: bool = False,
    gains: tuple[float, float] | None = None,
    data: Any = None,
) -> ForwardDynamics:
    """Acceleration of the closed mechanism, and the forces in its closures.

    Solves M a + h = S u + τ + Kᵀ λ together with K a + K̇ v = -kd K v - kp r. With redundant rows, λ is the solution
    with the least norm, in units of the characteristic length.

    Pinocchio's proximal solver is used (Carpentier, Budhiraja, Mansard, *Proximal and sparse resolution of constrained
    dynamic equations*, 2021) if no joint mimics another, the closures are closed to 1e-9 and K v = 0, the dimensionless
    K Kᵀ has a condition number of at most 1e6, and the solution satisfies both equations to 1e-9; with distances and
    couplings, which it has no model for, it gives the terms of the equations. Otherwise the equations are solved by
    elimination, which is slower: redundant rows that differ by rounding would lock the mechanism, and Pinocchio needs
    inertia at every joint, even at one that the closures do not let move.

    M includes the armature. Limits of joints and motors are ignored.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed.
        v: Velocity (nv,), with K v = 0. A velocity that opens the closures is not corrected, except by ``gains``.
        u: Motor torques (nu,), in the order of the actuation, N·m and N; zero by default.
        tau: Additional generalized forces (nv,), N·m and N; the springs of joints act in any case.
        external: For frames of the model, by name, the force and moment (6,) that act at the frame's origin, in world
            axes, N and N·m.
        dissipation: Whether damping and dry friction of the joints act: -d v - f sign(v). Friction does not act at
            rest, since sign(0) = 0.
        gains: Baumgarte gains kp (1/s²) and kd (1/s), which close an open mechanism; kd = 2 √kp for critical damping.
            The default is the gains of the constraint models, which are zero unless set.
        data: A `pin.Data` of the model to compute in. By default one is kept with the robot for the next call. It takes
            64 nv³ bytes: a robot with more than 64 velocities is divided into limbs that share no closed loop, each
            with one of its own, and one with more than 130 that cannot be divided does without, joint by joint.

    Raises:
        ValueError: A vector has a wrong shape or is not finite, or a frame is unknown.
        UndeterminedMotion: A joint without inertia can move.
        NumericalOverflow: The result is not finite.
    """
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"), working_memory(robot, ForwardSolver) as solver:
        q, v = start(robot, q, "q"), velocity_of(robot, v)
        dynamics = solver.dynamics(data)
        force = AppliedForce(robot, external, dissipation).total(q, v, u, tau)
        a, lambdas = solver.solve(robot, q, v, force, solver.gains.given(gains), dynamics)
    return ForwardDynamics(a, Forces.of(solver, lambdas))


@overflow_refused("the motor torques")
def inverse_dynamics(
    robot: Robot,
    q: Named,
    v: Named,
    a: Named,
    *,
    tau: Named | None = None,
    external: External | None = None,
    dissipation: bool = False,
    weights: Named | None = None,
    u0: Named | None = None,
    tolerance: float = 1e-6,
    data: Any = None,
) -> InverseDynamics:
    """Motor torques for a motion of the closed mechanism, and the forces in its closures.

    Solves S u + Kᵀ λ = M a + h - τ. With N a basis of the free motions, K N = 0, the torques minimise Σ wᵢ (uᵢ - u0ᵢ)²
    subject to Nᵀ S u = Nᵀ (M a + h - τ); λ is the solution with the least norm, in units of the characteristic length.
    (Nakamura, Ghodoussi, *Dynamics computation of closed-link robot mechanisms with nonredundant and redundant
    actuators*, 1989.) It is the inverse of `forward_dynamics`.

    If, with the motors locked, the singular values of the dimensionless K all exceed 1e-4 times its norm, u and λ are
    the only solution. It is computed without N, and forward dynamics tell whether the motion is possible. Otherwise
    singular values decide, which is slower.

    A motion that opens the closures is refused: project it onto them first. A motion that the motors cannot produce is
    refused, too; `achievable_acceleration` returns the nearest one that they can produce.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed.
        v: Velocity (nv,), with K v = 0.
        a: Acceleration (nv,), with K a + K̇ v = 0.
        tau: As in `forward_dynamics`.
        external: As in `forward_dynamics`.
        dissipation: As in `forward_dynamics`.
        weights: w (nu,), positive; all 1 by default.
        u0: Motor torques (nu,) to change least, N·m and N; zero by default. If the motors are independent, there is
            only one solution, and they have no effect.
        tolerance: Accepted difference of v and a from the nearest ones that keep the closures closed, and of a from the
            nearest one that the motors can produce, relative to 1 plus the largest component (rad and s, or
            characteristic lengths).
        data: As in `forward_dynamics`.

    Raises:
        ValueError: A vector has a wrong shape or is not finite, a frame is unknown, or a weight is not positive.
        InconsistentMotion: v or a does not keep the closures closed.
        UnderactuatedMotion: The motors cannot produce this motion.
        NumericalOverflow: The result is not finite.
    """
    with working_memory(robot, ForwardSolver) as solver, working_memory(robot, InverseSolver) as inverse_solver:
        q, v, a, dynamics = _state(robot, q, v, a, solver, data)
        norm, tolerance = norm_of(robot, weights), checked_tolerance(tolerance)
        near = np.zeros(len(norm)) if u0 is None else motor_values_of(robot, u0, "u0")
        applied = AppliedForce(robot, external, dissipation).total(q, v, None, tau)
        found = inverse_solver.solve(solver, q, v, a, applied, tolerance, dynamics)
        if found is not None:
            u, lambdas = found
            return InverseDynamics(u, Forces.of(solver, lambdas))
        motion, S = EquationOfMotion(robot, q, v, dynamics), robot.actuation.selection
        motion.refuse_open(a, tolerance)
        force = motion.bias - applied
        inertial = motion.mass(a)
        deviation, missing = _uncontrolled(motion, inertial, force)
        _refuse_uncontrolled(motion, a, deviation, missing, tolerance)
        required = force + inertial
        u = near + motion.torques(required - S @ near, norm)
        forces = Forces.of(solver, motion.P.T @ (required - S @ u))
    finite("the motor torques", u, *forces)
    return InverseDynamics(u, forces)


@overflow_refused("the acceleration")
def achievable_acceleration(
    robot: Robot,
    q: Named,
    v: Named,
    a: Named,
    *,
    tau: Named | None = None,
    external: External | None = None,
    dissipation: bool = False,
    tolerance: float = 1e-6,
    data: Any = None,
) -> Vector:
    """The acceleration that the motors can produce, with the given accelerations of the motors.

    The uncontrolled motions follow from the dynamics: with U a basis of them, K U = 0 and Sᵀ U = 0, the result is
    a' = a + U z with Uᵀ (M a' + h - τ) = 0. By Gauss' principle it is the one nearest to the unconstrained
    acceleration. `inverse_dynamics` accepts the result.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed.
        v: Velocity (nv,), with K v = 0.
        a: Acceleration (nv,), with K a + K̇ v = 0.
        tau: As in `forward_dynamics`.
        external: As in `forward_dynamics`.
        dissipation: As in `forward_dynamics`.
        tolerance: As in `inverse_dynamics`, of the closures.
        data: As in `forward_dynamics`.

    Returns:
        a' (nv,), rad/s² and m/s².

    Raises:
        ValueError: A vector has a wrong shape or is not finite, or a frame is unknown.
        InconsistentMotion: v or a does not keep the closures closed.
        UnderactuatedMotion: A motion without inertia would need a force.
        NumericalOverflow: The result is not finite.
    """
    with working_memory(robot, ForwardSolver) as solver:
        q, v, a, dynamics = _state(robot, q, v, a, solver, data)
        motion = EquationOfMotion(robot, q, v, dynamics)
        motion.refuse_open(a, checked_tolerance(tolerance))
        force = motion.bias - AppliedForce(robot, external, dissipation).total(motion.q, motion.v, None, tau)
        deviation, missing = _uncontrolled(motion, motion.mass(a), force)
        if missing.any():
            raise UnderactuatedMotion(by_joint(robot.tree, missing), np.inf)
        achievable = a - deviation
    finite("the acceleration", achievable)
    return achievable


@overflow_refused("the mass matrix")
def mass_matrix(robot: Robot, q: Named, *, data: Any = None) -> Matrix:
    """Mass matrix M(q) of the spanning tree, the armature included: its kinetic energy is ½ vᵀ M v.

    It is computed by `pin.crba`, except for robots with mimic joints: up to Pinocchio 4.1, `pin.crba` has wrong entries
    if a mimic joint carries several branches. Their M is computed from the inverse dynamics, column by column:
    M eᵢ = rnea(q, 0, eᵢ) - rnea(q, 0, 0).

    Source: Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapter 6.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed or open.
        data: A `pin.Data` of the model to compute in; by default a new one is created, or none for more than 130
            velocities.

    Returns:
        M (nv, nv), symmetric, in kg between two velocities in m/s, kg·m between m/s and rad/s, kg·m² between two in
        rad/s.

    Raises:
        ValueError: ``q`` is not a configuration, or ``data`` is of another model.
        NumericalOverflow: M is not finite.
    """
    tree = robot.tree
    M = tree.dynamics(data).mass_times(start(robot, q, "q"), np.eye(tree.nv))
    symmetric = np.asarray(0.5 * (M + M.T))
    finite("the mass matrix", symmetric)
    return symmetric


def _state(
    robot: Robot, q: Named, v: Named, a: Named, solver: ForwardSolver, data: Any
) -> tuple[Vector, Vector, Vector, TreeDynamics]:
    """Configuration, velocity, acceleration and dynamics of the tree, all checked."""
    dynamics = solver.dynamics(data)
    return start(robot, q, "q"), velocity_of(robot, v), velocity_of(robot, a, "a"), dynamics


def _uncontrolled(motion: EquationOfMotion, inertial: Vector, force: Vector) -> tuple[Vector, Vector]:
    """The part of an acceleration that the motors cannot produce.

    Args:
        motion: The robot in motion.
        inertial: M a (nv,).
        force: h - τ (nv,).

    Returns:
        The deviation of a (nv,) along the uncontrolled motions, and the missing generalized force (nv,) along those of
        them that have no inertia.
    """
    Z = motion.uncontrolled
    if not Z.shape[1]:
        return np.zeros(len(force)), np.zeros(len(force))
    U = motion.unit[:, None] * Z
    inertia, axes = np.linalg.eigh(U.T @ motion.mass_along(U))
    massive = inertia > MASSLESS * np.einsum("ij,ij->j", motion.N, motion.mass_along(motion.N)).max()
    U = U @ axes
    along = U.T @ (inertial + force)
    terms = np.abs(U.T) @ (np.abs(inertial) + np.abs(force))
    unborne = np.where(massive | (np.abs(along) <= FORCES_SOLVED * terms), 0.0, along)
    deviation = U[:, massive] @ (along[massive] / inertia[massive])
    return deviation, Z @ (axes @ unborne) / motion.unit


def _refuse_uncontrolled(
    motion: EquationOfMotion, a: Vector, deviation: Vector, missing: Vector, tolerance: float
) -> None:
    tree = motion.robot.tree
    if missing.any():
        raise UnderactuatedMotion(by_joint(tree, missing), np.inf)
    if motion.differ(deviation, a, tolerance):
        # The least additional force that produces the motion.
        along = motion.uncontrolled
        force = along @ (along.T @ (motion.unit * motion.mass(deviation))) / motion.unit
        raise UnderactuatedMotion(by_joint(tree, force), float(np.abs(deviation / motion.unit).max()))


def norm_of(robot: Robot, weights: Named | None) -> Vector:
    """1/√w (nu,)."""
    if weights is None:
        return np.ones(len(robot.actuation.idx_v))
    given = motor_values_of(robot, weights, "weights", others=1.0)
    if not (given > 0.0).all():
        raise ValueError(f"weights[{int(np.argmin(given))}] is {given.min()}; expected positive numbers")
    return np.asarray(1.0 / np.sqrt(given))
