"""The output of ``eurdf import --format json``, and its JSON Schema."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from eurdf.commands.loss_info import LossInfo, loss_info
from eurdf.diagnostics.report import Report, encodable

if TYPE_CHECKING:
    from eurdf.convert.exceptions import CannotImport
    from eurdf.convert.import_robot import Import
    from eurdf.convert.losses import Loss
    from eurdf.diagnostics import Place


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class OpeningInfo(_Entry):
    """How far a constraint was from being met."""

    name: str
    """Name of the constraint."""
    position: float
    """Distance, m."""
    angle: float
    """Angle, rad."""


class ImportInfo(_Entry):
    """The output of 'eurdf import --format json'."""

    path: str
    """The file, as given."""
    format: Annotated[str, Field(examples=["mjcf"])] | None
    """Format of the file, as --from names it; null if it was not recognized."""
    files: tuple[str, ...]
    """Files that were written; empty if none was."""
    refused: str | None
    """Why nothing was written; null if the files were."""
    start: str | None
    """Where the openings were measured, such as the name of a keyframe; null if nothing was imported."""
    opened: tuple[OpeningInfo, ...]
    """How far each constraint was open there."""
    closes: bool | None
    """Whether there is a configuration at which every loop is closed; null if nothing was imported."""
    losses: tuple[LossInfo, ...]
    """Every loss, in the order found."""
    diagnostics: tuple[dict[str, Any], ...]
    """What 'eurdf check --format json' reports of the robot, also where --strict refuses to write it."""


def refused_import(
    path: str, format_: str | None, reason: CannotImport, place_of: Callable[[Loss], Place | None]
) -> ImportInfo:
    """An import that wrote nothing; the arguments are those of `import_info`, and why."""
    return ImportInfo(
        path=encodable(path),
        format=format_,
        files=(),
        refused=encodable(str(reason)),
        start=None,
        opened=(),
        closes=None,
        losses=tuple(loss_info(loss, place_of(loss)) for loss in reason.losses),
        diagnostics=_diagnostics(Report(path, reason.diagnostics)),
    )


def import_info(
    path: str, found: Import, files: Sequence[str], report: Report, place_of: Callable[[Loss], Place | None]
) -> ImportInfo:
    """An import as ``eurdf import`` shows it.

    Args:
        path: The file, as given.
        found: What was imported.
        files: Paths of the files that were written.
        report: What `eurdf.check` reports of them.
        place_of: Where the element of a loss is stated.
    """
    return ImportInfo(
        path=encodable(path),
        format=found.format,
        files=tuple(map(encodable, files)),
        refused=None,
        start=encodable(found.start),
        opened=tuple(
            OpeningInfo(name=encodable(each.name), position=each.position, angle=each.angle) for each in found.opened
        ),
        closes=found.closes,
        losses=tuple(loss_info(loss, place_of(loss)) for loss in found.losses),
        diagnostics=_diagnostics(report),
    )


def _diagnostics(report: Report) -> tuple[dict[str, Any], ...]:
    return tuple(report.to_json()["diagnostics"])


def import_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `ImportInfo`."""
    schema = ImportInfo.model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
