"""Exceptions of the transmission between motors and joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eurdf.exceptions import EurdfError

if TYPE_CHECKING:
    from eurdf.kinematics.array import Vector


class NoTransmission(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A map between motors and joints does not exist at a configuration.

    Attributes:
        map: ``G`` or ``B_J``.
        reason: Why it does not exist.
    """

    def __init__(self, of: str, reason: str) -> None:
        self.map = of
        self.reason = reason
        super().__init__(f"{of} does not exist here: {reason}")


class DependentVelocities(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """The loops do not allow the given velocities, since they depend on each other.

    Attributes:
        names: The joints or motors.
        given: Their velocities (n,), rad/s or m/s.
        nearest: The nearest velocities (n,) that the loops allow.
    """

    def __init__(self, names: tuple[str, ...], given: Vector, nearest: Vector) -> None:
        self.names = names
        self.given = given
        self.nearest = nearest
        numbers = ", ".join(f"{name} {value:.6g}" for name, value in zip(names, nearest.tolist(), strict=True))
        super().__init__(f"the loops do not allow these velocities together; the nearest that they allow: {numbers}")
