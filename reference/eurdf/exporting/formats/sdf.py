"""SDFormat, for Gazebo: the joints of closures have a child that has another parent already.

Facts of SDFormat that the file relies on (its specification, version 1.11): coordinates of joints are zero where the
links are placed; a joint's frame is fixed to its child, and axes are in that frame; links, joints and frames share one
set of names; ``screw_thread_pitch`` is in m per revolution, positive for right-handed threads; the position of a mimic
joint is multiplier · (leader - reference) + offset.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import mul

from lxml import etree

from eurdf.exporting.coordinates import Coordinates, Part
from eurdf.exporting.exceptions import CannotExport
from eurdf.exporting.inertia import accepted_inertia
from eurdf.exporting.mesh_file import MeshFiles
from eurdf.exporting.written import Exportable, Format, Written
from eurdf.loss import ACCELERATION, BEYOND_LIMITS, COMMON, NAMED_FILE, Effect, Losses, LossKind
from eurdf.mechanism.body import Anchor, Body, Inertia, Shape
from eurdf.mechanism.constraint import Closure, Coupling, HingeClosure, PointClosure
from eurdf.mechanism.joint import Joint, drivers
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3, direction
from eurdf.writing.angles import rpy_of
from eurdf.writing.names import UniqueNames
from eurdf.writing.xml_text import file_content

VERSION = "1.11"

#: kg and kg·m² that a link without inertia gets: physics engines refuse 0.
LEAST = 1e-9

#: Largest opening, m or rad, of a loop that counts as closed (EU-CLO-005).
CLOSED = 1e-6

#: Largest cosine of the axes of a universal joint that are perpendicular but for rounding.
_SKEW = 1e-9

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_WORLD = "world"
_BETWEEN = f"{LEAST:g} kg and kg·m² for each link between them in the mass matrix"

LOSSES = (
    LossKind(
        "export-planar-joint",
        "planar joint",
        Effect.APPROXIMATE,
        "becomes two prismatic joints and one that turns",
        "use Export.coordinates",
        error=_BETWEEN,
    ),
    LossKind(
        "export-floating-joint",
        "floating joint",
        Effect.APPROXIMATE,
        "becomes three prismatic joints and a ball joint",
        "use Export.coordinates",
        error=_BETWEEN,
    ),
    LossKind(
        "export-cylindrical-joint",
        "cylindrical joint",
        Effect.APPROXIMATE,
        "becomes a prismatic joint and one that turns",
        "use Export.coordinates",
        error=_BETWEEN,
    ),
    LossKind(
        "export-universal-joint",
        "universal joint",
        Effect.APPROXIMATE,
        "its axes are not perpendicular: becomes two joints",
        "use Export.coordinates",
        error=_BETWEEN,
        only="axes not perpendicular",
    ),
    LossKind(
        "export-zero",
        "configuration",
        Effect.EXACT,
        "is where the links are: coordinates of joints are zero there",
        "use Export.coordinates",
        only="the one where the links are",
    ),
    LossKind(
        "export-configurations",
        "configuration",
        Effect.DROPPED,
        "is left out: a file has one configuration, where its links are",
        "export with another --configuration, or keep the description beside the file",
        only="all but one",
    ),
    LossKind(
        "export-distance-dropped",
        "distance closure",
        Effect.DROPPED,
        "is left out: SDFormat has no such joint",
        "describe the rod as a link, with a joint at each end",
    ),
    LossKind(
        "export-coupling",
        "coupling",
        Effect.EXACT,
        "becomes the mimic of one joint by the other",
        "simulate with a physics engine that has mimic joints",
        only="two joints",
    ),
    LossKind(
        "export-coupling-dropped",
        "coupling",
        Effect.DROPPED,
        "is left out: SDFormat relates two joints, of which one has no other relation",
        "add a plugin that couples the joints",
        only="three joints or more, or joints that mimic",
    ),
    LossKind(
        "export-compliance", "compliance", Effect.DROPPED, "is left out", "set 'cfm' and 'erp' of the joint by hand"
    ),
    LossKind(
        "export-velocity-limit",
        "velocity limit",
        Effect.DROPPED,
        "is left out: a ball joint has none",
        "limit velocities in the controller",
        only="spherical and floating joints",
    ),
    LossKind(
        "export-effort-limit",
        "effort limit",
        Effect.DROPPED,
        "is left out: a ball joint has none",
        "limit efforts in the controller",
        only="spherical and floating joints",
    ),
    LossKind(
        "export-damping",
        "damping",
        Effect.DROPPED,
        "is left out: a ball joint has none",
        "add a plugin",
        only="spherical and floating joints",
    ),
    LossKind(
        "export-friction",
        "friction",
        Effect.DROPPED,
        "is left out: a ball joint has none",
        "add a plugin",
        only="spherical and floating joints",
    ),
    LossKind(
        "export-armature", "armature", Effect.DROPPED, "is left out", "add the inertia of the rotor to a link by hand"
    ),
    LossKind("export-gear-ratio", "gear ratio", Effect.DROPPED, "is left out", "multiply in the controller"),
    LossKind(
        "export-actuators",
        "actuator",
        Effect.DROPPED,
        "is left out: SDFormat has plugins",
        "add the plugin of a controller for the joint",
    ),
    LossKind(
        "export-control-range", "control range", Effect.DROPPED, "is left out", "limit controls in the controller"
    ),
    LossKind(
        "export-massless-link",
        "link without mass",
        Effect.APPROXIMATE,
        f"gets {LEAST:g} kg and kg·m²: physics engines refuse 0",
        "give the link its mass",
        error=f"{LEAST:g} kg and kg·m² in the mass matrix",
    ),
    LossKind(
        "export-inertia",
        "inertia",
        Effect.APPROXIMATE,
        "is not that of a body with volume, which SDFormat asks for: principal moments are raised",
        "correct the inertia in the URDF; `eurdf check` reports those that no body has",
        error="the message gives the change of a principal moment; none in mass and centre of mass",
        only="what no body has",
    ),
    LossKind("export-texture", "texture", Effect.DROPPED, "is left out; the color is kept", "add a material"),
    BEYOND_LIMITS,
    NAMED_FILE,
    ACCELERATION,
    *COMMON,
)


@dataclass(frozen=True, slots=True)
class _Axis:
    """An axis of a joint of the file.

    Attributes:
        xyz: In the frame of the joint.
        index: Index of the coordinate, and velocity, of the robot's joint that it has.
    """

    xyz: Vector3
    index: int


@dataclass(frozen=True, slots=True)
class _Step:
    """One joint of the file of those that a joint is.

    Attributes:
        suffix: What its name adds to that of the joint.
        type: Its type in the file.
        moved: How far it has moved at the configuration of the file.
        axes: Its axes.
    """

    suffix: str
    type: str
    moved: Pose
    axes: tuple[_Axis, ...] = ()


def write(given: Exportable) -> Written:
    """Write the SDFormat file of a robot: ``robot.sdf``, and its meshes in ``meshes/``.

    Raises:
        CannotExport: A link has a negative mass; or no closed configuration is known, at which the file has its links.
    """
    return _Writer(given).write()


class _Writer:
    """A file while it is written."""

    def __init__(self, given: Exportable) -> None:
        self.given, self.mechanism = given, given.mechanism
        self.losses = Losses(LOSSES)
        self.names = UniqueNames(self.losses, _WORLD)
        self.meshes = MeshFiles(given, self.losses)
        self.sdf = etree.Element("sdf", version=VERSION)
        self.model = etree.SubElement(self.sdf, "model", name=_allowed(self.mechanism.name) or "robot")
        self.zero = self._zero()
        #: Names of links, and poses at the configuration of the file in the world.
        self.links = {body.name: self._new(body.name) for body in self.mechanism.bodies}
        self.poses: dict[str, Pose] = {}
        #: By joint with axes, the last one: the axis of one that can mimic or be coupled.
        self.axes: dict[str, etree._Element] = {}
        self.joints: dict[str, str] = {}
        self.parts: list[Part] = []
        self.mimics = drivers({joint.name: joint.mimic for joint in self.mechanism.joints if joint.mimic is not None})

    def write(self) -> Written:
        mechanism = self.mechanism
        self._root(mechanism.bodies[0])
        for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
            self._joint(joint, body)
        for frame in mechanism.frames:
            element = _add(self.model, "frame", name=self._new(frame.name), attached_to=self.links[frame.body])
            _pose(element, frame.pose)
        for joint in mechanism.joints:
            if joint.mimic is not None:
                mimic = joint.mimic
                self._mimic(joint.name, mimic.joint, mimic.multiplier, mimic.offset)
        for closure in mechanism.closures:
            self._closure(closure)
        for coupling in mechanism.couplings:
            self._coupling(coupling)
        for name in mechanism.actuators:
            motor = mechanism.motor(name)
            self.losses.add("export-actuators", motor.name)
            if motor.control is not None:
                self.losses.add("export-control-range", motor.name)
        if mechanism.metadata or mechanism.own_data:
            self.losses.add("export-metadata", mechanism.name)
        files = {"robot.sdf": file_content(self.sdf), **self.meshes.files}
        return Written(files, self.losses.found, Coordinates(tuple(self.parts), self.given.own, "wxyz"))

    def _zero(self) -> Mapping[str, tuple[float, ...]]:
        """The configuration at which the links are placed.

        Zero, or the first one given if there are loops, or limits that exclude zero.
        """
        name = next(iter(self.given.configurations), "")
        ranges = (limits for joint in self.mechanism.joints for limits in joint.ranges)
        chosen = bool(self.mechanism.closures) or not all(lower <= 0.0 <= upper for lower, upper in ranges)
        for other in self.mechanism.configurations:
            if not (chosen and other == name):
                self.losses.add("export-configurations", other)
        if not chosen:
            return {}
        if not name:
            raise CannotExport(
                f"no closed configuration of '{self.mechanism.name}' was found; SDFormat closes loops where the links "
                "are placed: find one with `eurdf assemble`"
            )
        self.losses.add("export-zero", name)
        return self.given.configurations[name]

    def _coordinates(self, joint: Joint) -> tuple[float, ...]:
        mimic = self.mimics.get(joint.name)
        if mimic is None:
            return tuple(self.zero.get(joint.name, joint.type.neutral))
        (leader,) = self.zero.get(mimic.joint, (0.0,))
        return (mimic.multiplier * leader + mimic.offset,)

    def _new(self, name: str) -> str:
        """A name that no link, joint or frame has; ``::`` and names in double underscores are reserved."""
        allowed = _allowed(name)
        found = self.names.new(allowed)
        if found != name:
            self.losses.add("export-name", name, f"becomes '{found}'")
        return found

    # -- links ------------------------------------------------------------------------------------------------------

    def _root(self, body: Body) -> None:
        name = self.links[body.name]
        self.model.set("canonical_link", name)
        placed = IDENTITY
        if self.mechanism.root == "floating":
            x, y, z, *orientation = self.zero.get(ROOT_JOINT, JointType.FLOATING.neutral)
            qx, qy, qz, qw = orientation
            placed = Pose((x, y, z), (qx, qy, qz, qw))
            self.parts.append(Part((name,), ROOT_JOINT, JointType.FLOATING))
        self.poses[body.name] = placed
        self._link(body, _add(self.model, "link", name=name), "", placed)
        if self.mechanism.root == "fixed":
            joint = _add(self.model, "joint", name=self._new(f"{_WORLD}_{name}"), type="fixed")
            _add(joint, "parent").text = _WORLD
            _add(joint, "child").text = name

    def _link(self, body: Body, link: etree._Element, parent: str, placed: Pose) -> None:
        _pose(link, placed, parent)
        _inertial(link, accepted_inertia(body, self.losses, LEAST))
        for use, shapes in (("visual", body.visuals), ("collision", body.collisions)):
            for number, shape in enumerate(shapes):
                self._shape(link, use, f"{use}_{number}", shape)

    def _shape(self, link: etree._Element, use: str, name: str, shape: Shape) -> None:
        uri = None
        if shape.kind == "mesh":
            uri = self.meshes.path(shape.filename)
            if uri is None:
                return
        element = _add(link, use, name=name)
        _pose(element, shape.pose)
        geometry = _add(_add(element, "geometry"), shape.kind)
        size = shape.size
        match shape.kind:
            case "box":
                _add(geometry, "size").text = _text(size)
            case "cylinder" | "capsule":
                _add(geometry, "radius").text = _text(size[:1])
                _add(geometry, "length").text = _text(size[1:])
            case "sphere":
                _add(geometry, "radius").text = _text(size)
            case "mesh":
                _add(geometry, "uri").text = f"file://{uri}" if str(uri).startswith("/") else uri
                _add(geometry, "scale").text = _text(size)
        if shape.texture:
            self.losses.add("export-texture", shape.texture)
        if shape.color is not None and use == "visual":
            material = _add(element, "material")
            for light in ("ambient", "diffuse"):
                _add(material, light).text = _text(shape.color)

    # -- joints -----------------------------------------------------------------------------------------------------

    def _joint(self, joint: Joint, body: Body) -> None:
        at = self._coordinates(joint)
        steps = _steps(joint, at)
        if len(steps) > 1:
            self.losses.add(f"export-{joint.type}-joint", joint.name)
        self._report(joint)
        parent, placement, names = self.links[joint.parent], joint.placement, []
        for number, step in enumerate(steps):
            name = self._new(joint.name + step.suffix)
            last = number == len(steps) - 1
            child = self.links[body.name] if last else self._new(f"{name}_link")
            link = _add(self.model, "link", name=child)
            pose = placement * step.moved
            if last:
                self._link(body, link, parent, pose * joint.offset)
            else:
                _pose(link, pose, parent)
                _inertial(link, Inertia(LEAST, IDENTITY, (LEAST, 0.0, 0.0, LEAST, 0.0, LEAST)))
            element = _add(self.model, "joint", name=name, type=step.type)
            if last:
                _pose(element, joint.offset.inverse() if joint.offset is not IDENTITY else IDENTITY)
            _add(element, "parent").text = parent
            _add(element, "child").text = child
            if step.type == "screw":
                _add(element, "screw_thread_pitch").text = _text((joint.pitch,))
            for tag, axis in zip(("axis", "axis2"), step.axes, strict=False):
                stated = _add(element, tag)
                self._axis(joint, stated, axis, at[axis.index])
                self.axes[joint.name] = stated
            names.append(name)
            parent, placement = child, IDENTITY
        self.joints[joint.name] = names[0]
        self.poses[body.name] = self.poses[joint.parent] * joint.placement * joint.transform(at) * joint.offset
        if not joint.type.is_fixed:
            self.parts.append(self._part(joint, names, at))

    def _axis(self, joint: Joint, element: etree._Element, axis: _Axis, at: float) -> None:
        properties, i = joint.properties, axis.index
        _add(element, "xyz").text = _text(direction(axis.xyz))
        lower, upper = joint.ranges[i]
        limit = {
            name: value
            for name, value in (
                ("lower", lower - at),
                ("upper", upper - at),
                ("effort", properties.effort[i] if properties.effort else math.inf),
                ("velocity", properties.velocity[i] if properties.velocity else math.inf),
            )
            if math.isfinite(value)
        }
        if limit:
            limits = _add(element, "limit")
            for name, value in limit.items():
                _add(limits, name).text = _text((value,))
        dynamics = {
            name: values[i]
            for name, values in (("damping", properties.damping), ("friction", properties.friction))
            if values and values[i]
        }
        if properties.stiffness and properties.stiffness[i]:
            dynamics |= {"spring_reference": properties.rest[i] - at, "spring_stiffness": properties.stiffness[i]}
        if dynamics:
            losses = _add(element, "dynamics")
            for name, value in dynamics.items():
                _add(losses, name).text = _text((value,))

    def _report(self, joint: Joint) -> None:
        """Record what the joints of the file do not have."""
        properties = joint.properties
        if properties.rates:
            self.losses.add(ACCELERATION.code, joint.name)
        if any(properties.armature):
            self.losses.add("export-armature", joint.name)
        if any(ratio != 1.0 for ratio in properties.gear_ratio) or any(properties.rotor_inertia):
            self.losses.add("export-gear-ratio", self.mechanism.motor(joint.name).name)
        if joint.type not in (JointType.SPHERICAL, JointType.FLOATING):
            return
        turning = slice(0, 3) if joint.type is JointType.SPHERICAL else slice(3, 6)
        for code, values in (("velocity-limit", properties.velocity), ("effort-limit", properties.effort)):
            if any(map(math.isfinite, values[turning])):
                self.losses.add(f"export-{code}", joint.name)
        for code, values in (("damping", properties.damping), ("friction", properties.friction)):
            if any(values[turning]):
                self.losses.add(f"export-{code}", joint.name)

    def _part(self, joint: Joint, names: Sequence[str], at: tuple[float, ...]) -> Part:
        mimic = self.mimics.get(joint.name)
        if mimic is not None:
            ratio = (0, mimic.multiplier, mimic.offset - at[0])
            return Part(tuple(names), mimic.joint, joint.type, (ratio,), mimics=True)
        if joint.type in (JointType.PLANAR, JointType.SPHERICAL, JointType.FLOATING):
            zero = () if at == joint.type.neutral else at
            return Part(tuple(names), joint.name, joint.type, zero=zero, turn=joint.offset.quaternion)
        ratios = tuple((index, 1.0, -value) for index, value in enumerate(at))
        return Part(tuple(names), joint.name, joint.type, ratios)

    # -- relations --------------------------------------------------------------------------------------------------

    def _mimic(self, follower: str, leader: str, multiplier: float, offset: float) -> None:
        """State that follower = multiplier · leader + offset, in coordinates of the robot."""
        joints = {joint.name: joint for joint in self.mechanism.joints}
        (mine,), (its,) = (self._coordinates(joints[name]) for name in (follower, leader))
        mimic = _add(self.axes[follower], "mimic", joint=self.joints[leader])
        _add(mimic, "multiplier").text = _text((multiplier,))
        _add(mimic, "offset").text = _text((multiplier * its + offset - mine,))
        _add(mimic, "reference").text = "0"

    def _coupling(self, coupling: Coupling) -> None:
        if len(coupling.coefficients) == 2:
            for (follower, c), (leader, d) in (coupling.coefficients, coupling.coefficients[::-1]):
                if self.axes[follower].find("mimic") is None:
                    self._mimic(follower, leader, -d / c, coupling.offset / c)
                    self.losses.add("export-coupling", coupling.name)
                    return
        self.losses.add("export-coupling-dropped", coupling.name)

    def _closure(self, closure: Closure) -> None:
        if closure.compliance.linear or closure.compliance.angular:
            self.losses.add("export-compliance", closure.name)
        if closure.type not in _CLOSURES:
            self.losses.add("export-distance-dropped", closure.name)
            return
        self._must_be_closed(closure)
        joint = _add(self.model, "joint", name=self._new(closure.name), type=_CLOSURES[closure.type])
        _pose(joint, closure.b.pose)
        for tag, end in (("parent", closure.a), ("child", closure.b)):
            _add(joint, tag).text = self.links[end.body]
        if isinstance(closure, HingeClosure):
            _add(_add(joint, "axis"), "xyz").text = _text(direction(closure.axes[1]))
        engine = _add(_add(joint, "physics"), "simbody")
        _add(engine, "must_be_loop_joint").text = "true"

    def _must_be_closed(self, closure: Closure) -> None:
        a, b = (self._in_world(end) for end in closure.anchors)
        pairs: Iterable[tuple[Vector3, Vector3]] = ()
        if isinstance(closure, HingeClosure):
            pairs = [(a.rotate(direction(closure.axes[0])), b.rotate(direction(closure.axes[1])))]
        elif not isinstance(closure, PointClosure):
            pairs = [(a.rotate(axis), b.rotate(axis)) for axis in (_X, _Y, _Z)]
        opening = max(math.dist(a.xyz, b.xyz), *(math.dist(*pair) for pair in pairs), 0.0)
        if opening > 2.0 * CLOSED:
            raise CannotExport(
                f"closure '{closure.name}' is open by {opening:.1e} m or rad at the chosen configuration; SDFormat "
                "closes loops where the links are placed: choose a closed one"
            )

    def _in_world(self, anchor: Anchor) -> Pose:
        return self.poses[anchor.body] * anchor.pose


_CLOSURES = {"3d": "ball", "6d": "fixed", "hinge": "continuous"}


def _steps(joint: Joint, at: tuple[float, ...]) -> Sequence[_Step]:
    """The joints of the file, from the parent outwards, that a joint at some coordinates is."""

    def turn(suffix: str, axis: Vector3, index: int) -> _Step:
        kind = "revolute" if any(map(math.isfinite, joint.ranges[index])) else "continuous"
        return _Step(suffix, kind, _moved(JointType.REVOLUTE, axis, at[index]), (_Axis(axis, index),))

    def slide(suffix: str, axis: Vector3, index: int) -> _Step:
        return _Step(suffix, "prismatic", _moved(JointType.PRISMATIC, axis, at[index]), (_Axis(axis, index),))

    match joint.type:
        case JointType.FIXED:
            return [_Step("", "fixed", IDENTITY)]
        case JointType.REVOLUTE | JointType.CONTINUOUS:
            return [turn("", joint.axes[0], 0)]
        case JointType.PRISMATIC:
            return [slide("", joint.axes[0], 0)]
        case JointType.HELICAL:
            return [_Step("", "screw", joint.transform(at), (_Axis(joint.axes[0], 0),))]
        case JointType.CYLINDRICAL:
            return [slide("_slide", joint.axes[0], 0), turn("_turn", joint.axes[0], 1)]
        case JointType.UNIVERSAL:
            first, second = map(direction, joint.axes)
            if abs(sum(map(mul, first, second))) > _SKEW:
                return [turn("_1", first, 0), turn("_2", second, 1)]
            # The frame of the joint is fixed to the child: the second turn has moved the first axis there.
            seen = _moved(JointType.REVOLUTE, second, -at[1]).rotate(first)
            return [_Step("", "universal", joint.transform(at), (_Axis(seen, 0), _Axis(second, 1)))]
        case JointType.PLANAR:
            return [slide("_x", _X, 0), slide("_y", _Y, 1), turn("_angle", _Z, 2)]
        case JointType.SPHERICAL:
            return [_Step("", "ball", joint.transform(at))]
    slides = [slide(suffix, axis, i) for i, (suffix, axis) in enumerate((("_x", _X), ("_y", _Y), ("_z", _Z)))]
    ball = replace(joint.transform(at), xyz=(0.0, 0.0, 0.0))
    return [*slides, _Step("_ball", "ball", ball)]


def _moved(kind: JointType, axis: Vector3, value: float) -> Pose:
    return Joint("", kind, "", "", axes=(axis,)).transform((value,))


def _inertial(link: etree._Element, inertia: Inertia) -> None:
    element = _add(link, "inertial")
    _add(element, "mass").text = _text((inertia.mass,))
    _pose(element, inertia.pose)
    moments = _add(element, "inertia")
    for name, value in zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), inertia.moments, strict=True):
        _add(moments, name).text = _text((value,))


def _pose(element: etree._Element, pose: Pose, relative_to: str = "") -> None:
    if pose == IDENTITY and not relative_to:
        return
    attributes = {"relative_to": relative_to} if relative_to else {}
    _add(element, "pose", **attributes).text = _text((*pose.xyz, *rpy_of(pose)))


def _add(parent: etree._Element, tag: str, **attributes: str) -> etree._Element:
    return etree.SubElement(parent, tag, attributes)


def _text(values: Sequence[float]) -> str:
    """Numbers that are read back to the last bit; the schema asks for a point before an exponent.

    A number below the normal ones, 2.2e-308, is written as 0: libsdformat refuses it.
    """
    return " ".join(_number(value if abs(value) >= sys.float_info.min else 0.0) for value in values)


def _number(value: float) -> str:
    text = repr(float(value) + 0.0).removesuffix(".0")
    digits, e, exponent = text.partition("e")
    return f"{digits}.0e{exponent}" if e and "." not in digits else text


def _allowed(name: str) -> str:
    """The name, as SDFormat allows it: without ``::``, and not between double underscores."""
    allowed = name.replace("::", "__")
    return f"_{allowed}_" if allowed.startswith("__") and allowed.endswith("__") else allowed


FORMAT = Format("sdf", f"SDFormat {VERSION}, for Gazebo", write, LOSSES)
