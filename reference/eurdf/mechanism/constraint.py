"""The constraints between bodies that the spanning tree does not have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from eurdf.mechanism.frame import Anchor

ClosureType = Literal["3d", "6d"]


@dataclass(frozen=True, slots=True)
class Closure:
    """A loop closure: frame B is held on frame A, in position (3d) or in position and orientation (6d).

    Attributes:
        name: Unique among the closures.
        type: ``3d``, 3 rows: the origin of B, seen from A; or ``6d``, 6 rows: log6 of the pose of B in A.
        a: Frame A.
        b: Frame B.
    """

    name: str
    type: ClosureType
    a: Anchor
    b: Anchor

    @property
    def rows(self) -> int:
        """Number of constraint rows."""
        return 3 if self.type == "3d" else 6
