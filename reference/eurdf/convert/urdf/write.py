"""The links and joints of a URDF: in its extensions, and in plain URDF, with the types and properties that it has."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

from lxml import etree

from eurdf.convert.coordinates import Coordinates
from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.losses import Losses
from eurdf.convert.meshes import MeshFiles
from eurdf.convert.names import UniqueNames
from eurdf.convert.parts import Part, part_of
from eurdf.convert.steps import ExportedJoint, in_series, turn_type
from eurdf.convert.urdf.facts import EXACT, ROWS
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, root_joint
from eurdf.mechanism.pose import IDENTITY, Pose, Z
from eurdf.writing.urdf_elements import (
    add_dynamics,
    add_fixed_joint,
    add_inertial,
    add_joint,
    add_limit,
    add_mimic,
    add_shape,
    state_version,
)
from eurdf.writing.xml_text import file_content, representable


class UrdfTree:
    """The links and joints of a URDF while it is written.

    Attributes:
        root: The element of the robot.
        names: Names of links and joints that the robot does not have.
        links: Name of the link of each body.
        joints: Names of the joints of each joint.
        parts: The robot's joints in it.
    """

    #: The types of joint that are one joint of the file, beside those of one axis.
    whole: tuple[JointType, ...] = ()

    def __init__(
        self, given: ExportInput, losses: Losses, is_readable: Callable[[str, bytes], bool] | None = None
    ) -> None:
        """Prepare the tree; ``is_readable`` is that of `MeshFiles`."""
        self._given, self.mechanism, self.losses = given, given.mechanism, losses
        self.root = etree.Element("robot", name=representable(self.mechanism.name))
        links, joints = (body.name for body in self.mechanism.bodies), (joint.name for joint in self.mechanism.joints)
        self.names = UniqueNames(losses, *links, *joints)
        self.links = {body.name: body.name for body in self.mechanism.bodies}
        self.joints: dict[str, tuple[str, ...]] = {}
        self.meshes = MeshFiles(given, losses, is_readable)
        self.parts: list[Part] = []

    def write(self) -> None:
        """Write all links and joints."""
        for body in self.mechanism.bodies:
            link = etree.SubElement(self.root, "link", name=self.links[body.name])
            inertia = self.inertia(body)
            if inertia is not None:
                add_inertial(link, inertia)
            for tag, shapes in (("visual", body.visuals), ("collision", body.collisions)):
                for shape in shapes:
                    self._shape(link, tag, shape)
        for joint in self.mechanism.joints:
            if joint.type.is_fixed:
                self.fixed(joint.name, joint.parent, self.links[joint.child], joint.placement * joint.offset)
            else:
                self._joint(joint)

    def inertia(self, body: Body) -> Inertia | None:
        """The inertia that is written of a body."""
        return body.inertia

    def _shape(self, link: etree._Element, use: str, shape: Shape) -> None:
        name = shape.filename
        if shape.kind == "mesh":
            name = self.meshes.path(name) or name
        add_shape(link, use, shape, name)

    def fixed(self, name: str, parent: str, child: str, placement: Pose) -> None:
        """Add a fixed joint from a body to a link."""
        self.joints[name] = (name,)
        add_fixed_joint(self.root, name, self.links[parent], child, placement)

    def _joint(self, joint: Joint) -> None:
        # The slide of a screw mimics the turn, which readers want first.
        steps = sorted(in_series(joint, self.whole), key=lambda step: step.lead != 0.0)
        parent, placement, names = self.links[joint.parent], joint.placement, []
        for step in steps:
            name = step.joint.name if step.joint.name == joint.name else self.names.new(step.joint.name)
            last = step is steps[-1] and joint.offset is IDENTITY
            child = self.links[joint.child] if last else self.names.new(f"{name}_link")
            if not last:
                etree.SubElement(self.root, "link", name=child)
            kind = step.joint.type
            in_a_plane = kind.moving_frame and kind.quaternion is None
            axis = Z if in_a_plane else next(iter(step.joint.axes), None)
            element = add_joint(self.root, name, self.type(joint, step), parent, child, placement, axis)
            self.add_properties(joint, step, element)
            if step.lead:
                add_mimic(element, Mimic(joint.name, step.lead))
            elif joint.mimic is not None:
                add_mimic(element, joint.mimic)
            names.append(name)
            parent, placement = child, IDENTITY
        if joint.offset is not IDENTITY:
            name = self.names.new(f"{joint.name}_offset")
            add_fixed_joint(self.root, name, parent, self.links[joint.child], joint.offset)
        self.joints[joint.name] = tuple(names)
        self.add_part(joint, names, steps)

    def type(self, joint: Joint, step: ExportedJoint) -> JointType:
        """The type of one of the joints that a joint becomes."""
        return step.joint.type

    def add_properties(self, joint: Joint, step: ExportedJoint, element: etree._Element) -> None:
        """Add what the file states of one of the joints that a joint becomes."""
        raise NotImplementedError

    def add_part(self, joint: Joint, names: Sequence[str], steps: Sequence[ExportedJoint]) -> None:
        """Add the joint to `parts`, unless it has no coordinates of its own."""
        raise NotImplementedError


class PlainTree(UrdfTree):
    """A tree that has only the joint types of URDF, with frames as links."""

    whole = (JointType.PLANAR, JointType.FLOATING)

    def write(self) -> None:
        """Write links, joints and frames."""
        super().write()
        state_version(self.root)
        for frame in self.mechanism.frames:
            name = self.names.new(frame.name)
            etree.SubElement(self.root, "link", name=name)
            self.fixed(self.names.new(f"{name}_fixed"), frame.body, name, frame.pose)
        if self.mechanism.root == "floating":
            # The coordinates are those of the URDF once it is loaded as the hint says.
            self.parts.insert(0, part_of(root_joint(""), (ROOT_JOINT,), ()))

    def output(self) -> ExportOutput:
        """The files."""
        return ExportOutput({"robot.urdf": file_content(self.root), **self.meshes.files}, self.coordinates)

    @cached_property
    def _leaders(self) -> frozenset[str]:
        """Names of the joints that others mimic."""
        return frozenset(joint.mimic.joint for joint in self.mechanism.joints if joint.mimic is not None)

    def type(self, joint: Joint, step: ExportedJoint) -> JointType:
        """Of a turn without limits, ``continuous``.

        Not where joints mimic: Pinocchio lets no revolute or prismatic joint mimic a continuous one.
        """
        kind = step.joint.type
        is_alone = joint.type is JointType.REVOLUTE and joint.mimic is None and joint.name not in self._leaders
        return turn_type(joint) if is_alone else kind

    def add_properties(self, joint: Joint, step: ExportedJoint, element: etree._Element) -> None:
        """Add limits and losses; of planar and floating joints, those of the first axis."""
        properties = step.joint.properties

        def first(values: tuple[float, ...], otherwise: float) -> float:
            return values[0] if values else otherwise

        position = None
        if self.type(joint, step).is_ranged:
            position = step.joint.ranges[0]
        velocity, effort = first(properties.velocity, math.inf), first(properties.effort, math.inf)
        rates = {name: value for name, (value, *others) in properties.rates.items() if not others}
        if position or math.isfinite(velocity) or math.isfinite(effort) or rates:
            add_limit(element, position, effort, velocity, rates)
        add_dynamics(element, first(properties.damping, 0.0), first(properties.friction, 0.0))

    def add_part(self, joint: Joint, names: Sequence[str], steps: Sequence[ExportedJoint]) -> None:
        """Add the joint: Pinocchio's q has cosine and sine of the angle of a continuous or planar joint."""
        if joint.mimic is not None:
            return
        own = [(name, step) for name, step in zip(names, steps, strict=True) if not step.lead]
        circular = [number for number, (_, step) in enumerate(own) if self.type(joint, step) == JointType.CONTINUOUS]
        if joint.type is JointType.PLANAR:
            circular = [2]
        ratios = ((step.velocities[0], 1.0, 0.0) for _, step in own)
        rotation = "xyz" if joint.type is JointType.SPHERICAL else "quaternion"
        part = part_of(joint, [name for name, _ in own], ratios, rotation=rotation)
        self.parts.append(replace(part, circular=tuple(circular)))

    @property
    def coordinates(self) -> Coordinates:
        """From the vectors of the robot to those of Pinocchio's model of the file, with its mimic joints."""
        rank = {name: number for number, name in enumerate(self._depth_first())}
        parts = sorted(self.parts, key=lambda part: -1 if part.joint == ROOT_JOINT else rank[part.names[0]])
        return Coordinates(tuple(parts), self._given.own, "xyzw", at_rest=False)

    def _depth_first(self) -> Iterator[str]:
        """Names of the joints in the order of Pinocchio: depth first, those of one link by their names."""
        leaving: dict[str, list[tuple[str, str]]] = {}
        for joint in self.root.findall("joint"):
            name, parent, child = (str(joint.xpath(f"string({at})")) for at in ("@name", "parent/@link", "child/@link"))
            leaving.setdefault(parent, []).append((name, child))
        found = sorted(leaving.get(self.links[self.mechanism.bodies[0].name], ()), reverse=True)
        while found:
            name, child = found.pop()
            yield name
            found += sorted(leaving.get(child, ()), reverse=True)


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the plain URDF of a robot: ``robot.urdf``, and its meshes in ``meshes/``."""
    tree = PlainTree(given, losses)
    tree.write()
    return tree.output()


FORMAT = Format(write, ROWS, EXACT)
