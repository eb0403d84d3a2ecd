"""`eurdf.generate` and `eurdf.migrate`: descriptions from the names in a URDF, and from descriptions of version 1."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from eurdf.diagnostics import Diagnostics
from eurdf.errors import CannotMigrate, InvalidRobot
from eurdf.linking.robot_files import ReadRobot, read_urdf_alone, read_valid
from eurdf.mechanism.mechanism import Root
from eurdf.pinocchio.arguments import as_names
from eurdf.reading.robot_source import RobotSource, display_name
from eurdf.reading.source import Source
from eurdf.writing import generation, migration
from eurdf.writing.generation import Generation
from eurdf.writing.migrated_text import NotMigratable
from eurdf.writing.migration import Migration
from eurdf.writing.naming_conventions import ClosureType, GeneratedVersion, conventions


def generate(
    urdf: RobotSource,
    *,
    closures: str | Iterable[str] = (),
    motors: str | Iterable[str] = (),
    sphericals: str | Iterable[str] = (),
    universals: str | Iterable[str] = (),
    closure_type: ClosureType | None = None,
    root: Root = "fixed",
    version: GeneratedVersion | None = None,
    urdf_path: str | None = None,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
) -> Generation:
    """Generate a description from the names in a URDF, as ``eurdf generate`` does, whose help has the conventions.

    Nothing is written: the description is the ``text`` of the result.

    Args:
        urdf: A URDF or a xacro: a file, ``-`` for standard input, a pipe or a text.
        closures: Regular expressions that each match the whole name of a frame of a closure, in place of the published
            conventions. The group ``side`` distinguishes the two frames, the group ``loop`` (optional) is their common
            part, and the group ``type`` (optional) is 3d or 6d.
        motors: Regular expressions, each found in the name of an actuated joint, in place of the conventions.
        sphericals: The same of spherical joints.
        universals: The same of universal joints, after their axes in the joint's frame, as in ``xy=free_(knee|foot)``.
        closure_type: The type of all closures. By default it is that in their names, or else the one with which the
            loops close and move; ``notes`` of the result gives the reason.
        root: Whether the root is fixed or floating; version 1 can only state fixed.
        version: Version of the description, 2 for 2.0. By default 2, or 2.1 if there is a hinge.
        urdf_path: Path of the URDF from the folder of the description. By default they are in the same folder.
        package_dirs: Folders to look for packages in, which a xacro finds files in.
        xacro_args: Values of the arguments of a xacro.

    Returns:
        The description, and what was found.

    Raises:
        InvalidRobot: The URDF has errors, or its names contradict each other.
        ValueError: A pattern is not a regular expression, or lacks its group or axes; or version 1 is to float.
        CannotExpand, MissingExtra: See `eurdf.load`.
    """
    patterns = [tuple(as_names(given)) for given in (closures, motors, sphericals, universals)]
    chosen = conventions(*patterns)
    tree = read_urdf_alone(urdf, Diagnostics(), package_dirs, xacro_args)
    path = urdf_path or urdf_named(display_name(urdf), tree.document.source)
    made = generation.generate(tree, chosen, version, root, path, closure_type=closure_type)
    if made.mechanism is None:
        raise InvalidRobot(display_name(urdf), tuple(made.diagnostics), "the names in the URDF contradict each other")
    return made


def migrate(
    path: RobotSource,
    urdf: RobotSource | None = None,
    *,
    urdf_path: str | None = None,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
) -> Migration:
    """Convert a description from version 1 to version 2, with the same model, as ``eurdf migrate`` does.

    Nothing is written: the new description is the ``text`` of the result. It was read once more, and describes the same
    model. A description of version 2 stays as it is.

    Args:
        path: The robot; see `eurdf.load`.
        urdf: A URDF in place of the one that the description names.
        urdf_path: Path of the URDF from the folder of the new description. By default, that is the folder of the old
            one.
        package_dirs: As in `eurdf.load`.
        xacro_args: As in `eurdf.load`.
        confined: As in `eurdf.load`.
        allow_outside: As in `eurdf.load`.

    Raises:
        CannotMigrate: Version 2 cannot state the same, or the robot has no description.
        InvalidRobot, RobotNotFound, CannotExpand, MissingExtra: See `eurdf.load`.
    """
    read = read_valid(
        path,
        urdf=urdf,
        package_dirs=package_dirs,
        xacro_args=xacro_args,
        confined=confined,
        allow_outside=allow_outside,
    )
    source = described(read).source
    if read.description.version != "1":
        return Migration(source.text, (nothing_to_do(read),), read.mechanism)
    return migrated(read, urdf_path or urdf_named(source.file, read.urdf.document.source))


def described(read: ReadRobot) -> Any:
    """The document of a robot's description; `CannotMigrate` if it has none."""
    if read.yaml is None:
        raise CannotMigrate(
            f"'{read.path}' is a plain URDF, which has nothing to migrate; `eurdf generate` writes a description"
        )
    return read.yaml.document


def nothing_to_do(read: ReadRobot) -> str:
    """The note on a description of version 2."""
    description = read.description
    return f"'{description.document.source.file}' already has version {description.version}: nothing to do"


def migrated(read: ReadRobot, urdf_path: str, schema: str | None = None) -> Migration:
    """As `migration.migrate`, of a description of version 1; `CannotMigrate` if version 2 cannot state the same."""
    try:
        return migration.migrate(read, urdf_path, schema)
    except NotMigratable as reason:
        document = read.description.document
        line = document.place(reason.pointer).line if reason.pointer else None
        where = f"{document.source.file}:{line}" if line else document.source.file
        raise CannotMigrate(f"cannot migrate: {where}: {reason}") from None


def urdf_named(description: str | os.PathLike[str], urdf: Source) -> str:
    """The name of the URDF, or of its xacro, in a description; ``robot.urdf`` if it is not a file."""
    if not urdf.files:
        return "robot.urdf"
    home, file = os.path.realpath(Path(description).parent), Path(urdf.files[0])
    # Resolve the folder, because '..' is relative to the target of a link; the file can stay a link.
    place = Path(os.path.realpath(file.parent)) / file.name
    try:
        return Path(os.path.relpath(place, home)).as_posix()
    except ValueError:  # on another drive
        return place.as_posix()
