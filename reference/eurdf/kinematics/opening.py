"""How far a constraint is open."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from eurdf.kinematics.tolerances import CLOSED


@dataclass(frozen=True, slots=True, repr=False)
class Opening:
    """How far a constraint is open.

    Attributes:
        name: Name of the constraint.
        position: Distance between the origins of A and B, m; for a distance closure, what it is off its length. For a
            coupling whose coordinate with the largest coefficient is a length, what that would have to move, else 0.
        angle: Angle between A and B, rad, or between their axes for a hinge; 0 for a closure that leaves it free. For
            other couplings, what the coordinate with the largest coefficient would have to move.
    """

    name: str
    position: float
    angle: float

    def __str__(self) -> str:
        parts = []
        if self.position > CLOSED or self.angle <= CLOSED:
            parts.append(f"{self.position:.3g} m" if self.position >= 1.0 else f"{self.position * 1e3:.3g} mm")
        if self.angle > CLOSED:
            parts.append(f"{math.degrees(self.angle):.3g} degrees")
        return f"'{self.name}' by {' and '.join(parts)}"

    @property
    def is_open(self) -> bool:
        """Whether it is open by more than `CLOSED`; what is no number is open."""
        return not self.width <= CLOSED

    @property
    def width(self) -> float:
        """The larger of its two numbers, in m or rad."""
        return max(self.position, self.angle)

    def __repr__(self) -> str:
        return f"<Opening: {self}>"


def widest(openings: Iterable[Opening], most: int = 4) -> str:
    """The open ones for a message, the widest first, a few at most."""
    wide = sorted((each for each in openings if each.is_open), key=lambda each: each.width, reverse=True)
    return "; ".join(map(str, wide[:most])) + (f"; and {len(wide) - most} more" if len(wide) > most else "")
