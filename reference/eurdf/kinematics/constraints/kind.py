"""What a kind of constraint is to the rest of the kinematics, and what kinds between two frames have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.constraints.relative_motion import RelativeMotions
from eurdf.kinematics.tree_kinematics import PairMemory, TreeKinematics
from eurdf.mechanism.constraint import Closure, Constraint

AnyConstraint = TypeVar("AnyConstraint", bound=Constraint)
AnyClosure = TypeVar("AnyClosure", bound=Closure)


class State(NamedTuple):
    """Where the constraints of a stack are evaluated.

    Attributes:
        q: The configuration (nq,).
        placements: ᴬM_B of each pair of frames of the stack there, as `pin.SE3`.
        memory: Where they were computed; None where no derivative is asked for.
    """

    q: Vector
    placements: Sequence[Any]
    memory: PairMemory | None = None


class Kind(ABC, Generic[AnyConstraint]):
    """The constraints of one kind in a stack, k of them with r rows each, evaluated together.

    The residual is zero where they hold; its derivatives are exact everywhere, K v = d/dt r(q ⊕ t v) at t = 0
    (EU-CLO-010).

    Attributes:
        data: Class of the constraints.
    """

    data: ClassVar[type[Constraint]]

    def __init__(
        self, constraints: Sequence[AnyConstraint], pairs: Sequence[int], tree: TreeKinematics, velocities: Indices
    ) -> None:
        """Prepare what does not depend on the configuration.

        Args:
            constraints: The constraints, k.
            pairs: Index of each one's pair of frames in the stack; of no meaning for a kind without frames.
            tree: The spanning tree.
            velocities: Indices (n,) in v of the columns of K.
        """

    @abstractmethod
    def residual(self, at: State) -> Matrix:
        """The residuals (k, r), in the units of the kind."""

    @abstractmethod
    def jacobian(self, at: State) -> Matrix:
        """K (k r, n), the derivative of the residuals by the velocities."""

    @abstractmethod
    def drift(self, motions: RelativeMotions) -> Matrix:
        """K̇ v (k, r), the second derivatives of the residuals while every joint keeps its velocity."""

    @abstractmethod
    def scale(self, length: float) -> Matrix:
        """Factors (k, r) that make the rows dimensionless; ``length`` (m) is the robot's characteristic length."""

    @abstractmethod
    def openings(self, at: State) -> list[tuple[float, float]]:
        """How far each constraint is open: a length, m, and an angle, rad (EU-CLO-005)."""


class Closures(Kind[AnyClosure]):
    """Closures of one kind, whose residual is a function of the pose of B in A."""

    def __init__(
        self, constraints: Sequence[AnyClosure], pairs: Sequence[int], tree: TreeKinematics, velocities: Indices
    ) -> None:
        """See `Kind`."""
        self.which = list(pairs)
        self._units = type(constraints[0]).units
        self._k = len(self.which)

    def residual(self, at: State) -> Matrix:
        """See `Kind`."""
        return self.rows(self._placements(at))

    def jacobian(self, at: State) -> Matrix:
        """See `Kind`."""
        assert at.memory is not None
        return at.memory.jacobian(self.rows_of_twist(self._placements(at)), self.which)

    def drift(self, motions: RelativeMotions) -> Matrix:
        """See `Kind`."""
        return self.rows_of_motion(motions.of(self.which))

    def scale(self, length: float) -> Matrix:
        """1/length for rows in m, 1 for rows in rad."""
        return np.array([[1.0 / length if unit == "m" else 1.0 for unit in self._units]] * self._k)

    def openings(self, at: State) -> list[tuple[float, float]]:
        """See `Kind`."""
        return [self.opening(aMb, index) for index, aMb in enumerate(self._placements(at))]

    def _placements(self, at: State) -> list[Any]:
        return [at.placements[index] for index in self.which]

    @abstractmethod
    def rows(self, placements: Sequence[Any]) -> Matrix:
        """The residuals (k, r) where the poses of B in A are these, `pin.SE3`."""

    @abstractmethod
    def rows_of_twist(self, placements: Sequence[Any]) -> Matrix:
        """The derivative (k, r, 6) of the rows by the twists of B against A, seen from A."""

    @abstractmethod
    def rows_of_motion(self, motions: RelativeMotions) -> Matrix:
        """The second derivatives of the residuals (k, r) along these motions."""

    @abstractmethod
    def opening(self, aMb: Any, index: int) -> tuple[float, float]:
        """How far the closure with this index is open where B is at ``aMb``, m and rad."""
