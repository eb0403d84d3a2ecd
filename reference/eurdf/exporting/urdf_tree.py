"""The links and joints of a URDF, in plain URDF and in those of its extensions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from lxml import etree

from eurdf.exporting.coordinates import Coordinates, Part
from eurdf.exporting.mesh_file import MeshFiles
from eurdf.exporting.written import Exportable
from eurdf.loss import ACCELERATION, COMMON, NAMED_FILE, Effect, Losses, LossKind
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.mechanism.pose import IDENTITY, Vector3
from eurdf.writing.names import UniqueNames
from eurdf.writing.urdf_elements import (
    add_dynamics,
    add_inertial,
    add_joint,
    add_limit,
    add_mimic,
    add_shape,
    state_version,
)
from eurdf.writing.xml_text import representable

AXES: tuple[tuple[str, Vector3], ...] = (("_x", (1.0, 0.0, 0.0)), ("_y", (0.0, 1.0, 0.0)), ("_z", (0.0, 0.0, 1.0)))

#: Losses of every URDF.
URDF_LOSSES = (
    LossKind(
        "export-universal-joint",
        "universal joint",
        Effect.EXACT,
        "becomes two joints with a link without mass between them",
        "use Export.coordinates",
    ),
    LossKind(
        "export-cylindrical-joint",
        "cylindrical joint",
        Effect.EXACT,
        "becomes a prismatic joint and one that turns, with a link without mass between them",
        "use Export.coordinates",
    ),
    LossKind("export-spring", "spring", Effect.DROPPED, "is left out", "add the spring in the simulator"),
    LossKind(
        "export-configurations",
        "configuration",
        Effect.DROPPED,
        "is left out",
        "keep the description beside the URDF",
    ),
    LossKind(
        "export-compliance",
        "compliance",
        Effect.DROPPED,
        "is left out",
        "set the compliance of the loop in the simulator",
    ),
    LossKind("export-texture", "texture", Effect.DROPPED, "is left out; the color is kept", "add it to the URDF"),
    NAMED_FILE,
    *COMMON,
)

_ON_AXES = tuple(
    kind
    for concept, word in (
        ("velocity limit", "velocity"),
        ("effort limit", "effort"),
        ("damping", "damping"),
        ("friction", "friction"),
    )
    for kind in (
        LossKind(
            f"export-ball-{word}",
            concept,
            Effect.DROPPED,
            "is left out: the three joints that the joint becomes have none",
            "choose values for the three joints",
            only="spherical joints",
        ),
        LossKind(
            f"export-unequal-{word}",
            concept,
            Effect.APPROXIMATE,
            "the axes of the joint have different values: that of the first is written",
            "give the axes of the joint one value",
            error="difference of the values to that of the first axis",
            only="planar and floating joints with different values",
        ),
    )
)

#: Losses of a tree that has only the joint types of URDF.
PLAIN_LOSSES = (
    LossKind(
        "export-coupling-dropped",
        "coupling",
        Effect.DROPPED,
        "is left out: URDF has mimic joints alone",
        "where it relates two joints, let one of them mimic the other in the URDF",
    ),
    LossKind(
        "export-floating-root",
        "floating root",
        Effect.DROPPED,
        "is left out: in URDF, who reads the file decides",
        "load the URDF with a floating root",
    ),
    LossKind(
        "export-spherical-joint",
        "spherical joint",
        Effect.APPROXIMATE,
        "becomes three continuous joints about x, y and z",
        "keep the joint away from where its second angle is ±π/2, or export to a format with spherical joints",
        error="none in poses; angular velocities are singular where the second angle is ±π/2",
    ),
    LossKind(
        "export-helical-joint",
        "helical joint",
        Effect.EXACT,
        "becomes a joint that turns and a prismatic one that mimics it",
        "read the URDF with its mimic joints",
    ),
    LossKind(
        "export-armature",
        "armature",
        Effect.DROPPED,
        "is left out",
        "set the armature in the simulator",
    ),
    *_ON_AXES,
    replace(
        ACCELERATION,
        title="limits of acceleration, deceleration and jerk are left out: the three joints that it becomes have none",
        only="spherical joints",
    ),
    LossKind(
        "export-position-limit",
        "position limit",
        Effect.DROPPED,
        "is left out: planar and floating joints have none",
        "use prismatic and revolute joints",
        only="planar and floating joints",
    ),
    LossKind(
        "export-frame",
        "frame",
        Effect.EXACT,
        "becomes a link without mass on a fixed joint",
        "read the pose of the link",
    ),
    LossKind(
        "export-gear-ratio",
        "gear ratio",
        Effect.DROPPED,
        "is left out",
        "set the gear in the simulator",
    ),
    LossKind(
        "export-actuators", "actuator", Effect.DROPPED, "is left out", "name the actuated joints in the simulator"
    ),
    LossKind(
        "export-control-range",
        "control range",
        Effect.DROPPED,
        "is left out",
        "limit controls in the controller",
    ),
    *URDF_LOSSES,
)


@dataclass(frozen=True, slots=True)
class Step:
    """One joint of the file of those that a joint is.

    Attributes:
        suffix: What its name adds to that of the joint.
        type: The type of URDF that it has, or comes nearest to.
        axis: Its axis, if it has one.
        index: Index of the velocity of the joint that it has, if it has one.
        mimic: The leader that it mimics for the sake of the joint.
        tag: Tag of its element.
        type_name: Its type in an element with another tag.
    """

    suffix: str
    type: JointType
    axis: Vector3 | None
    index: int | None = None
    mimic: Mimic | None = None
    tag: str = "joint"
    type_name: str = ""


class UrdfTree:
    """The links and joints of a URDF while it is written.

    Attributes:
        root: The element of the robot.
        names: Names of links and joints that the robot does not have.
        links: Name of the link of each body.
        joints: Names of the joints of each joint.
        parts: The robot's joints in it.
    """

    def __init__(
        self, given: Exportable, losses: Losses, is_readable: Callable[[str, bytes], bool] | None = None
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
        """Write all links and joints, and record what every URDF loses."""
        mechanism, losses = self.mechanism, self.losses
        for body in mechanism.bodies:
            self._link(body)
        for joint in mechanism.joints:
            self._joint(joint)
        for closure in mechanism.closures:
            if closure.compliance.linear or closure.compliance.angular:
                losses.add("export-compliance", closure.name)
        for name in mechanism.configurations:
            losses.add("export-configurations", name)
        if mechanism.metadata or mechanism.own_data:
            losses.add("export-metadata", mechanism.name)

    # -- links ------------------------------------------------------------------------------------------------------

    def _link(self, body: Body) -> None:
        link = etree.SubElement(self.root, "link", name=self.links[body.name])
        inertia = self.inertia(body)
        if inertia is not None:
            add_inertial(link, inertia)
        for tag, shapes in (("visual", body.visuals), ("collision", body.collisions)):
            for shape in shapes:
                self._shape(link, tag, shape)

    def inertia(self, body: Body) -> Inertia | None:
        """The inertia that is written of a body."""
        return body.inertia

    def _shape(self, link: etree._Element, use: str, shape: Shape) -> None:
        name = shape.filename
        if shape.kind == "mesh":
            name = self.meshes.path(name) or name
        if shape.texture:
            self.losses.add("export-texture", shape.texture)
        add_shape(link, use, shape, name)

    # -- joints -----------------------------------------------------------------------------------------------------

    def steps(self, joint: Joint) -> Sequence[Step]:
        """The joints, from the parent outwards, that a joint is."""
        return plain_steps(joint)

    def part(self, joint: Joint, names: Sequence[str], steps: Sequence[Step]) -> Part:
        """The joint in the vectors of the model."""
        if joint.type is JointType.SPHERICAL:
            return Part(tuple(names), joint.name, joint.type, rotation="xyz")
        if joint.type in (JointType.PLANAR, JointType.FLOATING):
            return Part(tuple(names), joint.name, joint.type)
        own = [(name, step.index) for name, step in zip(names, steps, strict=True) if step.index is not None]
        ratios = tuple((index, 1.0, 0.0) for _, index in own)
        return Part(tuple(name for name, _ in own), joint.name, joint.type, ratios)

    def _joint(self, joint: Joint) -> None:
        steps = self.steps(joint)
        if len(steps) > 1:
            self.losses.add(f"export-{joint.type}-joint", joint.name)
        if any(joint.properties.stiffness):
            self.losses.add("export-spring", joint.name)
        parent, placement = self.links[joint.parent], joint.placement
        names = []
        for number, step in enumerate(steps):
            name = joint.name if not step.suffix else self.names.new(joint.name + step.suffix)
            last = number == len(steps) - 1 and joint.offset is IDENTITY
            child = self.links[joint.child] if last else self.names.new(f"{name}_link")
            if not last:
                etree.SubElement(self.root, "link", name=child)
            element = add_joint(self.root, name, step.type, parent, child, placement, step.axis)
            if step.tag != "joint":
                element.tag, element.attrib["type"] = step.tag, step.type_name
            self.add_properties(joint, step, element)
            mimic = step.mimic or (joint.mimic if len(steps) == 1 else None)
            if mimic is not None:
                add_mimic(element, mimic)
            names.append(name)
            parent, placement = child, IDENTITY
        if joint.offset is not IDENTITY:
            offset = joint.placement * joint.offset if joint.type.is_fixed else joint.offset
            name = joint.name if joint.type.is_fixed else self.names.new(f"{joint.name}_offset")
            add_joint(self.root, name, JointType.FIXED, parent, self.links[joint.child], offset, None)
        self.joints[joint.name] = tuple(names)
        if not joint.type.is_fixed:
            self.add_part(joint, names, steps)

    def add_part(self, joint: Joint, names: Sequence[str], steps: Sequence[Step]) -> None:
        """Add the joint to `parts`, unless it has no coordinates of its own."""
        if joint.mimic is None:
            self.parts.append(self.part(joint, names, steps))

    def add_properties(self, joint: Joint, step: Step, element: etree._Element) -> None:
        """Add limits and losses of one step of a joint."""
        properties = joint.properties
        at = step.index
        if at is None:
            if step.type is JointType.PRISMATIC:  # of a helical joint
                add_limit(element, (-math.inf, math.inf), math.inf, math.inf)
            if joint.type not in (JointType.PLANAR, JointType.FLOATING):
                return
            at = 0
        position = None
        if step.type in (JointType.REVOLUTE, JointType.PRISMATIC):
            position = joint.ranges[at]
        velocity = properties.velocity[at] if properties.velocity else math.inf
        effort = properties.effort[at] if properties.effort else math.inf
        rates = {name: values[at] for name, values in properties.rates.items() if math.isfinite(values[at])}
        if position or math.isfinite(velocity) or math.isfinite(effort) or rates:
            add_limit(element, position, effort, velocity, rates)
        damping = properties.damping[at] if properties.damping else 0.0
        friction = properties.friction[at] if properties.friction else 0.0
        add_dynamics(element, damping, friction)


class PlainTree(UrdfTree):
    """A tree that has only the joint types of URDF, with frames as links; its losses are `PLAIN_LOSSES`."""

    def write(self) -> None:
        """Write links, joints and frames, and record what plain URDF loses."""
        super().write()
        state_version(self.root)
        mechanism, losses = self.mechanism, self.losses
        for frame in mechanism.frames:
            name = self.names.new(frame.name)
            etree.SubElement(self.root, "link", name=name)
            fixed = self.names.new(f"{name}_fixed")
            add_joint(self.root, fixed, JointType.FIXED, self.links[frame.body], name, frame.pose, None)
            losses.add("export-frame", frame.name)
        for joint in mechanism.joints:
            self._report_axes(joint)
            if any(joint.properties.armature):
                losses.add("export-armature", joint.name)
            if any(ratio != 1.0 for ratio in joint.properties.gear_ratio) or any(joint.properties.rotor_inertia):
                losses.add("export-gear-ratio", mechanism.motor(joint.name).name)
        for name in mechanism.actuators:
            motor = mechanism.motor(name)
            losses.add("export-actuators", motor.name)
            if motor.control is not None:
                losses.add("export-control-range", motor.name)
        if mechanism.root == "floating":
            losses.add("export-floating-root", mechanism.bodies[0].name)
            # The coordinates are those of the URDF once it is loaded as the hint says.
            self.parts.insert(0, Part((ROOT_JOINT,), ROOT_JOINT, JointType.FLOATING))

    @cached_property
    def _leaders(self) -> frozenset[str]:
        """Names of the joints that others mimic."""
        return frozenset(joint.mimic.joint for joint in self.mechanism.joints if joint.mimic is not None)

    def steps(self, joint: Joint) -> Sequence[Step]:
        """The joints, from the parent outwards, that a joint is: without limits, a revolute one is continuous.

        Not where joints mimic: Pinocchio lets no revolute or prismatic joint mimic a continuous one.
        """
        if joint.type is not JointType.REVOLUTE or any(map(math.isfinite, joint.ranges[0])):
            return super().steps(joint)
        kind = joint.type if joint.mimic is not None or joint.name in self._leaders else JointType.CONTINUOUS
        return [Step("", kind, joint.axes[0], 0)]

    def _report_axes(self, joint: Joint) -> None:
        """Record what the axes of a joint with several of them lose."""
        properties = joint.properties
        if joint.type not in (JointType.SPHERICAL, JointType.PLANAR, JointType.FLOATING):
            return
        if any(math.isfinite(limit) for limits in joint.ranges for limit in limits):
            self.losses.add("export-position-limit", joint.name)
        if properties.rates:
            self.losses.add(ACCELERATION.code, joint.name)
        for word, values, none in (
            ("velocity", properties.velocity, math.inf),
            ("effort", properties.effort, math.inf),
            ("damping", properties.damping, 0.0),
            ("friction", properties.friction, 0.0),
        ):
            if joint.type is JointType.SPHERICAL:
                if any(value != none for value in values):
                    self.losses.add(f"export-ball-{word}", joint.name)
            elif len(set(values)) > 1:
                self.losses.add(f"export-unequal-{word}", joint.name)

    def part(self, joint: Joint, names: Sequence[str], steps: Sequence[Step]) -> Part:
        """The joint in the vectors of Pinocchio's model: q has cosine and sine of the angle of a continuous joint."""
        own = [step.type for step in steps if step.mimic is None]
        circular = [index for index, kind in enumerate(own) if kind is JointType.CONTINUOUS]
        if joint.type is JointType.PLANAR:
            circular = [2]
        return replace(super().part(joint, names, steps), circular=tuple(circular))

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


def plain_steps(joint: Joint) -> Sequence[Step]:
    """The joints of plain URDF, from the parent outwards, that a joint is."""

    def turning(index: int) -> JointType:
        return JointType.REVOLUTE if any(map(math.isfinite, joint.ranges[index])) else JointType.CONTINUOUS

    match joint.type:
        case JointType.FIXED:
            return [Step("", JointType.FIXED, None)] if joint.offset is IDENTITY else []
        case JointType.PLANAR:
            return [Step("", joint.type, AXES[2][1])]
        case JointType.FLOATING:
            return [Step("", joint.type, None)]
        case JointType.SPHERICAL:
            return [Step(suffix, JointType.CONTINUOUS, axis) for suffix, axis in AXES]
        case JointType.UNIVERSAL:
            return [Step(f"_{index + 1}", turning(index), joint.axes[index], index) for index in range(2)]
        case JointType.CYLINDRICAL:
            slide = Step("_slide", JointType.PRISMATIC, joint.axes[0], 0)
            return [slide, Step("_turn", turning(1), joint.axes[0], 1)]
        case JointType.HELICAL:
            advance = Mimic(joint.name, joint.pitch / (2.0 * math.pi))
            slide = Step("_slide", JointType.PRISMATIC, joint.axes[0], mimic=advance)
            # Not continuous: the slide counts full turns, and Pinocchio lets none mimic a joint of (cos, sin).
            return [Step("", JointType.REVOLUTE, joint.axes[0], 0), slide]
    return [Step("", joint.type, joint.axes[0], 0)]
