"""Errors that prevent a command from running, as opposed to errors in a robot."""


class CannotRun(Exception):  # noqa: N818 - shown to the user as it is
    """The command cannot run; the text says why. Exit code 2."""
