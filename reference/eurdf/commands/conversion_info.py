"""The outputs of ``eurdf export``, ``eurdf import`` and ``eurdf simplify`` with ``--json``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from eurdf.convert.losses import Effect, Loss
from eurdf.convert.same_motion import SameMotion
from eurdf.convert.verification.read_model import Finding
from eurdf.json_schema import Keywords, NullIfInfinite
from eurdf.kinematics.opening import Opening
from eurdf.writing.rewriting import RobotSize

if TYPE_CHECKING:
    from eurdf.convert.simplify import Simplification
    from eurdf.convert.verification.verify import Verification
    from eurdf.diagnostics import Place


@dataclass(frozen=True, slots=True)
class LossInfo:
    """Something that one of two formats does not say as the other one does."""

    LIKE: ClassVar = "eurdf.convert.losses:Loss"

    code: Annotated[str, Keywords(pattern="^(export|import)(-[a-z0-9]+)+$")]
    effect: Effect
    concept: str
    name: str
    message: str
    hint: str
    file: str | None
    """File that states the element; null if none does."""
    line: Annotated[int, Keywords(minimum=1)] | None
    """Its line there, from 1."""


@dataclass(frozen=True, slots=True)
class ConversionOpening:
    """How far a closure, coupling or mimic joint of the file is open.

    Attributes:
        position: Distance, m; None if it is not finite.
        angle: Angle, rad; None if it is not finite.
    """

    position: NullIfInfinite
    angle: NullIfInfinite


@dataclass(frozen=True, slots=True)
class LargestOpening(ConversionOpening):
    """The largest opening in a simulation."""

    time: float
    """When, s."""


@dataclass(frozen=True, slots=True)
class ConstraintInfo:
    """A closure, coupling or mimic joint of the file."""

    name: str
    """Its name in the file."""
    start: ConversionOpening
    """How far it is open at the start."""
    fall: LargestOpening | None
    """How far it opens in the simulation; null if nothing is simulated."""


@dataclass(frozen=True, slots=True)
class FallInfo:
    """A simulation of 2 s from rest at the start, with gravity and without actuation."""

    LIKE: ClassVar = "eurdf.convert.verification.fall:Fall"

    seconds: float
    diverged: bool


@dataclass(frozen=True, slots=True)
class BeyondLimits:
    """A coordinate that is outside its limits at the start."""

    joint: str
    """Name of the joint in the file."""
    value: float
    """Its value, rad or m."""
    lower: NullIfInfinite
    """Its lower limit; null if there is none."""
    upper: NullIfInfinite
    """Its upper limit; null if there is none."""


@dataclass(frozen=True, slots=True)
class VerificationInfo:
    """What a program reads of the exported file, against the robot."""

    LIKE: ClassVar = "eurdf.convert.verification.verify:Verification"

    reader: Annotated[str, Keywords(examples=["MuJoCo 4.0.0"])]
    refused: str | None
    """What the program says if it refuses the file; else null. If it does, the numbers below are 0."""
    mass_read: float
    """Mass of all bodies, as read, kg."""
    mass: float
    """Mass of all bodies of the robot, kg."""
    mass_matrix_error: float
    constraints: tuple[ConstraintInfo, ...]
    """Closures, couplings and mimic joints that the file states."""
    beyond_limits: tuple[BeyondLimits, ...]
    fall: FallInfo | None
    findings: tuple[Finding, ...]
    listed: tuple[str, ...]
    unverified: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ExportInfo:
    """The output of 'eurdf export --json'."""

    path: str
    """The robot, as given."""
    format: Annotated[str, Keywords(examples=["mjcf"])]
    """Format that it was exported to, as --to names it."""
    files: tuple[str, ...]
    """Files that were written, the main one first; empty if none was."""
    refused: str | None
    """Why nothing was written; null if the files were."""
    losses: tuple[LossInfo, ...]
    """Every loss, in the order found."""
    verification: VerificationInfo | None
    """What reading the files back found, with --verify; else null."""


@dataclass(frozen=True, slots=True)
class ImportInfo:
    """The output of 'eurdf import --json'."""

    path: str
    """The file, as given."""
    format: Annotated[str, Keywords(examples=["mjcf"])] | None
    """Format of the file, as --from names it; null if it was not recognized."""
    files: tuple[str, ...]
    """Files that were written; empty if none was."""
    refused: str | None
    """Why nothing was written; null if the files were."""
    start: str | None
    """Where the openings were measured, such as the name of a keyframe; null if nothing was imported."""
    opened: tuple[Opening, ...]
    """How far each constraint was open there."""
    closes: bool | None
    """Whether there is a configuration at which every loop is closed; null if nothing was imported."""
    losses: tuple[LossInfo, ...]
    """Every loss, in the order found."""
    diagnostics: tuple[dict[str, Any], ...]
    """What 'eurdf check --json' reports of the robot, also where --strict refuses to write it."""


@dataclass(frozen=True, slots=True)
class SimplifyInfo:
    """The output of 'eurdf simplify --json'."""

    LIKE: ClassVar = "eurdf.convert.simplify:Simplification"

    path: str
    """The robot, as given."""
    files: tuple[str, ...]
    """Files that were written; empty if none was."""
    changes: tuple[str, ...]
    kept: tuple[str, ...]
    lost: tuple[str, ...]
    before: RobotSize
    after: RobotSize
    motion: SameMotion | None

    @classmethod
    def of(cls, path: str, files: tuple[str, ...], found: Simplification) -> SimplifyInfo:
        """What was found, and written."""
        own = (found.changes, found.kept, found.lost, found.before, found.after, found.motion)
        return cls(path, files, *own)


def loss_infos(losses: Sequence[Loss], place_of: Callable[[Loss], Place | None]) -> tuple[LossInfo, ...]:
    """Losses, and where the element of each is stated, if anywhere."""
    return tuple(
        LossInfo(**asdict(loss), file=place.file if place else None, line=place.line or None if place else None)
        for loss, place in ((loss, place_of(loss)) for loss in losses)
    )


def verification_info(found: Verification) -> VerificationInfo:
    """What `Export.verify` found."""
    fall = found.fall
    largest = zip(fall.openings, fall.times, strict=True) if fall is not None and fall.openings else None
    return VerificationInfo(
        reader=found.reader,
        refused=found.refused or None,
        mass_read=found.mass[0],
        mass=found.mass[1],
        mass_matrix_error=found.mass_matrix_error,
        constraints=tuple(
            ConstraintInfo(
                start.name,
                ConversionOpening(start.position, start.angle),
                None if most is None else LargestOpening(most[0].position, most[0].angle, most[1]),
            )
            for start, most in zip(found.openings, largest or [None] * len(found.openings), strict=True)
        ),
        beyond_limits=tuple(
            BeyondLimits(each.joint, each.value, each.lower, each.upper) for each in found.beyond_limits
        ),
        fall=None if fall is None else FallInfo(fall.seconds, fall.diverged),
        findings=found.findings,
        listed=found.listed,
        unverified=found.unverified,
    )
