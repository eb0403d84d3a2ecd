"""The spanning tree of a robot in a dialect of URDF, read by the reader of this package."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from lxml import etree

from eurdf.convert.import_format import ImportInput
from eurdf.convert.losses import Losses, LossKind, dropped
from eurdf.convert.names import UniqueNames
from eurdf.convert.steps import continuous_if_unlimited
from eurdf.convert.xml_elements import Elements, inside, local, read_root
from eurdf.diagnostics import Diagnostics, FileError
from eurdf.errors import CannotImport
from eurdf.format.urdf.read import read_urdf
from eurdf.linking.link import link
from eurdf.mechanism.body import Shape
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism, Motor
from eurdf.mesh_files.reader import RefusedFile
from eurdf.reading.source import Source, read_source
from eurdf.reading.xml_reader import read_xml

_URDF = ("link", "joint", "material", "transmission")

#: Losses of every dialect.
URDF_LOSSES = {
    "mesh": dropped(
        "mesh",
        "its file was not found, or is refused; its name is kept",
        "put the file beside the URDF, or name its folder with --within (within= in Python), and import again",
    ),
    "texture": dropped("texture", "its file is not copied; its name is kept", "copy the file"),
    "actuator": dropped(
        "actuator", "is left out: it names no joint that can be actuated", "name the actuated joint in the description"
    ),
    "later-version": dropped(
        "element",
        "has no effect: the file states no version of URDF that has it",
        "state the version in <robot>, and import again",
    ),
    "element": dropped("element", "is no part of a description", "keep it in a file of the simulator"),
}


def loop_left_out(concept: str) -> LossKind:
    """The loss of a loop of a type that no closure is; the concept is what the dialect calls it."""
    return dropped(
        concept,
        "is left out: loops are closed by spherical, fixed and revolute joints",
        "let another joint of the loop close it",
    )


@dataclass(frozen=True, slots=True)
class UrdfDialect:
    """What a dialect shares with URDF.

    Attributes:
        root: The root element, as written.
        elements: Reads its elements.
        mechanism: The links and joints, with actuators from ``<transmission>``.
        losses: What is lost.
    """

    root: etree._Element
    elements: Elements
    mechanism: Mechanism
    losses: Losses

    @property
    def links(self) -> list[str]:
        """Names of the links."""
        return [body.name for body in self.mechanism.bodies]

    def link(self, element: etree._Element, name: str | None) -> str:
        """The name of a link that exists, which an element states."""
        return self.elements.link(element, name, self.links)

    def children(self, tag: str) -> list[etree._Element]:
        """The elements of the robot with a tag, in any namespace."""
        return [element for element in self.root if isinstance(element.tag, str) and local(element) == tag]

    def frame_names(self) -> UniqueNames:
        """Names of frames."""
        return UniqueNames(self.losses, *self.links, *(joint.name for joint in self.mechanism.joints))


def read_tree(
    given: ImportInput,
    known: tuple[str, ...],
    plain: Callable[[etree._Element], None] | None = None,
    change: Callable[[Joint], Joint] | None = None,
) -> UrdfDialect:
    """Read the links and joints of a file.

    Args:
        given: The file; losses are those of `URDF_LOSSES`.
        known: Local tags of the elements of the robot that the dialect reads itself.
        plain: Makes the elements of a copy those of plain URDF.
        change: Makes each joint of the plain URDF that of the dialect.

    Raises:
        CannotImport: The file has an error.
    """
    path, losses = given.path, given.losses
    inside(path, path.resolve(), given.folders)
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
    bodies = []
    for body in mechanism.bodies:
        visuals, collisions = (
            tuple(_with_copy(shape, given) for shape in shapes) for shapes in (body.visuals, body.collisions)
        )
        bodies.append(replace(body, visuals=visuals, collisions=collisions))
    joints = map(continuous_if_unlimited, mechanism.joints)
    joints = joints if change is None else map(change, joints)
    mechanism = replace(mechanism, bodies=tuple(bodies), joints=tuple(joints))
    for element in root:
        if isinstance(element.tag, str) and local(element) not in (*_URDF, *known):
            losses.add("import-element", local(element))
    elements = Elements(path)
    return UrdfDialect(root, elements, _actuated(mechanism, root, elements, losses), losses)


def _with_copy(shape: Shape, given: ImportInput) -> Shape:
    """A shape whose mesh, if it is one, is copied."""
    if shape.texture:
        given.losses.add("import-texture", shape.texture)
    if shape.kind != "mesh":
        return shape
    file = given.finder.find(shape.filename)
    if file is None:
        given.losses.add("import-mesh", shape.filename)
        return shape
    try:
        return replace(shape, filename=given.copy(file))
    except RefusedFile as reason:
        given.losses.add("import-mesh", shape.filename, f"is not copied, and its name is kept: {reason}")
        return shape


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
        joint.properties, gear_ratio=(ratio,) * nv, rotor_inertia=(rotor,) * nv, armature=(ratio * ratio * rotor,) * nv
    )
    return replace(joint, properties=own)
