"""The constraints that a mechanism has beside its spanning tree, one class a kind.

What a kind means, its residual and the derivatives of that, is in `eurdf.kinematics.constraints`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Literal

from eurdf.mechanism.body import Anchor
from eurdf.mechanism.pose import Vector3

if TYPE_CHECKING:
    from typing_extensions import Self

#: Unit of a row of a residual; empty for one whose unit its coefficients decide.
Unit = Literal["m", "rad", ""]


@dataclass(frozen=True, slots=True)
class Constraint:
    """A relation that holds at every closed configuration.

    Attributes:
        type: Name of the kind, as files write it.
        units: Unit of each row of the residual.
        name: Unique among the constraints of a mechanism.
    """

    type: ClassVar[str]
    units: ClassVar[tuple[Unit, ...]]
    name: str

    @property
    def rows(self) -> int:
        """Number of rows of the residual."""
        return len(self.units)

    @property
    def anchors(self) -> tuple[Anchor, ...]:
        """Frames A and B that the constraint joins, if it joins frames."""
        return ()

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints whose coordinates the constraint relates, if it relates any."""
        return ()

    def with_joints_locked(self, coordinates: Mapping[str, float]) -> Self:
        """The constraint on the remaining joints, where those given are locked at their coordinates, rad or m."""
        return self


@dataclass(frozen=True, slots=True)
class Compliance:
    """How much a closure gives way under load: for simulators with soft constraints, without effect on kinematics.

    Attributes:
        linear: m/N; 0 is rigid.
        angular: rad/(N·m); 0 is rigid.
    """

    linear: float = 0.0
    angular: float = 0.0


RIGID = Compliance()


@dataclass(frozen=True, slots=True)
class Closure(Constraint):
    """A loop closure: it joins frame B to frame A.

    Attributes:
        a: Frame A.
        b: Frame B.
        compliance: What soft simulators may use.
    """

    a: Anchor
    b: Anchor
    compliance: Compliance = field(default=RIGID, kw_only=True)

    @property
    def anchors(self) -> tuple[Anchor, ...]:
        """Frames A and B."""
        return self.a, self.b

    def with_orientation_free(self) -> Closure:
        """The closure that constrains positions alone as this one does; itself if it leaves orientations free."""
        return self


@dataclass(frozen=True, slots=True)
class PointClosure(Closure):
    """The origin of B is at the origin of A: a ball joint."""

    type: ClassVar[str] = "3d"
    units: ClassVar[tuple[Unit, ...]] = ("m",) * 3


@dataclass(frozen=True, slots=True)
class FrameClosure(Closure):
    """B is at A in position and orientation: a weld."""

    type: ClassVar[str] = "6d"
    units: ClassVar[tuple[Unit, ...]] = ("m",) * 3 + ("rad",) * 3

    def with_orientation_free(self) -> PointClosure:
        """The 3d closure of the same frames."""
        return PointClosure(self.name, self.a, self.b)


@dataclass(frozen=True, slots=True)
class HingeClosure(Closure):
    """The origin of B is at the origin of A, and an axis of B is along an axis of A: a revolute joint.

    Attributes:
        axes: The axis in A and the axis in B, of any length but zero.
    """

    type: ClassVar[str] = "hinge"
    units: ClassVar[tuple[Unit, ...]] = ("m",) * 3 + ("rad",) * 2
    axes: tuple[Vector3, Vector3] = ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0))

    def with_orientation_free(self) -> PointClosure:
        """The 3d closure of the same frames."""
        return PointClosure(self.name, self.a, self.b)


@dataclass(frozen=True, slots=True)
class DistanceClosure(Closure):
    """The origins of A and B are at a fixed distance: a massless rod between two ball joints.

    Attributes:
        length: The distance, m; positive.
    """

    type: ClassVar[str] = "distance"
    units: ClassVar[tuple[Unit, ...]] = ("m",)
    length: float


@dataclass(frozen=True, slots=True)
class Coupling(Constraint):
    """A linear relation of joint coordinates: Σ cᵢ qᵢ = offset.

    Attributes:
        coefficients: cᵢ by the name of the joint, which has one coordinate, an angle (rad) or a length (m).
        offset: In the unit of cᵢ qᵢ.
    """

    type: ClassVar[str] = "coupling"
    units: ClassVar[tuple[Unit, ...]] = ("",)
    coefficients: tuple[tuple[str, float], ...]
    offset: float = 0.0

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order written."""
        return tuple(name for name, _ in self.coefficients)

    def with_joints_locked(self, coordinates: Mapping[str, float]) -> Self:
        """The same relation, with what the locked joints contribute moved into the offset."""
        return replace(
            self,
            coefficients=tuple(each for each in self.coefficients if each[0] not in coordinates),
            offset=self.offset - sum(c * coordinates[name] for name, c in self.coefficients if name in coordinates),
        )


#: The kinds of closure that files can state, by their type there.
CLOSURES: Mapping[str, type[Closure]] = {
    kind.type: kind for kind in (PointClosure, FrameClosure, HingeClosure, DistanceClosure)
}
