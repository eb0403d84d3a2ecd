"""MJCF, the format of MuJoCo.

Facts of MuJoCo that the file relies on (documentation, XML reference): angles are in radians by ``compiler/angle``;
quaternions are w x y z; joints of one body act in order; equalities of joints and tendons are relative to the reference
configuration, which is all zeros here; mass and principal moments of a moving body are at least 1e-15, and 1e-14 where
MuJoCo computes these moments from a full matrix; no moment exceeds the sum of the others, to the last bit.
"""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import PurePosixPath

from lxml import etree

from eurdf.closures.hinge import HingeClosure
from eurdf.convert.conventions import LEAST, neighbours, point_on, position_gain
from eurdf.convert.coordinates import Coordinates
from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.inertia import accepted_inertia, along_principal_axes, has_inertia
from eurdf.convert.losses import Losses
from eurdf.convert.meshes import MeshFiles
from eurdf.convert.mjcf import ball_hinges, facts
from eurdf.convert.names import UniqueNames
from eurdf.convert.parts import Part, part_of
from eurdf.convert.steps import ExportedJoint, in_series
from eurdf.mechanism.body import Body, Shape
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import ROOT_JOINT, root_joint
from eurdf.mechanism.pose import AXES, IDENTITY, Pose, Vector3, direction
from eurdf.writing.xml_text import file_content, numbers, representable

_WORLD = "world"


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the MJCF of a robot: ``robot.xml``, and its meshes in ``meshes/``.

    Raises:
        CannotExport: A link has a negative mass, or the hinges of a ball are singular at the start.
    """
    return _MjcfWriter(given, losses).write()


class _MjcfWriter:
    """A file while it is written."""

    def __init__(self, given: ExportInput, losses: Losses) -> None:
        self.given, self.mechanism, self.losses = given, given.mechanism, losses
        self.bodies = UniqueNames(losses, _WORLD)
        self.joints, self.sites, self.equalities, self.tendons, self.actuators = (UniqueNames(losses) for _ in range(5))
        self.root = etree.Element("mujoco", model=representable(self.mechanism.name))
        self._head()
        self.asset, self.world, self.contact, self.tendon, self.equality, self.actuator, self.keyframe = (
            etree.SubElement(self.root, tag)
            for tag in ("asset", "worldbody", "contact", "tendon", "equality", "actuator", "keyframe")
        )
        #: For each link, the element that has it, and its pose there.
        self.hosts: dict[str, tuple[etree._Element, Pose]] = {}
        #: The MuJoCo joints of each joint, by their names.
        self.steps: dict[str, dict[str, ExportedJoint]] = {}
        self.parts: list[Part] = []
        self.meshes = MeshFiles(given, losses, facts.is_readable)
        self.used_meshes: dict[tuple[str, tuple[float, ...]], str] = {}
        self.mimics = given.mechanism.leaders
        self.whole = facts.WHOLE if given.joints == "stated" else ()

    def write(self) -> ExportOutput:
        mechanism = self.mechanism
        self._root_body(mechanism.bodies[0])
        for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
            self._body(joint, body)
        for frame in mechanism.frames:
            self._site(frame.body, frame.pose, frame.name)
        self._exclusions()
        for closure in mechanism.closures:
            if closure.type in facts.CLOSURES:
                self._closure(closure)
        for coupling in mechanism.couplings:
            self._coupling(coupling)
        for joint in mechanism.joints:
            self._joint_equalities(joint)
        named = {joint.name: joint for joint in mechanism.joints}
        for name in mechanism.actuators if self.given.actuators != "none" else ():
            self._actuator(named[name])
        coordinates = Coordinates(tuple(self.parts), self.given.own, "wxyz")
        keys = UniqueNames(self.losses)
        ball_hinges.check_start(coordinates, self.given.start)
        for name, configuration in self.given.configurations.items():
            qpos = numbers(coordinates.from_files(configuration).tolist())
            etree.SubElement(self.keyframe, "key", name=keys.new(name), qpos=qpos)
        for section in [each for each in self.root if len(each) == 0 and each.tag not in ("compiler", "option")]:
            self.root.remove(section)
        return ExportOutput({"robot.xml": file_content(self.root), **self.meshes.files}, coordinates)

    def _head(self) -> None:
        etree.SubElement(
            self.root, "compiler", angle="radian", inertiafromgeom="false", autolimits="true", meshdir="meshes"
        )
        # The implicit integrators add the damping of servos after the constraints are solved, which opens the loops.
        option = {
            "timestep": numbers((facts.TIMESTEP,)),
            "tolerance": numbers((facts.TOLERANCE,)),
            "integrator": "Euler",
        }
        etree.SubElement(self.root, "option", option)
        default = etree.SubElement(self.root, "default")
        etree.SubElement(default, "equality", solref=numbers(facts.SOLREF), solimp=numbers(facts.SOLIMP))
        visual = etree.SubElement(default, "default", {"class": "visual"})
        etree.SubElement(visual, "geom", group="2", contype="0", conaffinity="0")
        collision = etree.SubElement(default, "default", {"class": "collision"})
        etree.SubElement(collision, "geom", group="3")

    # -- bodies -----------------------------------------------------------------------------------------------------

    def _root_body(self, body: Body) -> None:
        if self.mechanism.root == "fixed":
            self._fixed(body, self.world, IDENTITY)
            return
        element = etree.SubElement(self.world, "body", name=self.bodies.new(body.name))
        name = self.joints.new(ROOT_JOINT)
        etree.SubElement(element, "freejoint", name=name)
        self.parts.append(part_of(root_joint(""), (name,), ()))
        self._content(body, element, LEAST)

    def _body(self, joint: Joint, body: Body) -> None:
        host, pose = self.hosts[joint.parent]
        pose = pose * joint.placement * joint.offset
        if joint.type.is_fixed:
            self._fixed(body, host, pose)
            return
        element = etree.SubElement(host, "body", {"name": self.bodies.new(body.name), **_placed(pose)})
        back = joint.offset.inverse()
        self.steps[joint.name] = found = {
            self.joints.new(step.joint.name): step for step in in_series(joint, self.whole, turns_have_properties=True)
        }
        if by_hinges := joint.type.quaternion is not None and not self.whole:
            ball_hinges.report(joint, self.given, self.losses)
        for name, step in found.items():
            attributes = {"name": name, "type": facts.KINDS[step.joint.type]}
            if joint.offset is not IDENTITY and any(back.xyz):
                attributes["pos"] = numbers(back.xyz)
            if step.joint.axes:
                attributes["axis"] = numbers(back.rotate(direction(step.joint.axes[0])))
            attributes |= self._properties(joint, step)
            etree.SubElement(element, "joint", attributes)
        ratios = ((step.velocities[0], step.lead or 1.0, 0.0) for step in found.values())
        mimic = self.mimics.get(joint.name)
        orientation = {"rotation": "xyz"} if by_hinges else {"turn": joint.offset.quaternion}
        self.parts.append(part_of(joint, tuple(found), ratios, mimic, **orientation))
        self._content(body, element, LEAST)

    def _fixed(self, body: Body, host: etree._Element, pose: Pose) -> None:
        """A link that is fixed to its host: a body, or a site if it has no mass."""
        # Of what is below the world, Pinocchio reads one body alone: a base that carries several is a body.
        if not has_inertia(body) and not (host is self.world and self._branches > 1):
            self._shapes(body, host, pose)
            if not body.virtual:
                self._site(body.name, IDENTITY, body.name)
            return
        element = etree.SubElement(host, "body", {"name": self.bodies.new(body.name), **_placed(pose)})
        self._content(body, element, 0.0)

    @cached_property
    def _branches(self) -> int:
        """Number of bodies on the base and on the links without mass that are fixed to it."""
        base, joints = {self.mechanism.bodies[0].name}, self.mechanism.joints
        for joint, body in zip(joints, self.mechanism.bodies[1:], strict=True):
            if joint.parent in base and joint.type.is_fixed and not has_inertia(body):
                base.add(body.name)
        return sum(joint.parent in base and joint.child not in base for joint in joints)

    def _content(self, body: Body, element: etree._Element, least: float) -> None:
        """Inertia and shapes of a link, which the element is; mass and principal moments are at least ``least``."""
        # From a full matrix, MuJoCo leaves out turns to the principal axes by less than 1e-6 rad.
        inertia = along_principal_axes(accepted_inertia(body, self.losses, least, least))
        xx, _, _, yy, _, zz = inertia.moments
        attributes = {"pos": numbers(inertia.pose.xyz), **_placed(Pose(quaternion=inertia.pose.quaternion))}
        attributes |= {"mass": numbers((inertia.mass,)), "diaginertia": numbers((xx, yy, zz))}
        etree.SubElement(element, "inertial", attributes)
        self._shapes(body, element, IDENTITY)

    # -- shapes and sites -------------------------------------------------------------------------------------------

    def _shapes(self, body: Body, element: etree._Element, pose: Pose) -> None:
        """The shapes of a link, which is at a pose in the element."""
        self.hosts[body.name] = (element, pose)
        for use, shapes in (("visual", body.visuals), ("collision", body.collisions)):
            for shape in shapes:
                self._geom(shape, element, pose, use)

    def _geom(self, shape: Shape, element: etree._Element, pose: Pose, use: str) -> None:
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
        for one, other in dict.fromkeys((hosts[a], hosts[b]) for a, b in neighbours(self.mechanism, LEAST)):
            etree.SubElement(self.contact, "exclude", body1=one, body2=other)

    # -- joints -----------------------------------------------------------------------------------------------------

    def _properties(self, joint: Joint, step: ExportedJoint) -> dict[str, str]:
        """The attributes of a MuJoCo joint, one of those that a joint is."""
        found = {}
        for attribute in ("armature", "damping", "friction"):
            every, mine = getattr(joint.properties, attribute), getattr(step.joint.properties, attribute)
            together = mine
            if joint.type.moving_frame and step.joint.type.slides:
                # These axes turn with the child, those of MuJoCo do not: the numbers must be equal.
                slides = (index for index, motion in enumerate(joint.type.steps) if motion.kind == "slide")
                together = tuple(every[index] for index in slides) if every else ()
            if any(together):
                if len(set(together)) > 1:
                    shown = ", ".join(f"{value:g}" for value in together)
                    message = f"{attribute} {shown}: the mean is written"
                    self.losses.add(f"export-unequal-{attribute}", joint.name, message)
                    mine = together
                mean = math.fsum(mine) / len(mine)
                found["frictionloss" if attribute == "friction" else attribute] = numbers((mean,))
        own = step.joint.properties
        for effort in filter(math.isfinite, own.effort):
            if not step.joint.axes or (effort == 0.0 and joint.name in self.mechanism.actuators):
                self.losses.add("export-effort-limit", joint.name)
            elif effort:
                found["actuatorfrcrange"] = numbers((-effort, effort))
        if not step.joint.axes or step.lead:
            return found
        if any(own.stiffness):
            found |= {"stiffness": numbers(own.stiffness), "springref": numbers(own.rest)}
        ((lower, upper),) = step.joint.ranges
        if (math.isfinite(lower) or math.isfinite(upper)) and lower < upper:
            found["range"] = numbers((max(lower, -facts.UNLIMITED), min(upper, facts.UNLIMITED)))
        return found

    def _scalar(self, joint: str) -> str:
        """The MuJoCo joint with the one coordinate of a joint; the angle of a helical one."""
        return list(self.steps[joint])[-1]

    def _joint_equalities(self, joint: Joint) -> None:
        """What holds between the MuJoCo joints of a joint, and those of its leader."""
        steps = self.steps.get(joint.name, {})
        for name, step in steps.items():
            if step.lead:
                self._joint_equality(f"{name}/mimic", (name, self._scalar(joint.name)), 0.0, step.lead)
        if mimic := self.mimics.get(joint.name):
            joints = self._scalar(joint.name), self._scalar(mimic.joint)
            self._joint_equality(f"{joints[0]}/mimic", joints, mimic.offset, mimic.multiplier)
        for name, step in steps.items():
            for lower, upper in step.joint.ranges:
                if lower == upper:
                    self._joint_equality(f"{name}/locked", (name,), lower, 0.0)

    def _joint_equality(self, name: str, joints: tuple[str, ...], offset: float, ratio: float) -> None:
        """Let a joint be at an offset, plus a ratio times another one if there is one."""
        attributes = {"name": self.equalities.new(name)}
        attributes |= {f"joint{number}": joint for number, joint in enumerate(joints, 1)}
        attributes["polycoef"] = numbers((offset, ratio, 0, 0, 0))
        etree.SubElement(self.equality, "joint", attributes)

    # -- constraints ------------------------------------------------------------------------------------------------

    def _closure(self, closure: Closure) -> None:
        name = self.equalities.new(closure.name)
        a, b = self._sites(closure)
        if "length" in closure.own:
            path = self.tendons.new(closure.name)
            spatial = etree.SubElement(self.tendon, "spatial", name=path)
            etree.SubElement(spatial, "site", site=a)
            etree.SubElement(spatial, "site", site=b)
            # The equality is relative to the length at the reference configuration.
            excess = closure.own["length"] - math.dist(*(self._origin(end.body, end.pose) for end in closure.anchors))
            self._tendon_equality(name, path, excess)
            return
        etree.SubElement(self.equality, facts.CLOSURES[closure.type], name=name, site1=a, site2=b)
        if isinstance(closure, HingeClosure):
            one, other = (Pose(point_on(direction(axis))) for axis in closure.axes)
            a, b = self._sites(closure, "_axis", (one, other))
            name = self.equalities.new(f"{closure.name}/axis")
            etree.SubElement(self.equality, facts.CLOSURES[closure.type], name=name, site1=a, site2=b)

    def _sites(
        self, closure: Closure, suffix: str = "", poses: tuple[Pose, Pose] = (IDENTITY, IDENTITY)
    ) -> tuple[str, str]:
        """Add sites at poses in the frames A and B of a closure; returns their names."""
        a, b = (
            self._site(end.body, end.pose * pose, f"{closure.name}/{side}{suffix}")
            for end, pose, side in zip(closure.anchors, poses, "ab", strict=True)
        )
        return a, b

    def _origin(self, body: str, pose: Pose) -> Vector3:
        """The origin of a pose in a body at the reference configuration."""
        carried = {joint.child: joint for joint in self.mechanism.joints}
        while body in carried:
            joint = carried[body]
            pose, body = joint.placement * joint.offset * pose, joint.parent
        return pose.xyz

    def _tendon_equality(self, name: str, tendon: str, offset: float) -> None:
        polycoef = numbers((offset, 0, 0, 0, 0))
        etree.SubElement(self.equality, "tendon", name=name, tendon1=tendon, polycoef=polycoef)

    def _coupling(self, coupling: Coupling) -> None:
        terms = [(self._scalar(joint), coefficient) for joint, coefficient in coupling.coefficients]
        (first, c), *others = terms
        if len(others) <= 1:
            ratio = -others[0][1] / c if others else 0.0
            joints = (first, *(joint for joint, _ in others))
            self._joint_equality(coupling.name, joints, coupling.offset / c, ratio)
            return
        name, fixed = self.equalities.new(coupling.name), self.tendons.new(coupling.name)
        element = etree.SubElement(self.tendon, "fixed", name=fixed)
        for joint, coefficient in terms:
            etree.SubElement(element, "joint", joint=joint, coef=numbers((coefficient,)))
        self._tendon_equality(name, fixed, coupling.offset)

    # -- actuators --------------------------------------------------------------------------------------------------

    def _actuator(self, joint: Joint) -> None:
        motor = self.mechanism.motor(joint.name)
        own = ((name, step, index) for name, step in self.steps[joint.name].items() for index in step.velocities)
        for name, step, index in own:
            if step.lead:
                continue
            shown = motor.name if joint.type.nv == 1 else f"{motor.name}_{index + 1}"
            attributes = {"name": self.actuators.new(shown), "joint": name}
            effort = joint.properties.effort[index] if joint.properties.effort else math.inf
            bounds = motor.control or ((-effort, effort) if 0.0 < effort < math.inf else None)
            is_ball = not step.joint.axes
            if is_ball:
                unit = Pose(quaternion=joint.offset.quaternion).inverse().rotate(AXES[index % 3])
                attributes["gear"] = numbers((*unit, 0.0, 0.0, 0.0))
            is_position = self.given.actuators == "position" and not is_ball
            if is_position:
                gain = position_gain(effort)
                attributes |= {"kp": numbers((gain,)), "dampratio": "1"}
                self.losses.add("export-position-gain", motor.name, f"kp is {gain:g}, dampratio 1")
            if bounds is not None and bounds[0] < bounds[1]:
                attributes["forcerange" if is_position else "ctrlrange"] = numbers(bounds)
            if is_position and "range" in self._properties(joint, step):
                attributes["inheritrange"] = "1"
            etree.SubElement(self.actuator, "position" if is_position else "motor", attributes)


def _placed(pose: Pose) -> dict[str, str]:
    """The attributes of a pose; those at their default are left out."""
    attributes = {}
    if any(pose.xyz):
        attributes["pos"] = numbers(pose.xyz)
    x, y, z, w = pose.quaternion
    if (x, y, z) != (0.0, 0.0, 0.0):
        attributes["quat"] = numbers((w, x, y, z))
    return attributes


FORMAT = Format(write, facts.ROWS, facts.EXACT)
