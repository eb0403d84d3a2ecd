"""The constraints that a mechanism has beside its spanning tree: closures (kinds: `eurdf.closures`) and couplings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

from eurdf.mechanism.body import Anchor

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


class ClosureKey(NamedTuple):
    """What a file states of a closure in one of its keys, beside the frames.

    Attributes:
        title: Its name for readers.
        text: What it is, with its unit.
        example: A value as files have it.
        type: Its type: ``float``, ``Vector3`` or ``tuple[Vector3, Vector3]``.
        least: The least value, or None.
        default: What it means if it is left out; None if it must not be.
    """

    title: str
    text: str
    example: Any
    type: str = ""
    least: float | None = None
    default: Any = None


class Form(NamedTuple):
    """A mapping in which a file states a closure of a kind.

    Attributes:
        name: Of its definition in the schema.
        title: What editors call it.
        text: What it is.
        keys: What it has beside name, type, frames and compliance, by key.
    """

    name: str
    title: str
    text: str
    keys: Mapping[str, ClosureKey]


def key(title: str, text: str, *, example: Any, least: float | None = None, **options: Any) -> Any:
    """A field of a kind that a file states in a key; ``options`` are those of `dataclasses.field`."""
    return field(metadata={"key": ClosureKey(title, text, example, least=least)}, **options)


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

    @property
    def own(self) -> dict[str, Any]:
        """What the closures of its kind have beside name, frames and compliance, by field."""
        return {each.name: getattr(self, each.name) for each in fields(self) if "key" in each.metadata}

    def stated(self) -> dict[str, Any]:
        """The same, by the keys in which a file states it."""
        return self.own

    def with_orientation_free(self) -> Closure:
        """The closure that constrains positions alone as this one does; itself if it leaves orientations free."""
        return self


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
