"""A loss of an export or an import as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import BaseModel, ConfigDict, Field

from eurdf.convert.losses import Effect
from eurdf.diagnostics.report import encodable

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss
    from eurdf.diagnostics import Place


class LossInfo(BaseModel):
    """Something that one of two formats does not say as the other one does."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    code: Annotated[str, Field(pattern="^(export|import)(-[a-z0-9]+)+$")]
    """Permanent name of the kind of loss."""
    effect: Effect
    """What is left: exact, in other terms; approximate; dropped, nothing."""
    concept: str
    """Kind of the element, such as '3d closure'; the rows of the table of losses."""
    name: str
    """Name of the element."""
    message: str
    """What happened."""
    hint: str
    """What to do about it."""
    file: str | None
    """File that states the element; null if none does."""
    line: Annotated[int, Field(ge=1)] | None
    """Its line there, from 1."""


def loss_info(loss: Loss, place: Place | None) -> LossInfo:
    """A loss, and where its element is stated, if anywhere."""
    return LossInfo(
        code=loss.code,
        effect=loss.effect,
        concept=loss.concept,
        name=encodable(loss.name),
        message=encodable(loss.message),
        hint=loss.hint,
        file=None if place is None else encodable(place.file),
        line=None if place is None else place.line or None,
    )
