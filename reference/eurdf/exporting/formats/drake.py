"""URDF for Drake, with its own joint types and constraints.

Facts of Drake that the file relies on (documentation of its parser, and as run with Drake 1.51): a robot floats unless
it is joined to the link ``world``; joints come depth first, in the order of the file; ``ball`` has roll, pitch and yaw,
and its velocity is the angular velocity along the axes of the parent; ``planar``, ``screw`` and ``ball`` have no
limits; an actuator acts on a joint with one freedom; constraints need the SAP solver, in discrete time. An inertia that
no body has becomes that of a ball of water of its mass; one without mass, that of 1 kg of water.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from lxml import etree

from eurdf.exporting.coordinates import Coordinates, Part
from eurdf.exporting.inertia import accepted_inertia, has_inertia
from eurdf.exporting.urdf_tree import AXES, URDF_LOSSES, Step, UrdfTree, plain_steps
from eurdf.exporting.written import Exportable, Format, Written
from eurdf.loss import ACCELERATION, CONVERSION, Effect, Losses, LossKind
from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.constraint import Closure, Coupling, DistanceClosure, FrameClosure, HingeClosure, PointClosure
from eurdf.mechanism.joint import Joint, drivers
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.mechanism.pose import IDENTITY, Vector3, direction
from eurdf.writing.angles import rpy_of
from eurdf.writing.urdf_elements import add_dynamics, add_joint
from eurdf.writing.xml_text import file_content, numbers

_ORIGIN: Vector3 = (0.0, 0.0, 0.0)
_NAMESPACE = "http://drake.mit.edu"
_WORLD = "world"

#: Distance of the points that hold a frame or a hinge, m.
WIDTH = 0.1

#: Stiffness of a coupling, N/m or N·m/rad: Drake has no rigid ones of three joints, and softens what is stiffer than
#: its time step allows.
STIFFNESS = 1e12

#: kg and kg·m² that links without mass get where Drake needs some: far below any of a robot.
LEAST = 1e-13

_ONE_FREEDOM = (
    JointType.REVOLUTE,
    JointType.CONTINUOUS,
    JointType.PRISMATIC,
    JointType.HELICAL,
    JointType.UNIVERSAL,
    JointType.CYLINDRICAL,
)
_SAP = "less than 1e-3 m or rad in 1 s under gravity, on the robots of the tests; continuous time ignores it"

LOSSES = (
    LossKind(
        "export-spherical-joint",
        "spherical joint",
        Effect.APPROXIMATE,
        "becomes a 'ball', whose coordinates are roll, pitch and yaw",
        "keep the joint away from where its pitch is ±π/2, or choose its zero otherwise",
        error="none in poses and dynamics; rates of coordinates are singular where the pitch is ±π/2",
    ),
    LossKind(
        "export-floating-joint",
        "floating joint",
        Effect.APPROXIMATE,
        "becomes three prismatic joints and a 'ball', whose coordinates are roll, pitch and yaw",
        "keep the joint away from where its pitch is ±π/2, or choose its zero otherwise",
        error="none in poses and dynamics; rates of coordinates are singular where the pitch is ±π/2",
    ),
    LossKind(
        "export-mimic-joint",
        "mimic joint",
        Effect.APPROXIMATE,
        "becomes a free joint that a constraint couples to its leader",
        "simulate in discrete time, with the SAP solver",
        error=_SAP,
    ),
    LossKind(
        "export-soft-3d",
        "3d closure",
        Effect.APPROXIMATE,
        "becomes a 'drake:ball_constraint'",
        "simulate in discrete time, with the SAP solver",
        error=_SAP,
    ),
    LossKind(
        "export-soft-6d",
        "6d closure",
        Effect.APPROXIMATE,
        "becomes three 'drake:ball_constraint': 9 rows of rank 6",
        "replace them with MultibodyPlant.AddWeldConstraint, which a file cannot state",
        error=_SAP,
    ),
    LossKind(
        "export-hinge-closure",
        "hinge closure",
        Effect.APPROXIMATE,
        "becomes two 'drake:ball_constraint' on the axis: 6 rows of rank 5",
        "simulate in discrete time, with the SAP solver",
        error=_SAP,
    ),
    LossKind(
        "export-distance-closure",
        "distance closure",
        Effect.DROPPED,
        "is left out: Drake has no element for it",
        "call MultibodyPlant.AddDistanceConstraint with the points and the length of the message",
    ),
    LossKind(
        "export-soft-coupling",
        "coupling",
        Effect.APPROXIMATE,
        f"becomes a 'drake:tendon_constraint' of the stiffness {STIFFNESS:g}",
        "simulate in discrete time, with the SAP solver",
        error=_SAP,
    ),
    LossKind(
        "export-limits",
        "position limit",
        Effect.DROPPED,
        "limits of position and velocity are left out: Drake has none for this type of joint",
        "limit the motion in the controller",
        only="planar and helical joints",
    ),
    LossKind(
        "export-velocity-limit",
        "velocity limit",
        Effect.DROPPED,
        "is left out: Drake has none for this type of joint",
        "limit velocities in the controller",
        only="spherical, planar, floating and helical joints",
    ),
    replace(
        ACCELERATION,
        title="limits of acceleration, deceleration and jerk are left out: Drake has one for both directions of q̈",
        only="all but equal limits of acceleration and deceleration of joints with one axis",
    ),
    LossKind(
        "export-effort-limit",
        "effort limit",
        Effect.DROPPED,
        "is left out: in Drake, it is one of the actuator, which acts on a joint with one freedom",
        "limit efforts in the controller",
        only="spherical, planar and floating joints",
    ),
    LossKind(
        "export-unequal-damping",
        "damping",
        Effect.APPROXIMATE,
        "the axes of the joint have different values: their mean is written",
        "give the axes of the joint one value",
        error="difference of the values to their mean",
        only="spherical joints with different values",
    ),
    LossKind("export-friction", "friction", Effect.DROPPED, "is left out: Drake has none of joints", "model it apart"),
    LossKind(
        "export-armature",
        "armature",
        Effect.DROPPED,
        "is left out: in Drake, it is one of an actuator, which acts on a joint with one freedom",
        "make the joint an actuator, or add the inertia to its link",
        only="joints without an actuator",
    ),
    LossKind(
        "export-gear-ratio",
        "gear ratio",
        Effect.EXACT,
        "is written as 1, with the armature as rotor inertia: the armature is not gear ratio² · rotor inertia",
        "leave out the armature in the description",
        only="armature stated apart",
    ),
    LossKind(
        "export-actuator",
        "actuator",
        Effect.DROPPED,
        "is left out: in Drake, one acts on a joint with one freedom and an effort limit above 0",
        "apply the forces from a program",
        only="spherical, planar and floating joints, and limits of 0",
    ),
    LossKind(
        "export-control-range",
        "control range",
        Effect.DROPPED,
        "is left out: an actuator of Drake has the effort limit of its joint alone",
        "limit controls in the controller",
    ),
    LossKind(
        "export-massless-link",
        "link without mass",
        Effect.APPROXIMATE,
        f"gets {LEAST:g} kg and kg·m²: Drake replaces inertia without mass by 1 kg of water, and does not simulate a "
        "joint that moves no inertia, nor a mimic joint, which is free there, whose link has none",
        "give the link its mass",
        error=f"{LEAST:g} kg and kg·m² in the mass matrix",
        only="links with inertia, with a mimic joint, or with a joint that moves no inertia",
    ),
    LossKind(
        "export-inertia",
        "inertia",
        Effect.APPROXIMATE,
        "is not that of a body with volume, which Drake replaces by a ball of water: principal moments are raised",
        "correct the inertia in the URDF; `eurdf check` reports those that no body has",
        error="the message gives the change of a principal moment; none in mass and centre of mass",
        only="what no body has",
    ),
    *CONVERSION,
    *URDF_LOSSES,
)


def write(given: Exportable) -> Written:
    """Write the URDF of a robot for Drake: ``robot.urdf``, and its meshes in ``meshes/``.

    Raises:
        CannotExport: A link has a negative mass.
    """
    tree = _Tree(given, Losses(LOSSES))
    tree.write()
    files = {"robot.urdf": file_content(tree.root), **tree.meshes.files}
    return Written(files, tree.losses.found, Coordinates(tuple(tree.parts), given.own, "wxyz"))


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


class _Tree(UrdfTree):
    """A file while it is written."""

    def __init__(self, given: Exportable, losses: Losses) -> None:
        super().__init__(given, losses, lambda name, _: PurePosixPath(name).suffix in (".obj", ".gltf", ".vtk"))
        self.root = etree.Element("robot", name=self.root.get("name", ""), nsmap={"drake": _NAMESPACE})
        mechanism = self.mechanism
        self.base = mechanism.bodies[0].name
        if _WORLD in self.links and not (mechanism.root == "fixed" and self.base == _WORLD):
            self.links[_WORLD] = self.names.new(_WORLD)
        self.without_mass = _moved_without_mass(mechanism)
        self.mimics = drivers({joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None})

    def write(self) -> None:
        mechanism = self.mechanism
        base = self.links[self.base]
        if mechanism.root == "floating":
            self.parts.append(Part((base,), ROOT_JOINT, JointType.FLOATING, orientation_first=True))
        elif base != _WORLD:
            etree.SubElement(self.root, "link", name=_WORLD)
            add_joint(self.root, self.names.new(f"{_WORLD}_{base}"), JointType.FIXED, _WORLD, base, IDENTITY, None)
        super().write()
        for frame in mechanism.frames:
            pose = {"xyz": numbers(frame.pose.xyz), "rpy": numbers(rpy_of(frame.pose))}
            etree.SubElement(self.root, "frame", {"name": frame.name, "link": self.links[frame.body], **pose})
        for joint in mechanism.joints:
            self._motor(joint)
        for closure in mechanism.closures:
            self._closure(closure)
        for coupling in mechanism.couplings:
            self._coupling(coupling)

    def inertia(self, body: Body) -> Inertia | None:
        if has_inertia(body) or body.name in self.without_mass:
            return accepted_inertia(body, self.losses, LEAST)
        return body.inertia

    # -- joints -----------------------------------------------------------------------------------------------------

    def steps(self, joint: Joint) -> Sequence[Step]:
        match joint.type:
            case JointType.SPHERICAL:
                return [Step("", joint.type, None, tag=_tag("joint"), type_name="ball")]
            case JointType.PLANAR:
                return [Step("", joint.type, AXES[2][1], tag=_tag("joint"), type_name="planar")]
            case JointType.HELICAL if joint.pitch:
                return [Step("", joint.type, joint.axes[0], 0, tag=_tag("joint"), type_name="screw")]
            case JointType.HELICAL:
                return [Step("", JointType.CONTINUOUS, joint.axes[0], 0)]
            case JointType.FLOATING:
                slides = [Step(suffix, JointType.PRISMATIC, axis, i) for i, (suffix, axis) in enumerate(AXES)]
                return [*slides, Step("_ball", JointType.SPHERICAL, None, tag=_tag("joint"), type_name="ball")]
        return plain_steps(joint)

    def part(self, joint: Joint, names: Sequence[str], steps: Sequence[Step]) -> Part:
        if joint.type in (JointType.SPHERICAL, JointType.FLOATING):
            return Part(tuple(names), joint.name, joint.type, rotation="rpy")
        return super().part(joint, names, steps)

    def add_part(self, joint: Joint, names: Sequence[str], steps: Sequence[Step]) -> None:
        mimic = self.mimics.get(joint.name)
        if mimic is None:
            self.parts.append(self.part(joint, names, steps))
            return
        self.losses.add("export-mimic-joint", joint.name)
        ratio = (0, mimic.multiplier, mimic.offset)
        self.parts.append(Part(tuple(names), mimic.joint, joint.type, (ratio,), mimics=True))

    def add_properties(self, joint: Joint, step: Step, element: etree._Element) -> None:
        properties = joint.properties
        if joint.type.is_fixed:
            return
        if any(properties.friction):
            self.losses.add("export-friction", joint.name)
        if joint.type is JointType.SPHERICAL:
            self.losses.add("export-spherical-joint", joint.name)
        if step.type_name == "screw":
            etree.SubElement(element, _tag("screw_thread_pitch"), value=numbers((joint.pitch,)))
        own = _velocities(joint, step)
        limited = step.type in (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
        lower, upper = zip(*joint.ranges, strict=True)
        finite = {
            name: values[step.index]
            for name, values in (
                ("lower", lower),
                ("upper", upper),
                ("velocity", properties.velocity),
                ("effort", properties.effort),
            )
            if step.index is not None and step.index < len(values) and math.isfinite(values[step.index])
        }
        if not limited:
            if {"lower", "upper"} & finite.keys():
                self.losses.add("export-limits", joint.name)
            if any(math.isfinite(value) for value in properties.velocity):
                self.losses.add("export-velocity-limit", joint.name)
            finite = {name: value for name, value in finite.items() if name == "effort"}
        if not (limited or step.type_name == "screw") and any(math.isfinite(value) for value in properties.effort):
            self.losses.add("export-effort-limit", joint.name)
        rates = dict(properties.rates)
        if limited and step.index is not None and rates.get("acceleration") == rates.get("deceleration"):
            rates.pop("deceleration", None)
            accelerations = rates.pop("acceleration", ())
            finite |= {_tag("acceleration"): value for value in accelerations[step.index : step.index + 1]}
        if rates:
            self.losses.add(ACCELERATION.code, joint.name)
        if finite:
            attributes = {name: numbers((value,)) for name, value in finite.items()}
            etree.SubElement(element, "limit", attributes)
        damping = [properties.damping[index] for index in own] if properties.damping else []
        if step.type is JointType.PLANAR and any(damping):
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
        if joint.name not in mechanism.actuators:
            if any(armature):
                self.losses.add("export-armature", joint.name)
            return
        motor = mechanism.motor(joint.name)
        shown = motor.name
        if motor.control is not None:
            self.losses.add("export-control-range", shown)
        efforts = properties.effort or (math.inf,) * joint.type.nv
        if joint.type not in _ONE_FREEDOM or min(efforts) <= 0.0:
            self.losses.add("export-actuator", shown)
            if any(armature):
                self.losses.add("export-armature", joint.name)
            return
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
        match closure:
            case PointClosure():
                self._balls(closure, [(_ORIGIN, _ORIGIN)])
                self.losses.add("export-soft-3d", closure.name)
            case FrameClosure():
                points = [_ORIGIN, *(_scaled(WIDTH, axis) for _, axis in AXES[:2])]
                self._balls(closure, [(point, point) for point in points])
                self.losses.add("export-soft-6d", closure.name)
            case HingeClosure():
                one, other = (_scaled(WIDTH, direction(axis)) for axis in closure.axes)
                self._balls(closure, [(_ORIGIN, _ORIGIN), (one, other)])
                self.losses.add("export-hinge-closure", closure.name)
            case DistanceClosure():
                p, r = closure.a.pose.xyz, closure.b.pose.xyz
                bodies = f"body_A '{closure.a.body}', p_AP {list(p)}, body_B '{closure.b.body}', p_BQ {list(r)}"
                self.losses.add(
                    "export-distance-closure", closure.name, f"is left out: {bodies}, distance {closure.length}"
                )
                return
        a, b = (self.links[end.body] for end in closure.anchors)
        if a != b:
            # Links that a joint connects are apart already.
            group = etree.SubElement(self.root, _tag("collision_filter_group"), name=closure.name)
            for link in (a, b):
                etree.SubElement(group, _tag("member"), link=link)
            etree.SubElement(group, _tag("ignored_collision_filter_group"), name=closure.name)

    def _balls(self, closure: Closure, points: Iterable[tuple[Vector3, Vector3]]) -> None:
        for both in points:
            ball = etree.SubElement(self.root, _tag("ball_constraint"))
            for side, end in zip("AB", closure.anchors, strict=True):
                etree.SubElement(ball, _tag(f"ball_constraint_body_{side}"), name=self.links[end.body])
            for side, end, point in zip(("AP", "BQ"), closure.anchors, both, strict=True):
                etree.SubElement(ball, _tag(f"ball_constraint_p_{side}"), value=numbers(end.pose.act(point)))

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
        self.losses.add("export-soft-coupling", coupling.name)


def _velocities(joint: Joint, step: Step) -> Sequence[int]:
    """Indices of the velocities of a joint that a step has."""
    if step.index is not None:
        return (step.index,)
    return (3, 4, 5) if joint.type is JointType.FLOATING else (0, 1, 2)


def _scaled(length: float, unit: Vector3) -> Vector3:
    return length * unit[0], length * unit[1], length * unit[2]


FORMAT = Format("drake", "URDF with the joints and constraints of Drake", write, LOSSES)
