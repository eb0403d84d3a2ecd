"""What reading and loading a robot raises, and the base of all errors of the package."""

from __future__ import annotations

from eurdf.diagnostics import Diagnostic
from eurdf.diagnostics.registry import Severity


class EurdfError(Exception):
    """Base of all errors of this package."""


class InvalidRobot(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot that cannot be built without guessing.

    Attributes:
        path: As the caller gave it.
        diagnostics: Everything found, warnings too, in the order found; the text has the errors first.
    """

    def __init__(self, path: str, diagnostics: tuple[Diagnostic, ...], reason: str = "") -> None:
        self.path = path
        self.diagnostics = diagnostics
        errors_first = sorted(diagnostics, key=lambda found: found.severity is not Severity.ERROR)
        lines = [reason or f"{path} is not a valid robot", *(f"  {found}" for found in errors_first)]
        super().__init__("\n".join(lines))


class RobotNotFound(EurdfError, FileNotFoundError):  # noqa: N818 - part of the public interface
    """Neither a path nor the name of a robot of the collection.

    Attributes:
        path: As the caller gave it.
    """

    def __init__(self, path: str, message: str) -> None:
        self.path = path
        super().__init__(message)


class CannotExpand(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A xacro file that cannot be expanded with the arguments that are given.

    Attributes:
        path: The file.
        reason: Why not.
    """

    def __init__(self, path: str, reason: str) -> None:
        self.path = path
        self.reason = reason
        super().__init__(f"xacro cannot expand '{path}': {reason}")


class MissingExtra(EurdfError, ImportError):  # noqa: N818 - part of the public interface
    """An optional dependency that is needed and not installed.

    Attributes:
        extra: The extra of this package that installs it.
    """

    def __init__(self, message: str, extra: str) -> None:
        self.extra = extra
        super().__init__(message)
