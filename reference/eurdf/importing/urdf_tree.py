"""The spanning tree of a robot in a dialect of URDF, read by the reader of this package."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from lxml import etree

from eurdf.diagnostics import Diagnostics, FileError
from eurdf.format.urdf.read import read_urdf
from eurdf.importing.elements import Elements, local
from eurdf.importing.exceptions import CannotImport
from eurdf.importing.mesh_copies import NAMED_FILE, MeshCopies
from eurdf.importing.xml_files import inside, read_root
from eurdf.linking.link import link
from eurdf.loss import Effect, Losses, LossKind
from eurdf.mechanism.body import Shape
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, Motor
from eurdf.mesh_files.reader import RefusedFile
from eurdf.reading.resource import FileFinder
from eurdf.reading.source import Source, read_source
from eurdf.reading.xml_reader import read_xml

#: Losses of every dialect.
URDF_LOSSES = (
    LossKind(
        "import-name",
        "name",
        Effect.EXACT,
        "is changed: the name is missing, or used by another element",
        "give the element a unique name in the file",
    ),
    LossKind(
        "import-mesh",
        "mesh",
        Effect.DROPPED,
        "its file was not found, or is refused; its name is kept",
        "put the file beside the URDF, or name its folder with --within (within= in Python), and import again",
    ),
    NAMED_FILE,
    LossKind(
        "import-texture",
        "texture",
        Effect.DROPPED,
        "its file is not copied; its name is kept",
        "copy the file",
    ),
    LossKind(
        "import-actuator",
        "actuator",
        Effect.DROPPED,
        "is left out: it names no joint that can be actuated",
        "name the actuated joint in the description",
    ),
    LossKind(
        "import-later-version",
        "element",
        Effect.DROPPED,
        "has no effect: the file states no version of URDF that has it",
        "state the version in <robot>, and import again",
    ),
    LossKind(
        "import-element",
        "element",
        Effect.DROPPED,
        "is no part of a description",
        "keep it in a file of the simulator",
    ),
)


def loop_left_out(concept: str) -> LossKind:
    """The loss of a loop of a type that no closure is; the concept is what the dialect calls it."""
    return LossKind(
        "import-loop",
        concept,
        Effect.DROPPED,
        "is left out: loops are closed by spherical, fixed and revolute joints",
        "let another joint of the loop close it",
    )


@dataclass(frozen=True, slots=True)
class UrdfTree:
    """What a dialect shares with URDF.

    Attributes:
        root: The root element, as written.
        elements: Reads its elements.
        mechanism: The links and joints, with actuators from ``<transmission>``.
        copies: The mesh files.
    """

    root: etree._Element
    elements: Elements
    mechanism: Mechanism
    copies: MeshCopies


def read_tree(
    path: Path,
    finder: FileFinder,
    losses: Losses,
    known: tuple[str, ...],
    plain: Callable[[etree._Element], None] | None = None,
    change: Callable[[Joint], Joint] | None = None,
) -> UrdfTree:
    """Read the links and joints of a file.

    Args:
        path: The file.
        finder: Finds its meshes, and says where files may be.
        losses: Where to record losses, of `URDF_LOSSES`.
        known: Local tags of the elements of the robot that the dialect reads itself.
        plain: Makes the elements of a copy those of plain URDF.
        change: Makes each joint of the plain URDF that of the dialect.

    Raises:
        CannotImport: The file has an error.
    """
    inside(path, path.resolve(), finder.folders)
    root = read_root(path)
    diagnostics = Diagnostics()
    try:
        source = read_source(path)
        if plain is not None:
            copy = read_root(path)
            plain(copy)
            text = etree.tostring(copy, encoding="unicode")
            source = Source(os.fspath(path), text, text.encode(), path.parent)
        urdf = read_urdf(read_xml(source), diagnostics)
    except FileError as error:
        raise CannotImport(path, error.diagnostic.message) from None
    mechanism = None if urdf is None else link(urdf, None, diagnostics)
    if urdf is None or mechanism is None:
        first = diagnostics.errors[0]
        where = f"{path.name}:{first.line}: " if first.line and plain is None else ""
        raise CannotImport(path, where + first.message)
    for found in diagnostics:
        if found.code == "urdf-later-version" and "<capsule>" not in found.message:
            losses.add("import-later-version", found.message.partition(" ")[0].strip("'"), found.message)
    copies = MeshCopies(finder.folders, losses)

    def copied(shape: Shape) -> Shape:
        if shape.texture:
            losses.add("import-texture", shape.texture)
        if shape.kind != "mesh":
            return shape
        file = finder.find(shape.filename)
        if file is None:
            losses.add("import-mesh", shape.filename)
            return shape
        try:
            return replace(shape, filename=copies.file(Path(file)))
        except RefusedFile as reason:
            losses.add("import-mesh", shape.filename, f"is not copied, and its name is kept: {reason}")
            return shape

    bodies = tuple(
        replace(body, visuals=tuple(map(copied, body.visuals)), collisions=tuple(map(copied, body.collisions)))
        for body in mechanism.bodies
    )
    joints = map(_continuous, mechanism.joints)
    mechanism = replace(mechanism, bodies=bodies, joints=tuple(joints if change is None else map(change, joints)))
    for element in root:
        if isinstance(element.tag, str) and local(element) not in (*_URDF, *known):
            losses.add("import-element", local(element))
    elements = Elements(path)
    return UrdfTree(root, elements, _actuated(mechanism, root, elements, losses), copies)


_URDF = ("link", "joint", "material", "transmission")


def _continuous(joint: Joint) -> Joint:
    """The joint, continuous if it is revolute and has no position limits."""
    limits = (*joint.properties.lower, *joint.properties.upper)
    if joint.type is not JointType.REVOLUTE or any(map(math.isfinite, limits)):
        return joint
    return replace(joint, type=JointType.CONTINUOUS)


def _actuated(mechanism: Mechanism, root: etree._Element, elements: Elements, losses: Losses) -> Mechanism:
    """The mechanism with the actuators that transmissions state."""
    joints = {joint.name: joint for joint in mechanism.joints}
    actuators: dict[str, Motor | None] = {}
    for transmission in root.iterchildren("transmission"):
        joint, actuator = transmission.find("joint"), transmission.find("actuator")
        name = "" if joint is None else joint.get("name", "")
        own = joints.get(name)
        if own is None or own.type.is_fixed or own.mimic is not None or name in actuators:
            losses.add("import-actuator", name or transmission.get("name", ""))
            continue
        shown = name if actuator is None else actuator.get("name") or name
        actuators[name] = None if shown == name else Motor(shown)
        joints[name] = own if actuator is None else _geared(own, actuator, elements)
    return replace(
        mechanism,
        joints=tuple(joints[joint.name] for joint in mechanism.joints),
        actuators=tuple(actuators),
        motors={name: motor for name, motor in actuators.items() if motor is not None},
    )


def _geared(joint: Joint, actuator: etree._Element, elements: Elements) -> Joint:
    """A joint with the gear and the rotor that Drake states of an actuator."""
    values: Mapping[str, float] = {
        local(child): elements.attribute(child, "value")
        for child in actuator
        if isinstance(child.tag, str) and local(child) in ("gear_ratio", "rotor_inertia")
    }
    ratio, rotor = values.get("gear_ratio", 1.0), values.get("rotor_inertia", 0.0)
    if ratio == 1.0 and not rotor:
        return joint
    nv = joint.type.nv
    own = replace(
        joint.properties,
        gear_ratio=(ratio,) * nv,
        rotor_inertia=(rotor,) * nv,
        armature=(ratio * ratio * rotor,) * nv,
    )
    return replace(joint, properties=own)
