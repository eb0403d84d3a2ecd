"""Exceptions of the transmission between motors and joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from eurdf.exceptions import EurdfError
from eurdf.kinematics.exceptions import NotClosable

if TYPE_CHECKING:
    from eurdf.array import Vector
    from eurdf.kinematics.opening import Opening


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
        self.map = of
        self.reason = reason
        super().__init__(f"{of} is not determined: {reason}")


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
