"""The entry point of ``eurdf certify``."""

from __future__ import annotations

from collections.abc import Sequence

from eurdf.errors import CannotRun
from eurdf_conformance.needed import missing, needs


def main(argv: Sequence[str]) -> int:
    """Run the command.

    Args:
        argv: What follows ``eurdf certify``.

    Returns:
        The exit code.

    Raises:
        CannotRun: A package is not installed, or the command cannot do what it was asked.
    """
    if lacking := missing():
        raise CannotRun(needs(lacking))
    from eurdf_conformance.command.run import certify

    return certify(argv)
