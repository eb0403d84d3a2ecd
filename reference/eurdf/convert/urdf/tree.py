"""The links and joints of a URDF, in plain URDF and in those of its extensions."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from lxml import etree

from eurdf.convert.export_format import ExportInput
from eurdf.convert.losses import Losses
from eurdf.convert.meshes import MeshFiles
from eurdf.convert.names import UniqueNames
from eurdf.convert.parts import Part
from eurdf.convert.steps import ExportedJoint, in_series
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Z
from eurdf.writing.urdf_elements import add_fixed_joint, add_inertial, add_joint, add_mimic, add_shape
from eurdf.writing.xml_text import representable


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
