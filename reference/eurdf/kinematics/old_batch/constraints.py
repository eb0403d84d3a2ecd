"""The kinds of constraint, for arrays of relative poses: for each its residual, derivative and opening.

The meaning is that of `eurdf.kinematics.constraints`. Components come first and elements last: k constraints of one
kind at B configurations have relative poses (3, 3, k, B) and (3, k, B).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.constraints.vector import plane_across
from eurdf.kinematics.old_batch import rigid
from eurdf.mechanism.constraint import Closure, DistanceClosure, FrameClosure, HingeClosure, PointClosure

AnyClosure = TypeVar("AnyClosure", bound=Closure)

# The sine of θ near half a turn, where the shortest rotation has no derivative, is taken as no less than this.
_LEAST_SINE = 1e-9


class ClosureKind(ABC, Generic[AnyClosure]):
    """Closures of one kind, k of them, whose residual is a function of the poses of B in A.

    Attributes:
        data: Class of the closures.
    """

    data: ClassVar[type[Closure]]

    def __init__(self, closures: Sequence[AnyClosure]) -> None:
        """Prepare what does not depend on the configuration."""

    @abstractmethod
    def rows(self, R: Matrix, p: Matrix) -> Matrix:
        """The residuals (r, k, B)."""

    @abstractmethod
    def rows_of_twist(self, R: Matrix, p: Matrix) -> Matrix:
        """Their derivatives (r, 6, k, B) by the twists of B against A, seen from A."""

    @abstractmethod
    def openings(self, R: Matrix, p: Matrix) -> tuple[Matrix, Matrix]:
        """How far the closures are open, m and rad, (k, B) each (EU-CLO-005)."""


class Points(ClosureKind[PointClosure]):
    """3d: r = p."""

    data = PointClosure

    def rows(self, R: Matrix, p: Matrix) -> Matrix:
        """See `ClosureKind`."""
        return p

    def rows_of_twist(self, R: Matrix, p: Matrix) -> Matrix:
        """See `ClosureKind`."""
        return _velocity_of_origin(p)

    def openings(self, R: Matrix, p: Matrix) -> tuple[Matrix, Matrix]:
        """See `ClosureKind`."""
        return rigid.norm(p), np.zeros(p.shape[1:])


class Frames(ClosureKind[FrameClosure]):
    """6d: r = log6(ᴬM_B)."""

    data = FrameClosure

    def rows(self, R: Matrix, p: Matrix) -> Matrix:
        """See `ClosureKind`."""
        return np.concatenate(rigid.log6(R, p))

    def rows_of_twist(self, R: Matrix, p: Matrix) -> Matrix:
        """Jlog6(ᴬM_B) Ad(ᴮM_A) = Jlog6(ᴮM_A)."""
        return rigid.jacobian_log6(rigid.transposed(R), -rigid.turned_back(R, p))

    def openings(self, R: Matrix, p: Matrix) -> tuple[Matrix, Matrix]:
        """See `ClosureKind`."""
        return rigid.norm(p), rigid.norm(rigid.log3(R))


class Hinges(ClosureKind[HingeClosure]):
    """hinge: r = (p, Eᵀ s), s the shortest rotation vector that takes axis a of A to axis b of B."""

    data = HingeClosure

    def __init__(self, closures: Sequence[HingeClosure]) -> None:
        """See `ClosureKind`."""
        axes = np.array([closure.axes for closure in closures], dtype=np.float64)
        axes /= np.abs(axes).max(axis=2, keepdims=True)  # of any length, also of one whose square is out of range
        axes /= np.linalg.norm(axes, axis=2, keepdims=True)
        self._a, self._b = axes[:, 0].T[:, :, None], axes[:, 1].T[:, :, None]
        self._across = np.stack([plane_across(a) for a in axes[:, 0]], axis=-1)[..., None]

    def rows(self, R: Matrix, p: Matrix) -> Matrix:
        """See `ClosureKind`."""
        _, theta, axis = self._turn(R)
        return np.concatenate((p, rigid.turned_back(self._across, theta * axis)))

    def rows_of_twist(self, R: Matrix, p: Matrix) -> Matrix:
        """[1, -skew(p); 0, Eᵀ S], where ṡ = S ω, S = -g skew(a) skew(β) - g' (a × β)(a × β)ᵀ, g(cos θ) = θ / sin θ."""
        beta, theta, axis = self._turn(R)
        sine, cosine = np.maximum(np.sin(theta), _LEAST_SINE), np.cos(theta)
        g = np.where(theta < 1e-3, 1.0 + theta**2 / 6.0, theta / sine)
        # g' sin² θ = cos θ g - 1; the product with the squares of the normals has no quotient of small numbers.
        S = -g * rigid.product(rigid.skew(self._a), rigid.skew(beta))
        S -= (cosine * g - 1.0) * axis[:, None] * axis[None, :]
        rows = np.zeros((5, 6, *p.shape[1:]))
        rows[:3] = _velocity_of_origin(p)
        rows[3:, 3:] = rigid.product(rigid.transposed(self._across), S)
        return rows

    def openings(self, R: Matrix, p: Matrix) -> tuple[Matrix, Matrix]:
        """See `ClosureKind`."""
        return rigid.norm(p), self._turn(R)[1]

    def _turn(self, R: Matrix) -> tuple[Matrix, Vector, Matrix]:
        """β = R b, the angle θ from a to β, in [0, π], and the axis about which it turns."""
        beta = rigid.turned(R, self._b)
        normal = rigid.cross(np.broadcast_to(self._a, beta.shape), beta)
        sine = rigid.norm(normal)
        theta = np.arctan2(sine, rigid.dot(self._a, beta))
        axis = np.array(np.broadcast_to(self._across[:, 0], beta.shape))
        np.divide(normal, sine, out=axis, where=sine > 0.0)
        return beta, theta, axis


class Distances(ClosureKind[DistanceClosure]):
    """distance: r = |p| - length. At p = 0 the direction p/|p| is taken along x of A."""

    data = DistanceClosure

    def __init__(self, closures: Sequence[DistanceClosure]) -> None:
        """See `ClosureKind`."""
        self._lengths = np.array([closure.length for closure in closures])[:, None]

    def rows(self, R: Matrix, p: Matrix) -> Matrix:
        """See `ClosureKind`."""
        return np.asarray(rigid.norm(p) - self._lengths)[None]

    def rows_of_twist(self, R: Matrix, p: Matrix) -> Matrix:
        """See `ClosureKind`."""
        distance = rigid.norm(p)
        rows = np.zeros((1, 6, *distance.shape))
        rows[0, 0] = 1.0
        np.divide(p, distance, out=rows[0, :3], where=distance > 0.0)
        return rows

    def openings(self, R: Matrix, p: Matrix) -> tuple[Matrix, Matrix]:
        """See `ClosureKind`."""
        open_by = np.abs(rigid.norm(p) - self._lengths)
        return open_by, np.zeros_like(open_by)


_ALL: tuple[type[ClosureKind[Any]], ...] = (Points, Frames, Hinges, Distances)

#: What evaluates the closures of each class.
CLOSURE_KINDS: dict[type[Closure], type[ClosureKind[Any]]] = {kind.data: kind for kind in _ALL}


def _velocity_of_origin(p: Matrix) -> Matrix:
    """[1, -skew(p)] (3, 6, …)."""
    rows = np.empty((3, 6, *p.shape[1:]))
    rows[:, :3] = np.eye(3).reshape(3, 3, *(1,) * (p.ndim - 1))
    rows[:, 3:] = -rigid.skew(p)
    return rows
