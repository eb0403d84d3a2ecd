"""Inverse kinematics of frames of a closed mechanism, within its joint limits."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from pinocchio import SE3

from eurdf.array import Vector
from eurdf.closures.se3 import IDENTITY_ROTATION
from eurdf.kinematics.assembly import assembled, opened, openings
from eurdf.kinematics.blocks import checked_rows, shape_of
from eurdf.kinematics.closing import start
from eurdf.kinematics.frame_jacobian import frames_of
from eurdf.kinematics.frame_targets import Target
from eurdf.kinematics.inverse_newton import InverseNewton
from eurdf.kinematics.inverse_search import InverseKinematicsReason, InverseTask, search
from eurdf.kinematics.named import Named
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.position_limit import JointAtLimit, chosen_limits
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.tolerances import (
    RESTARTS,
    SOLVED,
)
from eurdf.pinocchio.arguments import all_finite, checked_array, checked_count, checked_tolerance
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, repr=False)
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

    def __repr__(self) -> str:
        return f"<FrameError: {self}>"


_SENTENCES: dict[InverseKinematicsReason, str] = {
    "closures open": "closures stay open",
    "joint limits": "joints are at their limits",
    "tolerance": "as near as rounding and the closed loops allow; use a larger tolerance",
    "local minimum": "no motion from the configuration found brings the frames nearer; another start may",
    "steps": "the maximum number of steps was reached; start nearer, or allow more restarts",
}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class InverseKinematics:
    """The result of `inverse_kinematics`.

    Attributes:
        q: The configuration (nq,) nearest to the targets that was found: closed and within the limits, if one was.
        converged: Whether every frame is at its target, and every loop closed, within the tolerances.
        errors: How far each frame is from its target, in the order of the targets.
        open: How far each closure is open at q, in file order.
        iterations: Number of steps tried.
        tolerance: Bound of the errors, m and rad, that was asked for.
        starts: Number of other configurations that the search started from again.
        same_branch: Whether q is on the branch of q0 for certain: every step to it was so short that closing the loops
            after it moved the joints little. If not, a part of the motion may have to lead through a dead point.
        reason: Why it did not converge; None if it did. No reason shows that the target is out of reach.
        at_limits: The joints that are at their limits at q and would have to exceed them to come nearer.
    """

    q: Vector
    converged: bool
    errors: tuple[FrameError, ...]
    open: tuple[Opening, ...]
    iterations: int
    tolerance: float = 1e-8
    starts: int = 0
    same_branch: bool = True
    reason: InverseKinematicsReason | None = None
    at_limits: tuple[JointAtLimit, ...] = ()

    def __repr__(self) -> str:
        parts = ["converged" if self.reason is None else f"not converged: {_SENTENCES[self.reason]}"]
        if self.reason is not None:
            is_open = ", ".join(str(found) for found in self.open if found.is_open)
            parts += [f"open: {is_open}"] if is_open else []
            parts += [f"at their limits: {', '.join(map(str, self.at_limits))}"] if self.at_limits else []
            parts += [f"off target: {', '.join(map(str, self.errors))} (tolerance {self.tolerance:.3g} m and rad)"]
        parts += [] if self.same_branch else ["perhaps on another branch than q0"]
        again = f" from {1 + self.starts} starts" if self.starts else ""
        return f"<InverseKinematics: {'; '.join(parts)}; {self.iterations} iterations{again}>"


def inverse_kinematics(
    robot: Robot,
    targets: Mapping[str, Any],
    q0: Named | None = None,
    *,
    limits: bool = True,
    tolerance: float = 1e-8,
    restarts: int = 20,
) -> InverseKinematics:
    """Move frames of the closed mechanism to targets.

    It minimises the sum over the frames of |oMf.translation - p|² / L² + |log3(Rᵀ oMf.rotation)|² (the second term only
    for targets that are poses), subject to r(q) = 0 and the joint limits. L is the characteristic length of the robot's
    loops (1 m without loops). Every step is a damped Gauss-Newton step y along the closed configurations, v = Z y with
    K Z = 0, bounded by the limits (active set), after which `assemble` closes the loops. So loops are closed and limits
    respected at every step, even if the targets cannot be reached. If a descent ends off target, others start from
    configurations around q0: first from those on its branch, which paths along closed configurations lead to, then from
    any. Springs have no effect: they may be deflected in the result.

    Source: `closedLoopInverseKinematics` of the toolbox of Batto, De Matteïs and Mansard, 2025, which passes the loops
    to a general solver as equality constraints.

    Near targets are reached sooner, by the Newton steps of least norm that solve the closures and the targets at once;
    they count where each loop is closed to 1e-10, the limits are respected, and the steps after the first, together,
    are at most a quarter as long as it, so that the branch is that of q0. If not, the search above starts at q0.

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
        restarts: Maximum number of restarts while frames are off target by more than 1e-6; a quarter of them on the
            branch of q0. The time is bounded by ``restarts`` + 2 descents of at most 60 steps.

    Returns:
        The configuration found: how near it is, and what was tried. The result is deterministic.

    Raises:
        ValueError: ``q0`` is not a configuration; ``targets`` is not a mapping; a frame is unknown or ambiguous; a
            target is neither a pose nor a finite position.
    """
    if not isinstance(targets, Mapping):
        raise ValueError(f"targets must map names of frames to poses or positions, not {type(targets).__name__}")
    checked = {name: _target(name, target) for name, target in targets.items()}
    chosen, tolerance = chosen_limits(robot, limits), checked_tolerance(tolerance)
    q, restarts = start(robot, q0), checked_count("restarts", restarts, 0)
    poses = tuple(isinstance(target, SE3) for target in checked.values())
    goals = [
        Target(np.array(target.translation)[None], np.array(target.rotation)[None])
        if is_pose
        else Target(np.array(target)[None])
        for is_pose, target in zip(poses, checked.values(), strict=True)
    ]
    with (
        working_memory(robot, Problem) as problem,
        working_memory(robot, frames_of, *checked) as frames,
        working_memory(robot, InverseNewton, poses, *checked) as newton,
    ):
        task = InverseTask(problem, frames, newton, poses, chosen, tolerance, restarts)
        found = search(task, goals, q[None])
        at_limits = found.at_limits[0]
        if found.reason[0] == "closures open":  # the joints whose limits keep the loops open
            clipped = q if chosen is None else chosen.clip(q)
            at_limits = assembled(problem, clipped, SOLVED, RESTARTS, chosen).at_limits
        with np.errstate(over="ignore", invalid="ignore"):
            is_open = openings(problem, found.q) if found.openings is None else opened(problem, *found.openings)
    return InverseKinematics(
        q=found.q[0],
        converged=found.reason[0] is None,
        errors=tuple(map(FrameError, checked, found.position[0].tolist(), found.angle[0].tolist())),
        open=is_open,
        iterations=int(found.iterations[0]),
        tolerance=tolerance,
        starts=int(found.starts[0]),
        same_branch=bool(found.same_branch[0]),
        reason=found.reason[0],
        at_limits=at_limits,
    )


def _target(name: str, target: Any) -> Any:
    """A target, checked: a pose, or a position (3,)."""
    if isinstance(target, SE3):
        R = target.rotation
        if all_finite(target.translation) and np.abs(R.T.dot(R) - IDENTITY_ROTATION).max() <= 1e-6:
            x, y, z = R.tolist()
            volume = sum(x[i] * (y[i - 2] * z[i - 1] - y[i - 1] * z[i - 2]) for i in range(3))
            if volume > 0.0:  # no reflection
                return target
        raise ValueError(f"targets['{name}'] is not a pose: its rotation is not orthonormal, or a number is not finite")
    try:
        return checked_array(f"targets['{name}']", target, (3,))
    except ValueError as error:
        raise ValueError(f"{error}, or a pose (pin.SE3)") from None


def checked_targets(name: str, target: Any) -> Target:
    """Targets, checked.

    Raises:
        ValueError: They are neither positions nor poses, or are not finite.
    """
    argument = f"targets['{name}']"
    if isinstance(target, Sequence) and len(target) and all(isinstance(each, SE3) for each in target):
        target = np.array([each.homogeneous for each in target])
    shape = shape_of(target)
    if len(shape) != 3 or shape[1:] != (4, 4):
        try:
            return Target(checked_rows(argument, target, 3))
        except ValueError as error:
            raise ValueError(f"{error}, or poses: (B, 4, 4), or a list of pin.SE3") from None
    poses = checked_array(argument, target, shape)
    R = poses[:, :3, :3]
    wrong = np.abs(np.swapaxes(R, 1, 2) @ R - IDENTITY_ROTATION).max(axis=(1, 2), initial=0.0) > 1e-6
    wrong |= (np.linalg.det(R) < 0.0) | (np.abs(poses[:, 3] - (0.0, 0.0, 0.0, 1.0)).max(axis=1, initial=0.0) > 1e-9)
    if wrong.any():
        raise ValueError(f"{argument}[{int(np.argmax(wrong))}] is not a pose: its rotation is not orthonormal")
    return Target(poses[:, :3, 3], R)
