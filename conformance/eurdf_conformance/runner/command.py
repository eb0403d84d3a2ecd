"""From the text of ``--parser`` to the command that starts a reader."""

from __future__ import annotations

import re
import shlex
import sys

_OBJECT = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")


def command_of(parser: str) -> list[str]:
    """The program that a parser is, and its arguments.

    Args:
        parser: ``package.module:object``, a Python object that `protocol.serve` serves; or ``cmd:`` and a command line,
            split as a shell does it, but not run by one.

    Raises:
        ValueError: It is neither.
    """
    if parser.startswith("cmd:"):
        command = shlex.split(parser.removeprefix("cmd:"))
        if not command:
            raise ValueError("after 'cmd:' there is no command")
        return command
    if _OBJECT.fullmatch(parser):
        return [sys.executable, "-m", "eurdf_conformance.protocol.serve", parser]
    raise ValueError(f"'{parser}' is neither 'package.module:object' nor 'cmd:' and a command line")
