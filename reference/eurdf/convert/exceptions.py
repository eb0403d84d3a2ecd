"""Exceptions of exports and imports."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from eurdf.diagnostics.wording import visible
from eurdf.exceptions import EurdfError

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss
    from eurdf.diagnostics import Diagnostic


class CannotExport(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot cannot be written in a format.

    Attributes:
        losses: What was refused, where the caller refuses losses.
    """

    def __init__(self, message: str, losses: tuple[Loss, ...] = ()) -> None:
        self.losses = losses
        super().__init__(message)


class CannotImport(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A file cannot be imported.

    Attributes:
        path: The file.
        reason: What is wrong, and what would be right.
        losses: What was refused, where the caller refuses losses.
        diagnostics: The errors that were refused, where the caller refuses the robot's errors.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        reason: str,
        losses: tuple[Loss, ...] = (),
        diagnostics: tuple[Diagnostic, ...] = (),
    ) -> None:
        self.path, self.reason, self.losses, self.diagnostics = os.fspath(path), reason, losses, diagnostics
        super().__init__(visible(f"cannot import '{self.path}': {reason}"))
