"""Inverse kinematics of frames of a closed mechanism, within its joint limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pinocchio import SE3

from eurdf.closures.se3 import log3, log3_derivative
from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import Assembler, Assembly, start
from eurdf.kinematics.bounded_step import bounded_step
from eurdf.kinematics.damped_step import damped_step
from eurdf.kinematics.derived import borrowed, derived
from eurdf.kinematics.evaluate import Evaluator, Frames, evaluator, frames
from eurdf.kinematics.least_solution import certain_inverse
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.position_limit import JointAtLimit, chosen_limits
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import all_openings
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.mechanism.joint import LIMIT_TOLERANCE
from eurdf.pinocchio.arguments import checked_array, checked_count, checked_tolerance

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_MOST_STEPS = 60
# Bound of each row of the residual for closed loops, m or rad.
_CLOSED = 1e-10
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
_ONE = np.eye(3)


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
    limits: bool = True,
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
    q0. Springs have no effect: they may be deflected in the result.

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
            mimic joints are ignored. Limits that are both 0 are no range (`urdf-no-range`).
        tolerance: Bound of the distance of a frame from its target, m and rad. Loops are closed to 1e-10 if possible.
        restarts: Maximum number of restarts while frames are off target. The time is bounded by ``restarts`` + 2
            descents of at most 60 steps.

    Returns:
        The configuration found. The result is deterministic.

    Raises:
        ValueError: ``q0`` is not a configuration; ``targets`` is not a mapping; a frame is unknown or ambiguous; a
            target is neither a pose nor a finite position.
    """
    if not isinstance(targets, Mapping):
        raise ValueError(f"targets must map names of frames to poses or positions, not {type(targets).__name__}")
    checked = {name: _target(name, target) for name, target in targets.items()}
    chosen, tolerance = chosen_limits(robot, limits), checked_tolerance(tolerance)
    q, restarts = start(robot, q0), checked_count("restarts", restarts, 0)
    with borrowed(robot, Assembler) as assembler, borrowed(robot, _memory, *checked) as memory:
        assembler.limits, assembler.tolerance = chosen, _CLOSED
        return _Search(robot, checked, assembler, memory, tolerance).run(q, restarts)


def _memory(robot: Robot, *names: str) -> tuple[Frames, Evaluator]:
    """The frames, and all constraints."""
    return frames(robot, names, few=True), evaluator(robot, few=True)


class _Search:
    """The descents for one set of targets."""

    def __init__(
        self,
        robot: Robot,
        targets: Mapping[str, Any],
        assembler: Assembler,
        memory: tuple[Frames, Evaluator],
        tolerance: float,
    ) -> None:
        self.robot, self.targets = robot, targets
        self.assembler, (self.frames, self.constraints) = assembler, memory
        self.spaces = derived(robot, TangentSpaces)
        self.nv = robot.tree.nv
        self.tolerance = tolerance
        self.iterations = 0
        self.limits = assembler.limits
        self._at: Any = None
        # Of each target its position, the inverse of its rotation, if it has one, and where its rows begin.
        self._parts: list[tuple[Vector, Matrix | None, int]] = []
        rows = 0
        for target in targets.values():
            is_pose = isinstance(target, SE3)
            position = np.array(target.translation if is_pose else target)
            self._parts.append((position, np.array(target.rotation.T) if is_pose else None, rows))
            rows += 6 if is_pose else 3
        self._rows = rows
        poses = [inverse is not None for _, inverse, _ in self._parts]
        self._all_poses = all(poses)
        self._used = np.repeat([[True, pose] for pose in poses], 3) if poses else np.empty(0, bool)
        # The derivatives of positions by linear velocities; the other entries are set in `_jacobian`.
        self._twists = np.zeros((len(poses), 6, 6))
        self._twists[:, [0, 1, 2], [0, 1, 2]] = 1.0 / self.spaces.length
        self._begun: list[Vector] = []  # where descents began
        # Of E Z, at the configuration farthest from singular.
        self.motions, self.rank, self.smallest = self.nv, 0, 0.0

    def run(self, q: Vector, restarts: int) -> InverseKinematics:
        if np.array_equal(self._clipped(q), q) and self._reached(self._error(q)):
            openings = all_openings(self.robot, q)
            if not any(found.is_open for found in openings):
                return InverseKinematics(q, True, self._errors(self._error(q)), openings, 0)
        q, opened = self._closed(self._clipped(q), 20)
        if opened is not None:
            best, error = q, self._error(q)
        else:
            best, error = self._descend(q)
            random = np.random.default_rng(0)
            for attempt in range(restarts):
                if self._reached(error):
                    break
                spread = _SPREADS[min(attempt, len(_SPREADS) - 1)]
                place = self._moved(q, self.spaces.scale * random.uniform(-spread, spread, self.nv))
                beginning, still_open = self._closed(place)
                if still_open is not None:
                    continue
                end, reached = self._descend(beginning)
                if reached @ reached < error @ error:
                    best, error = end, reached
            if not self._reached(error):
                best, error = self._descend(best, _IDLE_AT_LAST)
        reason: InverseKinematicsReason | None = None
        at_limits: tuple[JointAtLimit, ...] = ()
        if opened is not None:
            reason, at_limits = "closures open", opened.at_limits
        elif not self._reached(error):
            reason, at_limits = self._why_off_target(best)
        return InverseKinematics(
            q=best,
            converged=reason is None,
            errors=self._errors(error),
            open=all_openings(self.robot, best),
            iterations=self.iterations,
            reason=reason,
            at_limits=at_limits,
        )

    def _closed(self, q: Vector, restarts: int = 0) -> tuple[Vector, Assembly | None]:
        """The closed configuration near q; or the least open one, and the assembly that found no closed one."""
        closed = self.assembler.closed(q)
        if closed is not None:
            return closed, None
        assembly = self.assembler.assemble(q, restarts)
        return assembly.q, None if assembly.closes else assembly

    def _why_off_target(self, q: Vector) -> tuple[InverseKinematicsReason, tuple[JointAtLimit, ...]]:
        """Why no descent continues from a closed configuration at which frames are off their targets."""
        e = self._error(q)
        Z = self._free_motions(q)
        A = self._jacobian() @ Z
        for begun in self._begun:
            self._error(begun)
            self._look_at_rank(self._jacobian() @ self._free_motions(begun))
        self._look_at_rank(A)
        slope, values = A.T @ e, _singular_values(A)
        size = max(values.max(initial=0.0), self.smallest) * np.linalg.norm(e)
        at_limits = () if self.limits is None else self.limits.pressed(q, -Z @ slope)
        if np.linalg.norm(slope) <= _FLAT * size:
            singular = self.rank > 0 and not values[self.rank - 1] > _SINGULAR * self.smallest
            return ("singular" if singular else "out of reach"), ()
        if at_limits:
            G, h = self._bounds(q, Z)
            at_bounds = h <= LIMIT_TOLERANCE
            down = bounded_step(np.eye(len(slope)), slope, G[at_bounds], np.zeros(int(at_bounds.sum())))
            if np.linalg.norm(down) <= _FLAT * size:
                return "joint limits", at_limits
        return "steps", at_limits

    def _descend(self, q: Vector, least: float = _IDLE) -> tuple[Vector, Vector]:
        """The configuration after a descent from a closed configuration, and the error there.

        Args:
            q: Where to start (nq,).
            least: A step that reduces the squared error by less than this fraction is idle.
        """
        e = self._error(q)
        if self._reached(e):
            return q, e
        self._begun.append(q)
        E = self._jacobian()
        cost, damping, idle = float(e @ e), 1e-3, 0
        for _ in range(_MOST_STEPS):
            if idle > _MOST_IDLE_STEPS:
                break
            v = self._step(q, e, E, damping * cost)
            left = e + E @ v
            expected = cost - float(left @ left)
            if not expected > _LEAST_GAIN * cost:
                break
            self.iterations += 1
            trial, opened = self._closed(self._moved(q, v))
            e_trial = self._error(trial)
            reached = float(e_trial @ e_trial)
            gain = (cost - reached) / expected if opened is None else 0.0
            idle = 0 if opened is None and reached < (1.0 - least) * cost else idle + 1
            if not gain > 0.01:
                damping *= 8.0
                continue
            damping = max(damping * (0.1 if gain > 0.75 else 1.0 if gain > 0.25 else 4.0), 1e-8)
            q, e, cost = trial, e_trial, reached
            if self._reached(e):
                break
            E = self._jacobian()
        return q, e

    def _step(self, q: Vector, e: Vector, E: Matrix, damping: float) -> Vector:
        """The v (nv,) with K v = 0 that minimises |E v + e|² + λ|v|² within the limits; at most 1 rad or length."""
        K = self._constraint_jacobian(q)
        v = self._step_in_the_open(q, K, e, E, damping)
        if v is None:
            Z = self.spaces.at(K).free
            A = E @ Z
            H = A.T @ A
            damping = _damping(damping, float(np.trace(H)))
            np.einsum("ii->i", H)[:] += damping
            G, h = self._bounds(q, Z)
            y = damped_step(A, e, damping)
            if (G @ y > h).any():
                y = bounded_step(H, A.T @ e, G, h)
            v = Z @ y
        return np.asarray(v / np.abs(v / self.spaces.scale).max(initial=1.0), dtype=np.float64)

    def _step_in_the_open(self, q: Vector, K: Matrix, e: Vector, E: Matrix, damping: float) -> Vector | None:
        """The same step where the rows of K are independent for certain and no limit bounds it; else None.

        With A the dimensionless K, P = 1 - Aᵀ (A Aᵀ)⁻¹ A projects on the free motions, and B = E P takes the place of
        the derivative.
        """
        scale = self.spaces.scale
        A = K * self.spaces.dimensionless
        B = E * scale
        if len(A):
            inverse = certain_inverse(A.dot(A.T), math.sqrt(float(np.vdot(A, A))))
            if inverse is None:
                return None
            B -= B.dot(A.T).dot(inverse).dot(A)
            B -= B.dot(A.T).dot(inverse).dot(A)  # what rounding left
        v = scale * damped_step(B, e, _damping(damping, float(np.vdot(B, B))))
        if self.limits is not None:
            down, up = self.limits.room(q)
            if (((v > up) & (up <= scale)) | ((v < down) & (-down <= scale))).any():
                return None
        return np.asarray(v)

    def _free_motions(self, q: Vector) -> Matrix:
        """Basis Z (nv, m) of the motions that keep the loops closed, orthonormal in the units of the velocities."""
        return self.spaces.at(self._constraint_jacobian(q)).free

    def _constraint_jacobian(self, q: Vector) -> Matrix:
        """K (nc, nv)."""
        return np.asarray(self.constraints.jacobian(self.constraints.at(q[None]))[0])

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
        down, up = self.limits.room(q)
        scale = self.spaces.scale
        rows = Z / scale[:, None]
        moves = np.linalg.norm(rows, axis=1) > 1e-9
        above, below = moves & (up <= scale), moves & (-down <= scale)
        return np.vstack([rows[above], -rows[below]]), np.concatenate([(up / scale)[above], (-down / scale)[below]])

    def _moved(self, q: Vector, v: Vector) -> Vector:
        return self._clipped(self.robot.tree.normalized(self.robot.tree.integrate(q, v)))

    def _clipped(self, q: Vector) -> Vector:
        return q if self.limits is None else self.limits.clip(q)

    def _error(self, q: Vector) -> Vector:
        """Stacked errors of all frames at q, in characteristic lengths and rad."""
        self._at, e = self.frames.at(q[None]), np.empty(self._rows)
        (rotations,), (origins,) = self.frames.poses(self._at)
        for (position, inverse, first), R, p in zip(self._parts, rotations, origins, strict=True):
            e[first : first + 3] = (p - position) / self.spaces.length
            if inverse is not None:
                e[first + 3 : first + 6] = log3(inverse.dot(R))
        return e

    def _jacobian(self) -> Matrix:
        """Derivative of the errors by v, where they were last computed."""
        rows = self._twists
        (rotations,), (origins,) = self.frames.poses(self._at)
        for row, (_, inverse, _), R, p in zip(rows, self._parts, rotations, origins, strict=True):
            x, y, z = (p / self.spaces.length).tolist()
            row[0, 4], row[0, 5], row[1, 5] = z, -y, x  # minus the skew matrix
            row[1, 3], row[2, 3], row[2, 4] = -z, y, -x
            if inverse is not None:
                row[3:, 3:] = log3_derivative(log3(inverse.dot(R))).dot(R.T)
        J: Matrix = self.frames.rows(self._at, rows[None])[0]
        return J if self._all_poses else J[self._used]

    def _reached(self, e: Vector) -> bool:
        """Whether every frame is at its target within the tolerance, m and rad."""
        errors = e.tolist()
        for _, inverse, first in self._parts:
            if not self.spaces.length * math.hypot(*errors[first : first + 3]) <= self.tolerance:
                return False
            if inverse is not None and not math.hypot(*errors[first + 3 : first + 6]) <= self.tolerance:
                return False
        return True

    def _errors(self, e: Vector) -> tuple[FrameError, ...]:
        """The same by frame, m and rad."""
        errors, found = e.tolist(), []
        for name, (_, inverse, first) in zip(self.targets, self._parts, strict=True):
            position = self.spaces.length * math.hypot(*errors[first : first + 3])
            angle = 0.0 if inverse is None else math.hypot(*errors[first + 3 : first + 6])
            found.append(FrameError(name, position, angle))
        return tuple(found)


def _damping(given: float, trace: float) -> float:
    """λ, at least so large that what it is added to can be inverted."""
    return max(given, 1e-13 * trace, 1e-300)


def _singular_values(A: Matrix) -> Vector:
    return np.asarray(np.linalg.svd(A, compute_uv=False) if A.size else np.empty(0), dtype=np.float64)


def _target(name: str, target: Any) -> Any:
    """A target, checked: a pose, or a position (3,)."""
    if isinstance(target, SE3):
        R = target.rotation
        if np.isfinite(target.translation).all() and np.abs(R.T.dot(R) - _ONE).max() <= 1e-6:
            x, y, z = R.tolist()
            volume = sum(x[i] * (y[i - 2] * z[i - 1] - y[i - 1] * z[i - 2]) for i in range(3))
            if volume > 0.0:  # no reflection
                return target
        raise ValueError(f"targets['{name}'] is not a pose: its rotation is not orthonormal, or a number is not finite")
    try:
        return checked_array(f"targets['{name}']", target, (3,))
    except ValueError as error:
        raise ValueError(f"{error}, or a pose (pin.SE3)") from None
