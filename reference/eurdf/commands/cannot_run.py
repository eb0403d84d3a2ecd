"""What keeps a command from running at all, as against what it finds."""


class CannotRun(Exception):  # noqa: N818 - said to the user as it stands
    """The command cannot do what it was asked; its text says why. Exit code 2."""
