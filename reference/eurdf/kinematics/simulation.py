"""Simulation of the closed mechanism."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.kinematics.applied_force import AppliedForce, External
from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import assemble, start
from eurdf.kinematics.dynamics import forward_dynamics
from eurdf.kinematics.exceptions import NotClosable, SimulationDiverged, StepTooLongWarning
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

# Energy error, relative to the energy exchanged, above which the step is too long, and that of the step suggested.
_TOO_LONG, _SHORT_ENOUGH = 1e-2, 1e-3

# Errors below this, relative to the largest energy, are rounding.
_ROUNDING = 1e-9


class Simulation(NamedTuple):
    """The result of `simulate`, at equal time steps.

    Attributes:
        t: Times (n + 1,), s.
        q: Configurations (n + 1, nq).
        v: Velocities (n + 1, nv), rad/s and m/s.
        kinetic: Kinetic energy (n + 1,), J, that of the armature included.
        potential: Potential energy (n + 1,), J, of gravity and springs.
        work: Work of motors, external forces, damping and friction since the start (n + 1,), J.
    """

    t: Vector
    q: Matrix
    v: Matrix
    kinetic: Vector
    potential: Vector
    work: Vector

    @property
    def energy_error(self) -> float:
        """Largest difference between the energy gained since the start and the work done, J.

        It is the error of the integration: the exact motion has none.
        """
        energy = self.kinetic + self.potential
        return float(np.abs(energy - energy[0] - self.work).max())

    @property
    def energy_exchanged(self) -> float:
        """The largest range of kinetic energy, potential energy and work, J: what `energy_error` compares with."""
        return float(max(np.ptp(part) for part in (self.kinetic, self.potential, self.work)))


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

    The result states the energy error. Above 1 % of the energy exchanged, the step is too long, and a
    `StepTooLongWarning` suggests a shorter one.

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
    applied = AppliedForce(robot, external, dissipation)
    count = round(duration / step)
    times: Vector = np.linspace(0.0, count * step, count + 1)
    qs, vs = np.empty((count + 1, tree.nq)), np.empty((count + 1, tree.nv))
    kinetic, potential, work = np.zeros((3, count + 1))
    assembly = assemble(robot, start(robot, q, "q"))
    if not assembly.closes:
        raise NotClosable("the simulation cannot start from an open configuration", assembly.open, assembly.q)

    def rates(t: float, begin: Vector, x: Vector, v: Vector) -> tuple[Vector, Vector, float]:
        q = tree.integrate(begin, x)
        if not (np.abs(v).max(initial=0.0) < _FASTEST and np.isfinite(q).all()):
            raise SimulationDiverged(t, step)
        u = None if control is None else control(t, q, v)
        a = forward_dynamics(robot, q, v, u, external=external, dissipation=dissipation, data=data).a
        power = float(applied.at(q, v, u) @ v)
        return np.asarray(np.linalg.solve(tree.integrate_derivative(begin, x), v), dtype=np.float64), a, power

    @overflow_refused("the configuration")
    def closed(t: float, q: Vector, v: Vector, newton_steps: int) -> tuple[Vector, Vector]:
        for _ in range(newton_steps):
            r, K = residual_and_jacobian(robot, q)
            q = tree.normalized(tree.integrate(q, -spaces.at(K).inverse @ r))
            if not np.isfinite(q).all():
                raise SimulationDiverged(t, step)
        _, K = residual_and_jacobian(robot, q)
        return q, v - spaces.at(K).inverse @ (K @ v)

    def energies(q: Vector, v: Vector) -> tuple[float, float]:
        with np.errstate(over="ignore", invalid="ignore"):  # energies beyond all numbers are not warned of
            momentum = tree.mass_times(q, v[:, None], data)[:, 0]
            return 0.5 * float(v @ momentum), tree.potential_energy(q, data)

    initial = checked_array("v", np.zeros(tree.nv) if v is None else v, (tree.nv,))
    qs[0], vs[0] = closed(0.0, assembly.q, initial, 0)
    kinetic[0], potential[0] = energies(qs[0], vs[0])
    for n in range(count):
        t, q, v, still = float(times[n]), qs[n], vs[n], np.zeros(tree.nv)
        x1, v1, p1 = rates(t, q, still, v)
        x2, v2, p2 = rates(t + step / 2.0, q, step / 2.0 * x1, v + step / 2.0 * v1)
        x3, v3, p3 = rates(t + step / 2.0, q, step / 2.0 * x2, v + step / 2.0 * v2)
        x4, v4, p4 = rates(t + step, q, step * x3, v + step * v3)
        end = tree.integrate(q, step / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4))
        v = v + step / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4)
        if not (np.isfinite(end).all() and np.isfinite(v).all()):
            raise SimulationDiverged(float(times[n + 1]), step)
        qs[n + 1], vs[n + 1] = closed(float(times[n + 1]), np.asarray(end), v, 2)
        kinetic[n + 1], potential[n + 1] = energies(qs[n + 1], vs[n + 1])
        work[n + 1] = work[n] + step / 6.0 * (p1 + 2.0 * p2 + 2.0 * p3 + p4)
    simulation = Simulation(times, qs, vs, kinetic, potential, work)
    _warn_of_long_step(simulation, step)
    return simulation


def _warn_of_long_step(simulation: Simulation, step: float) -> None:
    error, exchanged = simulation.energy_error, simulation.energy_exchanged
    largest = max(float(np.abs(part).max()) for part in (simulation.kinetic, simulation.potential, simulation.work))
    if error > _TOO_LONG * exchanged and error > _ROUNDING * largest:
        # The error of a fourth-order method falls with the fourth power of the step.
        suggested = step * (_SHORT_ENOUGH * exchanged / error) ** 0.25
        warnings.warn(StepTooLongWarning(error, exchanged, step, suggested), stacklevel=3)
