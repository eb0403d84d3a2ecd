"""What a command is: a function, its arguments, and how errors end it."""

from __future__ import annotations

import argparse
import inspect
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple

from eurdf.collection.near_paths import URDF_ENDINGS, near_path
from eurdf.commands.selection import select_one
from eurdf.commands.terminal import Style, write_refusal
from eurdf.errors import CannotRun, InvalidRobot, MissingExtra
from eurdf.reading.robot_source import is_stream, is_text

#: The path that means the standard output.
STDOUT = "-"

_PATH = "a robot: a folder, a .yaml, .urdf or .xacro file, - for standard input, or a name of the collection"


@dataclass(slots=True, eq=False, repr=False)
class Option:
    """An argument of a command: the default of a parameter of its function.

    Without names, that of an option is made of the parameter's. Options in succession that have the same group exclude
    each other. The settings are other parameters of `argparse.ArgumentParser.add_argument`.
    """

    names: tuple[str, ...]
    group: str
    settings: dict[str, Any]


def option(text: str, *names: str, group: str = "", **settings: Any) -> Any:
    """An option with its help; see `Option` for the arguments."""
    return Option(names, group, {**settings, "help": text})


def flag(text: str, *names: str, group: str = "") -> Any:
    """An option without a value, which is False unless it is given."""
    return option(text, *names, group=group, action="store_true")


def _xacro_arg(text: str) -> tuple[str, str]:
    name, separator, value = text.partition(":=")
    if not (separator and name.strip()):
        raise argparse.ArgumentTypeError(f"'{text}' does not have the form NAME:=VALUE")
    return name.strip(), value.strip()


#: Where a URDF, or a robot, may find other files: the function gets them as ``options``.
URDF_OPTIONS = (
    option(
        "a folder with ROS packages, to find meshes and xacro files (repeatable)",
        "--package-dir",
        metavar="DIR",
        dest="package_dirs",
        action="append",
        default=[],
    ),
    option(
        "an argument of the .xacro file that is given, or that the description names (repeatable)",
        "--xacro-arg",
        metavar="NAME:=VALUE",
        dest="xacro_args",
        type=_xacro_arg,
        action="append",
        default=[],
    ),
)

_ROBOT_OPTIONS = (
    option("the URDF, instead of the one that the description names; - for standard input", "--urdf", metavar="FILE"),
    flag(
        "refuse a description that names a URDF outside its own folder or a xacro, and a URDF that names a mesh "
        "outside the robot's folder",
        "--confined",
        group="places",
    ),
    flag("read meshes that are outside the robot's folder", "--allow-outside", group="places"),
    *URDF_OPTIONS,
)

#: One robot: the function gets its path, and its other arguments as ``options``, those of `eurdf.load`.
ROBOT: Any = (option(_PATH, "path", metavar="PATH"), *_ROBOT_OPTIONS)

#: Several robots: the function gets the paths as they are given, and ``options``.
ROBOTS: Any = (
    option(f"{_PATH}; a folder can contain several robots", "paths", nargs="+", metavar="PATH"),
    *_ROBOT_OPTIONS,
)

#: A URDF: the function gets what is given, and ``options``.
URDF: Any = (option("a .urdf or .xacro file, or - for standard input", "urdf", metavar="URDF"), *URDF_OPTIONS)

ROOT: Any = option("default: as the description says", choices=("fixed", "floating"))
JSON: Any = flag("write one JSON object")
FORCE: Any = flag("replace existing files")
FORCE_FILE: Any = flag("replace an existing file")
FORCE_DESCRIPTION: Any = flag("replace OUT and its schema if they exist")

#: The file to write; None is the standard output.
OUTPUT: Any = option(
    "the file to write; default, or -: the standard output",
    "-o",
    "--output",
    metavar="OUT",
    type=lambda path: None if path == STDOUT else path,
)
OUTPUT_FOLDER: Any = option("the folder to write to", "-o", "--output", required=True, metavar="FOLDER")

#: The joints of a serial robot, and the motors that drive them.
SERIAL_JOINTS: Any = option("joints of the serial robot", nargs="+", required=True, metavar="JOINT")
SERIAL_MOTORS: Any = option("the motors; default: the actuated joints that move the joints", nargs="+", metavar="JOINT")


class Command(NamedTuple):
    """A command of the command line.

    Attributes:
        function: What it does: from its arguments, by name, to the exit code. The default of each of its parameters is
            the option that gives its value. Of `InvalidRobot`, the diagnostics are shown, and the exit code is 1; of
            `CannotRun`, the message, and the exit code is 2.
        summary: What it does, for the list of commands.
        description: What it does, at length.
        epilog: The end of its help: see `ending`.
        has_output: Whether the standard output is kept for what it writes: diagnostics go to the standard error.
    """

    function: Callable[..., int]
    summary: str
    description: str
    epilog: str
    has_output: bool

    def register(self, subparsers: argparse._SubParsersAction[Any], name: str) -> None:
        """Add the command to a parser."""
        parser = subparsers.add_parser(
            name,
            description=self.description,
            epilog=self.epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        groups: dict[str, Any] = {"": parser}
        for parameter in inspect.signature(self.function).parameters.values():
            if parameter.default is parameter.empty:  # ``options``
                continue
            found = parameter.default if isinstance(parameter.default, tuple) else (parameter.default,)
            for number, each in enumerate(found):
                if each.group not in groups:
                    groups[each.group] = parser.add_mutually_exclusive_group()
                names = each.names or (f"--{parameter.name.replace('_', '-')}",)
                dest = {"dest": parameter.name} if number == 0 and names[0].startswith("-") else {}
                groups[each.group].add_argument(*names, **{**dest, **each.settings})
        add_style(parser)
        parser.set_defaults(run=self.run)

    def run(self, args: argparse.Namespace) -> int:
        """Run it, and return the exit code."""
        values = {name: value for name, value in vars(args).items() if name not in ("run", *Style._fields)}
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


@dataclass(frozen=True, slots=True)
class FailureInfo:
    """The output of a command with --json that cannot run, or that has no result."""

    error: str
    """The reason."""


@dataclass(frozen=True, slots=True)
class WrittenInfo:
    """The output of --json of 'eurdf picture', 'eurdf view' and, with -o, 'eurdf schema'."""

    files: tuple[str, ...]
    """The files that were written."""
    url: str | None
    """Address of the page of 'eurdf view'; null if the command serves none."""


def add_style(parser: argparse.ArgumentParser) -> None:
    """Add the options of `Style`, which every command has, also before its name."""
    texts = {("-q", "--quiet"): "write no notes, only results and errors", ("--no-color",): "write without colours"}
    for names, text in texts.items():
        parser.add_argument(*names, action="store_true", default=argparse.SUPPRESS, help=text)


def command(
    *, summary: str, description: str, exit_codes: str, examples: tuple[str, ...], has_output: bool = True
) -> Callable[[Callable[..., int]], Command]:
    """Make a command of a function; see `Command` and `ending` for the arguments."""
    epilog = ending(exit_codes, *examples)
    return lambda function: Command(function, summary, description, epilog, has_output)


def ending(exit_codes: str, *examples: str) -> str:
    """The end of the help text of a command."""
    shown = "\n".join(f"  {example}" for example in examples)
    return f"{'example' if len(examples) == 1 else 'examples'}:\n{shown}\n\nExit codes: {exit_codes}"


@contextmanager
def cannot_run(*errors: type[Exception], unless: tuple[type[Exception], ...] = (), by: str = "") -> Iterator[None]:
    """Raise `CannotRun` in place of some errors, with ``by`` before their texts.

    An error that says what to do by itself stays as it is, and one of the types ``unless``.
    """
    try:
        yield
    except errors as reason:
        if isinstance(reason, (InvalidRobot, MissingExtra, *unless)):
            raise
        raise CannotRun(f"{by}{reason}") from None


def require_urdf(path: str) -> None:
    """Raise `CannotRun` if a URDF does not exist."""
    if not (os.path.exists(path) or is_stream(path) or is_text(path)):
        raise CannotRun(f"the URDF '{path}' does not exist{_hint(near_path(path, endings=URDF_ENDINGS))}")


def _file_options(values: dict[str, Any]) -> dict[str, Any]:
    """Take the values of options that say which files to read; as keyword arguments of `eurdf.load`.

    A file or a folder that does not exist is refused by `CannotRun`.
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
