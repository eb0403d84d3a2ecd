"""Forward and inverse dynamics of the closed mechanism.

The equation of motion and the second derivative of the closures are

    M(q) a + h(q, v) = S u + τ + τ_s(q) + Kᵀ λ,        K(q) a + K̇(q, v) v = 0,

with τ_s the force of the springs (`eurdf.kinematics.springs`), which always acts and is part of τ in what follows, and
K the derivative of the residual of `eurdf.kinematics.residual`. The forces λ of a closure are conjugate to its
rows: λᵀ K v is their power. At a closed configuration (EU-CLO-008, EU-CLO-009) they are the force (N), and for a 6d
closure also the moment (N·m), that act at frame A on the body of B, in the axes of A. The opposite acts on the body of
A, which is Pinocchio's ``contact_force``.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import start
from eurdf.kinematics.derived import derived
from eurdf.kinematics.exceptions import InconsistentMotion, UnderactuatedMotion, UndeterminedMotion
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.loop import Loop, find_loops
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import acceleration_drift, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tree_kinematics import TreeKinematics
from eurdf.pinocchio.arguments import checked_array, checked_data, checked_tolerance
from eurdf.pinocchio.constraint import NoConstraintModel
from eurdf.pinocchio.frame_index import frame_index

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Forces and moments at frames, by frame name: six numbers each, or a `pin.Force`.
External = Mapping[str, ArrayLike]

# Accepted error of Pinocchio's solver in either equation, relative to the largest term.
_SOLVED = 1e-9

# An inertia below this, relative to the largest one of a free motion, counts as zero.
_MASSLESS = 1e-14

# μ regularizes only the first step of the solver; after the following steps the result does not depend on it.
_MU, _MOST_PROXIMAL_STEPS = 1e-8, 50


class ForwardDynamics(NamedTuple):
    """The result of `forward_dynamics`.

    Attributes:
        a: Acceleration (nv,), rad/s² and m/s².
        forces: λ of each closure, in file order: (3,) N, or (6,) N and N·m; see the docstring of the module.
    """

    a: Vector
    forces: tuple[Vector, ...]


class InverseDynamics(NamedTuple):
    """The result of `inverse_dynamics`.

    Attributes:
        u: Motor torques (nu,), in the order of the actuation, N·m and N.
        forces: λ of each closure, in file order: (3,) N, or (6,) N and N·m; see the docstring of the module.
    """

    u: Vector
    forces: tuple[Vector, ...]


def forward_dynamics(
    robot: Robot,
    q: Vector,
    v: Vector,
    u: Vector | None = None,
    *,
    tau: Vector | None = None,
    external: External | None = None,
    dissipation: bool = False,
    gains: tuple[float, float] | None = None,
    data: Any = None,
) -> ForwardDynamics:
    """Acceleration of the closed mechanism, and the forces in its closures.

    Solves M a + h = S u + τ + Kᵀ λ together with K a + K̇ v = -kd K v - kp r, through Pinocchio's proximal solver
    (Carpentier, Budhiraja, Mansard, *Proximal and sparse resolution of constrained dynamic equations*, 2021).
    With redundant rows, λ is the solution with the least norm, in units of the characteristic length.

    Pinocchio's solver does not support mimic joints. It needs inertia at every joint, even at one that the closures do
    not let move. And it treats redundant rows that differ by rounding as independent rows, which lock the mechanism. So
    its solution is used only if it satisfies both equations to 1e-9 with the rank of K that `analyze` finds. Otherwise
    the equations are solved by elimination.

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
        data: A `pin.Data` of the model to compute in; by default a new one is created.

    Raises:
        ValueError: A vector has a wrong shape or is not finite, or a frame is unknown.
        UndeterminedMotion: A joint without inertia can move.
        NumericalOverflow: The result is not finite.
    """
    with overflow_refused("the acceleration"):
        solved = _forward_dynamics(robot, q, v, u, tau, external, dissipation, gains, data)
    finite("the acceleration", solved.a, *solved.forces)
    return solved


def _forward_dynamics(
    robot: Robot,
    q: Vector,
    v: Vector,
    u: Vector | None,
    tau: Vector | None,
    external: External | None,
    dissipation: bool,
    gains: tuple[float, float] | None,
    data: Any,
) -> ForwardDynamics:
    motion = _Motion(robot, q, v, data)
    force = motion.applied(u, tau, external, dissipation)
    constraint_models, kp, kd = _stabilised(robot, None if gains is None else checked_array("gains", gains, (2,)))
    target = -motion.drift - kd * (motion.K @ motion.v) - kp * motion.r
    if len(target) and constraint_models is not None and not len(robot.model.mimicking_joints):
        solved = _proximal(motion, constraint_models, force, target)
        if solved is not None:
            return solved
    return _eliminate(motion, force, target)


def inverse_dynamics(
    robot: Robot,
    q: Vector,
    v: Vector,
    a: Vector,
    *,
    tau: Vector | None = None,
    external: External | None = None,
    dissipation: bool = False,
    weights: Vector | None = None,
    tolerance: float = 1e-6,
    data: Any = None,
) -> InverseDynamics:
    """Motor torques for a motion of the closed mechanism, and the forces in its closures.

    Solves S u + Kᵀ λ = M a + h - τ. With N a basis of the free motions, K N = 0, the torques minimise Σ wᵢ uᵢ² subject
    to Nᵀ S u = Nᵀ (M a + h - τ); λ is the solution with the least norm, in units of the characteristic length.
    (Nakamura, Ghodoussi, *Dynamics computation of closed-link robot mechanisms with nonredundant and redundant
    actuators*, 1989.) It is the inverse of `forward_dynamics`.

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
    with overflow_refused("the motor torques"):
        motion = _Motion(robot, q, v, data)
        a = checked_array("a", a, (robot.model.nv,))
        S, norm = robot.actuation.selection, _norm(robot, weights)
        motion.refuse_open(a, checked_tolerance(tolerance))
        force = motion.bias - motion.applied(None, tau, external, dissipation)
        inertial = motion.mass(a)
        deviation, missing = _uncontrolled(motion, inertial, force)
        _refuse_uncontrolled(motion, a, deviation, missing, tolerance)
        required = force + inertial
        controlled, _ = motion.by_motors
        along = controlled.T @ motion.N.T
        u = norm * (np.linalg.pinv(along @ S * norm) @ (along @ required))
        forces = _per_closure(motion.loops, motion.P.T @ (required - S @ u))
    finite("the motor torques", u, *forces)
    return InverseDynamics(u, forces)


def achievable_acceleration(
    robot: Robot,
    q: Vector,
    v: Vector,
    a: Vector,
    *,
    tau: Vector | None = None,
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
    with overflow_refused("the acceleration"):
        motion = _Motion(robot, q, v, data)
        a = checked_array("a", a, (robot.model.nv,))
        motion.refuse_open(a, checked_tolerance(tolerance))
        force = motion.bias - motion.applied(None, tau, external, dissipation)
        deviation, missing = _uncontrolled(motion, motion.mass(a), force)
        if missing.any():
            raise UnderactuatedMotion(_by_joint(robot.tree, missing), np.inf)
        achievable = a - deviation
    finite("the acceleration", achievable)
    return achievable


class _Motion:
    """The terms of the equations of motion at a configuration and velocity.

    Attributes:
        r: Residual (nc,).
        K: Its derivative (nc, nv).
        drift: K̇ v (nc,).
        P: Pseudoinverse of K (nv, nc): P b is the x with K x = b of least norm, Pᵀ f the λ with Kᵀ λ = f of least norm,
            in units of the characteristic length.
        unit: Unit (nv,) of each velocity: a characteristic length, or 1.
        bias: h (nv,).
    """

    def __init__(self, robot: Robot, q: Vector, v: Vector, data: Any) -> None:
        model = robot.model
        self.robot = robot
        self.q = start(robot, q, "q")
        self.v = checked_array("v", v, (model.nv,))
        self.data = checked_data(model, data)
        self.loops = find_loops(robot)
        self.r, self.K = residual_and_jacobian(robot, self.q, self.data)
        self.drift = acceleration_drift(robot, self.q, self.v, self.data)
        spaces = derived(robot, TangentSpaces)
        space = spaces.at(self.K)
        self.P, self.unit, self._basis = space.inverse, spaces.scale, space.basis
        self.bias: Vector = robot.tree.inverse_dynamics(self.q, self.v, np.zeros(model.nv), self.data)
        finite("the equation of motion", self.r, self.drift, self.bias, self.P)

    @cached_property
    def free(self) -> Matrix:
        """Basis (nv, f) of the free motions, orthonormal in the units of the velocities."""
        return np.linalg.qr(self._basis / self.unit[:, None])[0]

    @cached_property
    def N(self) -> Matrix:  # noqa: N802 - the field's own symbol
        """The same in rad/s and m/s: K N = 0."""
        return self.unit[:, None] * self.free

    @cached_property
    def by_motors(self) -> tuple[Matrix, Matrix]:
        """Orthonormal bases, (f, k) and (f, f - k), of the controlled and of the uncontrolled free motions.

        The rank k is the `numerical_rank`. With the second, Z, no motor moves along N Z.
        """
        S = self.robot.actuation.selection
        if not S.shape[1]:
            return np.zeros((self.N.shape[1], 0)), np.eye(self.N.shape[1])
        basis, values, _ = np.linalg.svd(self.free.T @ S)
        rank = numerical_rank(values, values.max(initial=0.0))
        return basis[:, :rank], basis[:, rank:]

    def differ(self, change: Vector, given: Vector, tolerance: float) -> bool:
        """Whether a change of a velocity or acceleration (nv,) exceeds tolerance · (1 + its largest entry)."""
        largest = np.abs(change / self.unit).max(initial=0.0)
        return bool(largest > tolerance * (1.0 + np.abs(given / self.unit).max(initial=0.0)))

    def mass(self, a: Vector) -> Vector:
        """M a, including the armature."""
        return self.robot.tree.inverse_dynamics(self.q, self.v, a, self.data) - self.bias

    def mass_along(self, motions: Matrix) -> Matrix:
        """M times the columns (nv, n)."""
        return self.robot.tree.mass_times(self.q, motions, self.data)

    def applied(self, u: Vector | None, tau: Vector | None, external: External | None, dissipation: bool) -> Vector:
        """Generalized force (nv,) of springs, motors, external forces, damping and friction."""
        force = applied_force(self.robot, self.q, self.v, u, external, dissipation, self.data)
        force += self.robot.tree.springs.force(self.q, len(force))
        return force if tau is None else force + checked_array("tau", tau, (len(force),))

    def refuse_open(self, a: Vector, tolerance: float) -> None:
        """Raise `InconsistentMotion` if v or a would open the closures."""
        for order, opening, given in (
            ("velocity", self.K @ self.v, self.v),
            ("acceleration", self.K @ a + self.drift, a),
        ):
            change = self.P @ opening  # without the rounding errors of redundant rows
            if self.differ(change, given, tolerance):
                opening = self.K @ change
                least = 1e-3 * np.abs(opening).max()
                rows = zip(self.robot.constraints, _per_closure(self.loops, opening), strict=True)
                opened = {
                    constraint.name: tuple(own.tolist()) for constraint, own in rows if (np.abs(own) > least).any()
                }
                raise InconsistentMotion(order, opened)


def _proximal(motion: _Motion, constraint_models: Any, force: Vector, target: Vector) -> ForwardDynamics | None:
    """The solution of Pinocchio's solver; None if it does not satisfy the equations.

    Force components along rows that are redundant in P are removed.
    """
    model, data = motion.robot.model, motion.data
    constraint_datas = pin.StdVec_RigidConstraintData()
    for constraint in constraint_models:
        constraint_datas.append(constraint.createData())
    pin.initConstraintDynamics(model, data, constraint_models, constraint_datas)
    settings = pin.ProximalSettings(1e-14, 1e-14, _MU, _MOST_PROXIMAL_STEPS)
    a = np.array(
        pin.constraintDynamics(model, data, motion.q, motion.v, force, constraint_models, constraint_datas, settings)
    )
    on_a = [
        found.contact_force.vector[: loop.rows.stop - loop.rows.start]
        for found, loop in zip(constraint_datas, motion.loops, strict=True)
    ]
    K, P = motion.K, motion.P
    lambdas = -P.T @ (K.T @ np.concatenate(on_a))
    if not (np.isfinite(a).all() and np.isfinite(lambdas).all()):
        return None
    inertial = motion.mass(a)
    terms = max(np.abs(part).max(initial=0.0) for part in (inertial, motion.bias, force))
    wrong = np.abs(inertial + motion.bias - force - K.T @ lambdas).max()
    opening, moved = K @ (P @ (K @ a - target)), np.abs(K) @ np.abs(a) + np.abs(target)
    if wrong > _SOLVED * terms or np.abs(opening).max() > _SOLVED * moved.max():
        return None
    return ForwardDynamics(a, _per_closure(motion.loops, lambdas))


def _eliminate(motion: _Motion, force: Vector, target: Vector) -> ForwardDynamics:
    """Solve the equations in the free motions: a = P b + N z, with Nᵀ M N z = Nᵀ (τ - h - M P b)."""
    N, P = motion.N, motion.P
    a = P @ target
    MN = motion.mass_along(N)
    required = force - motion.bias - motion.mass(a)
    inertia, axes = np.linalg.eigh(N.T @ MN)
    massless = inertia <= _MASSLESS * inertia.max(initial=0.0)
    if massless.any():
        motions = N @ axes[:, massless]
        raise UndeterminedMotion(tuple(_by_joint(motion.robot.tree, np.abs(motions).max(axis=1))))
    z = axes @ ((axes.T @ (N.T @ required)) / inertia)
    lambdas = P.T @ (MN @ z - required)
    return ForwardDynamics(a + N @ z, _per_closure(motion.loops, lambdas))


def _uncontrolled(motion: _Motion, inertial: Vector, force: Vector) -> tuple[Vector, Vector]:
    """The part of an acceleration that the motors cannot produce.

    Args:
        motion: The robot in motion.
        inertial: M a (nv,).
        force: h - τ (nv,).

    Returns:
        The deviation of a (nv,) along the uncontrolled motions, and the missing generalized force (nv,) along those of
        them that have no inertia.
    """
    _, Z = motion.by_motors
    if not Z.shape[1]:
        return np.zeros(len(force)), np.zeros(len(force))
    free_inertia = motion.N.T @ motion.mass_along(motion.N)
    inertia, axes = np.linalg.eigh(Z.T @ free_inertia @ Z)
    massive = inertia > _MASSLESS * np.diagonal(free_inertia).max()
    U = motion.N @ Z @ axes
    along = U.T @ (inertial + force)
    terms = np.abs(U.T) @ (np.abs(inertial) + np.abs(force))
    unborne = np.where(massive | (np.abs(along) <= _SOLVED * terms), 0.0, along)
    deviation = U[:, massive] @ (along[massive] / inertia[massive])
    return deviation, motion.free @ (Z @ (axes @ unborne)) / motion.unit


def _refuse_uncontrolled(motion: _Motion, a: Vector, deviation: Vector, missing: Vector, tolerance: float) -> None:
    tree = motion.robot.tree
    if missing.any():
        raise UnderactuatedMotion(_by_joint(tree, missing), np.inf)
    if motion.differ(deviation, a, tolerance):
        # The least additional force that produces the motion.
        along = motion.free @ motion.by_motors[1]
        force = along @ (along.T @ (motion.unit * motion.mass(deviation))) / motion.unit
        raise UnderactuatedMotion(_by_joint(tree, force), float(np.abs(deviation / motion.unit).max()))


def _stabilised(robot: Robot, gains: Vector | None) -> tuple[Any, Vector, Vector]:
    """The constraint models with their Baumgarte gains, and these for each row, kp (nc,) and kd (nc,).

    Where Pinocchio does not have a kind, there are none, and the gains are those given, or zero.
    """
    try:
        own = robot.constraint_models
    except NoConstraintModel:
        kp, kd = (0.0, 0.0) if gains is None else gains
        nc = sum(constraint.rows for constraint in robot.constraints)
        return None, np.full(nc, float(kp)), np.full(nc, float(kd))
    constraint_models, kps, kds = pin.StdVec_RigidConstraintModel(), [], []
    for constraint_model, constraint in zip(own, robot.constraints, strict=True):
        if gains is not None:
            constraint_model = pin.RigidConstraintModel(constraint_model)
            parameters = constraint_model.m_baumgarte_parameters
            parameters.Kp, parameters.Kd = map(float, gains)
        constraint_models.append(constraint_model)
        kps += [constraint_model.m_baumgarte_parameters.Kp] * constraint.rows
        kds += [constraint_model.m_baumgarte_parameters.Kd] * constraint.rows
    return constraint_models, np.array(kps), np.array(kds)


def applied_force(
    robot: Robot, q: Vector, v: Vector, u: Vector | None, external: External | None, dissipation: bool, data: Any
) -> Vector:
    """Generalized force (nv,) of motors, external forces, damping and friction, as in `forward_dynamics`."""
    model, S = robot.model, robot.actuation.selection
    force: Vector = np.zeros(model.nv)
    if u is not None:
        force += S @ checked_array("u", u, (S.shape[1],))
    if external:
        at_joints, still = _at_joints(model, data, q, external), np.zeros(model.nv)
        force += pin.rnea(model, data, q, still, still) - pin.rnea(model, data, q, still, still, at_joints)
    if dissipation:
        force -= model.damping * v + model.upperDryFrictionLimit * np.sign(v)
    return force


def _at_joints(model: Any, data: Any, q: Vector, external: External) -> Any:
    """The forces at frames as Pinocchio needs them: at each joint, in the joint's axes."""
    pin.forwardKinematics(model, data, q)
    forces = [pin.Force.Zero() for _ in range(model.njoints)]
    for name, given in external.items():
        frame = model.frames[frame_index(model, name)]
        joint = frame.parentJoint
        values = given.vector if isinstance(given, pin.Force) else given
        upright = pin.SE3(data.oMi[joint].rotation.T, frame.placement.translation)
        forces[joint] += upright.act(pin.Force(checked_array(f"external['{name}']", values, (6,))))
    at_joints = pin.StdVec_Force()
    for force in forces:
        at_joints.append(force)
    return at_joints


def _norm(robot: Robot, weights: Vector | None) -> Vector:
    """1/√w (nu,)."""
    nu = robot.actuation.selection.shape[1]
    if weights is None:
        return np.ones(nu)
    given = checked_array("weights", weights, (nu,))
    if not (given > 0.0).all():
        raise ValueError(f"weights[{int(np.argmin(given))}] is {given.min()}; expected positive numbers")
    return np.asarray(1.0 / np.sqrt(given))


def _per_closure(loops: tuple[Loop, ...], lambdas: Vector) -> tuple[Vector, ...]:
    return tuple(lambdas[loop.rows] for loop in loops)


def _by_joint(tree: TreeKinematics, values: Vector) -> dict[str, tuple[float, ...]]:
    """The values (nv,) by joint name, for the joints that have a value above rounding."""
    least = 1e-6 * np.abs(values).max(initial=0.0)
    found, names = {}, tree.velocity_names
    for v in tree.own_velocities:
        own = values[v.start : v.stop]
        if (np.abs(own) > least).any():
            found[names[v.start]] = tuple(own.tolist())
    return found
