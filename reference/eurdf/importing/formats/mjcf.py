"""MJCF, the format of MuJoCo.

Facts of MuJoCo that the importer relies on (documentation: Modeling, XML reference, mjModel): joints of one body act in
order, each about its anchor ``pos`` and along its ``axis``, both given in the body at the reference configuration
qpos0; quaternions are w x y z; equalities of joints and tendons are relative to qpos0; the data of a compiled
``connect`` are its anchors in body 1 and in body 2, those of a ``weld`` its anchors in body 2 and in body 1 and the
orientation of body 2 in body 1; the pose of a compiled mesh shape is that of the mesh's own inertial frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from eurdf.importing.exceptions import CannotImport
from eurdf.importing.mjcf.actuators import read_actuators
from eurdf.importing.mjcf.bodies import read_body
from eurdf.importing.mjcf.closures import movable, read_closures
from eurdf.importing.mjcf.configurations import read_configurations
from eurdf.importing.mjcf.couplings import read_couplings
from eurdf.importing.mjcf.frames import read_frames
from eurdf.importing.mjcf.joints import read_joints
from eurdf.importing.mjcf.losses import LOSSES
from eurdf.importing.mjcf.model import MjcfModel, compile_mjcf
from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.remainder import leave_out_rest, leave_out_scenery
from eurdf.importing.mjcf.values import NoDirection, must_have_direction
from eurdf.importing.places import places_of_names
from eurdf.importing.robot_read import ImportFormat, RobotRead
from eurdf.importing.xml_files import included_files
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.spanning_tree import depth_first
from eurdf.reading.resource import FileFinder

#: What has a direction: the kind of element, its array, and what it is.
_DIRECTIONS = (
    ("body", "body_quat", "quaternion"),
    ("body", "body_iquat", "quaternion"),
    ("geom", "geom_quat", "quaternion"),
    ("site", "site_quat", "quaternion"),
    ("mesh", "mesh_quat", "quaternion"),
    ("joint", "jnt_axis", "axis"),
)


def read(path: Path, finder: FileFinder) -> RobotRead:
    """Read an MJCF file.

    Raises:
        CannotImport: It is not MJCF, or MuJoCo refuses it, or one of the XML files is where none may be.
        MissingExtra: The extra ``mujoco`` is not installed.
    """
    folders = finder.folders
    sources = included_files(path, folders)
    model = compile_mjcf(path, folders)
    _must_have_directions(path, model, sources)
    try:
        return replace(_robot(MjcfReading(model, path, folders)), sources=sources)
    except NoDirection as reason:
        raise CannotImport(path, f"a keyframe or an equality has {reason}") from None


def _must_have_directions(path: Path, model: MjcfModel, sources: Sequence[Path]) -> None:
    for kind, array, what in _DIRECTIONS:
        for name, values in zip(model.names[kind], model[array], strict=False):
            try:
                must_have_direction(what, values)
            except NoDirection as reason:
                places = places_of_names(sources)
                line = f":{places[name].line}" if name in places else ""
                raise CannotImport(path, f"{path.name}{line}: {kind} '{name}' has {reason}") from None


def _robot(reading: MjcfReading) -> RobotRead:
    """Read all parts of the robot."""
    for body in reading.below(reading.root_body):
        reading.bodies[body] = read_body(reading, body)
    root = reading.bodies[reading.root_body].name
    for body in list(reading.bodies):
        if body != reading.root_body:
            read_joints(reading, body)
    leave_out_scenery(reading)
    closures = read_closures(reading)
    couplings = read_couplings(reading)
    actuators, motors = read_actuators(reading)
    frames = read_frames(reading)
    ordered = depth_first(root, reading.joints)
    by_name = {body.name: body for body in (*reading.bodies.values(), *reading.extra)}
    mechanism = Mechanism(
        reading.name,
        "",
        reading.root,
        (by_name[root], *(by_name[joint.child] for joint in ordered)),
        tuple(ordered),
        frames,
        (),
        actuators,
        couplings=couplings,
        motors=MappingProxyType(motors),
    )
    mechanism = replace(mechanism, closures=movable(reading, closures, mechanism))
    configurations, start = read_configurations(reading, mechanism)
    leave_out_rest(reading)
    mechanism = replace(mechanism, configurations=MappingProxyType(configurations))
    return RobotRead(mechanism, reading.losses.found, reading.copies.files, start)


FORMAT = ImportFormat("mjcf", read, LOSSES)
