"""The output of ``eurdf export --format json``, and its JSON Schema."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from eurdf.commands.loss_info import LossInfo, loss_info
from eurdf.diagnostics.report import encodable

if TYPE_CHECKING:
    from eurdf.diagnostics import Place
    from eurdf.loss import Loss


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


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


def export_info(
    path: str,
    to: str,
    files: Sequence[str],
    losses: Sequence[Loss],
    refusal: str,
    place_of: Callable[[Loss], Place | None],
) -> ExportInfo:
    """An export as ``eurdf export`` shows it.

    Args:
        path: The robot, as given.
        to: Name of the format.
        files: Paths of the files that were written.
        losses: The losses.
        refusal: Why nothing was written; empty if the files were.
        place_of: Where the element of a loss is stated.
    """
    return ExportInfo(
        path=encodable(path),
        format=to,
        files=tuple(encodable(each) for each in files),
        refused=refusal or None,
        losses=tuple(loss_info(loss, place_of(loss)) for loss in losses),
    )


def export_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of `ExportInfo`."""
    schema = ExportInfo.model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
