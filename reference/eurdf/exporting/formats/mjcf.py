"""MJCF, the format of MuJoCo.

Facts of MuJoCo that the file relies on (documentation, XML reference): angles are in radians by ``compiler/angle``;
quaternions are w x y z; joints of one body act in order; equalities of joints and tendons are relative to the reference
configuration, which is all zeros here; mass and principal moments of a moving body are at least 1e-15, and 1e-14 where
MuJoCo computes these moments from a full matrix; no moment exceeds the sum of the others, to the last bit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePosixPath

from lxml import etree

from eurdf.exporting.contacts import neighbours
from eurdf.exporting.coordinates import Coordinates, Part
from eurdf.exporting.exceptions import CannotExport
from eurdf.exporting.inertia import accepted_inertia, along_principal_axes, has_inertia
from eurdf.exporting.mesh_file import MeshFiles
from eurdf.exporting.servo import position_gain
from eurdf.exporting.written import Exportable, Format, Written
from eurdf.loss import ACCELERATION, BEYOND_LIMITS, COMMON, CONVERSION, NAMED_FILE, Effect, Losses, LossKind
from eurdf.mechanism.body import Body, Shape
from eurdf.mechanism.constraint import (
    Closure,
    Coupling,
    DistanceClosure,
    FrameClosure,
    HingeClosure,
    PointClosure,
)
from eurdf.mechanism.joint import Joint, Mimic, drivers
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3, direction
from eurdf.writing.names import UniqueNames
from eurdf.writing.xml_text import file_content, numbers, representable

#: kg and kg·m² that a moving body without inertia gets: ten times the larger of MuJoCo's bounds, and far below any of a
#: robot.
LEAST = 1e-13

#: Time step, s. The equalities below are as stiff as it allows: MuJoCo keeps their time constant at two steps or more.
TIMESTEP = 0.001

#: Where MuJoCo's solver stops. At its default, 1e-8, it leaves equalities of joints with little inertia unsolved: mimic
#: joints of links without mass open by 0.1 rad. It does as many iterations in other robots.
TOLERANCE = 1e-15

#: Time constant (s) and damping ratio, and impedances, of closures, couplings and mimic joints.
SOLREF, SOLIMP = (2.0 * TIMESTEP, 1.0), (0.9999, 0.9999, 0.001, 0.5, 2.0)

#: Distance of the two points that hold a hinge, m.
HINGE_WIDTH = 0.1

#: The bound of a side without limit, where the other side has one: rad or m.
_UNLIMITED = 1e10

# What the tests hold robots to that have these elements.
_OPENING = "less than 1e-3 m or rad in 2 s under gravity, on the robots of the tests"

# A shorter time step helps some robots alone: those whose loops pass singular poses open as much, or diverge.
_MEASURE = "run `eurdf export --verify`: it shows how far the loops open in 2 s and, above 5 mm, what to do"

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_WORLD = "world"

LOSSES = (
    LossKind(
        "export-fixed-joint",
        "fixed joint",
        Effect.EXACT,
        "its name is left out: its link becomes a body without a joint, or a site if it has no mass",
        "name the link in its place",
    ),
    LossKind(
        "export-helical-joint",
        "helical joint",
        Effect.APPROXIMATE,
        "becomes a slide and a hinge that a soft equality couples",
        "let the simulation start at a keyframe, which meets the equality",
        error=_OPENING,
    ),
    LossKind(
        "export-mimic-joint",
        "mimic joint",
        Effect.APPROXIMATE,
        "becomes a free joint that a soft equality couples to its leader",
        "let the simulation start at a keyframe, which meets the equality",
        error=_OPENING,
    ),
    LossKind(
        "export-soft-3d",
        "3d closure",
        Effect.APPROXIMATE,
        "becomes a 'connect', which is soft",
        _MEASURE,
        error=_OPENING,
    ),
    LossKind(
        "export-soft-6d",
        "6d closure",
        Effect.APPROXIMATE,
        "becomes a 'weld', which is soft",
        _MEASURE,
        error=_OPENING,
    ),
    LossKind(
        "export-hinge-closure",
        "hinge closure",
        Effect.APPROXIMATE,
        "becomes two 'connect' on the axis: 6 soft rows of rank 5",
        _MEASURE,
        error=_OPENING,
    ),
    LossKind(
        "export-distance-closure",
        "distance closure",
        Effect.APPROXIMATE,
        "becomes the soft equality of a spatial tendon",
        _MEASURE,
        error=_OPENING,
    ),
    LossKind(
        "export-soft-coupling",
        "coupling",
        Effect.APPROXIMATE,
        "becomes a soft equality of two joints, or of a fixed tendon of three or more",
        "let the simulation start at a keyframe, which meets the equality",
        error=_OPENING,
    ),
    LossKind(
        "export-compliance",
        "compliance",
        Effect.DROPPED,
        "is left out: MuJoCo relates the softness of an equality to the inertia that it holds",
        f"set solref of the equality to '-s -2√s', s = {1.0 - SOLIMP[1]:.0e} · w / compliance, where w is the sum of "
        "model.body_invweight0[:, 0] of the two bodies",
    ),
    LossKind(
        "export-velocity-limit",
        "velocity limit",
        Effect.DROPPED,
        "is left out: MuJoCo has no velocity limits of joints",
        "limit velocities in the controller",
    ),
    LossKind(
        "export-effort-limit",
        "effort limit",
        Effect.DROPPED,
        "is left out: MuJoCo has none for a ball joint, and none of 0",
        "limit efforts in the controller",
        only="spherical joints, and limits of 0",
    ),
    LossKind(
        "export-equal-limits",
        "position limit",
        Effect.APPROXIMATE,
        "both limits are equal, which MuJoCo refuses: becomes a soft equality",
        "make the joint 'fixed' in the description",
        error=_OPENING,
        only="equal limits that are not 0",
    ),
    *(
        LossKind(
            f"export-unequal-{concept}",
            concept,
            Effect.APPROXIMATE,
            "the axes of the joint have different values: their mean is written",
            "give the axes of the joint one value",
            error="difference of the values to their mean",
            only="axes with different values",
        )
        for concept in ("armature", "damping", "friction")
    ),
    LossKind(
        "export-turning-armature",
        "armature",
        Effect.APPROXIMATE,
        "acts along the axes of the joint at rest, not along those of the child: centrifugal terms differ",
        "leave out the armature of planar and floating joints",
        error="up to armature · (joint velocity)² in the force; none at rest",
        only="planar and floating joints",
    ),
    LossKind(
        "export-gear-ratio",
        "gear ratio",
        Effect.EXACT,
        "controls are on the side of the joint; the rotor is in the armature, gear ratio² · rotor inertia",
        "to control the motor side, multiply 'gear' and divide 'ctrlrange' by the gear ratio",
    ),
    LossKind(
        "export-force-axes",
        "actuator",
        Effect.APPROXIMATE,
        "acts along the axes of the joint at rest, not along those of the child",
        "turn the forces with Export.coordinates.rates",
        error="none at the joint's zero; elsewhere the force is turned by the joint's angle",
        only="planar and floating joints",
    ),
    LossKind(
        "export-position-gain",
        "actuator",
        Effect.APPROXIMATE,
        "the description has no gain",
        "set 'kp' and 'dampratio' of the actuator",
        error="gain and damping are this export's choice",
        only="--actuators position",
    ),
    LossKind(
        "export-no-actuator",
        "actuator",
        Effect.DROPPED,
        "is left out, as asked for",
        "export with actuators 'motor' or 'position'",
        sayable=True,
        only="--actuators none",
    ),
    LossKind(
        "export-massless-link",
        "link without mass",
        Effect.APPROXIMATE,
        f"moves without inertia, which MuJoCo refuses: gets {LEAST:g} kg and kg·m²",
        "give the link its mass or its joint an armature, or merge its joints into one of a type with several axes",
        error=f"{LEAST:g} kg and kg·m² in the mass matrix; the simulation diverges where three joints with such links "
        "between them have their axes in a plane",
        only="links that move",
    ),
    LossKind(
        "export-inertia",
        "inertia",
        Effect.APPROXIMATE,
        "is not that of a body with volume, which MuJoCo asks for: principal moments are raised",
        "correct the inertia in the URDF; `eurdf check` reports those that no body has",
        error="the message gives the change of a principal moment; none in mass and centre of mass",
        only="what no body has",
    ),
    LossKind(
        "export-texture",
        "texture",
        Effect.DROPPED,
        "is left out; the color is kept",
        "add a texture and a material to the file",
    ),
    BEYOND_LIMITS,
    LossKind(
        "export-no-configuration",
        "configuration",
        Effect.DROPPED,
        "no closed configuration was found, so there is no keyframe",
        "find one with `eurdf assemble`, and write it to the description as 'assembled'",
        sayable=True,
        only="none is closed",
    ),
    *CONVERSION,
    NAMED_FILE,
    ACCELERATION,
    *COMMON,
)


@dataclass(frozen=True, slots=True)
class _Piece:
    """A joint of MuJoCo: one of those, in order, that a joint of the mechanism is.

    Attributes:
        name: Its name.
        kind: ``hinge``, ``slide`` or ``ball``.
        axis: In the frame of the joint at rest; of a ball the z axis, without effect.
        velocities: Indices of the velocities of the joint that it has.
        coordinate: Index of the coordinate of the joint that it has, if it is an angle or a length.
    """

    name: str
    kind: str
    axis: Vector3
    velocities: tuple[int, ...]
    coordinate: int | None = None


def write(given: Exportable) -> Written:
    """Write the MJCF of a robot: ``robot.xml``, and its meshes in ``meshes/``.

    Raises:
        CannotExport: A link has a negative mass.
    """
    return _Writer(given).write()


class _Writer:
    """A file while it is written."""

    def __init__(self, given: Exportable) -> None:
        self.given, self.mechanism = given, given.mechanism
        self.losses = Losses(LOSSES)
        self.bodies = UniqueNames(self.losses, _WORLD)
        self.joints, self.sites, self.equalities, self.tendons, self.actuators = (
            UniqueNames(self.losses) for _ in range(5)
        )
        self.root = etree.Element("mujoco", model=representable(self.mechanism.name))
        self._head()
        self.asset = etree.SubElement(self.root, "asset")
        self.world = etree.SubElement(self.root, "worldbody")
        #: For each link, the element that has it, and its pose there.
        self.hosts: dict[str, tuple[etree._Element, Pose]] = {}
        #: The MuJoCo joints of each joint.
        self.pieces: dict[str, tuple[_Piece, ...]] = {}
        self.parts: list[Part] = []
        self.meshes = MeshFiles(given, self.losses, _is_readable)
        self.used_meshes: dict[tuple[str, tuple[float, ...]], str] = {}
        self.mimics = drivers(
            {
                joint.name: joint.mimic
                for joint in self.mechanism.joints
                if joint.mimic is not None and joint.type.is_axial
            }
        )

    def write(self) -> Written:
        mechanism = self.mechanism
        self._root_body(mechanism.bodies[0])
        for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
            self._body(joint, body)
        for frame in mechanism.frames:
            self._site(frame.body, frame.pose, frame.name)
        self._exclusions()
        tendon = etree.SubElement(self.root, "tendon")
        equality = etree.SubElement(self.root, "equality")
        for closure in mechanism.closures:
            self._closure(closure, tendon, equality)
        for coupling in mechanism.couplings:
            self._coupling(coupling, tendon, equality)
        for joint in mechanism.joints:
            self._joint_equalities(joint, equality)
        actuator = etree.SubElement(self.root, "actuator")
        for name in mechanism.actuators:
            self._actuator(name, actuator)
        coordinates = Coordinates(tuple(self.parts), self.given.own, "wxyz")
        keyframe = etree.SubElement(self.root, "keyframe")
        keys = UniqueNames(self.losses)
        for name, configuration in self.given.configurations.items():
            etree.SubElement(
                keyframe, "key", name=keys.new(name), qpos=numbers(coordinates.from_files(configuration).tolist())
            )
        if mechanism.constraints and not self.given.configurations:
            self.losses.add("export-no-configuration", "assembled")
        if mechanism.metadata or mechanism.own_data:
            self.losses.add("export-metadata", mechanism.name)
        for section in [each for each in self.root if len(each) == 0 and each.tag not in ("compiler", "option")]:
            self.root.remove(section)
        return Written({"robot.xml": file_content(self.root), **self.meshes.files}, self.losses.found, coordinates)

    def _head(self) -> None:
        etree.SubElement(
            self.root, "compiler", angle="radian", inertiafromgeom="false", autolimits="true", meshdir="meshes"
        )
        # The implicit integrators add the damping of servos after the constraints are solved, which opens the loops.
        option = {"timestep": numbers((TIMESTEP,)), "tolerance": numbers((TOLERANCE,)), "integrator": "Euler"}
        etree.SubElement(self.root, "option", option)
        default = etree.SubElement(self.root, "default")
        etree.SubElement(default, "equality", solref=numbers(SOLREF), solimp=numbers(SOLIMP))
        visual = etree.SubElement(default, "default", {"class": "visual"})
        etree.SubElement(visual, "geom", group="2", contype="0", conaffinity="0")
        collision = etree.SubElement(default, "default", {"class": "collision"})
        etree.SubElement(collision, "geom", group="3")

    # -- bodies and joints ------------------------------------------------------------------------------------------

    def _root_body(self, body: Body) -> None:
        if self.mechanism.root == "fixed":
            self._fixed(body, self.world, IDENTITY)
            return
        element = etree.SubElement(self.world, "body", name=self.bodies.new(body.name))
        name = self.joints.new(ROOT_JOINT)
        etree.SubElement(element, "freejoint", name=name)
        self.parts.append(Part((name,), ROOT_JOINT, JointType.FLOATING))
        self._inertial(body, element, LEAST)
        self._content(body, element, IDENTITY)

    def _body(self, joint: Joint, body: Body) -> None:
        host, pose = self.hosts[joint.parent]
        pose = pose * joint.placement
        if joint.type.is_fixed:
            self.losses.add("export-fixed-joint", joint.name)
            self._fixed(body, host, pose * joint.offset)
            return
        element = etree.SubElement(host, "body", {"name": self.bodies.new(body.name), **_placed(pose * joint.offset)})
        back = joint.offset.inverse()
        pieces = tuple(self._pieces(joint))
        self.pieces[joint.name] = pieces
        for piece in pieces:
            attributes = {"name": piece.name, "type": piece.kind}
            if joint.offset is not IDENTITY and any(back.xyz):
                attributes["pos"] = numbers(back.xyz)
            if piece.kind != "ball":
                attributes["axis"] = numbers(back.rotate(direction(piece.axis)))
            attributes |= self._properties(joint, piece)
            etree.SubElement(element, "joint", attributes)
        self.parts.append(self._part(joint, pieces))
        self._inertial(body, element, LEAST)
        self._content(body, element, IDENTITY)

    def _fixed(self, body: Body, host: etree._Element, pose: Pose) -> None:
        """A link that is fixed to its host: a body, or a site if it has no mass."""
        # Of what is below the world, Pinocchio reads one body alone: a base that carries several is a body.
        if not has_inertia(body) and not (host is self.world and self._branches > 1):
            self._content(body, host, pose)
            if not body.virtual:
                self._site(body.name, IDENTITY, body.name)
            return
        element = etree.SubElement(host, "body", {"name": self.bodies.new(body.name), **_placed(pose)})
        self._inertial(body, element, 0.0)
        self._content(body, element, IDENTITY)

    @cached_property
    def _branches(self) -> int:
        """Number of bodies on the base and on the links without mass that are fixed to it."""
        base, number = {self.mechanism.bodies[0].name}, 0
        for joint, body in zip(self.mechanism.joints, self.mechanism.bodies[1:], strict=True):
            if joint.parent in base:
                if joint.type.is_fixed and not has_inertia(body):
                    base.add(body.name)
                else:
                    number += 1
        return number

    def _content(self, body: Body, element: etree._Element, pose: Pose) -> None:
        """The shapes of a link, which is at a pose in the element."""
        self.hosts[body.name] = (element, pose)
        for shape in body.visuals:
            self._geom(body, shape, element, pose, "visual")
        for shape in body.collisions:
            self._geom(body, shape, element, pose, "collision")

    def _inertial(self, body: Body, element: etree._Element, least: float) -> None:
        """The inertia of a link; mass and principal moments are at least ``least``."""
        # From a full matrix, MuJoCo leaves out turns to the principal axes by less than 1e-6 rad.
        inertia = along_principal_axes(accepted_inertia(body, self.losses, least, least))
        xx, _, _, yy, _, zz = inertia.moments
        attributes = {"pos": numbers(inertia.pose.xyz), **_placed(Pose(quaternion=inertia.pose.quaternion))}
        attributes |= {"mass": numbers((inertia.mass,)), "diaginertia": numbers((xx, yy, zz))}
        etree.SubElement(element, "inertial", attributes)

    def _pieces(self, joint: Joint) -> Iterator[_Piece]:
        def new(suffix: str, kind: str, axis: Vector3, velocity: int | None) -> _Piece:
            name = self.joints.new(joint.name + suffix)
            return _Piece(name, kind, axis, () if velocity is None else (velocity,), velocity)

        match joint.type:
            case JointType.REVOLUTE | JointType.CONTINUOUS:
                yield new("", "hinge", joint.axes[0], 0)
            case JointType.PRISMATIC:
                yield new("", "slide", joint.axes[0], 0)
            case JointType.HELICAL:
                yield new("_slide", "slide", joint.axes[0], None)
                yield new("", "hinge", joint.axes[0], 0)
            case JointType.CYLINDRICAL:
                yield new("_slide", "slide", joint.axes[0], 0)
                yield new("_turn", "hinge", joint.axes[0], 1)
            case JointType.UNIVERSAL:
                yield new("_1", "hinge", joint.axes[0], 0)
                yield new("_2", "hinge", joint.axes[1], 1)
            case JointType.PLANAR:
                yield new("_x", "slide", _X, 0)
                yield new("_y", "slide", _Y, 1)
                yield new("_angle", "hinge", _Z, 2)
            case JointType.SPHERICAL:
                yield _Piece(self.joints.new(joint.name), "ball", _Z, (0, 1, 2))
            case JointType.FLOATING:
                for index, (suffix, axis) in enumerate((("_x", _X), ("_y", _Y), ("_z", _Z))):
                    yield new(suffix, "slide", axis, index)
                yield _Piece(self.joints.new(f"{joint.name}_ball"), "ball", _Z, (3, 4, 5))

    def _part(self, joint: Joint, pieces: Sequence[_Piece]) -> Part:
        names = tuple(piece.name for piece in pieces)
        mimic = self.mimics.get(joint.name)
        if mimic is not None:
            return Part(names, mimic.joint, joint.type, ((0, mimic.multiplier, mimic.offset),), mimics=True)
        if joint.type in (JointType.PLANAR, JointType.SPHERICAL, JointType.FLOATING):
            return Part(names, joint.name, joint.type, turn=joint.offset.quaternion)
        if joint.type is JointType.HELICAL:
            return Part(names, joint.name, joint.type, ((0, _advance(joint), 0.0), (0, 1.0, 0.0)))
        return Part(names, joint.name, joint.type, tuple((index, 1.0, 0.0) for index in range(len(pieces))))

    def _properties(self, joint: Joint, piece: _Piece) -> dict[str, str]:
        properties, found = joint.properties, {}
        if properties.rates:
            self.losses.add(ACCELERATION.code, joint.name)
        for attribute, values in (
            ("armature", properties.armature),
            ("damping", properties.damping),
            ("friction", properties.friction),
        ):
            mine = [values[index] for index in piece.velocities] if values else []
            together = [values[i] for i in _sharing(joint, piece)] if values else []
            if any(together):
                if len(set(together)) > 1:
                    shown = ", ".join(f"{value:g}" for value in together)
                    self.losses.add(
                        f"export-unequal-{attribute}", joint.name, f"{attribute} {shown}: the mean is written"
                    )
                    mine = together
                if attribute == "armature" and piece.kind == "slide" and len(together) > 1:
                    self.losses.add("export-turning-armature", joint.name)
                found["frictionloss" if attribute == "friction" else attribute] = numbers(
                    (math.fsum(mine) / len(mine),)
                )
        for index in piece.velocities:
            if properties.velocity and math.isfinite(properties.velocity[index]):
                self.losses.add("export-velocity-limit", joint.name, f"{properties.velocity[index]:g} is left out")
            effort = properties.effort[index] if properties.effort else math.inf
            if math.isfinite(effort):
                if piece.kind == "ball" or effort == 0.0:
                    if piece.kind == "ball" or joint.name in self.mechanism.actuators:
                        self.losses.add("export-effort-limit", joint.name)
                else:
                    found["actuatorfrcrange"] = numbers((-effort, effort))
        if piece.coordinate is None:
            return found
        if properties.stiffness and properties.stiffness[piece.coordinate]:
            found["stiffness"] = numbers((properties.stiffness[piece.coordinate],))
            found["springref"] = numbers((properties.rest[piece.coordinate],))
        lower, upper = joint.ranges[piece.coordinate]
        if (math.isfinite(lower) or math.isfinite(upper)) and lower < upper:
            found["range"] = numbers((max(lower, -_UNLIMITED), min(upper, _UNLIMITED)))
        return found

    # -- shapes and sites -------------------------------------------------------------------------------------------

    def _geom(self, body: Body, shape: Shape, element: etree._Element, pose: Pose, use: str) -> None:
        attributes = {"class": use, "type": shape.kind}
        size = shape.size
        match shape.kind:
            case "box":
                attributes["size"] = numbers([side / 2.0 for side in size])
            case "cylinder" | "capsule":
                attributes["size"] = numbers((size[0], size[1] / 2.0))
            case "sphere":
                attributes["size"] = numbers(size)
            case "mesh":
                name = self._mesh(shape)
                if name is None:
                    return
                attributes["mesh"] = name
        if shape.color is not None:
            attributes["rgba"] = numbers(shape.color)
        if shape.texture:
            self.losses.add("export-texture", shape.texture)
        etree.SubElement(element, "geom", attributes | _placed(pose * shape.pose))

    def _mesh(self, shape: Shape) -> str | None:
        key = shape.filename, shape.size
        if key in self.used_meshes:
            return self.used_meshes[key]
        file = self.meshes.path(shape.filename)
        if file is None:
            return None
        name = f"{representable(PurePosixPath(file).stem)}_{len(self.used_meshes)}"
        self.used_meshes[key] = name
        file = representable(file.removeprefix("meshes/"))
        # Links have inertias of their own. MuJoCo computes that of each mesh, too: only a shell needs no volume.
        etree.SubElement(self.asset, "mesh", name=name, file=file, scale=numbers(shape.size), inertia="shell")
        return name

    def _site(self, link: str, pose: Pose, name: str) -> str:
        """Add a site at a pose in a link; returns its name."""
        element, host = self.hosts[link]
        name = self.sites.new(name)
        etree.SubElement(element, "site", {"name": name, **_placed(host * pose)})
        return name

    def _exclusions(self) -> None:
        """No contacts of bodies that a closure joins, nor of a fixed base and what moves on it.

        MuJoCo itself excludes a body and its parent, unless the parent is fixed to the world.
        """
        hosts = {body: element.get("name", _WORLD) for body, (element, _) in self.hosts.items()}
        contact = etree.SubElement(self.root, "contact")
        for one, other in dict.fromkeys((hosts[a], hosts[b]) for a, b in neighbours(self.mechanism, LEAST)):
            etree.SubElement(contact, "exclude", body1=one, body2=other)

    # -- constraints ------------------------------------------------------------------------------------------------

    def _closure(self, closure: Closure, tendon: etree._Element, equality: etree._Element) -> None:
        linear, angular = closure.compliance.linear, closure.compliance.angular
        if linear or angular:
            values = f"{linear:g} m/N" + (f", {angular:g} rad/(N·m)" if angular else "")
            self.losses.add("export-compliance", closure.name, f"{values} is left out")
        name = self.equalities.new(closure.name)
        ends = closure.a, closure.b

        def sites(suffix: str = "", poses: tuple[Pose, Pose] = (IDENTITY, IDENTITY)) -> tuple[str, str]:
            a, b = (
                self._site(end.body, end.pose * pose, f"{closure.name}/{side}{suffix}")
                for end, pose, side in zip(ends, poses, "ab", strict=True)
            )
            return a, b

        match closure:
            case PointClosure():
                a, b = sites()
                etree.SubElement(equality, "connect", name=name, site1=a, site2=b)
                self.losses.add("export-soft-3d", closure.name)
            case FrameClosure():
                a, b = sites()
                etree.SubElement(equality, "weld", name=name, site1=a, site2=b)
                self.losses.add("export-soft-6d", closure.name)
            case HingeClosure():
                a, b = sites()
                etree.SubElement(equality, "connect", name=name, site1=a, site2=b)
                one, other = (Pose(_scaled(HINGE_WIDTH, direction(axis))) for axis in closure.axes)
                a, b = sites("_axis", (one, other))
                second = self.equalities.new(f"{closure.name}/axis")
                etree.SubElement(equality, "connect", name=second, site1=a, site2=b)
                self.losses.add("export-hinge-closure", closure.name)
            case DistanceClosure():
                a, b = sites()
                path = self.tendons.new(closure.name)
                spatial = etree.SubElement(tendon, "spatial", name=path)
                for site in (a, b):
                    etree.SubElement(spatial, "site", site=site)
                # The equality is relative to the length at the reference configuration.
                excess = closure.length - self._distance_at_rest(closure)
                etree.SubElement(equality, "tendon", name=name, tendon1=path, polycoef=numbers((excess, 0, 0, 0, 0)))
                self.losses.add("export-distance-closure", closure.name)
            case _:
                raise CannotExport(f"closure '{closure.name}' has the type {closure.type}, which MJCF does not have")

    def _distance_at_rest(self, closure: DistanceClosure) -> float:
        carried = {joint.child: joint for joint in self.mechanism.joints}

        def origin(body: str, pose: Pose) -> Vector3:
            while body in carried:
                joint = carried[body]
                pose, body = joint.placement * joint.offset * pose, joint.parent
            return pose.xyz

        return math.dist(*(origin(end.body, end.pose) for end in (closure.a, closure.b)))

    def _coupling(self, coupling: Coupling, tendon: etree._Element, equality: etree._Element) -> None:
        name = self.equalities.new(coupling.name)
        self.losses.add("export-soft-coupling", coupling.name)
        terms = [(self._scalar(joint), coefficient) for joint, coefficient in coupling.coefficients]
        (first, c), *others = terms
        if len(others) <= 1:
            ratio = -others[0][1] / c if others else 0.0
            more = {"joint2": others[0][0]} if others else {}
            polycoef = numbers((coupling.offset / c, ratio, 0, 0, 0))
            etree.SubElement(equality, "joint", {"name": name, "joint1": first, **more, "polycoef": polycoef})
            return
        fixed = self.tendons.new(coupling.name)
        element = etree.SubElement(tendon, "fixed", name=fixed)
        for joint, coefficient in terms:
            etree.SubElement(element, "joint", joint=joint, coef=numbers((coefficient,)))
        etree.SubElement(equality, "tendon", name=name, tendon1=fixed, polycoef=numbers((coupling.offset, 0, 0, 0, 0)))

    def _joint_equalities(self, joint: Joint, equality: etree._Element) -> None:
        """What holds between the MuJoCo joints of a joint, and those of its leader."""
        pieces = self.pieces.get(joint.name, ())
        if joint.type is JointType.HELICAL:
            slide, hinge = (piece.name for piece in pieces)
            self._equal(equality, slide, Mimic(hinge, _advance(joint)))
            self.losses.add("export-helical-joint", joint.name)
        mimic = self.mimics.get(joint.name)
        if mimic is not None:
            leader = self._scalar(mimic.joint)
            self._equal(equality, pieces[0].name, Mimic(leader, mimic.multiplier, mimic.offset))
            self.losses.add("export-mimic-joint", joint.name)
        for piece in pieces:
            if piece.coordinate is None:
                continue
            lower, upper = joint.ranges[piece.coordinate]
            if lower == upper:
                polycoef = numbers((lower, 0, 0, 0, 0))
                name = self.equalities.new(f"{piece.name}/locked")
                etree.SubElement(equality, "joint", name=name, joint1=piece.name, polycoef=polycoef)
                self.losses.add("export-equal-limits", joint.name)

    def _equal(self, equality: etree._Element, follower: str, mimic: Mimic) -> None:
        polycoef = numbers((mimic.offset, mimic.multiplier, 0, 0, 0))
        name = self.equalities.new(f"{follower}/mimic")
        etree.SubElement(equality, "joint", name=name, joint1=follower, joint2=mimic.joint, polycoef=polycoef)

    def _scalar(self, joint: str) -> str:
        """The MuJoCo joint with the one coordinate of a joint; the angle of a helical one."""
        return self.pieces[joint][-1].name

    # -- actuators --------------------------------------------------------------------------------------------------

    def _actuator(self, name: str, actuator: etree._Element) -> None:
        mechanism = self.mechanism
        motor = mechanism.motor(name)
        shown, control = motor.name, motor.control
        if self.given.actuators == "none":
            self.losses.add("export-no-actuator", shown)
            return
        (joint,) = (joint for joint in mechanism.joints if joint.name == name)
        if any(ratio != 1.0 for ratio in joint.properties.gear_ratio) or any(joint.properties.rotor_inertia):
            self.losses.add("export-gear-ratio", shown)
        if joint.type in (JointType.PLANAR, JointType.FLOATING):
            self.losses.add("export-force-axes", shown)
        count = joint.type.nv
        for piece in self.pieces[name]:
            for index in piece.velocities:
                attributes = {"name": self.actuators.new(shown if count == 1 else f"{shown}_{index + 1}")}
                attributes["joint"] = piece.name
                effort = joint.properties.effort[index] if joint.properties.effort else math.inf
                bounds = control or ((-effort, effort) if 0.0 < effort < math.inf else None)
                if piece.kind == "ball":
                    unit = Pose(quaternion=joint.offset.quaternion).inverse().rotate((_X, _Y, _Z)[index % 3])
                    attributes["gear"] = numbers((*unit, 0.0, 0.0, 0.0))
                if self.given.actuators == "motor" or piece.kind == "ball":
                    if bounds is not None and bounds[0] < bounds[1]:
                        attributes["ctrlrange"] = numbers(bounds)
                    etree.SubElement(actuator, "motor", attributes)
                    continue
                gain = position_gain(effort)
                attributes |= {"kp": numbers((gain,)), "dampratio": "1"}
                if bounds is not None and bounds[0] < bounds[1]:
                    attributes["forcerange"] = numbers(bounds)
                if "range" in self._properties(joint, piece):
                    attributes["inheritrange"] = "1"
                etree.SubElement(actuator, "position", attributes)
                self.losses.add("export-position-gain", shown, f"kp is {gain:g}, dampratio 1")


def _placed(pose: Pose) -> dict[str, str]:
    """The attributes of a pose; those at their default are left out."""
    attributes = {}
    if any(pose.xyz):
        attributes["pos"] = numbers(pose.xyz)
    x, y, z, w = pose.quaternion
    if (x, y, z) != (0.0, 0.0, 0.0):
        attributes["quat"] = numbers((w, x, y, z))
    return attributes


def _scaled(length: float, unit: Vector3) -> Vector3:
    return length * unit[0], length * unit[1], length * unit[2]


def _advance(joint: Joint) -> float:
    """Of a helical joint, m/rad."""
    return joint.pitch / (2.0 * math.pi)


def _sharing(joint: Joint, piece: _Piece) -> Iterable[int]:
    """The velocities of a joint that turn with the child, of which a piece has one: their numbers must be equal."""
    if joint.type is JointType.PLANAR and piece.velocities[0] < 2:
        return (0, 1)
    if joint.type is JointType.FLOATING and piece.velocities[0] < 3:
        return (0, 1, 2)
    return piece.velocities


def _is_readable(file: str, content: bytes) -> bool:
    """Whether MuJoCo reads a mesh: a binary STL has 80 bytes, the number of triangles, and 50 bytes of each."""
    suffix = PurePosixPath(file).suffix.lower()
    if suffix == ".stl":
        return len(content) >= 84 and len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")
    return suffix in (".obj", ".msh")


FORMAT = Format("mjcf", "MJCF, for MuJoCo and what reads its format", write, LOSSES)
