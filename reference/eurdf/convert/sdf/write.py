"""SDFormat, for Gazebo: the joints of closures have a child that has another parent already.

Facts of SDFormat that the file relies on (its specification, version 1.11): coordinates of joints are zero where the
links are placed; a joint's frame is fixed to its child, and axes are in that frame; links, joints and frames share one
set of names; ``screw_thread_pitch`` is in m per revolution, positive for right-handed threads; the position of a mimic
joint is multiplier · (leader - reference) + offset.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence

from lxml import etree

from eurdf.closures import CLOSED
from eurdf.closures.hinge import HingeClosure
from eurdf.convert.conventions import LIGHT, opening_of
from eurdf.convert.coordinates import Coordinates, homogeneous
from eurdf.convert.export_format import ExportInput, ExportOutput, Format, coordinates_at
from eurdf.convert.inertia import accepted_inertia
from eurdf.convert.losses import Losses
from eurdf.convert.meshes import MeshFiles
from eurdf.convert.names import UniqueNames
from eurdf.convert.parts import Part, part_of
from eurdf.convert.sdf.facts import CLOSURES, EXACT, ROWS, VERSION
from eurdf.convert.steps import in_series, turn_type
from eurdf.errors import CannotExport
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import ROTARY, JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, root_joint
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3, direction
from eurdf.writing.xml_text import file_content, representable, rpy_of

_WORLD = "world"

#: The types of joint that are one of SDFormat, beside those of one axis.
_WHOLE = (JointType.SPHERICAL, JointType.HELICAL, JointType.UNIVERSAL)

#: Their names in SDFormat, where these are others.
_KINDS = {JointType.SPHERICAL: "ball", JointType.HELICAL: "screw"}


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the SDFormat file of a robot: ``robot.sdf``, and its meshes in ``meshes/``.

    Raises:
        CannotExport: A link has a negative mass; or no closed configuration is known, at which the file has its links.
    """
    return _SdfWriter(given, losses).write()


class _SdfWriter:
    """A file while it is written."""

    def __init__(self, given: ExportInput, losses: Losses) -> None:
        self.given, self.mechanism, self.losses = given, given.mechanism, losses
        self.names = UniqueNames(losses, _WORLD, representable=_allowed)
        self.meshes = MeshFiles(given, losses)
        self.sdf = etree.Element("sdf", version=VERSION)
        self.model = etree.SubElement(self.sdf, "model", name=_allowed(self.mechanism.name) or "robot")
        self.zero = self._zero()
        #: Names of links, and poses at the configuration of the file in the world.
        self.links = {body.name: self.names.new(body.name) for body in self.mechanism.bodies}
        self.poses: dict[str, Pose] = {}
        #: By joint with axes, the last one: the axis of one that can mimic or be coupled.
        self.axes: dict[str, etree._Element] = {}
        self.joints: dict[str, str] = {}
        self.parts: list[Part] = []
        self.mimics = given.mechanism.leaders

    def write(self) -> ExportOutput:
        mechanism = self.mechanism
        self._root(mechanism.bodies[0])
        for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
            self._joint(joint, body)
        for frame in mechanism.frames:
            element = _add(self.model, "frame", name=self.names.new(frame.name), attached_to=self.links[frame.body])
            _pose(element, frame.pose)
        for joint in mechanism.joints:
            if joint.mimic is not None:
                self._mimic(joint.name, joint.mimic)
        for closure in mechanism.closures:
            if closure.type in CLOSURES:
                self._closure(closure)
        for coupling in mechanism.couplings:
            self._coupling(coupling)
        files = {"robot.sdf": file_content(self.sdf), **self.meshes.files}
        return ExportOutput(files, Coordinates(tuple(self.parts), self.given.own, "wxyz"))

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
        return coordinates_at(self.zero, joint, self.mimics.get(joint.name))

    # -- links ------------------------------------------------------------------------------------------------------

    def _root(self, body: Body) -> None:
        name = self.links[body.name]
        self.model.set("canonical_link", name)
        placed = IDENTITY
        if self.mechanism.root == "floating":
            x, y, z, qx, qy, qz, qw = self.zero.get(ROOT_JOINT, root_joint("").type.neutral)
            placed = Pose((x, y, z), (qx, qy, qz, qw))
            self.parts.append(part_of(root_joint(""), (name,), ()))
        self.poses[body.name] = placed
        self._link(body, _add(self.model, "link", name=name), "", placed)
        if self.mechanism.root == "fixed":
            joint = _add(self.model, "joint", name=self.names.new(f"{_WORLD}_{name}"), type="fixed")
            _add(joint, "parent").text = _WORLD
            _add(joint, "child").text = name

    def _link(self, body: Body, link: etree._Element, parent: str, placed: Pose) -> None:
        _pose(link, placed, parent)
        _inertial(link, accepted_inertia(body, self.losses, LIGHT))
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
        if shape.color is not None and use == "visual":
            material = _add(element, "material")
            for light in ("ambient", "diffuse"):
                _add(material, light).text = _text(shape.color)

    # -- joints -----------------------------------------------------------------------------------------------------

    def _joint(self, joint: Joint, body: Body) -> None:
        at = self._coordinates(joint)
        parent, placement, names = self.links[joint.parent], joint.placement, []
        steps = in_series(joint, _WHOLE)
        for step in steps:
            name = self.names.new(step.joint.name)
            own = step.of(at)
            pose = placement * step.joint.transform(own)
            last = step is steps[-1]
            child = self.links[body.name] if last else self.names.new(f"{name}_link")
            link = _add(self.model, "link", name=child)
            if last:
                self._link(body, link, parent, pose * joint.offset)
            else:
                _pose(link, pose, parent)
                _inertial(link, Inertia(LIGHT, IDENTITY, (LIGHT, 0.0, 0.0, LIGHT, 0.0, LIGHT)))
            kind = step.joint.type
            if kind in ROTARY:
                kind = turn_type(step.joint)
            element = _add(self.model, "joint", name=name, type=_KINDS.get(kind, kind))
            if last:
                _pose(element, joint.offset.inverse() if joint.offset is not IDENTITY else IDENTITY)
            _add(element, "parent").text = parent
            _add(element, "child").text = child
            if kind is JointType.HELICAL:
                _numbers(element, {"screw_thread_pitch": joint.pitch})
            for index, (tag, axis) in enumerate(zip(("axis", "axis2"), _axes(step.joint, own), strict=False)):
                self.axes[joint.name] = stated = _add(element, tag)
                _add(stated, "xyz").text = _text(axis)
                _limits(stated, step.joint, index, own[index])
            names.append(name)
            parent, placement = child, IDENTITY
        self.joints[joint.name] = names[0]
        self.poses[body.name] = self.poses[joint.parent] * joint.placement * joint.transform(at) * joint.offset
        if joint.type.is_fixed:
            return
        if mimic := self.mimics.get(joint.name):
            mimic = mimic._replace(offset=mimic.offset - at[0])
        zero = () if at == joint.type.neutral else at
        ratios = ((index, 1.0, -value) for index, value in enumerate(at))
        self.parts.append(part_of(joint, names, ratios, mimic, zero=zero))

    # -- relations --------------------------------------------------------------------------------------------------

    def _mimic(self, follower: str, relation: Mimic) -> None:
        """State the relation of a joint to its leader, which is in coordinates of the robot."""
        joints = {joint.name: joint for joint in self.mechanism.joints}
        (mine,), (its,) = (self._coordinates(joints[name]) for name in (follower, relation.joint))
        mimic = _add(self.axes[follower], "mimic", joint=self.joints[relation.joint])
        offset = relation.multiplier * its + relation.offset - mine
        _numbers(mimic, {"multiplier": relation.multiplier, "offset": offset, "reference": 0.0})

    def _coupling(self, coupling: Coupling) -> None:
        if len(coupling.coefficients) == 2:
            for (follower, c), (leader, d) in (coupling.coefficients, coupling.coefficients[::-1]):
                if self.axes[follower].find("mimic") is None:
                    self._mimic(follower, Mimic(leader, -d / c, coupling.offset / c))
                    self.losses.add("export-coupling", coupling.name)
                    return
        self.losses.add("export-coupling-dropped", coupling.name)

    def _closure(self, closure: Closure) -> None:
        self._must_be_closed(closure)
        joint = _add(self.model, "joint", name=self.names.new(closure.name), type=CLOSURES[closure.type])
        _pose(joint, closure.b.pose)
        for tag, end in (("parent", closure.a), ("child", closure.b)):
            _add(joint, tag).text = self.links[end.body]
        if isinstance(closure, HingeClosure):
            _add(_add(joint, "axis"), "xyz").text = _text(direction(closure.axes[1]))
        engine = _add(_add(joint, "physics"), "simbody")
        _add(engine, "must_be_loop_joint").text = "true"

    def _must_be_closed(self, closure: Closure) -> None:
        a, b = (homogeneous(self.poses[end.body] * end.pose) for end in closure.anchors)
        opening = max(opening_of(closure, a, b))
        if opening > 2.0 * CLOSED:
            raise CannotExport(
                f"closure '{closure.name}' is open by {opening:.1e} m or rad at the chosen configuration; SDFormat "
                "closes loops where the links are placed: choose a closed one"
            )


def _axes(joint: Joint, at: Sequence[float]) -> list[Vector3]:
    """The axes of a joint of the file in its frame, which is fixed to the child, at its coordinates."""
    axes = [direction(axis) for axis in joint.axes]
    if joint.type is JointType.UNIVERSAL:  # the second turn has moved the first axis there
        second = Joint("", JointType.REVOLUTE, "", "", axes=(axes[1],))
        axes[0] = second.transform((-at[1],)).rotate(axes[0])
    return axes


def _limits(axis: etree._Element, joint: Joint, index: int, at: float) -> None:
    """State limits, losses and the spring of an axis, whose coordinate is zero at a value of that of the robot."""
    properties = joint.properties
    lower, upper = joint.ranges[index]
    limits = {"lower": lower - at, "upper": upper - at}
    limits |= {name: values[index] for name in ("effort", "velocity") if (values := getattr(properties, name))}
    if finite := {name: value for name, value in limits.items() if math.isfinite(value)}:
        _numbers(_add(axis, "limit"), finite)
    dynamics = {
        name: values[index]
        for name in ("damping", "friction")
        if (values := getattr(properties, name)) and values[index]
    }
    if properties.stiffness and properties.stiffness[index]:
        dynamics |= {"spring_reference": properties.rest[index] - at, "spring_stiffness": properties.stiffness[index]}
    if dynamics:
        _numbers(_add(axis, "dynamics"), dynamics)


def _inertial(link: etree._Element, inertia: Inertia) -> None:
    element = _add(link, "inertial")
    _numbers(element, {"mass": inertia.mass})
    _pose(element, inertia.pose)
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    _numbers(_add(element, "inertia"), dict(zip(names, inertia.moments, strict=True)))


def _pose(element: etree._Element, pose: Pose, relative_to: str = "") -> None:
    if pose == IDENTITY and not relative_to:
        return
    attributes = {"relative_to": relative_to} if relative_to else {}
    _add(element, "pose", **attributes).text = _text((*pose.xyz, *rpy_of(pose)))


def _add(parent: etree._Element, tag: str, **attributes: str) -> etree._Element:
    return etree.SubElement(parent, tag, attributes)


def _numbers(parent: etree._Element, values: Mapping[str, float]) -> None:
    """Add an element of each name with a number."""
    for name, value in values.items():
        _add(parent, name).text = _text((value,))


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
    """The name, as SDFormat allows it: without ``::``, and not between double underscores, which are reserved."""
    allowed = representable(name).replace("::", "__")
    return f"_{allowed}_" if allowed.startswith("__") and allowed.endswith("__") else allowed


FORMAT = Format(write, ROWS, EXACT)
