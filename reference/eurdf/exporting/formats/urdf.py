"""Plain URDF: the spanning tree, with the joint types and properties that URDF has."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from lxml import etree

from eurdf.exporting.coordinates import Coordinates, Part
from eurdf.exporting.mesh_file import mesh_names
from eurdf.exporting.written import Exportable, Format, Written
from eurdf.loss import COMMON, Effect, Losses, LossKind
from eurdf.mechanism.body import Body, Shape
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.mechanism.mimic import Mimic
from eurdf.mechanism.pose import IDENTITY, Vector3
from eurdf.writing.names import UniqueNames
from eurdf.writing.urdf_elements import add_dynamics, add_inertial, add_joint, add_limit, add_mimic, add_shape
from eurdf.writing.xml_text import file_content, representable

_AXES: tuple[tuple[str, Vector3], ...] = (("_x", (1.0, 0.0, 0.0)), ("_y", (0.0, 1.0, 0.0)), ("_z", (0.0, 0.0, 1.0)))


def _closure(kind: str) -> LossKind:
    return LossKind(
        f"export-{kind}-dropped",
        f"{kind} closure",
        Effect.DROPPED,
        "is left out: URDF has no loops",
        "keep the description beside the URDF, or export to a format with loops",
    )


LOSSES = (
    *(_closure(kind) for kind in ("3d", "6d", "hinge", "distance")),
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
        "becomes three continuous joints about x, y and z: singular where the second is at ±π/2, properties left out",
        "keep the joint away from there, or export to a format with spherical joints",
    ),
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
        "armature, gear and rotor are left out",
        "set the armature in the simulator",
    ),
    LossKind("export-spring", "spring", Effect.DROPPED, "is left out", "add the spring in the simulator"),
    LossKind(
        "export-actuators", "actuator", Effect.DROPPED, "is left out", "name the actuated joints in the simulator"
    ),
    LossKind(
        "export-unequal-properties",
        "effort limit",
        Effect.APPROXIMATE,
        "the axes of the joint have different values: those of the first are written",
        "give the axes of the joint one value",
    ),
    LossKind(
        "export-frame",
        "frame",
        Effect.EXACT,
        "becomes a link without mass on a fixed joint",
        "read the pose of the link",
    ),
    LossKind(
        "export-configurations",
        "configuration",
        Effect.DROPPED,
        "is left out",
        "keep the description beside the URDF",
    ),
    LossKind(
        "export-mesh-missing",
        "mesh",
        Effect.DROPPED,
        "its file was not found; its name is kept",
        "give the folder of its package, --package-dir or package_dirs=",
    ),
    LossKind("export-texture", "texture", Effect.DROPPED, "is left out; the color is kept", "add it to the URDF"),
    *COMMON,
)


@dataclass(frozen=True, slots=True)
class _Step:
    """One URDF joint of those that a joint is: its suffix, type, axis, and the velocity that it has."""

    suffix: str
    type: JointType
    axis: Vector3 | None
    index: int | None = None
    mimic: Mimic | None = None


def write(given: Exportable) -> Written:
    """Write the plain URDF of a robot: ``robot.urdf``, and its meshes in ``meshes/``."""
    return _Writer(given).write()


class _Writer:
    """A file while it is written."""

    def __init__(self, given: Exportable) -> None:
        self.given, self.mechanism = given, given.mechanism
        self.losses = Losses(LOSSES)
        self.root = etree.Element("robot", name=representable(self.mechanism.name))
        links, joints = (body.name for body in self.mechanism.bodies), (joint.name for joint in self.mechanism.joints)
        self.names = UniqueNames(self.losses, *links, *joints)
        self.contents, self.mesh_ids = mesh_names(given.meshes)
        self.copied: dict[str, bytes] = {}
        self.parts: list[Part] = []

    def write(self) -> Written:
        mechanism, losses = self.mechanism, self.losses
        for body in mechanism.bodies:
            self._link(body)
        for joint in mechanism.joints:
            self._joint(joint)
        for frame in mechanism.frames:
            name = self.names.new(frame.name)
            etree.SubElement(self.root, "link", name=name)
            fixed = self.names.new(f"{name}_fixed")
            add_joint(self.root, fixed, JointType.FIXED, frame.body, name, frame.pose, None)
            losses.add("export-frame", frame.name)
        for closure in mechanism.closures:
            losses.add(f"export-{closure.type}-dropped", closure.name)
        for coupling in mechanism.couplings:
            losses.add("export-coupling-dropped", coupling.name)
        if mechanism.root == "floating":
            losses.add("export-floating-root", mechanism.bodies[0].name)
            # The coordinates are those of the URDF once it is loaded as the hint says.
            self.parts.insert(0, Part((ROOT_JOINT,), ROOT_JOINT, JointType.FLOATING))
        for name in mechanism.actuators:
            losses.add("export-actuators", name)
        for name in mechanism.configurations:
            losses.add("export-configurations", name)
        if mechanism.metadata or mechanism.own_data:
            losses.add("export-metadata", mechanism.name)
        coordinates = Coordinates(tuple(self.parts), self.given.own, "xyzw", at_rest=False)
        return Written({"robot.urdf": file_content(self.root), **self.copied}, losses.found, coordinates)

    # -- links ------------------------------------------------------------------------------------------------------

    def _link(self, body: Body) -> None:
        link = etree.SubElement(self.root, "link", name=body.name)
        if body.inertia is not None:
            add_inertial(link, body.inertia)
        for tag, shapes in (("visual", body.visuals), ("collision", body.collisions)):
            for shape in shapes:
                self._shape(link, tag, shape)

    def _shape(self, link: etree._Element, use: str, shape: Shape) -> None:
        name = shape.filename
        if shape.kind == "mesh":
            if name in self.contents:
                name = f"meshes/{self.mesh_ids[name]}"
                self.copied[name] = self.contents[shape.filename]
            else:
                self.losses.add("export-mesh-missing", name)
        if shape.texture:
            self.losses.add("export-texture", shape.texture)
        add_shape(link, use, shape, name)

    # -- joints -----------------------------------------------------------------------------------------------------

    def _joint(self, joint: Joint) -> None:
        steps = _steps(joint)
        if joint.type not in (JointType.FIXED,) and (
            any(joint.properties.armature) or any(joint.properties.rotor_inertia)
        ):
            self.losses.add("export-armature", joint.name)
        if any(joint.properties.stiffness):
            self.losses.add("export-spring", joint.name)
        if len(steps) > 1:
            self.losses.add(f"export-{joint.type}-joint", joint.name)
        parent, placement = joint.parent, joint.placement
        names = []
        for number, step in enumerate(steps):
            name = joint.name if not step.suffix else self.names.new(joint.name + step.suffix)
            last = number == len(steps) - 1 and joint.offset is IDENTITY
            child = joint.child if last else self.names.new(f"{name}_link")
            if not last:
                etree.SubElement(self.root, "link", name=child)
            element = add_joint(self.root, name, step.type, parent, child, placement, step.axis)
            self._properties(joint, step, element)
            mimic = step.mimic or (joint.mimic if len(steps) == 1 else None)
            if mimic is not None:
                add_mimic(element, mimic)
            names.append(name)
            parent, placement = child, IDENTITY
        if joint.offset is not IDENTITY:
            offset = joint.placement * joint.offset if joint.type is JointType.FIXED else joint.offset
            at = joint.parent if joint.type is JointType.FIXED else parent
            name = joint.name if joint.type is JointType.FIXED else self.names.new(f"{joint.name}_offset")
            add_joint(self.root, name, JointType.FIXED, at, joint.child, offset, None)
        self._part(joint, steps, names)

    def _part(self, joint: Joint, steps: Sequence[_Step], names: Sequence[str]) -> None:
        if joint.mimic is not None or joint.type is JointType.FIXED:
            return
        if joint.type is JointType.SPHERICAL:
            self.parts.append(Part(tuple(names), joint.name, joint.type, angles=True))
        elif joint.type in (JointType.PLANAR, JointType.FLOATING):
            self.parts.append(Part(tuple(names), joint.name, joint.type))
        else:
            own = [(name, step.index) for name, step in zip(names, steps, strict=True) if step.index is not None]
            ratios = tuple((index, 1.0, 0.0) for _, index in own)
            self.parts.append(Part(tuple(name for name, _ in own), joint.name, joint.type, ratios))

    def _properties(self, joint: Joint, step: _Step, element: etree._Element) -> None:
        properties = joint.properties
        at = step.index
        if at is None:
            if step.type is JointType.PRISMATIC:  # of a helical joint
                add_limit(element, (-math.inf, math.inf), math.inf, math.inf)
            if joint.type not in (JointType.PLANAR, JointType.FLOATING):
                return
            at = 0
            several = (properties.velocity, properties.effort, properties.damping, properties.friction)
            if any(len(set(values)) > 1 for values in several):
                self.losses.add("export-unequal-properties", joint.name)
        position = None
        if step.type in (JointType.REVOLUTE, JointType.PRISMATIC):
            lower = properties.lower[at] if properties.lower else -math.inf
            upper = properties.upper[at] if properties.upper else math.inf
            position = lower, upper
        velocity = properties.velocity[at] if properties.velocity else math.inf
        effort = properties.effort[at] if properties.effort else math.inf
        if position or math.isfinite(velocity) or math.isfinite(effort):
            add_limit(element, position, effort, velocity)
        damping = properties.damping[at] if properties.damping else 0.0
        friction = properties.friction[at] if properties.friction else 0.0
        add_dynamics(element, damping, friction)


def _steps(joint: Joint) -> list[_Step]:
    """The URDF joints, from the parent outwards, that a joint is."""
    properties = joint.properties

    def turning(index: int) -> JointType:
        limited = properties.lower and math.isfinite(properties.lower[index]) and math.isfinite(properties.upper[index])
        return JointType.REVOLUTE if limited else JointType.CONTINUOUS

    match joint.type:
        case JointType.FIXED:
            return [_Step("", JointType.FIXED, None)] if joint.offset is IDENTITY else []
        case JointType.PLANAR:
            return [_Step("", joint.type, _AXES[2][1])]
        case JointType.FLOATING:
            return [_Step("", joint.type, None)]
        case JointType.SPHERICAL:
            return [_Step(suffix, JointType.CONTINUOUS, axis) for suffix, axis in _AXES]
        case JointType.UNIVERSAL:
            return [_Step(f"_{index + 1}", turning(index), joint.axes[index], index) for index in range(2)]
        case JointType.CYLINDRICAL:
            slide = _Step("_slide", JointType.PRISMATIC, joint.axes[0], 0)
            return [slide, _Step("_turn", turning(1), joint.axes[0], 1)]
        case JointType.HELICAL:
            advance = Mimic(joint.name, joint.pitch / (2.0 * math.pi))
            slide = _Step("_slide", JointType.PRISMATIC, joint.axes[0], mimic=advance)
            return [_Step("", turning(0), joint.axes[0], 0), slide]
    return [_Step("", joint.type, joint.axes[0], 0)]


FORMAT = Format("urdf", "the plain URDF of the spanning tree", write, LOSSES)
