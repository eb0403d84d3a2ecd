"""``eurdf certify``: the command of the conformance suite, which is another distribution, ``eurdf-conformance``."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from typing import Any

from eurdf.errors import CannotRun

#: Entry points of this group are commands: functions of their arguments that return the exit code.
GROUP = "eurdf.commands"


class Certify:
    """A command whose arguments the suite parses."""

    summary = "run the conformance suite on any parser, in any language"

    def register(self, subparsers: argparse._SubParsersAction[Any], name: str) -> None:
        """Add the command to the parser; no character makes an argument an option here."""
        parser = subparsers.add_parser(name, add_help=False, prefix_chars="\0")
        parser.add_argument("arguments", nargs="*")
        parser.set_defaults(run=self.run)

    def run(self, args: argparse.Namespace) -> int:
        """Run the command of the suite.

        Raises:
            CannotRun: The suite is not installed.
        """
        from importlib.metadata import entry_points

        found = tuple(entry_points(group=GROUP, name="certify"))
        if not found:
            from eurdf.diagnostics.extras import install_suite_command

            raise CannotRun(f"the conformance suite is not installed; install it with: {install_suite_command()}")
        run: Callable[[Sequence[str]], int] = found[0].load()
        return run(args.arguments)


certify = Certify()
