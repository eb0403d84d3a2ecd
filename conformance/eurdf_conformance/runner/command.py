"""Turns the text of ``--parser`` into the command that starts a parser."""

from __future__ import annotations

import errno
import re
import shlex
import sys
from pathlib import Path

#: The adapter of the reference parser, eurdf.
REFERENCE = "eurdf_conformance.adapters.reference:PARSER"

_OBJECT = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")


def command_of(parser: str) -> list[str]:
    """The program of a parser and its arguments.

    Args:
        parser: ``package.module:object``, a Python object that `protocol.serve` serves; or ``cmd:`` and a command line,
            split as a shell does it, but not run by one; or ``reference``, the reference parser.

    Raises:
        ValueError: It is none of them.
    """
    if parser == "reference":
        parser = REFERENCE
    if parser.startswith("cmd:"):
        command = shlex.split(parser.removeprefix("cmd:"))
        if not command:
            raise ValueError("the command after 'cmd:' is missing")
        return command
    if _OBJECT.fullmatch(parser):
        return [sys.executable, "-m", "eurdf_conformance.protocol.serve", parser]
    raise ValueError(f"'{parser}' is neither 'package.module:object' nor 'cmd:' and a command line, nor 'reference'")


def why_not(program: str, error: Exception) -> str:
    """Why a program cannot be started, and what may help.

    Args:
        program: As the command line has it.
        error: What came of trying.
    """
    path, is_path = Path(program), "/" in program
    match error:
        case FileNotFoundError() if not is_path:
            hint = f"; write './{program}' for the file in this folder" if path.is_file() else ""
            return f"program '{program}' is not in PATH{hint}"
        case FileNotFoundError() if path.exists():
            return f"the interpreter in the first line of '{program}' does not exist"
        case FileNotFoundError():
            return f"program '{path.absolute()}' does not exist"
        case PermissionError() if path.is_dir():
            return f"'{program}' is a folder"
        case PermissionError() if path.is_file():
            return f"'{program}' is not executable: chmod +x, or name what runs it, as in 'cmd:python {program}'"
        case OSError(errno=errno.ENOEXEC):
            return f"'{program}' is not a program; a script needs a first line such as '#!/usr/bin/env python3'"
        case _:
            return str(error)
