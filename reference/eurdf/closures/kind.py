"""What a kind of closure is.

A kind is a class in a file of its own: a dataclass of what a file states of one closure, and the mathematics of k
closures of the kind, as functions of the poses of their frames B in A. The schema, the reading and the writing of a
closure are made of its fields. To add a kind: its file, and its line in `eurdf.closures.MODULES`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, TypeVar

import numpy as np

from eurdf.closures.se3 import (
    cross,
    log3,
    log3_derivative,
    log6,
    log6_derivative,
    skew,
    transposed,
    turned,
    velocity_of_origin,
)
from eurdf.mechanism.constraint import Closure, ClosureKey, Form
from eurdf.mechanism.pose import Vector3

if TYPE_CHECKING:
    from typing_extensions import Self

    from eurdf.array import Matrix, Vector


_T = TypeVar("_T")


class RelativePoses:
    """ᴬM_B of k pairs of frames A, B at B configurations.

    Attributes:
        rotation: ᴬR_B (B, k, 3, 3).
        position: Origin p of B in A (B, k, 3), m.
    """

    rotation: Matrix
    position: Matrix
    _logarithm: Matrix | None = None
    _by_twist: Matrix | None = None
    _found: tuple[Callable[..., Any], Any] = isinstance, None

    def of(self, which: slice) -> RelativePoses:
        """Those of some of the pairs."""
        return PoseArrays(self.rotation[:, which], self.position[:, which])

    def logarithm(self) -> Matrix:
        """log6(ᴬM_B) (B, k, 6), linear and angular, m and rad."""
        if self._logarithm is None:
            self._logarithm = log6(self.rotation, self.position)
        return self._logarithm

    def logarithm_by_twist(self) -> Matrix:
        """Its derivative (B, k, 6, 6) by the twist of B against A, seen from A: Jlog6(ᴬM_B) Ad(ᴮM_A) = Jlog6(ᴮM_A)."""
        if self._by_twist is None:
            self._by_twist = log6_derivative(-self.logarithm())
        return self._by_twist

    def twist_in_b(self) -> Matrix:
        """Ad(ᴮM_A) (B, k, 6, 6), which takes the twist of B against A, seen from A, to the axes of B."""
        inverse = transposed(self.rotation)
        Ad = np.zeros((*self.position.shape[:2], 6, 6))
        Ad[..., :3, :], Ad[..., 3:, 3:] = inverse @ velocity_of_origin(self.position), inverse
        return Ad

    def turn_from(self, rotation: Matrix) -> Matrix:
        """log3(Sᵀ ᴬR_B) (B, k, 3), rad, how B is turned against the axes S (B, k, 3, 3), seen from A."""
        return log3(transposed(rotation) @ self.rotation)

    def turn_by_omega(self, turn: Matrix) -> Matrix:
        """The derivative (B, k, 3, 3) of such a turn by the angular velocity of B against A, seen from A."""
        return log3_derivative(turn) @ transposed(self.rotation)

    def once(self, compute: Callable[[RelativePoses, Any], _T], fixed: Any) -> _T:
        """What a function of a kind computes from the poses; it is kept for the next to ask for it."""
        if self._found[0] is not compute:
            self._found = compute, compute(self, fixed)
        value: _T = self._found[1]
        return value


class PoseArrays(RelativePoses):
    """Poses that were computed."""

    def __init__(self, rotation: Matrix, position: Matrix, logarithm: Matrix | None = None) -> None:
        self.rotation, self.position, self._logarithm = rotation, position, logarithm

    def of(self, which: slice) -> PoseArrays:
        """Those of some of the pairs."""
        logarithm = None if self._logarithm is None else self._logarithm[:, which]
        return PoseArrays(self.rotation[:, which], self.position[:, which], logarithm)


class RelativeMotions(NamedTuple):
    """How k frames B move against frames A, at B configurations, while every joint keeps its velocity.

    Attributes:
        poses: ᴬM_B.
        twist: ξ (B, k, 6), the twist of B against A in the axes of B, m/s and rad/s.
        change: ξ̇ (B, k, 6), m/s² and rad/s².
    """

    poses: RelativePoses
    twist: Matrix
    change: Matrix

    def of(self, which: slice) -> RelativeMotions:
        """Those of some of the pairs."""
        return RelativeMotions(self.poses.of(which), self.twist[:, which], self.change[:, which])

    @property
    def velocity(self) -> Matrix:
        """ṗ (B, k, 3), m/s, in the axes of A."""
        return turned(self.poses.rotation, self.twist[..., :3])

    @property
    def omega(self) -> Matrix:
        """Angular velocity ω of B against A (B, k, 3), rad/s, in the axes of A."""
        return turned(self.poses.rotation, self.twist[..., 3:])

    @property
    def acceleration(self) -> Matrix:
        """p̈ (B, k, 3), m/s², in the axes of A."""
        linear, angular = self.twist[..., :3], self.twist[..., 3:]
        return turned(self.poses.rotation, self.change[..., :3] + cross(angular, linear))  # ξ̇ lacks what turns with B

    @property
    def alpha(self) -> Matrix:
        """ω̇ (B, k, 3), rad/s², in the axes of A."""
        return turned(self.poses.rotation, self.change[..., 3:])


class Contact(NamedTuple):
    """A closure that simulators have: frame B is at frame A, 6 rows, or only a point of B is at one of A, 3 rows.

    Attributes:
        name: What is added to the name of the closure.
        is_frame: Whether the orientations agree too.
        a: The point in the axes of A, m.
        b: The point in the axes of B, m.
    """

    name: str = ""
    is_frame: bool = False
    a: Vector3 = (0.0, 0.0, 0.0)
    b: Vector3 = (0.0, 0.0, 0.0)

    @property
    def rows(self) -> int:
        """Number of its rows."""
        return 6 if self.is_frame else 3


@dataclass(frozen=True, slots=True)
class ClosureKind(Closure, ABC):
    """A closure whose residual r is a function of the pose of B in A, and how that is computed for k of its kind.

    The residual is zero where the closure holds; its derivatives are exact everywhere (EU-CLO-010).

    Attributes:
        text: What the type means, in the words of the schema.
        summary: What a closure of the type is.
        since: The first version of the format that has it.
        called: What other formats and textbooks call the type, in small letters, with ``_`` between words.
    """

    text: ClassVar[str]
    called: ClassVar[str] = ""
    summary: ClassVar[str] = "Two frames that are joined."
    since: ClassVar[Literal["1", "2.1"]] = "2.1"

    @classmethod
    def keys(cls) -> dict[str, ClosureKey]:
        """What the kind has beside name, frames and compliance, by field."""
        return {
            each.name: each.metadata["key"]._replace(
                type=str(each.type), default=None if each.default is MISSING else each.default
            )
            for each in fields(cls)
            if "key" in each.metadata
        }

    @classmethod
    def forms(cls) -> tuple[Form, ...]:
        """The mappings that state one: by default, one with a key for each of `keys`."""
        name = "".join(map(str.capitalize, cls.type.split("-")))
        return (Form(name, f"{cls.type.capitalize()} closure", cls.summary, cls.keys()),)

    @classmethod
    def values_of(cls, stated: Mapping[str, Any]) -> Mapping[str, Any]:
        """The values of the fields that a form states, the inverse of `stated`."""
        return stated

    def contacts(self) -> tuple[Contact, ...]:
        """What holds the same as the closure; nothing if simulators have no such closures."""
        return ()

    def forces_of_contacts(self) -> Matrix | None:
        """λ (r,) over the λ of the contacts: (r, rows of the contacts); None if their rows are those of the closure."""
        return None

    @staticmethod
    def of_distance(p: Matrix, velocity: Matrix, fixed: Any) -> tuple[Vector, Matrix, Vector] | None:
        """r (k,) of a kind of one row that depends only on |p|, its gradient, and what r̈ has besides this · p̈.

        None for another kind. p (k, 3), m, and its ``velocity`` (k, 3), m/s, are those of B against A in the axes of A,
        or in others that do not turn: these rows are combinations of those that hold the origins together.
        """
        return None

    @classmethod
    def prepare(cls, closures: Sequence[Self]) -> Any:
        """What the functions below need of k closures, as arrays."""
        return None

    @staticmethod
    @abstractmethod
    def residual(poses: RelativePoses, fixed: Any) -> Matrix:
        """r (B, k, r), in the units of the kind; ``fixed`` is what `prepare` returned."""

    @staticmethod
    @abstractmethod
    def jacobian(poses: RelativePoses, fixed: Any) -> Matrix:
        """The derivative (B, k, r, 6) of r by the twist of B against A, seen from A."""

    @staticmethod
    @abstractmethod
    def drift(motions: RelativeMotions, fixed: Any) -> Matrix:
        """r̈ (B, k, r) while every joint keeps its velocity."""

    @staticmethod
    @abstractmethod
    def jacobian_derivative(poses: RelativePoses, fixed: Any) -> Matrix:
        """The derivative (B, k, r, 6, 6) of the Jacobian P, last index, by the twist of B against A, seen from A."""

    @staticmethod
    @abstractmethod
    def bend_derivative(poses: RelativePoses, fixed: Any, twist: Matrix) -> Matrix:
        """That (B, k, r, 6) of the bend Ṗ η = r̈ - P η̇ at a constant twist η (B, k, 6) of B against A, seen from A."""

    @staticmethod
    @abstractmethod
    def opening(poses: RelativePoses, fixed: Any) -> tuple[Vector, Vector]:
        """How far each closure is open, a length, m, and an angle, rad (EU-CLO-005): (B, k) each."""


class CarriedVector(NamedTuple):
    """A residual φ(y) of a vector y that B carries, seen from A, by the derivatives of φ and of y.

    Attributes:
        by_twist: The derivative L (…, 3, 6) of y by the twist η of B against A, seen from A.
        first: φ′ (…, r, 3).
        second: φ″ (…, r, 3, 3).
        third: φ‴(ẏ, ẏ) (…, r, 3), by ẏ (…, 3).
    """

    by_twist: Matrix
    first: Matrix
    second: Matrix
    third: Callable[[Matrix], Matrix]

    def jacobian_derivative(self) -> Matrix:
        """That (…, r, 6, 6) of P = φ′ L: φ″(L η, L δ) + φ′ (ω × L δ)."""
        L = self.by_twist[..., None, :, :]
        found = transposed(L) @ self.second @ L
        found[..., 3:, :] -= skew(self.first) @ L
        return np.asarray(found)

    def bend_derivative(self, twist: Matrix) -> Matrix:
        """That (…, r, 6) of the bend φ″(ẏ, ẏ) + φ′ (ω × ẏ), with ẏ = L η, at a constant twist η (…, 6)."""
        W, rate = skew(twist[..., 3:]), turned(self.by_twist, twist)
        found = self.third(rate) + (self.first @ W + 2.0 * turned(self.second, rate[..., None, :])) @ W
        found += turned(self.second, turned(W, rate)[..., None, :])
        return np.asarray(found @ self.by_twist)


def no_angle(lengths: Vector) -> tuple[Vector, Vector]:
    """The openings of a kind that leaves angles free."""
    return lengths, np.zeros_like(lengths)
