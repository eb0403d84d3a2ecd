"""The output of ``eurdf export --format json``, and its JSON Schema."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from eurdf.commands.loss_info import LossInfo, loss_info
from eurdf.diagnostics.report import encodable

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss
    from eurdf.convert.verification.verify import Verification
    from eurdf.diagnostics import Place
    from eurdf.kinematics.opening import Opening


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class OpeningInfo(_Entry):
    """How far a closure, coupling or mimic joint of the file is open."""

    position: float | None
    """Distance, m; null if it is not finite."""
    angle: float | None
    """Angle, rad; null if it is not finite."""


class LargestOpening(OpeningInfo):
    """The largest opening in a simulation."""

    time: float
    """When, s."""


class ConstraintInfo(_Entry):
    """A closure, coupling or mimic joint of the file."""

    name: str
    """Its name in the file."""
    start: OpeningInfo
    """How far it is open at the start."""
    fall: LargestOpening | None
    """How far it opens in the simulation; null if nothing is simulated."""


class FallInfo(_Entry):
    """A simulation of 2 s from rest at the start, with gravity and without actuation."""

    seconds: float
    """Simulated time, s; less than 2 if it diverges."""
    diverged: bool
    """Whether a number was not finite."""


class FindingInfo(_Entry):
    """Something that is wrong with the file."""

    message: str
    """What is wrong, with its values."""
    causes: tuple[str, ...]
    """What was seen of the cause, and what to do."""


class BeyondLimits(_Entry):
    """A coordinate that is outside its limits at the start."""

    joint: str
    """Name of the joint in the file."""
    value: float
    """Its value, rad or m."""
    lower: float | None
    """Its lower limit; null if there is none."""
    upper: float | None
    """Its upper limit; null if there is none."""


class VerificationInfo(_Entry):
    """What a program reads of the exported file, against the robot."""

    reader: Annotated[str, Field(examples=["MuJoCo 4.0.0"])]
    """The program and its version."""
    refused: str | None
    """What the program says if it refuses the file; else null. If it does, the numbers below are 0."""
    mass_read: float
    """Mass of all bodies, as read, kg."""
    mass: float
    """Mass of all bodies of the robot, kg."""
    mass_matrix_error: float
    """Largest difference of the mass matrix at the start, relative to its largest entry."""
    constraints: tuple[ConstraintInfo, ...]
    """Closures, couplings and mimic joints that the file states."""
    beyond_limits: tuple[BeyondLimits, ...]
    """Coordinates outside their limits at the start."""
    fall: FallInfo | None
    """The simulation; null if the program simulates nothing."""
    findings: tuple[FindingInfo, ...]
    """What is wrong; empty if nothing is."""
    listed: tuple[str, ...]
    """What differs as losses say."""
    unverified: tuple[str, ...]
    """What this program cannot compare."""


class ExportInfo(_Entry):
    """The output of 'eurdf export --format json'."""

    path: str
    """The robot, as given."""
    format: Annotated[str, Field(examples=["mjcf"])]
    """Format that it was exported to, as --to names it."""
    files: tuple[str, ...]
    """Files that were written, the main one first; empty if none was."""
    refused: str | None
    """Why nothing was written; null if the files were."""
    losses: tuple[LossInfo, ...]
    """Every loss, in the order found."""
    verification: VerificationInfo | None
    """What reading the files back found, with --verify; else null."""


def export_info(
    path: str,
    to: str,
    files: Sequence[str],
    losses: Sequence[Loss],
    refusal: str,
    place_of: Callable[[Loss], Place | None],
    verification: Verification | None = None,
) -> ExportInfo:
    """An export as ``eurdf export`` shows it.

    Args:
        path: The robot, as given.
        to: Name of the format.
        files: Paths of the files that were written.
        losses: The losses.
        refusal: Why nothing was written; empty if the files were.
        place_of: Where the element of a loss is stated.
        verification: What reading the files back found.
    """
    return ExportInfo(
        path=encodable(path),
        format=to,
        files=tuple(encodable(each) for each in files),
        refused=refusal or None,
        losses=tuple(loss_info(loss, place_of(loss)) for loss in losses),
        verification=None if verification is None else _verification_info(verification),
    )


def _verification_info(found: Verification) -> VerificationInfo:
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
                name=encodable(start.name),
                start=OpeningInfo(**_opening(start)),
                fall=None if most is None else LargestOpening(**_opening(most[0]), time=most[1]),
            )
            for start, most in zip(found.openings, largest or [None] * len(found.openings), strict=True)
        ),
        beyond_limits=tuple(
            BeyondLimits(joint=each.joint, value=each.value, lower=_finite(each.lower), upper=_finite(each.upper))
            for each in found.beyond_limits
        ),
        fall=None if fall is None else FallInfo(seconds=fall.seconds, diverged=fall.diverged),
        findings=tuple(
            FindingInfo(message=encodable(each.message), causes=tuple(map(encodable, each.causes)))
            for each in found.findings
        ),
        listed=found.listed,
        unverified=found.unverified,
    )


def _opening(opening: Opening) -> dict[str, float | None]:
    return {"position": _finite(opening.position), "angle": _finite(opening.angle)}


def _finite(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None


def export_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `ExportInfo`."""
    schema = ExportInfo.model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
