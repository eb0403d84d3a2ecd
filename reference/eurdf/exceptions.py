"""Exceptions of reading and loading a robot, and the base class of all exceptions of the package."""

from __future__ import annotations

from typing import Any

from eurdf.diagnostics import Diagnostic
from eurdf.diagnostics.registry import Severity
from eurdf.diagnostics.wording import no_command, visible


class Portable(BaseException):
    """An exception or warning that can be pickled and copied, also if its constructor takes more than its text.

    By default, an exception is restored by calling its class with the text alone. If that fails in the parent of a
    worker process, the parent waits for ever.
    """

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self.args, self.__dict__)


def _restored(kind: type[BaseException], arguments: tuple[Any, ...], attributes: dict[str, Any]) -> BaseException:
    error = kind.__new__(kind)
    builtin = next(base for base in kind.__mro__ if base.__module__ == "builtins")
    builtin.__init__(error, *arguments)  # type: ignore[misc] # not the constructor of the class, which takes more
    error.__dict__.update(attributes)
    return error


class EurdfError(Portable, Exception):
    """Base of all errors of this package."""


class InvalidRobot(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A robot cannot be built without guessing.

    Attributes:
        path: The path that the caller gave.
        diagnostics: All diagnostics, including warnings, in the order found; the text shows the errors first.
    """

    def __init__(self, path: str, diagnostics: tuple[Diagnostic, ...], reason: str = "") -> None:
        self.path = path
        self.diagnostics = diagnostics
        errors_first = sorted(diagnostics, key=lambda found: found.severity is not Severity.ERROR)
        lines = [
            no_command(visible(reason or f"{path} is not a valid robot")),
            *(f"  {found}" for found in errors_first),
        ]
        super().__init__("\n".join(lines))


class RobotNotFound(EurdfError, FileNotFoundError):  # noqa: N818 - part of the public interface
    """A path does not exist and is not the name of a robot of the collection.

    Attributes:
        path: The path that the caller gave.
    """

    def __init__(self, path: str, message: str) -> None:
        self.path = path
        super().__init__(message)


class CannotExpand(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A xacro file cannot be expanded with the given arguments.

    Attributes:
        path: The file.
        reason: The message of xacro.
    """

    def __init__(self, path: str, reason: str) -> None:
        self.path = path
        self.reason = reason
        super().__init__(f"xacro cannot expand '{path}': {reason}")


class MissingExtra(EurdfError, ImportError):  # noqa: N818 - part of the public interface
    """An optional dependency is not installed.

    Attributes:
        extra: The extra of this package that installs it.
    """

    def __init__(self, message: str, extra: str) -> None:
        self.extra = extra
        super().__init__(message)


class CannotRun(Exception):  # noqa: N818 - shown to the user as it is
    """A command of the command line cannot run, as opposed to errors of a robot; the text says why. Exit code 2."""
