"""Simulation of the closed mechanism."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.errors import NotClosable, SimulationDiverged, StepTooLongWarning
from eurdf.kinematics.applied_force import AppliedForce, External
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.closing import start
from eurdf.kinematics.forward_solver import ForwardSolver
from eurdf.kinematics.independence import norm
from eurdf.kinematics.named import Named, velocity_of
from eurdf.kinematics.tangent_space import LeastSolutions, TangentSpaces
from eurdf.kinematics.tolerances import DIVERGED
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Motor torques (nu,) at a time (s), a configuration (nq,) and a velocity (nv,).
Control = Callable[[float, Vector, Vector], Named]


# Energy error, relative to the energy exchanged, above which the step is too long, and that of the step suggested.
_TOO_LONG, _SHORT_ENOUGH = 1e-2, 1e-3

# Norms of the residual, m and rad, up to which it stays as it is, and up to which one step with the K from before it
# corrects both q and v.
_CLOSED, _NEARLY_CLOSED = 1e-13, 1e-12

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

    def __repr__(self) -> str:
        return f"<Simulation: {self.t[-1]:.6g} s in {len(self.t) - 1} steps; energy error {self.energy_error:.3g} J>"


def simulate(
    robot: Robot,
    q: Named,
    v: Named | None = None,
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
    if not (0.0 < step < np.inf and 0.0 <= duration < np.inf and np.isfinite(duration / step)):
        raise ValueError("duration must be finite and at least 0 s, and step finite and above 0 s")
    tree = robot.tree
    count = round(duration / step)
    times: Vector = np.linspace(0.0, count * step, count + 1)
    qs, vs = np.empty((count + 1, tree.nq)), np.empty((count + 1, tree.nv))
    kinetic, potential, work = np.zeros((3, count + 1))
    assembly = assemble(robot, start(robot, q, "q"))
    if not assembly.closes:
        raise NotClosable("the simulation cannot start from an open configuration", assembly.open, assembly.q)
    callers = np.geterr()
    with working_memory(robot, ForwardSolver) as solver, np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        motion = _Integration(robot, solver, control, callers, AppliedForce(robot, external, dissipation), step)
        initial = velocity_of(robot, {} if v is None else v)
        qs[0], vs[0] = motion.closed(0.0, assembly.q, initial, 0)
        kinetic[0], potential[0] = motion.energies(qs[0], vs[0])
        for n in range(count):
            qs[n + 1], vs[n + 1], gained = motion.advanced(float(times[n]), qs[n], vs[n])
            work[n + 1] = work[n] + gained
            kinetic[n + 1], potential[n + 1] = motion.energies(qs[n + 1], vs[n + 1])
    simulation = Simulation(times, qs, vs, kinetic, potential, work)
    _warn_of_long_step(simulation, step)
    return simulation


class _Integration:
    """The motion of a robot, step by step."""

    def __init__(
        self,
        robot: Robot,
        solver: ForwardSolver,
        control: Control | None,
        callers: Mapping[str, Any],
        applied: AppliedForce,
        step: float,
    ) -> None:
        """Take what acts on a robot, and how the caller treats floating-point errors of NumPy."""
        self._robot, self._tree, self._solver = robot, robot.tree, solver
        self._control, self._callers, self._applied, self._step = control, callers, applied, step
        self._gains, self._dynamics = solver.gains.now(), solver.own
        self._least = LeastSolutions(robot.cached(TangentSpaces))
        self._nothing = np.zeros(robot.tree.nv)
        self._is_driven = control is not None or not applied.is_constant_zero

    def advanced(self, t: float, q: Vector, v: Vector) -> tuple[Vector, Vector, float]:
        """Configuration and velocity after a step from time t, and the work done meanwhile."""
        step, half, integrate = self._step, self._step / 2.0, self._tree.integrate
        x1, a1, p1 = self._rates(t, q, q, v, False)
        x2, a2, p2 = self._rates(t + half, q, integrate(q, half * x1), v + half * a1, True)
        x3, a3, p3 = self._rates(t + half, q, integrate(q, half * x2), v + half * a2, True)
        x4, a4, p4 = self._rates(t + step, q, integrate(q, step * x3), v + step * a3, True)
        end = integrate(q, step / 6.0 * (x1 + 2.0 * (x2 + x3) + x4))
        v = v + step / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
        if not (norm(end) < math.inf and norm(v) < math.inf):
            raise SimulationDiverged(t + step, step)
        return *self.closed(t + step, end, v, 2), step / 6.0 * (p1 + 2.0 * (p2 + p3) + p4)

    def _rates(self, t: float, begin: Vector, q: Vector, v: Vector, moved: bool) -> tuple[Vector, Vector, float]:
        """Rates of x and v at q = begin ⊕ x, and the power of what is applied; x is 0 unless ``moved``."""
        if not norm(v) < DIVERGED:
            raise SimulationDiverged(t, self._step)
        u, applied, power = None, self._nothing, 0.0
        if self._control is not None:
            with np.errstate(**self._callers):
                u = self._control(t, q, v)
        if self._is_driven:
            applied = self._applied.at(q, v, u)
            power = float(applied @ v)
        force = self._applied.with_springs(q, applied)
        a = self._solver.acceleration(self._robot, q, v, force, self._gains, within_step=moved)
        if moved and not self._tree.commutes:
            # The derivative of x = q ⊖ begin is the inverse of that of begin ⊕ x.
            return self._tree.difference_derivative(begin, q).dot(v), a, power
        return v, a, power

    def closed(self, t: float, q: Vector, v: Vector, newton_steps: int) -> tuple[Vector, Vector]:
        """The nearest closed q after at most so many Newton steps, and the nearest v that keeps it closed."""
        tree, rounding = self._tree, _CLOSED * (1.0 + norm(v))
        r, K = self._solver.closures(self._robot, q)
        for _ in range(newton_steps):
            is_open = norm(r)
            if is_open <= _CLOSED:
                break
            change, rate = self._least.of(K, np.array((r, K.dot(v))), rounding)
            q = tree.normalized(tree.integrate(q, -change))
            if not norm(q) < math.inf:
                raise SimulationDiverged(t, self._step)
            if is_open <= _NEARLY_CLOSED:
                return q, v - rate
            r, K = self._solver.closures(self._robot, q)
        (rate,) = self._least.of(K, K.dot(v)[None], rounding)
        return q, v - rate

    def energies(self, q: Vector, v: Vector) -> tuple[float, float]:
        """Kinetic and potential energy, J."""
        dynamics = self._dynamics
        return dynamics.kinetic_energy(q, v), dynamics.potential_energy(q)


def _warn_of_long_step(simulation: Simulation, step: float) -> None:
    error, exchanged = simulation.energy_error, simulation.energy_exchanged
    largest = max(float(np.abs(part).max()) for part in (simulation.kinetic, simulation.potential, simulation.work))
    if error > _TOO_LONG * exchanged and error > _ROUNDING * largest:
        # The error of a fourth-order method falls with the fourth power of the step.
        suggested = step * (_SHORT_ENOUGH * exchanged / error) ** 0.25
        warnings.warn(StepTooLongWarning(error, exchanged, step, suggested), stacklevel=3)
