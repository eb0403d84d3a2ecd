"""Common options of all commands: the robot to read; and the end of the help text."""

from __future__ import annotations

import argparse
import os
from typing import Any

from eurdf.collection.near_paths import near_path
from eurdf.commands.cannot_run import CannotRun
from eurdf.reading.given import is_stream, is_text

_PATH = "a robot: a folder, a .yaml, .urdf or .xacro file, - for standard input, or a name of the collection"
_URDF_ENDINGS = (".urdf", ".xml", ".xacro")


def add_robot_path(parser: argparse.ArgumentParser, *, several: bool = False) -> None:
    """Add the argument for one robot or for several."""
    if several:
        parser.add_argument("paths", nargs="+", metavar="PATH", help=f"{_PATH}; a folder can contain several robots")
    else:
        parser.add_argument("path", metavar="PATH", help=_PATH)


def add_serial_joints(parser: argparse.ArgumentParser) -> None:
    """Add the options for the joints of a serial robot, and for the motors that drive them."""
    parser.add_argument("--joints", nargs="+", required=True, metavar="JOINT", help="joints of the serial robot")
    parser.add_argument(
        "--motors", nargs="+", metavar="JOINT", help="the motors; default: the actuated joints that move the joints"
    )


def add_urdf_path(parser: argparse.ArgumentParser) -> None:
    """Add the argument for a URDF."""
    parser.add_argument("urdf", metavar="URDF", help="a .urdf or .xacro file, or - for standard input")


def add_robot_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for a robot."""
    parser.add_argument(
        "--urdf",
        metavar="FILE",
        help="the URDF, instead of the one that the description names; - for standard input",
    )
    places = parser.add_mutually_exclusive_group()
    places.add_argument(
        "--confined",
        action="store_true",
        help="refuse a description that names a URDF outside its own folder or a xacro, and a URDF that names a mesh "
        "outside the robot's folder",
    )
    places.add_argument("--allow-outside", action="store_true", help="read meshes that are outside the robot's folder")
    add_urdf_options(parser)


def add_urdf_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for a URDF."""
    parser.add_argument(
        "--package-dir",
        metavar="DIR",
        dest="package_dirs",
        action="append",
        default=[],
        help="a folder with ROS packages, to find meshes and xacro files (repeatable)",
    )
    parser.add_argument(
        "--xacro-arg",
        metavar="NAME:=VALUE",
        dest="xacro_args",
        type=_xacro_arg,
        action="append",
        default=[],
        help="an argument of the .xacro file that is given, or that the description names (repeatable)",
    )


def robot_options(args: argparse.Namespace) -> dict[str, Any]:
    """The values of `add_robot_options`, as keyword arguments of `eurdf.load` and `eurdf.check`.

    Raises:
        CannotRun: A file or a folder does not exist.
    """
    if args.urdf is not None:
        require_urdf(args.urdf)
    places = {"confined": args.confined, "allow_outside": args.allow_outside}
    return {"urdf": args.urdf, **places, **urdf_options(args)}


def urdf_options(args: argparse.Namespace) -> dict[str, Any]:
    """The values of `add_urdf_options`, as keyword arguments.

    Raises:
        CannotRun: A folder does not exist.
    """
    for folder in args.package_dirs:
        if not os.path.isdir(folder):
            raise CannotRun(f"--package-dir: '{folder}' is not a folder{_hint(near_path(folder, endings=()))}")
    return {"package_dirs": tuple(args.package_dirs), "xacro_args": dict(args.xacro_args)}


def require_urdf(path: str) -> None:
    """Check that a URDF exists.

    Raises:
        CannotRun: It does not exist.
    """
    if not (os.path.exists(path) or is_stream(path) or is_text(path)):
        raise CannotRun(f"the URDF '{path}' does not exist{_hint(near_path(path, endings=_URDF_ENDINGS))}")


def ending(exit_codes: str, *examples: str) -> str:
    """The end of the help text of a command.

    Args:
        exit_codes: Their meanings.
        examples: Command lines.
    """
    shown = "\n".join(f"  {example}" for example in examples)
    return f"{'example' if len(examples) == 1 else 'examples'}:\n{shown}\n\nExit codes: {exit_codes}"


def _hint(near: str | None) -> str:
    return f"; did you mean '{near}'?" if near else ""


def _xacro_arg(text: str) -> tuple[str, str]:
    name, separator, value = text.partition(":=")
    if not (separator and name.strip()):
        raise argparse.ArgumentTypeError(f"'{text}' does not have the form NAME:=VALUE")
    return name.strip(), value.strip()
