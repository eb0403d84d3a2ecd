"""The command line ``eurdf``.

Every command is a `Command` in a module of its own. Only the module of the command that runs is imported, and modules
that are slow to import, in its function.
"""

from __future__ import annotations

import argparse
import errno
import importlib
import io
import os
import sys
from collections.abc import Sequence
from typing import NoReturn, TextIO

from eurdf import __version__
from eurdf.commands import INTERRUPTED
from eurdf.commands.command import Command
from eurdf.errors import CannotExpand, CannotRun, MissingExtra
from eurdf.sandbox import BOUNDS_MEMORY

#: The commands, in the order in which the help shows them. Each is in the module of its name.
COMMANDS = (
    *("check", "explain", "info", "view", "picture", "assemble", "export", "import"),
    *("transmission", "serial", "robots", "migrate", "generate", "simplify", "schema", "certify"),
)

# `import` cannot be the name of a module.
_MODULES = {"import": "import_robot"}

_UNBOUNDED = " (this system does not bound the memory that reading a mesh, a xacro or an MJCF file takes)"

# Exit code of a program whose output nobody reads any more: 128 plus the number of SIGPIPE.
_BROKEN_PIPE = 141

# Errors of a full disk.
_FULL = (errno.ENOSPC, errno.EFBIG)

# Half of the time of a check is start-up. The matrices are too small for a thread pool, and pydantic plugins are not
# needed.
_START_FASTER = {"OPENBLAS_NUM_THREADS": "1", "PYDANTIC_DISABLE_PLUGINS": "__all__"}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; the exit code is 0 for success, 1 if a robot has errors, 2 if the command cannot run."""
    for name, value in _START_FASTER.items():
        os.environ.setdefault(name, value)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the parent process
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 - open until the process ends
    _write_any_character(sys.stdout)
    _write_any_character(sys.stderr)
    try:
        argv = sys.argv[1:] if argv is None else argv
        args = _parser(argv[0] if argv else "").parse_args(argv)
        code: int = args.run(args)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # The reader is gone. Redirect the final flush of the interpreter to nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _BROKEN_PIPE
    except (CannotRun, CannotExpand, MissingExtra, OSError) as reason:  # OSError: also RobotNotFound
        from eurdf.diagnostics.wording import visible

        said = str(reason)
        if isinstance(reason, OSError) and reason.errno in _FULL and reason.filename is None:  # no file
            said = f"cannot write the standard output: {reason.strerror}"
        sys.stderr.write(f"eurdf: {visible(said)}\n")
        return 2
    except Exception:
        # Uncaught, it would exit with 1, which means that the robot has errors.
        import traceback

        traceback.print_exc()
        sys.stderr.write("eurdf: this is a bug in eurdf, not an error of the robot; please report it\n")
        return 2
    return code


class _Parser(argparse.ArgumentParser):
    """A parser of arguments whose errors cannot control a terminal or a log."""

    def error(self, message: str) -> NoReturn:
        from eurdf.diagnostics.wording import visible

        super().error(visible(message))


def _parser(command: str) -> argparse.ArgumentParser:
    """The parser of one command, or of all if there is no command of this name."""
    parser = _Parser(prog="eurdf", description="Robots with closed kinematic chains, from a URDF and one YAML file.")
    version = f"eurdf {__version__}{'' if BOUNDS_MEMORY else _UNBOUNDED}"
    parser.add_argument("--version", action="version", version=version, help="show the version and exit")
    subparsers = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name in [command] if command in COMMANDS else COMMANDS:
        module = _MODULES.get(name, name)
        added: Command = getattr(importlib.import_module(f"eurdf.commands.{module}"), module)
        added.register(subparsers, name)
    return parser


def _write_any_character(stream: TextIO) -> None:
    """Write characters that the locale cannot encode as escapes."""
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(errors="backslashreplace")
