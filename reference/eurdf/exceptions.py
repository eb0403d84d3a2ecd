"""What `eurdf` raises."""

from __future__ import annotations

from eurdf.diagnostics import Diagnostic


class EurdfError(Exception):
    """Base of all errors of this package."""


class InvalidRobot(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot that cannot be built without guessing.

    Attributes:
        path: As the caller gave it.
        diagnostics: Everything found, warnings too.
    """

    def __init__(self, path: str, diagnostics: tuple[Diagnostic, ...], reason: str = "") -> None:
        self.path = path
        self.diagnostics = diagnostics
        lines = [reason or f"{path} is not a valid robot", *(f"  {found}" for found in diagnostics)]
        super().__init__("\n".join(lines))


class RobotNotFound(EurdfError, FileNotFoundError):  # noqa: N818 - part of the public interface
    """Neither a path nor the name of a robot of the collection.

    Attributes:
        path: As the caller gave it.
    """

    def __init__(self, path: str, message: str) -> None:
        self.path = path
        super().__init__(message)
