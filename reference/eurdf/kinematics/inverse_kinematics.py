"""Inverse kinematics of frames of a closed mechanism, within its joint limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pinocchio import SE3

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import Assembler, start
from eurdf.kinematics.bounded_step import bounded_step
from eurdf.kinematics.constraints.vector import origins, velocity_of_origin
from eurdf.kinematics.metric import orthonormal
from eurdf.kinematics.position_limit import BEYOND, JointAtLimit, Limits, chosen_limits
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import Opening, closure_openings, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.pinocchio.arguments import checked_array, checked_count, checked_tolerance
from eurdf.pinocchio.logarithm import log3, log3_derivative

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_MOST_STEPS = 60
# A descent gives up after this many consecutive idle steps. A step is idle if it reduces the squared error by less than
# this fraction; the last descent, after which the target is out of reach, uses a smaller fraction.
_MOST_IDLE_STEPS = 6
_IDLE = 0.02
_IDLE_AT_LAST = 1e-8
# A descent also ends if the expected reduction of the next step is below this fraction of the squared error.
_LEAST_GAIN = 1e-12
# Distance of the restarts from the start (rad, or characteristic lengths); the last one is repeated.
_SPREADS = (0.2, 0.5, 1.0, 2.0)
# The gradient of the squared error counts as zero below this fraction of |A| |e|; |A| is at least its smallest value
# met.
_FLAT = 0.02
# A configuration is singular if the smallest singular value of A is below this fraction of its largest value met.
_SINGULAR = 0.05
# Singular values of A below this fraction of the largest are zero.
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class FrameError:
    """How far a frame is from its target.

    Attributes:
        frame: Name of the frame.
        position: Distance of its origin from that of the target, m.
        angle: Angle between its axes and those of the target, rad; 0 if the target is a position.
    """

    frame: str
    position: float
    angle: float

    def __str__(self) -> str:
        angle = f" and {math.degrees(self.angle):.3g} degrees" if self.angle else ""
        return f"'{self.frame}' by {self.position * 1e3:.3g} mm{angle}"


#: Why inverse kinematics did not converge: closures stay open; joints at their limits keep the frames off target; the
#: configuration is singular, at the edge of the workspace; no motion of the mechanism brings the frames nearer; or the
#: maximum number of steps was reached.
InverseKinematicsReason = Literal["closures open", "joint limits", "singular", "out of reach", "steps"]

_SENTENCES: dict[InverseKinematicsReason, str] = {
    "closures open": "closures stay open",
    "joint limits": "joints are at their limits",
    "singular": "the configuration is singular, at the edge of the workspace",
    "out of reach": "no motion of the mechanism brings the frames nearer",
    "steps": "the maximum number of steps was reached; start nearer, or allow more restarts",
}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class InverseKinematics:
    """The result of `inverse_kinematics`.

    Attributes:
        q: The configuration (nq,) nearest to the targets: closed and within the limits, if such a one was found.
        converged: Whether every frame is at its target, and every loop closed, within the tolerances.
        errors: How far each frame is from its target, in the order of the targets.
        open: How far each closure is open at q, in file order.
        iterations: Number of steps tried.
        reason: Why it did not converge; None if it did.
        at_limits: The joints that are at their limits at q and would have to exceed them to come nearer.
    """

    q: Vector
    converged: bool
    errors: tuple[FrameError, ...]
    open: tuple[Opening, ...]
    iterations: int
    reason: InverseKinematicsReason | None = None
    at_limits: tuple[JointAtLimit, ...] = ()

    def __repr__(self) -> str:
        parts = ["converged" if self.reason is None else f"not converged: {_SENTENCES[self.reason]}"]
        if self.reason is not None:
            is_open = ", ".join(str(found) for found in self.open if found.is_open)
            parts += [f"open: {is_open}"] if is_open else []
            parts += [f"at their limits: {', '.join(map(str, self.at_limits))}"] if self.at_limits else []
            parts += [f"off target: {', '.join(map(str, self.errors))}"]
        return f"<InverseKinematics: {'; '.join(parts)}; {self.iterations} iterations>"


def inverse_kinematics(
    robot: Robot,
    targets: Mapping[str, Any],
    q0: Vector | None = None,
    limits: Limits = True,
    *,
    tolerance: float = 1e-8,
    restarts: int = 10,
) -> InverseKinematics:
    """Move frames of the closed mechanism to targets.

    It minimises the sum over the frames of |oMf.translation - p|² / L² + |log3(Rᵀ oMf.rotation)|² (the second term only
    for targets that are poses), subject to r(q) = 0 and the joint limits. L is the characteristic length of the robot's
    loops (1 m without loops). Every step is a damped Gauss-Newton step y along the closed configurations, v = Z y with
    K Z = 0, bounded by the limits (active set), after which `assemble` closes the loops. So loops are closed and limits
    respected at every step, even if the targets cannot be reached. If a descent ends off target, others start around
    q0.

    Source: `closedLoopInverseKinematics` of the toolbox of Batto, De Matteïs and Mansard, 2025, which passes the loops
    to a general solver as equality constraints.

    Args:
        robot: The robot.
        targets: For each frame its target in the world: a pose (`pin.SE3`), or a position (3,), m, that leaves the
            orientation free. A frame is given by the name of a link, a joint (its frame on the child side) or a frame
            of the description.
        q0: Where to start (nq,); the solution is near it. It is closed and clipped to the limits first. If it already
            is a solution, within 1e-6 for the closures, it is returned. The default is the `assembled` configuration,
            or the neutral one if there is none.
        limits: Whether to respect the position limits of joints whose coordinates are angles or lengths. Limits of
            mimic joints are ignored. A range of zero width counts as no range (`urdf-no-range`), unless ``limits`` is
            ``"strict"``: then such a joint does not move.
        tolerance: Bound of the distance of a frame from its target, m and rad. Loops are closed to 1e-10 if possible.
        restarts: Maximum number of restarts while frames are off target. The time is bounded by ``restarts`` + 2
            descents of at most 60 steps.

    Returns:
        The configuration found. The result is deterministic.

    Raises:
        ValueError: ``q0`` is not a configuration; a frame is unknown or ambiguous; a target is neither a pose nor a
            finite position.
    """
    search = _Search(robot, targets, limits, checked_tolerance(tolerance))
    return search.run(start(robot, q0), checked_count("restarts", restarts, 0))


class _Search:
    """The descents for one set of targets."""

    def __init__(self, robot: Robot, targets: Mapping[str, Any], limits: Limits, tolerance: float) -> None:
        self.robot = robot
        self.nv = robot.tree.nv
        self.frames = robot.tree.frames(list(targets)).memory()
        self.targets = [(name, _target(name, target)) for name, target in targets.items()]
        self.assembler = Assembler(robot, limits=limits)
        self.spaces = TangentSpaces(robot)
        self.tolerance = tolerance
        self.iterations = 0
        self.limits = chosen_limits(robot.tree, limits)
        self.velocities = np.arange(self.nv)
        # Of E Z, at the configuration farthest from singular.
        self.motions, self.rank, self.smallest = self.nv, 0, 0.0

    def run(self, q: Vector, restarts: int) -> InverseKinematics:
        openings = closure_openings(self.robot, q)
        if not any(found.is_open for found in openings) and np.array_equal(self._clipped(q), q) and self._reached(q):
            return InverseKinematics(q, True, self._errors(q), openings, 0)
        assembly = self.assembler.assemble(self._clipped(q))
        q = best = assembly.q
        if assembly.closes:
            best, cost = self._descend(q)
            random = np.random.default_rng(0)
            for attempt in range(restarts):
                if self._reached(best):
                    break
                spread = _SPREADS[min(attempt, len(_SPREADS) - 1)]
                place = self._moved(q, self.spaces.scale * random.uniform(-spread, spread, self.nv))
                beginning = self.assembler.assemble(place, restarts=0)
                if not beginning.closes:
                    continue
                end, reached = self._descend(beginning.q)
                if reached < cost:
                    best, cost = end, reached
            best, _ = self._descend(best, _IDLE_AT_LAST)
        closed = self.assembler.assemble(best, restarts=0)
        reason: InverseKinematicsReason | None = None
        at_limits: tuple[JointAtLimit, ...] = ()
        if not assembly.closes:
            reason, at_limits = "closures open", assembly.at_limits
        elif not self._reached(best):
            reason, at_limits = self._why_off_target(best)
        return InverseKinematics(
            q=best,
            converged=reason is None,
            errors=self._errors(best),
            open=closed.open,
            iterations=self.iterations,
            reason=reason,
            at_limits=at_limits,
        )

    def _why_off_target(self, q: Vector) -> tuple[InverseKinematicsReason, tuple[JointAtLimit, ...]]:
        """Why no descent continues from a closed configuration at which frames are off their targets."""
        e, E = self._error_and_jacobian(q)
        Z = self._free_motions(q)
        A = E @ Z
        self._look_at_rank(A)
        slope, values = A.T @ e, _singular_values(A)
        size = max(values.max(initial=0.0), self.smallest) * np.linalg.norm(e)
        at_limits = () if self.limits is None else self.limits.pressed(q, -Z @ slope)
        if np.linalg.norm(slope) <= _FLAT * size:
            singular = self.rank > 0 and not values[self.rank - 1] > _SINGULAR * self.smallest
            return ("singular" if singular else "out of reach"), ()
        if at_limits:
            G, h = self._bounds(q, Z)
            at_bounds = h <= BEYOND
            down = bounded_step(np.eye(len(slope)), slope, G[at_bounds], np.zeros(int(at_bounds.sum())))
            if np.linalg.norm(down) <= _FLAT * size:
                return "joint limits", at_limits
        return "steps", at_limits

    def _descend(self, q: Vector, least: float = _IDLE) -> tuple[Vector, float]:
        """The configuration after a descent from a closed configuration, and the squared error there.

        Args:
            q: Where to start (nq,).
            least: A step that reduces the squared error by less than this fraction is idle.
        """
        e, E = self._error_and_jacobian(q)
        self._look_at_rank(E @ self._free_motions(q))
        cost, damping, idle = float(e @ e), 1e-3, 0
        for _ in range(_MOST_STEPS):
            if idle > _MOST_IDLE_STEPS or self._reached(q):
                break
            v = self._step(q, e, E, damping * cost)
            expected = cost - float(np.sum(np.square(e + E @ v)))
            if not expected > _LEAST_GAIN * cost:
                break
            self.iterations += 1
            trial = self.assembler.assemble(self._moved(q, v), restarts=0)
            e_trial, E_trial = self._error_and_jacobian(trial.q)
            reached = float(e_trial @ e_trial)
            gain = (cost - reached) / expected if trial.closes else 0.0
            idle = 0 if trial.closes and reached < (1.0 - least) * cost else idle + 1
            if not gain > 0.01:
                damping *= 8.0
                continue
            damping = max(damping * (0.1 if gain > 0.75 else 1.0 if gain > 0.25 else 4.0), 1e-8)
            q, e, E, cost = trial.q, e_trial, E_trial, reached
        return q, cost

    def _step(self, q: Vector, e: Vector, E: Matrix, damping: float) -> Vector:
        """The v (nv,) with K v = 0 that minimises |E v + e|² + λ|v|² within the limits; at most 1 rad or length."""
        scale, Z = self.spaces.scale, self._free_motions(q)
        A = E @ Z
        H = A.T @ A
        damping = max(damping, 1e-13 * float(np.trace(H)), 1e-300)
        np.einsum("ii->i", H)[:] += damping
        G, h = self._bounds(q, Z)
        y = _damped(A, e, damping)
        if (G @ y > h).any():
            y = bounded_step(H, A.T @ e, G, h)
        v = Z @ y
        return np.asarray(v / np.abs(v / scale).max(initial=1.0), dtype=np.float64)

    def _free_motions(self, q: Vector) -> Matrix:
        """Basis Z (nv, m) of the motions that keep the loops closed, orthonormal in the units of the velocities."""
        _, K = residual_and_jacobian(self.robot, q)
        return orthonormal(self.spaces.at(K).basis, np.diag(self.spaces.scale**-2.0))

    def _look_at_rank(self, A: Matrix) -> None:
        """Keep the largest rank of A = E Z met so far, and with it the largest of its smallest singular values.

        Only configurations with the fewest columns of Z count: at singular loops, Z has more columns, and the rank can
        be larger.
        """
        values = _singular_values(A)
        motions, rank = A.shape[1], numerical_rank(values, values.max(initial=0.0))
        smallest = float(values[rank - 1]) if rank else 0.0
        if (-motions, rank, smallest) > (-self.motions, self.rank, self.smallest):
            self.motions, self.rank, self.smallest = motions, rank, smallest

    def _bounds(self, q: Vector, Z: Matrix) -> tuple[Matrix, Vector]:
        """G and h such that v = Z y respects the limits if G y ≤ h, for limits within a step of 1 rad or length."""
        if self.limits is None:
            return np.empty((0, Z.shape[1])), np.empty(0)
        down, up = self.limits.room(q, self.velocities)
        scale = self.spaces.scale
        rows = Z / scale[:, None]
        moves = np.linalg.norm(rows, axis=1) > 1e-9
        above, below = moves & (up <= scale), moves & (-down <= scale)
        return np.vstack([rows[above], -rows[below]]), np.concatenate([(up / scale)[above], (-down / scale)[below]])

    def _moved(self, q: Vector, v: Vector) -> Vector:
        return self._clipped(self.robot.tree.normalized(self.robot.tree.integrate(q, v)))

    def _clipped(self, q: Vector) -> Vector:
        return q if self.limits is None else self.limits.clip(q, self.velocities)

    def _error_and_jacobian(self, q: Vector) -> tuple[Vector, Matrix]:
        """Stacked errors of all frames, in characteristic lengths and rad, and their derivative with respect to v."""
        placements = self.frames.placements(q)
        rows = np.zeros((len(placements), 6, 6))
        rows[:, :3] = velocity_of_origin(origins(placements))
        rows[:, 3:, 3:] = np.eye(3)
        jacobians_in_world = self.frames.jacobian(rows, range(len(placements))).reshape(len(placements), 6, self.nv)
        errors, jacobians = [np.empty(0)], [np.empty((0, self.nv))]
        for (_, target), oMf, J in zip(self.targets, placements, jacobians_in_world, strict=True):
            position = target.translation if isinstance(target, SE3) else target
            errors.append((oMf.translation - position) / self.spaces.length)
            jacobians.append(J[:3] / self.spaces.length)
            if isinstance(target, SE3):
                turn = target.rotation.T @ oMf.rotation
                errors.append(log3(turn))
                jacobians.append(log3_derivative(turn) @ oMf.rotation.T @ J[3:])
        return np.concatenate(errors), np.vstack(jacobians)

    def _errors(self, q: Vector) -> tuple[FrameError, ...]:
        errors = []
        for (name, target), oMf in zip(self.targets, self.frames.placements(q), strict=True):
            if isinstance(target, SE3):
                angle = math.hypot(*log3(target.rotation.T @ oMf.rotation))
                errors.append(FrameError(name, math.dist(oMf.translation, target.translation), angle))
            else:
                errors.append(FrameError(name, math.dist(oMf.translation, target), 0.0))
        return tuple(errors)

    def _reached(self, q: Vector) -> bool:
        return all(max(error.position, error.angle) <= self.tolerance for error in self._errors(q))


def _damped(A: Matrix, e: Vector, damping: float) -> Vector:
    """The y (m,) that minimises |A y + e|² + λ|y|².

    Unlike (AᵀA + λ 1)⁻¹ Aᵀ e, it has no part along motions that change no error, which would be amplified rounding.
    """
    left, values, right = np.linalg.svd(A, full_matrices=False)
    factors = np.where(values > _ROUNDING * values.max(initial=0.0), values / (values**2 + damping), 0.0)
    return -np.asarray(right.T @ (factors * (left.T @ e)), dtype=np.float64)


def _singular_values(A: Matrix) -> Vector:
    return np.asarray(np.linalg.svd(A, compute_uv=False) if A.size else np.empty(0), dtype=np.float64)


def _target(name: str, target: Any) -> Any:
    """A target, checked: a pose, or a position (3,)."""
    if isinstance(target, SE3):
        R, p = target.rotation, target.translation
        if np.isfinite(p).all() and np.abs(R.T @ R - np.eye(3)).max() <= 1e-6 and np.linalg.det(R) > 0.0:
            return target
        raise ValueError(f"targets['{name}'] is not a pose: its rotation is not orthonormal, or a number is not finite")
    try:
        return checked_array(f"targets['{name}']", target, (3,))
    except ValueError as error:
        raise ValueError(f"{error}, or a pose (pin.SE3)") from None
