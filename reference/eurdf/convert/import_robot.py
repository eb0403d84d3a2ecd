"""`eurdf.import_robot`: a robot from a file of another format, and what is lost of it."""

from __future__ import annotations

import math
import os
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

import numpy as np

from eurdf.array import Vector
from eurdf.convert.formats import format_meant
from eurdf.convert.hinges import allowed_axes, with_axes
from eurdf.convert.import_format import ImportInput, RobotRead, import_format, loss_kinds
from eurdf.convert.losses import Effect, Loss, Losses, dropped, exact
from eurdf.convert.readme import licence_file, readme
from eurdf.convert.xml_elements import places_of_names, recognized
from eurdf.diagnostics import Diagnostic, Severity
from eurdf.diagnostics.wording import enumerated, visible
from eurdf.errors import CannotImport, RobotNotFound
from eurdf.format.schema import FILES, SchemaVersion, json_schema, schema_text
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.position_limit import position_limits
from eurdf.kinematics.residual import closure_openings, residual
from eurdf.kinematics.tolerances import CLOSED
from eurdf.linking.configurations import beyond_limits
from eurdf.linking.robot_files import read_robot
from eurdf.loading import check
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.spanning_tree import rigid_poses
from eurdf.mesh_files.folders import MANIFEST
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.reading.other_formats import IMPORTED
from eurdf.reading.resource import FileFinder
from eurdf.writing.description import DescriptionFiles, NotWritable, describe_mechanism, version_needed
from eurdf.writing.joined_closures import join_points
from eurdf.writing.output_folder import write_files
from eurdf.writing.saved_configuration import NAME as ASSEMBLED

# Of the files that a folder may be imported by; what cannot be imported is refused with its reason.
_ENDINGS = (".xml", ".sdf", ".urdf", ".usda", ".usd")

#: Losses of every format.
COMMON = loss_kinds(
    {
        "name": exact(
            "name",
            "is changed: the name is missing, reserved, or used by another element",
            "give the element a unique name in the file",
        ),
        "mesh-names": dropped(
            "mesh",
            "a material, a buffer or a picture that it names is left out",
            "copy it into the robot's folder, and name it by its path from the mesh",
        ),
        "not-assembled": dropped(
            "configuration",
            "no configuration was found that closes the loops within the limits of the joints",
            "correct limits or frames, and find one with `eurdf assemble`",
        ),
        "joined-points": exact(
            "3d closure",
            "is one hinge or 6d closure with others of the same two bodies: their points are as far apart in both",
            "use the hinge or the 6d closure: it has fewer rows",
        ),
        "points-apart": exact(
            "3d closure",
            "stays as it is: another one joins the same two bodies, and both cannot be closed",
            "correct the points in the file",
        ),
        "open-assembled": exact(
            "configuration",
            "the name is reserved for a configuration that closes the loops: this one is renamed",
            "choose another name in the file",
        ),
        "file-outside": exact(
            "file",
            "is outside the robot's folder, and was read because of --allow-outside",
            "copy it into the robot's folder",
        ),
    }
)


@dataclass(frozen=True, eq=False, repr=False)
class Import:
    """A robot from a file of another format.

    Attributes:
        format: Name of the format.
        mechanism: The robot.
        losses: What is not as in the file.
        files: Content of each file to write by its path relative to a folder: ``robot.urdf``, ``robot.yaml``, a README,
            the schema for editors, and the meshes.
        start: The configuration of the file that the loops were assembled from.
        opened: How far each closure was open there, before assembling.
        closes: Whether all loops close, in the configuration ``assembled``.
        sources: Every file that was read, the main one first.
    """

    format: str
    mechanism: Mechanism
    losses: tuple[Loss, ...]
    files: Mapping[str, bytes]
    start: str
    opened: tuple[Opening, ...]
    closes: bool
    sources: tuple[Path, ...]

    @cached_property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """What `eurdf.check` finds in the files, with places in them; it is looked for when it is first used.

        The files have no error with which `eurdf.load` refuses kinematics. They can have others, as the file had: an
        unphysical inertia, loops that do not close, a mesh that cannot be read.
        """
        with tempfile.TemporaryDirectory() as scratch:
            self.write(scratch)
            return tuple(_relative(found, scratch) for found in check(scratch).diagnostics)

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The errors in `diagnostics`: without them, the robot passes `eurdf.check`."""
        return tuple(found for found in self.diagnostics if found.severity is Severity.ERROR)

    def write(self, folder: str | os.PathLike[str], *, force: bool = False) -> tuple[Path, ...]:
        """Write the files to a folder: all of them or none.

        Args:
            folder: Where to write; made if it does not exist.
            force: Whether to replace files that exist.

        Returns:
            Paths of the files; the URDF is the first.

        Raises:
            FileExistsError: A file exists, and `force` is False.
            OSError: A file cannot be written.
        """
        return write_files(folder, self.files, force=force)

    def __repr__(self) -> str:
        state = "the loops close" if self.closes else "the loops do not close"
        return f"<Import of {self.format}: {self.mechanism!r}; {len(self.losses)} losses; {state}>"


def import_robot(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,  # noqa: A002 - the word of the command
    within: str | os.PathLike[str] | None = None,
    strict: bool = False,
    allow_outside: bool = False,
) -> Import:
    """Import a robot from a file of another format.

    Nothing is dropped in silence: what a description cannot say is in ``losses``. If the loops are open at the keyframe
    or reference pose of the file, a configuration is searched that closes them, ``assembled``.

    Args:
        path: The file, or a folder with one of these formats, as `eurdf.export` writes it: ``robot.xml``,
            ``robot.sdf``, ``robot.urdf``, or another name if there is no other file of these endings.
        format: Name of its format: ``mjcf``, ``sdf``, ``loop-joint``, ``drake`` or ``urdf-plus``. By default it is
            recognized by its content.
        within: A folder that files may be in which the file names, besides the robot's folder: the nearest one, from
            its own upwards, with a ``package.xml``, or else its own.
        strict: Whether to refuse losses that are not exact, and robots with errors.
        allow_outside: Whether files may be anywhere; each one outside these folders is a loss that is exact. If not,
            meshes elsewhere are left out, and other files are refused.

    Raises:
        CannotImport: The file is not of this format, has an error, or uses files outside the folder; or, if `strict`,
            it cannot be imported without losses, or the robot does not pass `eurdf.check`.
        MissingExtra: What reads the format is not installed.
        RobotNotFound: There is no such file, or the folder has none or several.
        ValueError: There is no such format.
    """
    file = _file_at(Path(path))
    if format is not None and format not in IMPORTED:
        raise ValueError(f"there is no format '{format}'; {format_meant(format, IMPORTED)}")
    name = format or recognized(file)
    finder = FileFinder(file.absolute().parent, [] if within is None else [within], allow_outside=allow_outside)
    chosen = import_format(name)
    imported = _import(name, chosen.read, ImportInput(file, finder, Losses((*COMMON, *chosen.losses))))
    if strict and (refused := tuple(loss for loss in imported.losses if loss.effect is not Effect.EXACT)):
        more = f"; and {len(refused) - 1} more" if len(refused) > 1 else ""
        raise CannotImport(file, f"it has losses: {refused[0]}{more}", refused)
    if strict and (errors := imported.errors):
        more = f"; and {len(errors) - 1} more" if len(errors) > 1 else ""
        raise CannotImport(file, f"the robot has errors: {errors[0]}{more}", diagnostics=errors)
    return imported


def _file_at(path: Path) -> Path:
    """The file to import: the one given, or the one in a folder.

    Raises:
        RobotNotFound: There is none, or several.
    """
    if path.is_file():
        return path
    if not path.is_dir():
        raise RobotNotFound(os.fspath(path), f"'{path}' is not a file or a folder")
    files = sorted(each for each in path.iterdir() if each.suffix.lower() in _ENDINGS and each.name != MANIFEST)
    found = [each for each in files if each.stem == "robot"] or files
    if len(found) == 1:
        return found[0]
    what = enumerated([each.name for each in found]) if found else f"no file of {', '.join(_ENDINGS)}"
    raise RobotNotFound(os.fspath(path), f"folder '{path}' contains {what}; name the file")


def _relative(found: Diagnostic, folder: str) -> Diagnostic:
    """A diagnostic of a file in a folder, with its place and words relative to the folder."""
    here = f"{folder}{os.sep}"
    place = replace(found.place, file=found.file.removeprefix(here))
    hint = None if found.hint is None else found.hint.replace(here, "")
    return Diagnostic(found.code, found.message.replace(here, ""), place, hint)


def _import(format_: str, read_file: Callable[[ImportInput], RobotRead], given: ImportInput) -> Import:
    path, losses = given.path, given.losses
    read = read_file(given)
    licence = licence_file(path, given.folders)
    for outside in given.folders.let_through:
        losses.add("import-file-outside", outside)
    start, coordinates = read.start
    # First: no number that the format refuses, such as an infinite one, may reach the kinematics.
    _description(path, format_, read.mechanism, read)
    _must_be_coordinates(path, start, coordinates)
    mechanism = _with_points_joined(read.mechanism, losses)
    if read.without_axis:
        mechanism = _with_axes(path, mechanism, read, losses)
    robot = build_robot(mechanism, geometry=False)
    q = robot.configuration(coordinates)
    opened = closure_openings(robot, q)
    mechanism, closes = _assembled(_without_open_assembled(mechanism, losses), robot, q, losses)
    mechanism = replace(
        mechanism,
        version=version_needed(mechanism),
        metadata=MappingProxyType({"source": visible(path.name), **mechanism.metadata}),
    )
    written, schema = _description(path, format_, mechanism, read)
    files = {
        "robot.urdf": written.urdf,
        "robot.yaml": written.yaml.encode(),
        "README.md": readme(path, IMPORTED[format_].title, mechanism, losses.found, read, opened, licence).encode(),
        FILES[schema]: schema_text(json_schema(schema)).encode(),
        **given.meshes,
    }
    if licence is not None:
        files["LICENSE"] = licence.read_bytes()
    return Import(format_, mechanism, losses.found, MappingProxyType(files), start, opened, closes, read.sources)


def _with_points_joined(mechanism: Mechanism, losses: Losses) -> Mechanism:
    found = join_points(mechanism.closures, rigid_poses(mechanism.bodies[0].name, mechanism.joints))
    for joined in found.joined:
        losses.add("import-joined-points", joined.closure.name, str(joined))
    for apart in found.apart:
        losses.add("import-points-apart", apart.names[1], f"stays as it is: {apart}")
    return replace(mechanism, closures=found.closures)


def _with_axes(path: Path, mechanism: Mechanism, read: RobotRead, losses: Losses) -> Mechanism:
    """The mechanism with the one axis that it allows each hinge of which the file states none.

    Raises:
        CannotImport: It allows a hinge several axes, or none, or its loops cannot be closed.
    """
    found = allowed_axes(mechanism, read.without_axis, read.start[1])
    why = "the rest of the mechanism does not let its links turn about exactly one axis of its frames"
    if found is None:
        why = "no configuration was found that closes the loops, which would show it"
    axes = found or {}
    for name in read.without_axis:
        if name not in axes:
            raise CannotImport(
                path,
                f"{_where(read, [name])}the loop joint '{name}' is revolute and has no <axis>, and {why}; "
                'add the axis, such as <axis xyz="0 0 1"/>',
            )
        losses.add("import-loop-axis", name, f"has no axis: {axes[name]} is taken, the only one that it can turn about")
    return with_axes(mechanism, axes)


def _without_open_assembled(mechanism: Mechanism, losses: Losses) -> Mechanism:
    """The mechanism without a configuration ``assembled`` at which loops are open: it gets another name."""
    configurations = dict(mechanism.configurations)
    if ASSEMBLED not in configurations or not mechanism.constraints:
        return mechanism
    robot = build_robot(mechanism, geometry=False)
    if np.abs(residual(robot, robot.configuration(configurations[ASSEMBLED]))).max() <= CLOSED:
        return mechanism
    name = f"{ASSEMBLED}_open"
    while name in configurations:
        name += "_"
    losses.add("import-open-assembled", ASSEMBLED, f"its loops are open: it is renamed to '{name}'")
    renamed = {name if key == ASSEMBLED else key: value for key, value in configurations.items()}
    return replace(mechanism, configurations=MappingProxyType(renamed))


def _assembled(mechanism: Mechanism, robot: Robot, q: Vector, losses: Losses) -> tuple[Mechanism, bool]:
    """The mechanism with a configuration ``assembled``, if one is found from q; and whether its loops close."""
    if not mechanism.constraints or ASSEMBLED in mechanism.configurations:
        return mechanism, True
    # Joints outside of loops too are within their limits in a file.
    starts = ((position_limits(robot).clip(q), True), (q, False))
    found = next((each for at, limits in starts if (each := assemble(robot, at, limits=limits)).closes), None)
    if found is None:
        losses.add("import-not-assembled", ASSEMBLED, "no configuration was found that closes the loops")
        return mechanism, False
    coordinates = robot.joint_positions(found.q)
    if beyond := beyond_limits(mechanism.joints, coordinates):
        losses.add("import-not-assembled", ASSEMBLED, f"the loops close beyond limits only: {beyond[0]}")
        return mechanism, True
    configurations = MappingProxyType({ASSEMBLED: coordinates, **mechanism.configurations})
    return replace(mechanism, configurations=configurations), True


def _description(
    path: Path, format_: str, mechanism: Mechanism, read: RobotRead
) -> tuple[DescriptionFiles, SchemaVersion]:
    """The two files of the mechanism, and the version of their schema.

    Raises:
        CannotImport: It could only be written as a description with errors.
    """
    schema: SchemaVersion = "2" if version_needed(mechanism) == "2.0" else "2.1"
    comment = f"Imported from {path.name} ({format_}) by eurdf."
    try:
        written = describe_mechanism(mechanism, schema=f"./{FILES[schema]}", comments=(comment,))
    except NotWritable as reason:
        raise CannotImport(path, str(reason)) from None
    found = read_robot(written.yaml, urdf=written.urdf.decode())
    if found.linked is None:
        message = found.diagnostics.errors[0].message
        where = _where(read, re.findall("'([^']*)'", message))
        raise CannotImport(path, f"{where}it has no valid description: {message}")
    return written, schema


def _where(read: RobotRead, names: Sequence[str]) -> str:
    """File and line of the first of some names that a file states, to begin a message with; empty if none does."""
    places = places_of_names(read.sources)
    place = next((places[name] for name in names if name in places), None)
    return "" if place is None else f"{Path(place.file).name}:{place.line}: "


def _must_be_coordinates(path: Path, start: str, coordinates: Mapping[str, tuple[float, ...]]) -> None:
    """Refuse a configuration to assemble from that is none, as the pose of a floating root that overflows."""
    for name, values in coordinates.items():
        if not all(map(math.isfinite, values)):
            shown = ", ".join(f"{value:g}" for value in values)
            raise CannotImport(path, f"{start}: the coordinates of '{name}' are {shown}; they must be finite")
