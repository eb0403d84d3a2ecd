"""What a command is: a function, its arguments, and how errors end it."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from eurdf.collection.near_paths import near_path
from eurdf.commands.selection import select_one
from eurdf.commands.terminal import write_refusal
from eurdf.exceptions import CannotRun, InvalidRobot, MissingExtra
from eurdf.reading.robot_source import is_stream, is_text

#: The path that means the standard output.
STDOUT = "-"

_PATH = "a robot: a folder, a .yaml, .urdf or .xacro file, - for standard input, or a name of the collection"
_URDF_ENDINGS = (".urdf", ".xml", ".xacro")


@dataclass(frozen=True, slots=True)
class Option:
    """One argument.

    Attributes:
        names: Its name, or the names of an option.
        settings: The other parameters of `argparse.ArgumentParser.add_argument`.
    """

    names: tuple[str, ...]
    settings: dict[str, Any]


@dataclass(frozen=True, slots=True)
class OneOf:
    """Options that exclude each other."""

    options: tuple[Option, ...]


def option(*names: str, **settings: Any) -> Option:
    """An argument, with the parameters of `argparse.ArgumentParser.add_argument`."""
    return Option(names, settings)


def one_of(*options: Option) -> OneOf:
    """Options that exclude each other."""
    return OneOf(options)


def _xacro_arg(text: str) -> tuple[str, str]:
    name, separator, value = text.partition(":=")
    if not (separator and name.strip()):
        raise argparse.ArgumentTypeError(f"'{text}' does not have the form NAME:=VALUE")
    return name.strip(), value.strip()


#: Where a URDF, or a robot, may find other files: the function gets them as ``options``.
URDF_OPTIONS = (
    option(
        "--package-dir",
        metavar="DIR",
        dest="package_dirs",
        action="append",
        default=[],
        help="a folder with ROS packages, to find meshes and xacro files (repeatable)",
    ),
    option(
        "--xacro-arg",
        metavar="NAME:=VALUE",
        dest="xacro_args",
        type=_xacro_arg,
        action="append",
        default=[],
        help="an argument of the .xacro file that is given, or that the description names (repeatable)",
    ),
)

_ROBOT_OPTIONS = (
    option(
        "--urdf",
        metavar="FILE",
        help="the URDF, instead of the one that the description names; - for standard input",
    ),
    one_of(
        option(
            "--confined",
            action="store_true",
            help="refuse a description that names a URDF outside its own folder or a xacro, and a URDF that names a "
            "mesh outside the robot's folder",
        ),
        option("--allow-outside", action="store_true", help="read meshes that are outside the robot's folder"),
    ),
    *URDF_OPTIONS,
)

#: One robot: the function gets its path as ``path``, and its other arguments as ``options``, those of `eurdf.load`.
ROBOT = (option("path", metavar="PATH", help=_PATH), *_ROBOT_OPTIONS)

#: Several robots: the function gets ``paths`` as they are given, and ``options``.
ROBOTS = (
    option("paths", nargs="+", metavar="PATH", help=f"{_PATH}; a folder can contain several robots"),
    *_ROBOT_OPTIONS,
)

#: A URDF.
URDF = option("urdf", metavar="URDF", help="a .urdf or .xacro file, or - for standard input")

ROOT = option("--root", choices=("fixed", "floating"), help="default: as the description says")
JSON = option("--json", action="store_true", help="write one JSON object")
FORMAT = option("--format", dest="form", choices=("text", "json"), default="text", help="format of the output")
FORCE = option("--force", action="store_true", help="replace existing files")
FORCE_FILE = option("--force", action="store_true", help="replace an existing file")
FORCE_DESCRIPTION = option("--force", action="store_true", help="replace OUT and its schema if they exist")

#: The file to write; None is the standard output.
OUTPUT = option(
    "-o",
    "--output",
    metavar="OUT",
    type=lambda path: None if path == STDOUT else path,
    help="the file to write; default, or -: the standard output",
)
OUTPUT_FOLDER = option("-o", "--output", required=True, metavar="FOLDER", help="the folder to write to")

#: The joints of a serial robot, and the motors that drive them.
SERIAL_JOINTS = (
    option("--joints", nargs="+", required=True, metavar="JOINT", help="joints of the serial robot"),
    option(
        "--motors", nargs="+", metavar="JOINT", help="the motors; default: the actuated joints that move the joints"
    ),
)


@dataclass(frozen=True, slots=True)
class Command:
    """A command of the command line.

    Attributes:
        function: What it does: from its arguments, by name, to the exit code. Of `InvalidRobot`, the diagnostics are
            shown, and the exit code is 1; of `CannotRun`, the message, and the exit code is 2.
        options: Its arguments, in the order of the help.
        summary: What it does, for the list of commands.
        description: What it does, at length.
        epilog: The end of its help: see `ending`.
        has_output: Whether the standard output is kept for what it writes: diagnostics go to the standard error.
    """

    function: Callable[..., int]
    options: tuple[Option | OneOf, ...]
    summary: str
    description: str
    epilog: str
    has_output: bool

    def register(self, subparsers: argparse._SubParsersAction[Any], name: str) -> None:
        """Add the command to a parser."""
        parser = subparsers.add_parser(
            name,
            help=self.summary,
            description=self.description,
            epilog=self.epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        for each in self.options:
            if isinstance(each, Option):
                parser.add_argument(*each.names, **each.settings)
            else:
                group = parser.add_mutually_exclusive_group()
                for option in each.options:
                    group.add_argument(*option.names, **option.settings)
        parser.set_defaults(run=self.run)

    def run(self, args: argparse.Namespace) -> int:
        """Run it, and return the exit code."""
        values = {name: value for name, value in vars(args).items() if name != "run"}
        as_json = values.get("json", values.get("form") == "json")
        if "path" in values:
            values["path"] = select_one(values["path"])
        if "package_dirs" in values:
            values["options"] = _file_options(values)
        try:
            return self.function(**values)
        except InvalidRobot as refusal:
            stream = sys.stderr if self.has_output else sys.stdout
            write_refusal(refusal.path, refusal.diagnostics, as_json, stream)
            return 1


def command(
    *options: Option | OneOf | tuple[Option | OneOf, ...],
    summary: str,
    exit_codes: str,
    examples: tuple[str, ...],
    description: str,
    has_output: bool = True,
) -> Callable[[Callable[..., int]], Command]:
    """Make a command of a function; see `Command` and `ending` for the arguments."""
    flat = tuple(each for some in options for each in (some if isinstance(some, tuple) else (some,)))
    return lambda function: Command(function, flat, summary, description, ending(exit_codes, *examples), has_output)


def ending(exit_codes: str, *examples: str) -> str:
    """The end of the help text of a command.

    Args:
        exit_codes: Their meanings.
        examples: Command lines.
    """
    shown = "\n".join(f"  {example}" for example in examples)
    return f"{'example' if len(examples) == 1 else 'examples'}:\n{shown}\n\nExit codes: {exit_codes}"


@contextmanager
def cannot_run(*errors: type[Exception], unless: tuple[type[Exception], ...] = (), by: str = "") -> Iterator[None]:
    """Raise `CannotRun` in place of other errors, but for those that say themselves what to do.

    Args:
        errors: Their types.
        unless: Types of errors that stay as they are, too.
        by: What comes before their texts.
    """
    try:
        yield
    except errors as reason:
        if isinstance(reason, (InvalidRobot, MissingExtra, *unless)):
            raise
        raise CannotRun(f"{by}{reason}") from None


def require_urdf(path: str) -> None:
    """Check that a URDF exists.

    Raises:
        CannotRun: It does not exist.
    """
    if not (os.path.exists(path) or is_stream(path) or is_text(path)):
        raise CannotRun(f"the URDF '{path}' does not exist{_hint(near_path(path, endings=_URDF_ENDINGS))}")


def _file_options(values: dict[str, Any]) -> dict[str, Any]:
    """Take the values of options that say which files to read; as keyword arguments of `eurdf.load`.

    Raises:
        CannotRun: A file or a folder does not exist.
    """
    taken: dict[str, Any] = {}
    if "confined" in values:
        taken = {name: values.pop(name) for name in ("urdf", "confined", "allow_outside")}
        if taken["urdf"] is not None:
            require_urdf(taken["urdf"])
    folders = tuple(values.pop("package_dirs"))
    for folder in folders:
        if not os.path.isdir(folder):
            raise CannotRun(f"--package-dir: '{folder}' is not a folder{_hint(near_path(folder, endings=()))}")
    return {**taken, "package_dirs": folders, "xacro_args": dict(values.pop("xacro_args"))}


def _hint(near: str | None) -> str:
    return f"; did you mean '{near}'?" if near else ""
