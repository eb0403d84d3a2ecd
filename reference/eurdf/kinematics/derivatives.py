"""Exact derivatives of the dynamics of the closed mechanism.

With F = M a + h - τ - Kᵀ λ and C = K a + K̇ v + kd K v + kp r, both zero, and ∂F and ∂C those of
`eurdf.kinematics.variation`, the changes of a and λ solve M ∂a - Kᵀ ∂λ = -∂F and K ∂a = -∂C: the equations of the
dynamics themselves, with other right-hand sides. One factorization serves all of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.applied_force import AppliedForce
from eurdf.kinematics.closing import start
from eurdf.kinematics.dynamics import inverse_dynamics, norm_of
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.forward_solver import ForwardSolver
from eurdf.kinematics.named import Named, velocity_of
from eurdf.kinematics.rank import certain_inverse, every, inverses, norms, numerical_rank, times
from eurdf.kinematics.residual import all_constraints
from eurdf.kinematics.sensitivity import dq_dq_actuated
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED
from eurdf.kinematics.variation import MotionState, Structure, Variation
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot
    from eurdf.pinocchio.tree_dynamics import TreeDynamics


class DynamicsDerivatives(NamedTuple):
    """The result of `dynamics_derivatives`; rows of λ are those of all constraints, one after the other.

    Derivatives by q are along q ⊕ δq, in the units of v.

    Attributes:
        a: Acceleration (nv,), rad/s² and m/s².
        lambdas: Forces λ (nc,) of the constraints, N and N·m.
        a_q: ∂a/∂q (nv, nv).
        a_v: ∂a/∂v (nv, nv).
        a_u: ∂a/∂u (nv, nu).
        a_tau: ∂a/∂τ (nv, nv), symmetric.
        lambda_q: ∂λ/∂q (nc, nv).
        lambda_v: ∂λ/∂v (nc, nv).
        lambda_u: ∂λ/∂u (nc, nu).
        lambda_tau: ∂λ/∂τ (nc, nv).
    """

    a: Matrix
    lambdas: Matrix
    a_q: Matrix
    a_v: Matrix
    a_u: Matrix
    a_tau: Matrix
    lambda_q: Matrix
    lambda_v: Matrix
    lambda_u: Matrix
    lambda_tau: Matrix

    def __repr__(self) -> str:
        (nc, nv), nu = self.lambda_q.shape[-2:], self.a_u.shape[-1]
        return f"<DynamicsDerivatives: of a ({nv},) and λ ({nc},), by q, v and τ ({nv},) and u ({nu},)>"


class DerivativesTask(NamedTuple):
    """What is the same for all states; see `dynamics_derivatives`.

    If redundant rows may contradict each other (not ``closed``), the derivatives lack how this changes.
    """

    robot: Robot
    gains: tuple[float, float] | None
    dissipation: bool
    closed: bool = True


def dynamics_derivatives(
    robot: Robot,
    q: Named,
    v: Named,
    u: Named | None = None,
    *,
    tau: Named | None = None,
    gains: tuple[float, float] | None = None,
    dissipation: bool = False,
) -> DynamicsDerivatives:
    """Derivatives of `forward_dynamics`, exact for every kind of constraint and of joint.

    They are those of the function: also along motions that open the loops, and at open configurations. With ``gains``,
    they contain those of kp r and kd K v. Redundant rows of K must not contradict each other, as those of closed loops
    with K v = 0; λ, of least norm, changes as the range of K turns.

    The derivative of dry friction is taken as zero. That of a force by the angle of a spring is its stiffness.

    Sources: Carpentier, Mansard, *Analytical derivatives of rigid body dynamics algorithms*, 2018, for the method of
    derivatives in place of differences; Golub, Pereyra, *The differentiation of pseudo-inverses*, 1973, for redundant
    rows.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        v: Velocity (nv,).
        u: Motor torques (nu,), N·m and N; zero by default.
        tau: Additional generalized forces (nv,), N·m and N, that do not depend on q and v.
        gains: As in `forward_dynamics`.
        dissipation: As in `forward_dynamics`.

    Raises:
        ValueError: As in `forward_dynamics`; or redundant rows of K contradict each other, as the loops are open.
        UndeterminedMotion: A joint without inertia can move.
        NumericalOverflow: A result is not finite.
    """
    q, v = start(robot, q, "q"), velocity_of(robot, v)
    force = AppliedForce(robot, None, dissipation).total(q, v, u, tau)
    each = derivatives_at(DerivativesTask(robot, gains, dissipation), q[None], v[None], force[None])
    return DynamicsDerivatives(*(one[0] for one in each))


@overflow_refused("the derivatives")
def derivatives_at(task: DerivativesTask, q: Matrix, v: Matrix, forces: Matrix) -> tuple[Matrix, ...]:
    """What `DynamicsDerivatives` has, (B, …), at normalized q (B, nq), v and generalized forces (B, nv)."""
    robot, nv, motors = task.robot, v.shape[1], task.robot.actuation.idx_v
    if not len(q):
        nu, nc = len(motors), robot.mechanism.nc
        return np.empty((0, nv)), np.empty((0, nc)), *(np.empty((0, m, n)) for m in (nv, nc) for n in (nv, nv, nu, nv))
    with (
        working_memory(robot, ForwardSolver) as solver,
        working_memory(robot, _tree_dynamics) as dynamics,
        working_memory(robot, all_constraints) as constraints,
    ):
        given, structure = solver.gains.given(task.gains), robot.cached(Structure)
        found = [solver.solve(robot, *each, given, solver.own) for each in zip(q, v, forces, strict=True)]
        a, lambdas = np.array([each.a for each in found]), np.array([each.lambdas for each in found])
        gains = np.array(given).reshape(-1, 2)
        state = MotionState(structure, dynamics, constraints, q, v, a)
        vary = state.variation(lambdas, gains, dissipation=task.dissipation)
        response, inverse = _response(robot, vary)
        if inverse is not None and task.closed:
            kp, kd = gains.T[:, structure.constraint_of_row]
            C = times(vary.K, a) + constraints.drift(q, v) + kd * times(vary.K, v)
            _refuse_contradictions(C + kp * constraints.residual(constraints.at(q)), v, a)
    by_both = np.concatenate(
        (np.concatenate((vary.F_q, vary.F_v), axis=2), np.concatenate((vary.C_q, vary.C_v), axis=2)), axis=1
    )
    both, by_tau = response @ by_both, -response[:, :, :nv]
    if inverse is not None:
        both[:, nv:, :nv] += _turning_range(robot, state, vary.K, inverse, lambdas)
    finite("the derivatives", both, response)
    each = both[:, :, :nv], both[:, :, nv:], by_tau[:, :, motors], by_tau
    return a, lambdas, *(one[:, :nv] for one in each), *(one[:, nv:] for one in each)


class InverseDynamicsDerivatives(NamedTuple):
    """The result of `inverse_dynamics_derivatives`; rows of λ are those of all constraints, one after the other.

    Attributes:
        u: Motor torques (nu,), N·m and N.
        lambdas: Forces λ (nc,) of the constraints, N and N·m.
        u_q: ∂u/∂q (nu, nv).
        u_v: ∂u/∂v (nu, nv).
        u_a: ∂u/∂a (nu, nv).
        lambda_q: ∂λ/∂q (nc, nv).
        lambda_v: ∂λ/∂v (nc, nv).
        lambda_a: ∂λ/∂a (nc, nv).
    """

    u: Vector
    lambdas: Vector
    u_q: Matrix
    u_v: Matrix
    u_a: Matrix
    lambda_q: Matrix
    lambda_v: Matrix
    lambda_a: Matrix

    def __repr__(self) -> str:
        (nu, nv), nc = self.u_q.shape, len(self.lambda_q)
        return f"<InverseDynamicsDerivatives: of u ({nu},) and λ ({nc},), by q, v and a ({nv},)>"


@overflow_refused("the derivatives")
def inverse_dynamics_derivatives(
    robot: Robot,
    q: Named,
    v: Named,
    a: Named,
    *,
    tau: Named | None = None,
    dissipation: bool = False,
    weights: Named | None = None,
) -> InverseDynamicsDerivatives:
    """Derivatives of `inverse_dynamics` along motions that it accepts.

    These are those that stay closed: ∂q, ∂v and ∂a with K ∂q = 0, K ∂v + ∂(K v)/∂q ∂q = 0, and K ∂a + ∂C = 0, whose
    motions the motors can produce. In other directions the derivatives have no meaning.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed.
        v: Velocity (nv,), with K v = 0.
        a: Acceleration (nv,), with K a + K̇ v = 0.
        tau: As in `dynamics_derivatives`.
        dissipation: As in `forward_dynamics`.
        weights: As in `inverse_dynamics`.

    Raises:
        ValueError: As in `inverse_dynamics`.
        InconsistentMotion: v or a does not keep the closures closed.
        UnderactuatedMotion: The motors cannot produce this motion.
        NumericalOverflow: A result is not finite.
    """
    q, v, a = start(robot, q, "q"), velocity_of(robot, v), velocity_of(robot, a, "a")
    found = inverse_dynamics(robot, q, v, a, tau=tau, dissipation=dissipation, weights=weights)
    u, lambdas = found.u, np.concatenate((*found.forces, np.empty(0)))
    with working_memory(robot, _tree_dynamics) as dynamics, working_memory(robot, all_constraints) as constraints:
        state = MotionState(robot.cached(Structure), dynamics, constraints, q[None], v[None], a[None])
        vary = state.variation(lambdas[None], np.zeros((len(robot.constraints), 2)), dissipation=dissipation)
    (space,), norm, motors = robot.cached(TangentSpaces).each(vary.K), norm_of(robot, weights), robot.actuation.idx_v
    N, back = space.free[0], space.inverse[0]
    # With A = Nᵀ S, u = A⁺ Nᵀ F, and A turns with N: ∂N = -K⁺ ∂K N.
    A = N[motors].T * norm
    left, values, right = np.linalg.svd(A, full_matrices=False)
    unit = robot.cached(TangentSpaces).scale[motors, None]
    rank = numerical_rank(np.linalg.svd(N[motors] / unit, compute_uv=False))
    inverse = norm[:, None] * (right[:rank].T @ (left[:, :rank] / values[:rank]).T)
    by_all = np.concatenate((vary.F_q[0], vary.F_v[0], vary.M[0]), axis=1)
    of_u, nv = inverse @ (N.T @ by_all), len(v)
    if rank < len(motors):
        y = N @ (left[:, :rank] @ ((right[:rank] @ (u / norm)) / values[:rank]))
        turning = norm[:, None] * (back @ state.of_velocity(y[None])[0])[motors]
        of_u[:, :nv] -= norm[:, None] * (turning - right[:rank].T @ (right[:rank] @ turning))
    by_all[motors] -= of_u
    of_lambda = back.T @ by_all
    of_lambda[:, :nv] += _turning_range(robot, state, vary.K, space.inverse, lambdas[None])[0]
    finite("the derivatives", of_u, of_lambda)
    return InverseDynamicsDerivatives(u, lambdas, *np.split(of_u, 3, axis=1), *np.split(of_lambda, 3, axis=1))


@overflow_refused("the derivative")
def dq_dq_actuated_derivative(robot: Robot, q: Named) -> Matrix:
    """Derivative of the D of `dq_dq_actuated` along the motions D: how the closed motions bend.

    While the actuators move with constant velocities w, all joints have the velocity D w and the acceleration
    Σ H_ijk w_j w_k. Of uncontrolled motions, D has the least ones, and so has H those that keep them least.

    With L = [K; Sᵀ], D = L⁺ [0; 1], and H is -L⁺ ∂L D + (1 - L⁺ L) ∂Lᵀ L⁺ᵀ D along D (Golub, Pereyra 1973).

    Args:
        robot: The robot.
        q: A closed configuration (nq,).

    Returns:
        H (nv, nu, nu): of the column j of D along the motion of the actuator k, in rad, m and the units of D. It is
        symmetric in j and k for joints of one velocity; the velocities of others do not commute.

    Raises:
        DependentActuators: As in `dq_dq_actuated`.
        ValueError: ``q`` is not a configuration.
    """
    q = start(robot, q, "q")
    D, motors = dq_dq_actuated(robot, q), robot.actuation.idx_v
    still = np.zeros((1, len(D)))
    with working_memory(robot, _tree_dynamics) as dynamics, working_memory(robot, all_constraints) as constraints:
        state = MotionState(robot.cached(Structure), dynamics, constraints, q[None], still, still)
        K = constraints.jacobian(constraints.at(q[None]))[0]
        space = robot.cached(TangentSpaces).at(K)
        Z, back = space.basis, space.inverse
        _, _, right = np.linalg.svd(Z[motors])
        free = Z @ right[len(motors) :].T  # uncontrolled motions, orthonormal
        back = back - D @ back[motors]  # K⁺ with the actuators still, ...
        back -= free @ (free.T @ back)  # ... of least norm
        H = np.empty((len(D), len(motors), len(motors)))
        for index, x in enumerate(D.T):
            H[:, index] = -back @ (state.of_velocity(x[None])[0] @ D)
            if free.shape[1]:
                H[:, index] += free @ (free.T @ (state.of_forces((x @ back)[None])[0] @ D))
    finite("the derivative", H)
    return H


def _tree_dynamics(robot: Robot) -> TreeDynamics:
    return robot.tree.dynamics()


def _response(robot: Robot, vary: Variation) -> tuple[Matrix, Matrix | None]:
    """[∂a; ∂λ] over [∂F; ∂C] (B, nv + nc, nv + nc), and K⁺ (B, nv, nc) unless all rows of K are independent.

    With N a basis of the free motions and K⁺ the pseudoinverse, it is [-Γ, Λᵀ; -Λ, Δ], with Γ = N (Nᵀ M N)⁻¹ Nᵀ,
    Λ = K⁺ᵀ (M Γ - 1) and Δ = K⁺ᵀ M Λᵀ: but for signs the inverse of [M, Kᵀ; K, 0], if the rows are independent.
    """
    (B, nc, nv), spaces = vary.K.shape, robot.cached(TangentSpaces)
    A = vary.K * spaces.dimensionless
    response = np.zeros((B, nv + nc, nv + nc))
    if nc <= nv and every(certain_inverse(A @ A.swapaxes(1, 2), norms(A))[1]):
        response[:, :nv, :nv], response[:, :nv, nv:], response[:, nv:, :nv] = vary.M, vary.K.swapaxes(1, 2), vary.K
        response = inverses(response)
        response[:, :nv] *= -1.0
        return response, None
    inverse = np.empty((B, nv, nc))
    for space in spaces.each(vary.K):
        N, back, M = space.free, space.inverse.swapaxes(1, 2), vary.M[space.which]
        across = N.swapaxes(1, 2)
        inertia = N @ inverses(across @ M @ N) @ across
        of_force = back @ (M @ inertia - np.eye(nv))
        of_motion = np.concatenate((of_force.swapaxes(1, 2), back @ M @ of_force.swapaxes(1, 2)), axis=1)
        response[space.which] = np.concatenate((np.concatenate((-inertia, -of_force), axis=1), of_motion), axis=2)
        inverse[space.which] = space.inverse
    return response, inverse


def _refuse_contradictions(C: Matrix, v: Matrix, a: Matrix) -> None:
    """Refuse C (B, nc) that the a (B, nv) nearest to all rows leaves: redundant rows contradict each other."""
    left, motion = (np.abs(each).max(axis=1, initial=0.0) for each in (C, np.concatenate((a, v * v), axis=1)))
    if (left > CLOSED * (1.0 + motion)).any():
        raise ValueError(
            f"redundant rows of K contradict each other, by {left.max():.2g} (m/s², rad/s²), which leaves forward "
            "dynamics without derivatives; close the loops (eurdf.assemble), and project v (eurdf.project_velocity)"
        )


def _turning_range(robot: Robot, state: MotionState, K: Matrix, inverse: Matrix, lambdas: Matrix) -> Matrix:
    """What the turning of the range of K adds to ∂λ/∂q (B, nc, nv), of the λ (B, nc) of least norm.

    It is W (1 - K K⁺) ∂(K x)/∂q with x = K⁺ W⁻¹ λ, where W has the squares of the row scale: zero for independent rows.
    """
    weights = robot.cached(TangentSpaces).row_scale ** 2
    by_q = state.of_velocity(times(inverse, lambdas / weights))
    return np.asarray(weights[:, None] * (by_q - K @ (inverse @ by_q)))
