"""``eurdf certify``: the command of the conformance suite, which is another distribution, ``eurdf-conformance``."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

from eurdf.commands.cannot_run import CannotRun

#: Entry points of this group are commands: functions of their arguments that return the exit code.
GROUP = "eurdf.commands"


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser. The suite parses the arguments: no character makes one an option here."""
    words = "run the conformance suite on any parser, in any language"
    parser = subparsers.add_parser("certify", help=words, add_help=False, prefix_chars="\0")
    parser.add_argument("arguments", nargs="*")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Run the command of the suite.

    Raises:
        CannotRun: The suite is not installed.
    """
    from importlib.metadata import entry_points

    found = tuple(entry_points(group=GROUP, name="certify"))
    if not found:
        from eurdf.diagnostics.extras import install_suite_command

        raise CannotRun(f"the conformance suite is not installed; install it with: {install_suite_command()}")
    command: Callable[[Sequence[str]], int] = found[0].load()
    return command(args.arguments)
