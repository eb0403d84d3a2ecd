"""`eurdf.export`: a robot in the format of a simulator, and what it loses there."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType

from eurdf.array import Vector
from eurdf.convert.common_losses import BEYOND_LIMITS, UNKNOWN
from eurdf.convert.coordinates import Coordinates
from eurdf.convert.export_format import ExportInput, Triangles, export_format
from eurdf.convert.formats import (
    ACTUATORS,
    CLOSURES,
    EXPORTS,
    JOINTS,
    MESH_FILES,
    Actuators,
    ClosureChoice,
    JointChoice,
    MeshFileChoice,
)
from eurdf.convert.hinges import with_hinges
from eurdf.convert.losses import Effect, Loss, Losses
from eurdf.convert.parts import OwnVectors
from eurdf.convert.rods import without_balls_of_rods
from eurdf.convert.verification.verify import Verification, verify
from eurdf.diagnostics import did_you_mean
from eurdf.errors import CannotExport, InvalidRobot
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.position_limit import position_limits
from eurdf.linking.configurations import beyond_limits
from eurdf.linking.mesh_files import find_meshes
from eurdf.linking.robot_files import ReadRobot, read_robot
from eurdf.mechanism.mechanism import ROOT_JOINT, Root
from eurdf.mesh_files.folders import Folders, folders_of_files
from eurdf.mesh_files.reader import MeshReader
from eurdf.pinocchio.meshes import read_meshes
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.reading.robot_source import RobotSource
from eurdf.writing.output_folder import write_files

#: The configuration to start from, unless another one is asked for.
ASSEMBLED = "assembled"

#: The configuration to start from of a robot without loops that has no `ASSEMBLED`.
NEUTRAL = "neutral"


@dataclass(frozen=True, slots=True)
class Choices:
    """What a user chooses of an export; see `export`."""

    to: str
    configuration: str
    actuators: Actuators
    closures: ClosureChoice
    joints: JointChoice
    mesh_files: MeshFileChoice
    strict: bool


@dataclass(frozen=True, eq=False, repr=False)
class Export:
    """A robot in another format.

    Attributes:
        format: Name of the format.
        files: Content of each file by its path relative to a folder; the main file is the first.
        losses: What is not as in the robot; empty if the file says everything.
        coordinates: From q and v of the robot to those of the exported model, and back.
        robot: The robot, with the closures and joints that were exported.
        start: The configuration (nq,) that simulations start from; neutral if no closed one was found.
    """

    format: str
    files: Mapping[str, bytes]
    losses: tuple[Loss, ...]
    coordinates: Coordinates
    robot: Robot = field(repr=False)
    start: Vector = field(repr=False)

    @property
    def main(self) -> bytes:
        """Content of the main file."""
        return next(iter(self.files.values()))

    def write(self, folder: str | os.PathLike[str], *, force: bool = False) -> tuple[Path, ...]:
        """Write the files to a folder: all of them or none.

        Args:
            folder: Where to write; made if it does not exist.
            force: Whether to replace files that exist.

        Returns:
            Paths of the files; the main file is the first.

        Raises:
            FileExistsError: A file exists, and `force` is False.
            OSError: A file cannot be written.
        """
        return write_files(folder, self.files, force=force)

    def verify(self, *, seconds: float = 2.0, progress: Callable[[float, float], None] | None = None) -> Verification:
        """Read the files back with the program that they are for, and compare and simulate what it reads.

        MuJoCo reads ``mjcf``; Drake ``drake``, and the tree of ``sdf``; the library of USD ``usd``; Pinocchio ``urdf``
        and the tree of ``loop-joint``. MuJoCo and Drake also simulate the robot from rest at `start`, with gravity and
        without actuation: ``findings`` say which loops open by more than 5 mm (or 5e-3 rad), when, and why, as far as
        the simulation shows it.

        Args:
            seconds: How long to simulate, s; 0 simulates nothing.
            progress: Called in a simulation with the simulated time and the whole, s. If a loop opens, the simulation
                is repeated with half the time step, and without contacts if there were any.

        Returns:
            What was read, against the robot; ``findings`` is empty if nothing is wrong.

        Raises:
            MissingExtra: The program is not installed.
        """
        return verify(self.format, self.files, self.losses, self.coordinates, self.robot, self.start, seconds, progress)

    def __repr__(self) -> str:
        return f"<Export to {self.format}: {len(self.files)} files, {len(self.losses)} losses>"


def export(
    robot: RobotSource | Robot,
    to: str,
    *,
    urdf: RobotSource | None = None,
    root: Root | None = None,
    configuration: str = ASSEMBLED,
    actuators: Actuators = "motor",
    closures: ClosureChoice = "stated",
    joints: JointChoice = "stated",
    mesh_files: MeshFileChoice = "copy",
    strict: bool = False,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
) -> Export:
    """Export a robot to the format of a simulator.

    Nothing is dropped in silence: what the format cannot say is in ``losses``. Numbers are read back to the last bit.

    Args:
        robot: What `eurdf.load` takes, or a robot that it returned, with the geometry that it was loaded with.
        to: Name of the format: ``mjcf``, ``usd``, ``drake``, ``loop-joint``, ``sdf`` or ``urdf``.
        urdf: As for `eurdf.load`; only if `robot` is not loaded yet, as `root` and all after `strict` but the last.
        root: As for `eurdf.load`.
        configuration: Name of the configuration to start a simulation from. If the description has none of the name
            ``assembled``, one is searched near the neutral configuration, within the limits of the joints; without
            loops, it is called ``neutral``.
        actuators: What actuators become, in a format that distinguishes: ``motor`` (a force or torque on the joint),
            ``position`` or ``none``.
        closures: ``stated`` keeps the closures of the description; with ``hinge``, each 3d closure whose bodies turn
            about one axis alone becomes a hinge, for solvers without ball joints in loops.
        joints: ``stated`` keeps ball joints; ``hinge``, which is for ``mjcf`` alone, is for programs without them. A
            passive one of a rod becomes a 3d closure, in place of a 6d closure, or a universal joint: q and v of
            `Export.coordinates` are then those of `Export.robot`. Others become three hinges of one body, about x, y
            and z of the joint's frame in this order. These are singular where the second angle is ±π/2 rad.
        mesh_files: ``copy`` writes them to ``meshes/`` beside the file; with ``reference`` the file names them where
            they are, by their absolute paths.
        strict: Whether to refuse losses that are not exact.
        package_dirs: As for `eurdf.load`.
        xacro_args: As for `eurdf.load`.
        confined: As for `eurdf.load`.
        allow_outside: Whether files are copied, or referenced, that are neither in the robot's folder nor in a package;
            see `eurdf.load`. If not, they are left out, which is a loss; if so, each of them is one that is exact.

    Returns:
        The files, the losses and the map of coordinates.

    Raises:
        InvalidRobot: The robot cannot be built without guessing.
        RobotNotFound: There are no such files.
        CannotExport: The robot cannot be written in this format, or, if `strict`, not without losses; or, with hinges
            for ball joints, the hinges are singular at the configuration to start from.
        MissingExtra: The format is ``usd``, and the extra ``usd`` is not installed.
        ValueError: There is no such format, configuration or kind of actuator; `joints` is ``hinge`` for another
            format than ``mjcf``; or `confined` and `allow_outside` are both True.
    """
    choices = Choices(to, configuration, actuators, closures, joints, mesh_files, strict)
    if isinstance(robot, Robot):
        meshes = files_of_meshes(robot)
        return _export(robot, meshes, {}, folders_of_files(meshes.values(), allow_outside=allow_outside), choices)
    read = read_robot(
        robot,
        urdf,
        root,
        package_dirs=package_dirs,
        xacro_args=xacro_args,
        confined=confined,
        allow_outside=allow_outside,
    )
    if read.linked is None or read.diagnostics.refused:
        raise InvalidRobot(read.path, tuple(read.diagnostics))
    return export_linked(read, choices, package_dirs, allow_outside=allow_outside)


def export_linked(
    read: ReadRobot, choices: Choices, package_dirs: Sequence[str | os.PathLike[str]], *, allow_outside: bool = False
) -> Export:
    """Export a robot that was read; see `export`."""
    files = find_meshes(read.urdf, package_dirs, allow_outside=allow_outside)
    bodies = read.mechanism.bodies
    uris = {shape.filename for body in bodies for shape in (*body.visuals, *body.collisions)}
    meshes = {uri: Path(path) for uri, path in files.paths.items() if uri in uris}
    robot = build_robot(read.mechanism, geometry=False)
    refused = dict.fromkeys(files.outside, str(files.folders))
    return _export(robot, meshes, refused, files.folders, choices)


def _export(
    robot: Robot, meshes: Mapping[str, Path], refused: Mapping[str, str], folders: Folders, choices: Choices
) -> Export:
    to = choices.to
    if to not in EXPORTS:
        hint = did_you_mean(to, EXPORTS) or f"the formats are: {', '.join(EXPORTS)}"
        raise ValueError(f"there is no format '{to}'; {hint}")
    for name, value, allowed in (
        ("actuators", choices.actuators, ACTUATORS),
        ("closures", choices.closures, CLOSURES),
        ("joints", choices.joints, JOINTS),
        ("mesh_files", choices.mesh_files, MESH_FILES),
    ):
        if value not in allowed:
            raise ValueError(f"{name} is {value!r}; it must be one of {', '.join(allowed)}")
    if choices.joints == "hinge" and to != "mjcf":
        raise ValueError(f"joints is 'hinge', which is for the format mjcf alone; leave it out for {to}")
    contacts = robot.mechanism.contacts
    if contacts:
        robot = replace(robot, mechanism=replace(robot.mechanism, contacts=()))
    configurations = _configurations(robot, choices.configuration)
    format_ = export_format(to)
    losses = Losses((*format_.rows, *UNKNOWN))
    if choices.joints == "hinge":
        robot, configurations = without_balls_of_rods(robot, configurations, losses)
    replaced: tuple[Loss, ...] = ()
    if choices.closures == "hinge" and configurations:
        closed = robot.configuration(next(iter(configurations.values())))
        robot, replaced = with_hinges(robot, closed)
    mechanism = robot.mechanism
    losses.find(replace(mechanism, contacts=contacts), choices.actuators, format_.exact)
    given = ExportInput(
        mechanism,
        _own_vectors(robot),
        configurations,
        meshes,
        refused,
        MeshReader(folders),
        choices.actuators,
        choices.joints,
        choices.mesh_files,
        partial(_triangles, folders),
    )
    written = format_.write(given, losses)
    if mechanism.constraints and not configurations and losses.has_kind("export-no-configuration"):
        losses.add("export-no-configuration", ASSEMBLED)
    for name, coordinates in list(configurations.items())[:1] if losses.has_kind(BEYOND_LIMITS.code) else ():
        every = robot.joint_positions(robot.configuration(coordinates), mimic=True)
        if beyond := beyond_limits(mechanism.joints, every):
            message = f"has joints beyond their limits: {', '.join(map(str, beyond))}"
            losses.add(BEYOND_LIMITS.code, name, message)
    for path in folders.let_through:
        losses.add("export-file-outside", path)
    found = replaced + losses.found
    if choices.strict and (inexact := tuple(loss for loss in found if loss.effect is not Effect.EXACT)):
        more = f"; and {len(inexact) - 1} more" if len(inexact) > 1 else ""
        raise CannotExport(f"'{mechanism.name}' has losses in the format {to}: {inexact[0]}{more}", inexact)
    start = robot.configuration(next(iter(configurations.values()), {}))
    return Export(to, MappingProxyType(dict(written.files)), found, written.coordinates, robot, start)


def _triangles(folders: Folders, path: Path) -> Triangles | None:
    meshes, _ = read_meshes([("", (1.0, 1.0, 1.0))], {"": os.fspath(path)}, folders)
    mesh = meshes.get(os.fspath(path))
    return None if mesh is None else (mesh.vertices, mesh.triangles)


def _own_vectors(robot: Robot) -> OwnVectors:
    places = {name: (slice(slot.idx_q, slot.idx_q + slot.nq), slot.idx_v) for name, slot in robot.slots.items()}
    if robot.mechanism.root == "floating":
        places[ROOT_JOINT] = (slice(0, 7), 0)
    return OwnVectors(robot.model.nq, robot.model.nv, MappingProxyType(places))


def _configurations(robot: Robot, first: str) -> dict[str, Mapping[str, tuple[float, ...]]]:
    """The configurations of the robot, the one to start from first.

    If none is stated: near the neutral configuration, one within the limits of the joints that closes the loops.
    """
    stated = robot.mechanism.configurations
    if first in stated:
        return {first: stated[first], **stated}
    if first != ASSEMBLED:
        hint = did_you_mean(first, stated) or f"the configurations are: {', '.join((ASSEMBLED, *stated))}"
        raise ValueError(f"there is no configuration '{first}'; {hint}")
    start = position_limits(robot).clip(robot.tree.neutral())
    if not robot.constraints:
        return {NEUTRAL: robot.joint_positions(start), **stated}
    for limits in (True, False):
        assembly = assemble(robot, start, limits=limits)
        if assembly.closes:
            return {ASSEMBLED: robot.joint_positions(assembly.q), **stated}
    return dict(stated)


def files_of_meshes(robot: Robot) -> dict[str, Path]:
    """The files of the meshes of a robot that was loaded with its geometry."""
    if robot.geometry is None:
        return {}
    found = {}
    for model, use in ((robot.geometry.visual, "visuals"), (robot.geometry.collision, "collisions")):
        shapes = [shape for body in robot.mechanism.bodies for shape in getattr(body, use)]
        for shape, built in zip(shapes, model.geometryObjects, strict=True):
            if shape.kind == "mesh":
                found[shape.filename] = Path(built.meshPath)
    return found
