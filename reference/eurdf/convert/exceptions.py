"""Exceptions of exports."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eurdf.exceptions import EurdfError

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss


class CannotExport(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot cannot be written in a format.

    Attributes:
        losses: What was refused, where the caller refuses losses.
    """

    def __init__(self, message: str, losses: tuple[Loss, ...] = ()) -> None:
        self.losses = losses
        super().__init__(message)
