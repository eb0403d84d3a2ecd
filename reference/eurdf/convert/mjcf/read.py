"""MJCF, the format of MuJoCo.

Facts of MuJoCo that the importer relies on (documentation: Modeling, XML reference, mjModel): joints of one body act in
order, each about its anchor ``pos`` and along its ``axis``, both given in the body at the reference configuration
qpos0; quaternions are w x y z; equalities of joints and tendons are relative to qpos0; the data of a compiled
``connect`` are its anchors in body 1 and in body 2, those of a ``weld`` its anchors in body 2 and in body 1 and the
orientation of body 2 in body 1; the pose of a compiled mesh shape is that of the mesh's own inertial frame.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from eurdf.convert.import_format import SIMULATION, TEXTURE, ImportFormat, ImportInput, RobotRead, loss_kinds
from eurdf.convert.losses import approximate, dropped, exact
from eurdf.convert.mjcf.compiled import MjcfModel, compile_mjcf, included_files
from eurdf.convert.mjcf.read_actuators import read_actuators
from eurdf.convert.mjcf.read_bodies import read_body
from eurdf.convert.mjcf.read_constraints import movable, read_closures, read_couplings
from eurdf.convert.mjcf.read_joints import coordinates_at, read_joints
from eurdf.convert.mjcf.read_state import (
    WORLD,
    MjcfReading,
    NoDirection,
    flat,
    must_have_direction,
    name_of,
    pose_from,
    usable,
    xyzw,
)
from eurdf.convert.names import UniqueNames
from eurdf.convert.xml_elements import places_of_names
from eurdf.errors import CannotImport
from eurdf.linking.configurations import beyond_limits
from eurdf.mechanism.body import Frame
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.mechanism.spanning_tree import depth_first

_LOSSES = {
    "scenery": dropped(
        "world",
        "the shapes of the world, and bodies that nothing moves, are left out: the root of the robot floats",
        "import the file of the robot alone",
    ),
    "softness": approximate(
        "equality",
        "becomes rigid: solref and solimp are left out",
        "give the closure a compliance, if simulators should know it",
    ),
    "inactive-equality": dropped("equality", "is not active, and is left out", "activate it"),
    "equality": dropped(
        "equality",
        "is left out: it does not connect two bodies or relate joints linearly",
        "describe it by a closure, a coupling or a mimic joint",
    ),
    "redundant-equality": exact(
        "equality",
        "is left out: it joins two bodies that are fixed to each other, or repeats another equality",
        "remove it",
    ),
    "locked-joint": exact("joint", "is fixed where an equality holds it", "make it a fixed body"),
    "tendon": dropped(
        "tendon",
        "its limits, springs and losses are left out",
        "describe what it does by springs of joints or couplings",
    ),
    "tendon-actuator": approximate(
        "actuator",
        "pulls a tendon: becomes a motor of the one joint that moves all others of the tendon",
        "check which joint the motor should drive",
    ),
    "actuator": dropped(
        "actuator", "is left out: it does not act on one joint", "name the actuated joint in the description"
    ),
    "second-actuator": dropped(
        "actuator", "is left out: its joint has another actuator", "keep one actuator of a joint"
    ),
    "actuator-gain": dropped(
        "actuator",
        "its gain, bias and dynamics are left out: it becomes a source of torque or force",
        "keep its controller beside the description",
    ),
    "effort-limit": approximate(
        "effort limit",
        "is not stated: the largest torque or force of the actuator is taken",
        "correct it in the description",
    ),
    "unequal-effort": approximate(
        "effort limit",
        "is not the same in both directions: the larger one is taken",
        "give the actuator a control range",
    ),
    "ball-limit": dropped(
        "position limit",
        "is left out: a spherical joint has no limits",
        "limit the angle of the joint in the simulator",
    ),
    "ball-spring": dropped(
        "spring", "is left out: spherical and floating joints have no springs", "add the spring in the simulator"
    ),
    "nonlinear-spring": dropped(
        "spring", "the nonlinear part of its stiffness or damping is left out", "add it in the simulator"
    ),
    "gravity-compensation": dropped(
        "link", "its gravity compensation is left out", "compensate gravity in the controller"
    ),
    "mocap": approximate("link", "is moved by the user (mocap): becomes fixed", "make it a body with a free joint"),
    "shape": dropped(
        "shape",
        "is left out: URDF has no planes, ellipsoids, height fields and signed distance fields",
        "replace it by boxes, spheres, capsules, cylinders or a mesh",
    ),
    "hidden-shape": dropped("shape", "is left out: it is neither visible nor touches anything", "remove it"),
    "mesh": dropped(
        "mesh",
        "is left out",
        "correct its file, or name the folder of the file with --within (within= in Python), and import again",
    ),
    "mesh-converted": approximate(
        "mesh",
        "is not in a file that URDF can name: its vertices, in single precision, are written as OBJ",
        "save it as STL or OBJ",
    ),
    "texture": TEXTURE,
    "frame": dropped("frame", "a site without a name is left out", "give it a name in the file"),
    "configuration": dropped(
        "configuration", "is left out: a coordinate is beyond its limits", "correct the keyframe or the limits"
    ),
    "simulation": SIMULATION,
}

#: What has a direction: the kind of element, as the file calls it, its prefix, the value, and what that is.
_DIRECTIONS = (
    ("body", "body", "quat", "quaternion"),
    ("body", "body", "iquat", "quaternion"),
    ("geom", "geom", "quat", "quaternion"),
    ("site", "site", "quat", "quaternion"),
    ("mesh", "mesh", "quat", "quaternion"),
    ("joint", "jnt", "axis", "axis"),
)

#: What is counted and left out.
_COUNTED = {
    "nsensor": "sensors",
    "ncam": "cameras",
    "nlight": "lights",
    "npair": "contact pairs",
    "nexclude": "contact exclusions",
    "nflex": "flexible bodies",
    "nskin": "skins",
    "nhfield": "height fields",
    "nplugin": "plugins",
}


def read(given: ImportInput) -> RobotRead:
    """Read an MJCF file.

    Raises:
        CannotImport: It is not MJCF, or MuJoCo refuses it, or one of the XML files is where none may be.
        MissingExtra: The extra ``mujoco`` is not installed.
    """
    sources = included_files(given.path, given.folders)
    model = compile_mjcf(given.path, given.folders)
    _must_have_directions(given.path, model, sources)
    try:
        return _robot(MjcfReading(given, model), sources)
    except NoDirection as reason:
        raise CannotImport(given.path, f"a keyframe or an equality has {reason}") from None


def _must_have_directions(path: Path, model: MjcfModel, sources: Sequence[Path]) -> None:
    for kind, prefix, value, what in _DIRECTIONS:
        for element in model[prefix]:
            try:
                must_have_direction(what, getattr(element, value))
            except NoDirection as reason:
                places = places_of_names(sources)
                line = f":{places[element.name].line}" if element.name in places else ""
                raise CannotImport(path, f"{path.name}{line}: {kind} '{element.name}' has {reason}") from None


def _robot(reading: MjcfReading, sources: tuple[Path, ...]) -> RobotRead:
    """Read all parts of the robot."""
    for body in reading.below(reading.root_body):
        reading.bodies[body] = read_body(reading, body)
    root = reading.bodies[reading.root_body].name
    for body in list(reading.bodies):
        if body != reading.root_body:
            read_joints(reading, body)
    _leave_out_scenery(reading)
    closures = read_closures(reading)
    couplings = read_couplings(reading)
    actuators, motors = read_actuators(reading)
    frames = _frames(reading)
    ordered = depth_first(root, reading.joints.values())
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
    configurations, start = _configurations(reading, mechanism)
    _leave_out_rest(reading)
    return RobotRead(replace(mechanism, configurations=MappingProxyType(configurations)), sources, start)


def _frames(reading: MjcfReading) -> tuple[Frame, ...]:
    """The sites with names, except the ends of closures, whose poses the closures state."""
    model = reading.model
    ends = {end for each in model["eq"] if each.objtype == "site" for end in (each.obj1id, each.obj2id)}
    ends |= {wrap.objid for each in model["tendon"] for wrap in reading.wraps(each.index) if wrap.type == "site"}
    links = [body.name for body in (*reading.bodies.values(), *reading.extra)]
    names = UniqueNames(reading.losses, "universe", ROOT_JOINT, *links, *reading.joints)
    found = []
    for site in model["site"]:
        if site.bodyid not in reading.bodies or site.index in ends:
            continue
        body = reading.bodies[site.bodyid].name
        if not site.name:
            reading.losses.add("import-frame", f"site {site.index} of {body}")
            continue
        found.append(Frame(names.new(usable(site.name)), body, pose_from(site.pos, site.quat)))
    return tuple(found)


def _configurations(
    reading: MjcfReading, mechanism: Mechanism
) -> tuple[dict[str, Mapping[str, tuple[float, ...]]], tuple[str, Mapping[str, tuple[float, ...]]]]:
    """The keyframes that are within limits; and the configuration to assemble from."""
    names = UniqueNames(reading.losses)
    found: dict[str, Mapping[str, tuple[float, ...]]] = {}
    keys: dict[str, Mapping[str, tuple[float, ...]]] = {}
    for key in reading.model["key"]:
        name = names.new(usable(key.name) or f"key_{key.index}")
        coordinates = keys[name] = _coordinates(reading, key.qpos, mechanism)
        beyond = beyond_limits(mechanism.joints, coordinates)
        if beyond:
            reading.losses.add("import-configuration", name, f"is left out: '{beyond[0].joint}' is beyond its limits")
        else:
            found[name] = coordinates
    for name in ("assembled", "home", *keys):
        if name in keys:
            return found, (f"keyframe '{name}'", keys[name])
    return found, ("the reference pose", _coordinates(reading, reading.model.qpos0, mechanism))


def _coordinates(reading: MjcfReading, qpos: Sequence[float], mechanism: Mechanism) -> Mapping[str, tuple[float, ...]]:
    """The coordinates of all joints with some of their own at a configuration of MuJoCo."""
    found: dict[str, tuple[float, ...]] = {}
    if mechanism.root == "floating":
        (joint,) = reading.joints_of[reading.root_body]
        found[ROOT_JOINT] = (
            *qpos[joint.qposadr : joint.qposadr + 3],
            *xyzw(qpos[joint.qposadr + 3 : joint.qposadr + 7]),
        )
    whole = {each.name: each for each in reading.whole.values()}
    for each in mechanism.joints:
        if each.name in whole and not each.type.is_fixed and each.mimic is None:
            found[each.name] = coordinates_at(whole[each.name], qpos)
    return MappingProxyType(found)


def _leave_out_scenery(reading: MjcfReading) -> None:
    """Record the bodies that are not part of the robot."""
    solid = {geom.bodyid for geom in reading.model["geom"]}
    for body in reading.model["body"]:
        if body.index not in reading.bodies and (body.index or 0 in solid):
            reading.losses.add("import-scenery", body.name or (f"body {body.index}" if body.index else WORLD))


def _leave_out_rest(reading: MjcfReading) -> None:
    """Record what the model has beside the robot."""
    model, losses = reading.model, reading.losses
    for each in model.left_out:
        losses.add("import-mesh" if each.kind == "mesh" else "import-shape", each.name, f"is left out: {each.reason}")
    used = {end for each in model["eq"] if each.type == "tendon" for end in (each.obj1id, each.obj2id)}
    used |= {each.trnid[0] for each in model["actuator"] if each.trntype == "tendon"}
    for tendon in model["tendon"]:
        passive = (tendon.limited, tendon.stiffness, tendon.damping, tendon.frictionloss)
        if tendon.index not in used or any(any(flat(each)) for each in passive):
            losses.add("import-tendon", name_of(tendon, "tendon"))
    shown = [f"{count} {_COUNTED[name]}" for name, count in model.counts.items() if count]
    if shown:
        losses.add("import-simulation", reading.name, f"left out: {', '.join(shown)}")


FORMAT = ImportFormat(read, loss_kinds(_LOSSES))
