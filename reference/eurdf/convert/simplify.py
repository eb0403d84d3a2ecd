"""`eurdf.simplify`: a robot with fewer velocities and constraint rows that moves in the same way, and back."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from eurdf.convert.export import files_of_meshes
from eurdf.convert.names import FileNames
from eurdf.convert.same_motion import SameMotion, compare_motion
from eurdf.diagnostics import quoted
from eurdf.errors import CannotSimplify, NotClosable, UndeterminedMotion
from eurdf.format.schema import FILES, SchemaVersion, json_schema, schema_text
from eurdf.kinematics.residual import residual
from eurdf.kinematics.tolerances import CLOSED
from eurdf.linking.mesh_files import find_meshes
from eurdf.linking.robot_files import ReadRobot, read_robot, read_valid
from eurdf.mechanism.body import Shape
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.mechanism.same_model import with_whole_joints
from eurdf.mesh_files.folders import Folders, folders_of_files
from eurdf.mesh_files.reader import MeshReader, RefusedFile
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.reading.robot_source import RobotSource
from eurdf.writing.description import NotWritable, describe_mechanism, version_needed
from eurdf.writing.output_folder import write_files
from eurdf.writing.rewriting import Rewriting, RobotSize, size_of
from eurdf.writing.saved_configuration import DECIMALS
from eurdf.writing.simplification import Only, expanded, simplified

#: Largest difference of poses (m, rad), and of accelerations (relative), of robots that move in the same way.
_SAME_POSE, _SAME_ACCELERATION = 1e-10, 1e-6

#: A comment of a YAML file that is more than the line for editors.
_COMMENT = re.compile(r"(^|\s)#(?! yaml-language-server)")


@dataclass(frozen=True, eq=False, repr=False)
class Simplification:
    """A robot, rewritten so that it moves in the same way.

    Attributes:
        mechanism: The robot.
        changes: What was changed, one sentence each; empty if there was nothing to change.
        kept: What could not be changed, and why.
        lost: What the new files do not say.
        before: Size of the robot that was given.
        after: Size of the robot.
        motion: How far the two differ along a random motion; None if nothing was changed.
        files: Content of each file to write by its path relative to a folder: ``robot.urdf``, ``robot.yaml``, the
            schema for editors, and the meshes; empty if nothing was changed.
    """

    mechanism: Mechanism
    changes: tuple[str, ...]
    kept: tuple[str, ...]
    lost: tuple[str, ...]
    before: RobotSize
    after: RobotSize
    motion: SameMotion | None
    files: Mapping[str, bytes]

    def write(self, folder: str | os.PathLike[str], *, force: bool = False) -> tuple[Path, ...]:
        """Write the files to a folder: all of them or none.

        Args:
            folder: Where to write; made if it does not exist.
            force: Whether to replace files that exist.

        Returns:
            Paths of the files; the URDF is the first. None if nothing was changed.

        Raises:
            FileExistsError: A file exists, and `force` is False.
            OSError: A file cannot be written.
        """
        return write_files(folder, self.files, force=force) if self.files else ()

    def __repr__(self) -> str:
        one, other = self.before, self.after
        return f"<Simplification: {len(self.changes)} changes; nv {one.nv} to {other.nv}, nc {one.nc} to {other.nc}>"


def simplify(
    robot: RobotSource | Robot,
    *,
    expand: bool = False,
    only: Only = None,
    urdf: RobotSource | None = None,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
) -> Simplification:
    """Rewrite a robot with fewer velocities and constraint rows where its motion stays the same.

    Three revolute or continuous joints whose axes meet in one point become a ball joint. A ball joint whose link a 6d
    closure holds becomes a 3d closure: the link is fixed to what held it (Batto, De Matteïs, Mansard, 2025, 3.2 and
    3.4). Joints that are actuated, coupled or limited, or have losses, an armature or a spring, stay; so does a closure
    with compliance. ``docs/simplify.md`` states the conditions.

    The result is compared with the robot along a random motion: the poses of all links differ by at most 1e-10 (m,
    rad), and the accelerations of the joints that both have, under the same torques of the actuators, by at most 1e-6
    of the largest. Links between merged axes, which have nothing, are not compared: they no longer turn.

    Args:
        robot: What `eurdf.load` takes, or a robot that it returned, with the geometry that it was loaded with.
        expand: Whether to go back: each 3d closure becomes a ball joint and a 6d closure, then each ball joint three
            continuous joints, which are singular where the second is at ±π/2.
        only: ``joints`` or ``closures``: what to rewrite; both by default.
        urdf: As for `eurdf.load`; only if `robot` is not loaded yet, as all below.
        package_dirs: As for `eurdf.load`.
        xacro_args: As for `eurdf.load`.
        confined: As for `eurdf.load`.
        allow_outside: Whether meshes are copied that are neither in the robot's folder nor in a package. If not, their
            names stay as they are.

    Returns:
        The robot, its files, and what was saved. Comments, and elements of the URDF that no description has, are lost.

    Raises:
        InvalidRobot: The robot cannot be built without guessing.
        RobotNotFound: There are no such files.
        CannotSimplify: Its loops do not close, so that motions cannot be compared, or they differ; or the two files
            cannot say what the robot becomes.
        ValueError: ``only`` is neither; or `confined` and `allow_outside` are both True.
    """
    if only not in (None, "joints", "closures"):
        raise ValueError(f"only is {only!r}; it must be 'joints' or 'closures'")
    lost: tuple[str, ...] = ()
    if isinstance(robot, Robot):
        given, paths = robot.mechanism, files_of_meshes(robot)
        folders = folders_of_files(paths.values(), allow_outside=allow_outside)
    else:
        files = {"package_dirs": package_dirs, "confined": confined, "allow_outside": allow_outside}
        read = read_valid(robot, urdf=urdf, xacro_args=xacro_args, **files)
        found = find_meshes(read.urdf, **files)  # type: ignore[arg-type]
        given, folders = read.mechanism, found.folders
        paths = {uri: Path(path) for uri, path in found.paths.items()}
        lost = _not_in_mechanism(read)
    before = build_robot(with_whole_joints(given), geometry=False)
    rewritten = (expanded if expand else simplified)(before.mechanism, only)
    if not rewritten.changes:
        size = size_of(before.mechanism)
        return Simplification(given, (), rewritten.kept, (), size, size, None, MappingProxyType({}))
    mechanism, open_names = _with_configurations(before, rewritten)
    mechanism, meshes, not_copied = _with_meshes(mechanism, paths, folders)
    lost += (*rewritten.lost, *open_names, *not_copied)
    schema: SchemaVersion = "2" if version_needed(mechanism) == "2.0" else "2.1"
    try:
        written = describe_mechanism(mechanism, schema=f"./{FILES[schema]}")
    except NotWritable as reason:
        raise CannotSimplify(f"cannot rewrite '{given.name}': {reason}") from None
    after = read_robot(written.yaml, urdf=written.urdf.decode())
    if after.linked is None:
        raise CannotSimplify(f"cannot rewrite '{given.name}': {after.diagnostics.errors[0].message}")
    built = build_robot(after.linked, geometry=False)
    return Simplification(
        after.linked,
        rewritten.changes,
        rewritten.kept,
        lost,
        size_of(before.mechanism),
        size_of(after.linked),
        _compared(before, built, rewritten),
        MappingProxyType(
            {
                "robot.urdf": written.urdf,
                "robot.yaml": written.yaml.encode(),
                FILES[schema]: schema_text(json_schema(schema)).encode(),
                **meshes,
            }
        ),
    )


def _not_in_mechanism(read: ReadRobot) -> tuple[str, ...]:
    """A sentence about what the files of a robot have beside what a mechanism contains."""
    tags = {element.tag for element in read.urdf.document.root}
    others = sorted({tag for tag in tags if isinstance(tag, str)} - {"link", "joint", "material"})
    found = [f"elements of the URDF that no description has are left out: {quoted(others)}"] if others else []
    yaml = "" if read.yaml is None else read.description.document.source.text
    if not all(isinstance(tag, str) for tag in tags) or any(map(_COMMENT.search, yaml.splitlines())):
        found.append("comments are left out")
    return tuple(found)


def _compared(before: Robot, after: Robot, rewritten: Rewriting) -> SameMotion:
    """How far the two differ; `CannotSimplify` if it is too far."""
    name = before.mechanism.name
    try:
        found = compare_motion(before, after, rewritten.converted, rewritten.between)
    except (NotClosable, UndeterminedMotion) as reason:
        raise CannotSimplify(f"cannot rewrite '{name}', whose motion cannot be compared: {reason}") from None
    if not (found.pose <= _SAME_POSE and (found.acceleration or 0.0) <= _SAME_ACCELERATION):
        raise CannotSimplify(f"cannot rewrite '{name}', whose motion would change: {found}")
    return found


def _with_configurations(before: Robot, rewritten: Rewriting) -> tuple[Mechanism, tuple[str, ...]]:
    """The mechanism with the named configurations of the robot; and a sentence about those with open loops."""
    mechanism = rewritten.mechanism
    stays = {(joint.name, joint.type) for joint in before.mechanism.joints}
    configurations, is_open = {}, []
    for name, stated in before.mechanism.configurations.items():
        q = before.configuration(stated)
        if np.abs(residual(before, q)).max(initial=0.0) > CLOSED:
            is_open.append(name)
        positions = rewritten.converted(before.joint_positions(q, mimic=True))
        found = {ROOT_JOINT: stated[ROOT_JOINT]} if ROOT_JOINT in stated else {}
        for joint in mechanism.joints:
            if (joint.name, joint.type) not in stays and not joint.type.is_fixed:
                values = tuple(round(value, DECIMALS) + 0.0 for value in positions[joint.name])
                found |= {joint.name: values} if values != joint.type.neutral else {}
            elif joint.name in stated and not joint.type.is_fixed:
                found[joint.name] = stated[joint.name]
        configurations[name] = MappingProxyType(found)
    lost = f"configurations with open loops, where links are in other places: {quoted(is_open)}"
    return replace(mechanism, configurations=MappingProxyType(configurations)), (lost,) if is_open else ()


def _with_meshes(
    mechanism: Mechanism, paths: Mapping[str, Path], folders: Folders
) -> tuple[Mechanism, dict[str, bytes], tuple[str, ...]]:
    """The mechanism with meshes in ``meshes/``, their content, and a sentence about each that is not copied."""
    reader, names = MeshReader(folders), FileNames()
    files: dict[str, bytes] = {}
    places: dict[str, str] = {}
    lost = []
    shapes = [shape for body in mechanism.bodies for shape in (*body.visuals, *body.collisions)]
    named = {shape.filename for shape in shapes if shape.kind == "mesh"}
    if missing := sorted(named - paths.keys()):
        lost.append(f"meshes that are not found, or outside the robot's folder, keep their names: {quoted(missing)}")
    for uri in sorted(named & paths.keys()):
        try:
            content = reader.read(paths[uri])
        except RefusedFile as reason:
            lost.append(f"mesh '{uri}' is not copied, its name stays: {reason}")
            continue
        places[uri] = f"meshes/{names.new(paths[uri].stem, paths[uri].suffix)}"
        lost += [f"mesh '{uri}' loses '{other}': {why}" for other, why in content.place(places[uri], files).items()]
    textures = sorted({shape.texture for shape in shapes if shape.texture})
    lost += [f"textures are not copied, their names stay: {quoted(textures)}"] if textures else []

    def placed(own: Sequence[Shape]) -> tuple[Shape, ...]:
        return tuple(replace(shape, filename=places.get(shape.filename, shape.filename)) for shape in own)

    bodies = tuple(
        replace(body, visuals=placed(body.visuals), collisions=placed(body.collisions)) for body in mechanism.bodies
    )
    return replace(mechanism, bodies=bodies), files, tuple(lost)
