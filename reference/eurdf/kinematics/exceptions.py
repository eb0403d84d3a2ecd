"""Exceptions of the kinematics and dynamics of a closed mechanism."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from eurdf.exceptions import EurdfError, Portable

if TYPE_CHECKING:
    from eurdf.array import Vector
    from eurdf.kinematics.opening import Opening


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
