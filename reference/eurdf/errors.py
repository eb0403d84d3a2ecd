"""Every exception and warning that a function of the package raises, each with the data of what is wrong.

All errors are an `EurdfError`, except `ValueError` and `TypeError` for arguments that are invalid.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from eurdf.diagnostics import Diagnostic, Severity
from eurdf.diagnostics.wording import no_command, visible

if TYPE_CHECKING:
    from eurdf.array import Vector
    from eurdf.convert.losses import Loss
    from eurdf.kinematics.opening import Opening


class Portable(BaseException):
    """An exception or warning that can be pickled and copied, also if its constructor takes more than its text.

    By default, an exception is restored by calling its class with the text alone. If that fails in the parent of a
    worker process, the parent waits for ever.
    """

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self.args, self.__dict__)


def _restored(kind: type[BaseException], arguments: tuple[Any, ...], attributes: dict[str, Any]) -> BaseException:
    error = kind.__new__(kind)
    builtin = next(base for base in kind.__mro__ if base.__module__ == "builtins")
    builtin.__init__(error, *arguments)  # type: ignore[misc] # not the constructor of the class, which takes more
    error.__dict__.update(attributes)
    return error


class EurdfError(Portable, Exception):
    """Base of all errors of this package."""


class InvalidRobot(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot cannot be built without guessing.

    Attributes:
        path: The path that the caller gave.
        diagnostics: All diagnostics, including warnings, in the order found; the text shows the errors first.
    """

    def __init__(self, path: str, diagnostics: tuple[Diagnostic, ...], reason: str = "") -> None:
        self.path = path
        self.diagnostics = diagnostics
        errors_first = sorted(diagnostics, key=lambda found: found.severity is not Severity.ERROR)
        lines = [
            no_command(visible(reason or f"{path} is not a valid robot")),
            *(f"  {found}" for found in errors_first),
        ]
        super().__init__("\n".join(lines))


class RobotNotFound(EurdfError, FileNotFoundError):  # noqa: N818 - part of the public interface
    """A path does not exist and is not the name of a robot of the collection.

    Attributes:
        path: The path that the caller gave.
    """

    def __init__(self, path: str, message: str) -> None:
        self.path = path
        super().__init__(message)


class CannotExpand(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A xacro file cannot be expanded with the given arguments.

    Attributes:
        path: The file.
        reason: The message of xacro.
    """

    def __init__(self, path: str, reason: str) -> None:
        self.path = path
        self.reason = reason
        super().__init__(f"xacro cannot expand '{path}': {reason}")


class MissingExtra(EurdfError, ImportError):  # noqa: N818 - part of the public interface
    """An optional dependency is not installed.

    Attributes:
        extra: The extra of this package that installs it.
    """

    def __init__(self, message: str, extra: str) -> None:
        self.extra = extra
        super().__init__(message)


class NoConstraintModel(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A constraint has a kind for which Pinocchio has no constraint model.

    Attributes:
        constraint: Name of the constraint.
        type: Its type.
    """

    def __init__(self, constraint: str, type_: str) -> None:
        self.constraint, self.type = constraint, type_
        super().__init__(
            f"Pinocchio has no constraint model for constraint '{constraint}' of type '{type_}'; use "
            "robot.model, robot.constraints and the other attributes one by one, and the functions of eurdf, such as "
            "eurdf.forward_dynamics in place of pin.constraintDynamics"
        )


class CannotLock(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A joint cannot be locked.

    Attributes:
        joint: Its name.
        reason: Why it cannot be locked.
        leader: For a mimic joint, the joint to lock instead; else None.
    """

    def __init__(self, joint: str, reason: str, leader: str | None = None) -> None:
        self.joint = joint
        self.reason = reason
        self.leader = leader
        super().__init__(f"joint '{joint}' cannot be locked: {reason}")


class LockedOpen(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """Locked joints would hold closures open.

    Attributes:
        openings: How far each of these closures is open.
        tolerance: Bound of each row of their residual, m or rad.
    """

    def __init__(self, openings: tuple[Opening, ...], tolerance: float) -> None:
        self.openings = openings
        self.tolerance = tolerance
        apart = ", ".join(map(str, openings))
        super().__init__(
            f"closures stay open with the joints locked there: {apart}; the tolerance is {tolerance:g} m or rad"
        )


class NotClosable(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """No configuration was found that closes the loops.

    Attributes:
        openings: How far each closure is open at the least open configuration found.
        q: That configuration (nq,).
    """

    def __init__(self, reason: str, openings: tuple[Opening, ...], q: Vector) -> None:
        self.openings = openings
        self.q = q
        apart = ", ".join(str(found) for found in openings if found.is_open)
        super().__init__(f"{reason}: closures stay open, {apart}" if apart else reason)


class TooFar(NotClosable):
    """The loops can be closed at given coordinates, but a straight path does not lead there.

    Attributes:
        openings: How far each closure is open at ``q``.
        q: The last configuration (nq,) on the path, with the given coordinates.
    """


class DependentActuators(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """The closures do not let the actuated joints move independently.

    Attributes:
        joints: The actuated joints that depend on others or cannot move at all.
        actuated: Number of actuated velocities, nu.
        rank: Number of independent actuated velocities.
    """

    def __init__(self, joints: tuple[str, ...], actuated: int, rank: int) -> None:
        self.joints = joints
        self.actuated = actuated
        self.rank = rank
        names = ", ".join(f"'{name}'" for name in joints)
        super().__init__(
            f"only {rank} of {actuated} actuated velocities are independent in the closed mechanism; "
            f"the loops couple or block {names}"
        )


class InconsistentMotion(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A velocity or an acceleration would open closures.

    Attributes:
        order: ``velocity`` or ``acceleration``.
        opening: For each closure that would open, the rows of K v or of K a + K̇ v, in m and rad per s or s².
    """

    def __init__(self, order: str, opening: Mapping[str, tuple[float, ...]]) -> None:
        self.order = order
        self.opening = opening
        closures = ", ".join(f"'{name}' by {math.hypot(*rows):.3g}" for name, rows in opening.items())
        unit = {"velocity": "m/s and rad/s", "acceleration": "m/s² and rad/s²"}[order]
        super().__init__(f"the {order} opens closures: {closures} ({unit}); project it with project_{order} first")


class UnderactuatedMotion(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """The motors cannot produce a motion.

    Attributes:
        missing: For each joint with an uncontrolled motion, the additional generalized force that the motion needs, N·m
            and N.
        deviation: Largest component of the difference from the acceleration that the motors can produce, rad/s² or
            characteristic lengths/s²; inf if a motion without inertia would need a force.
    """

    def __init__(self, missing: Mapping[str, tuple[float, ...]], deviation: float) -> None:
        self.missing = missing
        self.deviation = deviation
        joints = ", ".join(f"'{name}' {math.hypot(*force):.3g}" for name, force in missing.items())
        super().__init__(
            f"the motors cannot produce this motion; it needs additional forces (N·m, N) at joints {joints}"
        )


class UndeterminedMotion(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A motion without inertia is free, so the forces do not determine the acceleration.

    Attributes:
        joints: Names of the joints of such motions.
    """

    def __init__(self, joints: tuple[str, ...]) -> None:
        self.joints = joints
        named = ", ".join(f"'{name}'" for name in joints)
        super().__init__(f"the forces do not determine the acceleration: joints {named} move without inertia; add mass")


class StepTooLongWarning(Portable, UserWarning):
    """The time step of a simulation is too long to keep the energy.

    Attributes:
        error: Largest error of the energy balance, J.
        exchanged: Energy exchanged, J.
        step: Time step, s.
        suggested: A time step that keeps the error below 0.1 % if it falls with the fourth power of the step, s.
    """

    def __init__(self, error: float, exchanged: float, step: float, suggested: float) -> None:
        self.error = error
        self.exchanged = exchanged
        self.step = step
        self.suggested = suggested
        super().__init__(
            f"the energy error is {error:.2g} J, {100.0 * error / exchanged:.2g} % of the {exchanged:.2g} J exchanged: "
            f"the time step of {step:g} s is too long; try {suggested:.1g} s"
        )


class SimulationDiverged(EurdfError, ArithmeticError):  # noqa: N818 - part of the public interface
    """The time step of a simulation is too long for the motion.

    Attributes:
        t: Time at which the simulation diverged, s.
        step: Time step, s.
    """

    def __init__(self, t: float, step: float) -> None:
        self.t = t
        self.step = step
        super().__init__(
            f"the simulation diverges at {t:.6g} s: the time step of {step:g} s is too long; use a smaller one"
        )


class NumericalOverflow(EurdfError, ArithmeticError):  # noqa: N818 - part of the public interface
    """A result is not finite, although the robot and the arguments are.

    Attributes:
        result: What is not finite.
    """

    def __init__(self, result: str) -> None:
        self.result = result
        super().__init__(
            f"{result} would not be finite: lengths, inertias, coordinates or velocities are too large or too small"
        )


def shown(values: Iterable[tuple[str, float]]) -> str:
    """Names of joints with their values, for a message."""
    return ", ".join(f"{name} {value + 0.0:.6g}" for name, value in values)


class NoTransmission(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A map between motors and joints does not exist at a configuration.

    Attributes:
        map: ``G`` or ``B_J``.
        reason: Why it does not exist.
    """

    def __init__(self, of: str, reason: str) -> None:
        self.map, self.reason = of, reason
        super().__init__(f"{of} is not determined: {reason}")


class DependentVelocities(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """The loops do not allow the given velocities, since they depend on each other.

    Attributes:
        names: The joints or motors.
        given: Their velocities (n,), rad/s or m/s.
        nearest: The nearest velocities (n,) that the loops allow.
    """

    def __init__(self, names: tuple[str, ...], given: Vector, nearest: Vector) -> None:
        self.names, self.given, self.nearest = names, given, nearest
        allowed = shown(zip(names, nearest.tolist(), strict=True))
        super().__init__(f"the loops do not allow these velocities together; the nearest that they allow: {allowed}")


class OutOfReach(NotClosable):
    """Positions cannot be reached on a straight path.

    Attributes:
        wanted: The positions, by joint, rad or m.
        reached: The farthest positions on the path, as far as they are known.
        part: The part of the path that leads to them, from 0 to 1.
        openings: How far each closure is open at the least open configuration found at ``wanted``.
        q: That configuration (nq,).
    """

    def __init__(
        self,
        wanted: Mapping[str, float],
        reached: Mapping[str, float],
        part: float,
        openings: tuple[Opening, ...],
        q: Vector,
    ) -> None:
        self.wanted = dict(wanted)
        self.reached = dict(reached)
        self.part = part
        reason = (
            f"{shown(wanted.items())}: not reachable along a straight path from the start; the last reachable point is "
            f"{shown(reached.items())} ({100.0 * part:.1f} %); give values nearer to the start, or values in between "
            "one after the other"
        )
        super().__init__(reason, openings, q)


class CannotExport(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot cannot be written in a format.

    Attributes:
        losses: What was refused, where the caller refuses losses.
    """

    def __init__(self, message: str, losses: tuple[Loss, ...] = ()) -> None:
        self.losses = losses
        super().__init__(message)


class CannotSimplify(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot cannot be rewritten so that it surely moves in the same way; the text says why."""


class CannotImport(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A file cannot be imported.

    Attributes:
        path: The file.
        reason: What is wrong, and what would be right.
        losses: What was refused, where the caller refuses losses.
        diagnostics: The errors that were refused, where the caller refuses the robot's errors.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        reason: str,
        losses: tuple[Loss, ...] = (),
        diagnostics: tuple[Diagnostic, ...] = (),
    ) -> None:
        self.path, self.reason, self.losses, self.diagnostics = os.fspath(path), reason, losses, diagnostics
        super().__init__(visible(f"cannot import '{self.path}': {reason}"))


class CannotMigrate(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot has no description, or one of version 1 that version 2 cannot state; the text says which."""


class CannotRun(Exception):  # noqa: N818 - shown to the user as it is
    """A command of the command line cannot run, as opposed to errors of a robot; the text says why. Exit code 2."""
