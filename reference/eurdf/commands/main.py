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
from collections.abc import Mapping, Sequence
from itertools import chain, pairwise
from textwrap import fill
from typing import Any, NoReturn, TextIO

from eurdf import __version__
from eurdf.commands import INTERRUPTED
from eurdf.commands.command import Command, add_style
from eurdf.commands.terminal import STYLE, Style, columns, write_json
from eurdf.errors import CannotExpand, CannotRun, MissingExtra
from eurdf.sandbox import BOUNDS_MEMORY

#: The commands, in the groups and the order in which the help shows them. Each is in the module of its name.
GROUPS = {
    "look at a robot": ("check", "explain", "info", "view", "picture", "robots"),
    "write a description": ("generate", "assemble", "migrate", "simplify", "schema"),
    "convert": ("export", "import", "serial"),
    "measure": ("transmission",),
    "parsers, editors and shells": ("certify", "server", "completion"),
}
COMMANDS = tuple(chain.from_iterable(GROUPS.values()))

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
    argv = [*(sys.argv[1:] if argv is None else argv)] or ["--help"]
    if argv[0] == "help":  # of a command, or of all
        argv = [*argv[1:2], "--help"]
    as_json = "--json" in argv or "--format=json" in argv or ("--format", "json") in pairwise(argv)
    style = STYLE.set(Style())
    try:
        args = parser_of(next((word for word in argv if not word.startswith("-")), ""), as_json).parse_args(argv)
        STYLE.set(Style(*(getattr(args, name, False) for name in Style._fields)))
        code: int = args.run(args)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # The reader is gone. Redirect the final flush of the interpreter to nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _BROKEN_PIPE
    except (CannotRun, CannotExpand, MissingExtra, OSError) as reason:  # OSError: also RobotNotFound
        from eurdf.diagnostics.wording import encodable, visible

        said = str(reason)
        if isinstance(reason, OSError) and reason.errno in _FULL and reason.filename is None:  # no file
            said = f"cannot write the standard output: {reason.strerror}"
        sys.stderr.write(f"eurdf: {visible(said)}\n")
        if as_json:
            write_json({"error": encodable(said)})
        return 2
    except Exception:
        # Uncaught, it would exit with 1, which means that the robot has errors.
        import traceback

        traceback.print_exc()
        sys.stderr.write("eurdf: this is a bug in eurdf, not an error of the robot; please report it\n")
        return 2
    finally:
        STYLE.reset(style)
    return code


class _Parser(argparse.ArgumentParser):
    """A parser of arguments whose errors cannot control a terminal or a log, and name what was probably meant."""

    #: Whether errors are also written as JSON.
    as_json = False

    def error(self, message: str) -> NoReturn:
        from eurdf.diagnostics.wording import encodable, visible

        if self.as_json:
            write_json({"error": encodable(message)})
        self.exit(2, f"{self.prog}: {visible(message)}\n`{self.prog} --help` shows the arguments and examples\n")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As the base class; what a command does not know is an error of that command, not of `eurdf`."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            from eurdf.diagnostics.wording import meant

            hint = meant(unknown[0].partition("=")[0], self._option_string_actions)
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
        return found, unknown

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        choices = [*(action.choices or ())]
        if not choices or value in choices:
            return
        from eurdf.convert.formats import format_meant
        from eurdf.diagnostics.wording import meant

        if action.metavar == "COMMAND":
            message = f"there is no command '{value}'{meant(value, choices) or '; `eurdf help` lists the commands'}"
            raise argparse.ArgumentError(None, message)
        is_format = action.metavar == "FORMAT"
        hint = format_meant(value, choices) if is_format else meant(value, choices)[2:]
        what = f"{'format ' * is_format}'{value}'"
        raise argparse.ArgumentError(action, f"there is no {what}; {hint or 'choose ' + ' or '.join(choices)}")


def parser_of(command: str = "", as_json: bool = False) -> argparse.ArgumentParser:
    """The parser of one command, or of all if there is no command of this name; its errors are also written as JSON."""
    parser = _Parser(
        prog="eurdf",
        usage="%(prog)s [-h] [--version] [-q] [--no-color] COMMAND ...",
        description="Robots with closed kinematic chains, from a URDF and one YAML file.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.as_json = as_json
    version = f"eurdf {__version__}{'' if BOUNDS_MEMORY else _UNBOUNDED}"
    parser.add_argument("--version", action="version", version=version, help="show the version and exit")
    add_style(parser)
    subparsers = parser.add_subparsers(
        prog="eurdf",
        metavar="COMMAND",
        required=True,
        help=argparse.SUPPRESS,
    )
    commands: dict[str, Command] = {}
    for name in [command] if command in COMMANDS else COMMANDS:
        commands[name] = command_of(name)
        commands[name].register(subparsers, name)
        subparsers.choices[name].as_json = as_json
    if command not in COMMANDS:
        parser.epilog = _list_of({name: each.summary for name, each in commands.items()})
    return parser


def command_of(name: str) -> Command:
    """The command of a name of `COMMANDS`."""
    module = _MODULES.get(name, name)
    found: Command = getattr(importlib.import_module(f"eurdf.commands.{module}"), module)
    return found


def _list_of(summaries: Mapping[str, str]) -> str:
    """The commands in their groups, for a terminal of any width."""
    lines = []
    for group, names in GROUPS.items():
        lines.append(f"{group}:")
        for name in names:
            indent = " " * 18
            lines.append(fill(f"    {name:<13} {summaries[name]}", max(columns() - 2, 40), subsequent_indent=indent))
    return "\n".join([*lines, "", "`eurdf help COMMAND` shows the options of a command and examples."])


def _write_any_character(stream: TextIO) -> None:
    """Write characters that the locale cannot encode as escapes."""
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(errors="backslashreplace")
