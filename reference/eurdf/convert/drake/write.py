"""URDF for Drake, with its own joint types and constraints.

Facts of Drake that the file relies on (documentation of its parser, and as run with Drake 1.51): a robot floats unless
it is joined to the link ``world``; joints come depth first, in the order of the file; ``ball`` has roll, pitch and yaw,
and its velocity is the angular velocity along the axes of the parent; ``planar``, ``screw`` and ``ball`` have no
limits; an actuator acts on a joint with one freedom; constraints need the SAP solver, in discrete time. An inertia that
no body has becomes that of a ball of water of its mass; one without mass, that of 1 kg of water.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePosixPath

from lxml import etree

from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.convert.conventions import LEAST, point_on
from eurdf.convert.coordinates import Coordinates
from eurdf.convert.drake.facts import CLOSURES, EXACT, ROWS, STIFFNESS, can_have_actuator, has_one_acceleration
from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.inertia import accepted_inertia, has_inertia
from eurdf.convert.losses import Losses
from eurdf.convert.parts import part_of
from eurdf.convert.steps import ExportedJoint
from eurdf.convert.urdf.write import UrdfTree
from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, root_joint
from eurdf.mechanism.pose import AXES, IDENTITY, ORIGIN, direction
from eurdf.writing.urdf_elements import add_dynamics, add_fixed_joint
from eurdf.writing.xml_text import file_content, numbers, rpy_of

_NAMESPACE = "http://drake.mit.edu"
_WORLD = "world"

#: The types of joint that URDF lacks, or Drake has in its own element.
_KINDS = {JointType.SPHERICAL: "ball", JointType.PLANAR: "planar", JointType.HELICAL: "screw"}


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the URDF of a robot for Drake: ``robot.urdf``, and its meshes in ``meshes/``.

    Raises:
        CannotExport: A link has a negative mass.
    """
    tree = _DrakeTree(given, losses)
    tree.write()
    files = {"robot.urdf": file_content(tree.root), **tree.meshes.files}
    return ExportOutput(files, Coordinates(tuple(tree.parts), given.own, "wxyz"))


def _moved_without_mass(mechanism: Mechanism) -> set[str]:
    """The links that need inertia: those that a joint moves with no inertia beyond it, or a mimic joint."""
    with_inertia = {body.name for body in mechanism.bodies if has_inertia(body)}
    found = set()
    for joint in reversed(mechanism.joints):  # from the leaves
        if joint.child in with_inertia:
            with_inertia.add(joint.parent)
        if joint.mimic is not None or (not joint.type.is_fixed and joint.child not in with_inertia):
            found.add(joint.child)
    return found


def _tag(name: str) -> str:
    return f"{{{_NAMESPACE}}}{name}"


class _DrakeTree(UrdfTree):
    """A file while it is written."""

    whole = tuple(_KINDS)

    def __init__(self, given: ExportInput, losses: Losses) -> None:
        super().__init__(given, losses, lambda name, _: PurePosixPath(name).suffix in (".obj", ".gltf", ".vtk"))
        self.root = etree.Element("robot", name=self.root.get("name", ""), nsmap={"drake": _NAMESPACE})
        mechanism = self.mechanism
        self.base = mechanism.bodies[0].name
        if _WORLD in self.links and not (mechanism.root == "fixed" and self.base == _WORLD):
            self.links[_WORLD] = self.names.new(_WORLD)
        self.without_mass = _moved_without_mass(mechanism)
        self.mimics = given.mechanism.leaders

    def write(self) -> None:
        mechanism = self.mechanism
        base = self.links[self.base]
        if mechanism.root == "floating":
            self.parts.append(part_of(root_joint(""), (base,), (), orientation_first=True))
        elif base != _WORLD:
            etree.SubElement(self.root, "link", name=_WORLD)
            add_fixed_joint(self.root, self.names.new(f"{_WORLD}_{base}"), _WORLD, base, IDENTITY)
        super().write()
        for frame in mechanism.frames:
            pose = {"xyz": numbers(frame.pose.xyz), "rpy": numbers(rpy_of(frame.pose))}
            etree.SubElement(self.root, "frame", {"name": frame.name, "link": self.links[frame.body], **pose})
        for joint in mechanism.joints:
            self._motor(joint)
        for closure in mechanism.closures:
            if closure.type in CLOSURES:
                self._closure(closure)
        for coupling in mechanism.couplings:
            self._coupling(coupling)

    def inertia(self, body: Body) -> Inertia | None:
        if has_inertia(body) or body.name in self.without_mass:
            return accepted_inertia(body, self.losses, LEAST)
        return body.inertia

    # -- joints -----------------------------------------------------------------------------------------------------

    def add_part(self, joint: Joint, names: Sequence[str], steps: Sequence[ExportedJoint]) -> None:
        ratios = ((step.velocities[0], 1.0, 0.0) for step in steps)
        rotation = "quaternion" if joint.type is JointType.PLANAR else "rpy"
        self.parts.append(part_of(joint, names, ratios, self.mimics.get(joint.name), rotation=rotation))

    def add_properties(self, joint: Joint, step: ExportedJoint, element: etree._Element) -> None:
        kind, properties = step.joint.type, step.joint.properties
        if kind in self.whole:
            element.tag, element.attrib["type"] = _tag("joint"), _KINDS[kind]
        if kind is JointType.HELICAL:
            etree.SubElement(element, _tag("screw_thread_pitch"), value=numbers((joint.pitch,)))
        limits: dict[str, Sequence[float]] = {}
        if kind.is_axial:
            limits = dict(zip(("lower", "upper"), zip(*step.joint.ranges, strict=True), strict=True))
            limits["velocity"] = properties.velocity
        if kind.nv == 1:
            limits["effort"] = properties.effort
        if kind.is_axial and has_one_acceleration(joint):
            limits[_tag("acceleration")] = properties.acceleration
        finite = {name: numbers(values) for name, values in limits.items() if any(map(math.isfinite, values))}
        if finite:
            etree.SubElement(element, "limit", finite)
        damping = properties.damping
        if kind is JointType.PLANAR and any(damping):
            etree.SubElement(element, "dynamics", damping=numbers(damping))
        elif damping:
            if len(set(damping)) > 1:
                shown = ", ".join(f"{value:g}" for value in damping)
                self.losses.add("export-unequal-damping", joint.name, f"damping {shown}: the mean is written")
            add_dynamics(element, math.fsum(damping) / len(damping), 0.0)

    def _motor(self, joint: Joint) -> None:
        """The actuators of a joint, which carry its armature."""
        properties, mechanism = joint.properties, self.mechanism
        armature = properties.armature
        if joint.name not in mechanism.actuators or not can_have_actuator(joint):
            if any(armature):
                self.losses.add("export-armature", joint.name)
            return
        shown = mechanism.motor(joint.name).name
        names = self.joints[joint.name]
        for index, name in enumerate(names):
            transmission = etree.SubElement(self.root, "transmission")
            etree.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
            etree.SubElement(transmission, "joint", name=name)
            actuator = etree.SubElement(
                transmission, "actuator", name=shown if len(names) == 1 else f"{shown}_{index + 1}"
            )
            inertia = armature[index] if armature else 0.0
            ratio = properties.gear_ratio[index] if properties.gear_ratio else 1.0
            rotor = properties.rotor_inertia[index] if properties.rotor_inertia else 0.0
            if ratio * ratio * rotor != inertia or ratio < 0.0:
                if ratio != 1.0 or rotor:
                    self.losses.add("export-gear-ratio", shown)
                ratio, rotor = 1.0, inertia
            etree.SubElement(actuator, _tag("rotor_inertia"), value=numbers((rotor,)))
            etree.SubElement(actuator, _tag("gear_ratio"), value=numbers((ratio,)))

    # -- constraints ------------------------------------------------------------------------------------------------

    def _closure(self, closure: Closure) -> None:
        points = [(ORIGIN, ORIGIN)]
        if isinstance(closure, HingeClosure):
            one, other = (point_on(direction(axis)) for axis in closure.axes)
            points.append((one, other))
        elif isinstance(closure, FrameClosure):
            points += [(point_on(axis), point_on(axis)) for axis in AXES[:2]]
        for both in points:
            ball = etree.SubElement(self.root, _tag("ball_constraint"))
            for side, end in zip("AB", closure.anchors, strict=True):
                etree.SubElement(ball, _tag(f"ball_constraint_body_{side}"), name=self.links[end.body])
            for side, end, point in zip(("AP", "BQ"), closure.anchors, both, strict=True):
                etree.SubElement(ball, _tag(f"ball_constraint_p_{side}"), value=numbers(end.pose.act(point)))
        a, b = (self.links[end.body] for end in closure.anchors)
        if a != b:
            # Links that a joint connects are apart already.
            group = etree.SubElement(self.root, _tag("collision_filter_group"), name=closure.name)
            for link in (a, b):
                etree.SubElement(group, _tag("member"), link=link)
            etree.SubElement(group, _tag("ignored_collision_filter_group"), name=closure.name)

    def _coupling(self, coupling: Coupling) -> None:
        tendon = etree.SubElement(self.root, _tag("tendon_constraint"))
        for joint, coefficient in coupling.coefficients:
            name = self.joints[joint][0]
            etree.SubElement(tendon, _tag("tendon_constraint_joint"), name=name, a=numbers((coefficient,)))
        for what, value in (
            ("offset", -coupling.offset),
            ("lower_limit", 0.0),
            ("upper_limit", 0.0),
            ("stiffness", STIFFNESS),
            ("damping", 0.0),
        ):
            etree.SubElement(tendon, _tag(f"tendon_constraint_{what}"), value=numbers((value,)))


FORMAT = Format(write, ROWS, EXACT)
