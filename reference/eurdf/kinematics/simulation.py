"""Simulation of the closed mechanism."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import assemble, start
from eurdf.kinematics.dynamics import External, forward_dynamics
from eurdf.kinematics.exceptions import NotClosable, SimulationDiverged
from eurdf.kinematics.finite import overflow_refused
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Motor torques (nu,) at a time (s), a configuration (nq,) and a velocity (nv,).
Control = Callable[[float, Vector, Vector], Vector]


# Velocities above this, rad/s or m/s, count as divergence.
_FASTEST = 1e9


class Simulation(NamedTuple):
    """The result of `simulate`, at equal time steps.

    Attributes:
        t: Times (n + 1,), s.
        q: Configurations (n + 1, nq).
        v: Velocities (n + 1, nv), rad/s and m/s.
    """

    t: Vector
    q: Matrix
    v: Matrix


def simulate(
    robot: Robot,
    q: Vector,
    v: Vector | None = None,
    *,
    duration: float,
    step: float = 1e-3,
    control: Control | None = None,
    external: External | None = None,
    dissipation: bool = False,
) -> Simulation:
    """Simulate the dynamics of the closed mechanism.

    Each step is a classical fourth-order Runge-Kutta step in the coordinates x of q ⊕ x around its start, in which
    ẋ = J(x)⁻¹ v with J the derivative of ⊕ (Munthe-Kaas). At the start and after each step, q and v are projected onto
    the closures, v by the least change in units of the characteristic length.

    Args:
        robot: The robot.
        q: Initial configuration (nq,); if it is open, `assemble` closes it first.
        v: Initial velocity (nv,); zero by default.
        duration: Simulated time, s, rounded to a whole number of steps.
        step: Time step, s.
        control: The motor torques; zero by default.
        external: As in `forward_dynamics`, constant in time.
        dissipation: As in `forward_dynamics`. A step in which dry friction changes sign is only first-order accurate.

    Raises:
        NotClosable: No closed configuration was found near q.
        ValueError: A vector has a wrong shape or is not finite, the duration is negative, or the step is not positive.
        UndeterminedMotion: A joint without inertia can move.
        SimulationDiverged: The steps are too long for the motion.
        NumericalOverflow: As in `forward_dynamics`.
    """
    if not (step > 0.0 and duration >= 0.0 and np.isfinite(duration / step)):
        raise ValueError("duration must be at least 0 s, and step above 0 s")
    tree, data, spaces = robot.tree, robot.tree.memory(), TangentSpaces(robot)
    count = round(duration / step)
    times: Vector = np.linspace(0.0, count * step, count + 1)
    qs, vs = np.empty((count + 1, tree.nq)), np.empty((count + 1, tree.nv))
    assembly = assemble(robot, start(robot, q, "q"))
    if not assembly.closes:
        raise NotClosable("the simulation cannot start from an open configuration", assembly.open, assembly.q)

    def rates(t: float, begin: Vector, x: Vector, v: Vector) -> tuple[Vector, Vector]:
        q = tree.integrate(begin, x)
        if not (np.abs(v).max(initial=0.0) < _FASTEST and np.isfinite(q).all()):
            raise SimulationDiverged(t, step)
        u = None if control is None else control(t, q, v)
        a = forward_dynamics(robot, q, v, u, external=external, dissipation=dissipation, data=data).a
        return np.asarray(np.linalg.solve(tree.integrate_derivative(begin, x), v), dtype=np.float64), a

    @overflow_refused("the configuration")
    def closed(t: float, q: Vector, v: Vector, newton_steps: int) -> tuple[Vector, Vector]:
        for _ in range(newton_steps):
            r, K = residual_and_jacobian(robot, q, data)
            q = tree.normalized(tree.integrate(q, -spaces.at(K).inverse @ r))
            if not np.isfinite(q).all():
                raise SimulationDiverged(t, step)
        _, K = residual_and_jacobian(robot, q, data)
        return q, v - spaces.at(K).inverse @ (K @ v)

    initial = checked_array("v", np.zeros(tree.nv) if v is None else v, (tree.nv,))
    qs[0], vs[0] = closed(0.0, assembly.q, initial, 0)
    for n in range(count):
        t, q, v, still = float(times[n]), qs[n], vs[n], np.zeros(tree.nv)
        x1, v1 = rates(t, q, still, v)
        x2, v2 = rates(t + step / 2.0, q, step / 2.0 * x1, v + step / 2.0 * v1)
        x3, v3 = rates(t + step / 2.0, q, step / 2.0 * x2, v + step / 2.0 * v2)
        x4, v4 = rates(t + step, q, step * x3, v + step * v3)
        end = tree.integrate(q, step / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4))
        v = v + step / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4)
        if not (np.isfinite(end).all() and np.isfinite(v).all()):
            raise SimulationDiverged(float(times[n + 1]), step)
        qs[n + 1], vs[n + 1] = closed(float(times[n + 1]), np.asarray(end), v, 2)
    return Simulation(times, qs, vs)
