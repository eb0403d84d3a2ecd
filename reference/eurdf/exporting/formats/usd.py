"""USD with the UsdPhysics schema, for Isaac Sim, Newton and other simulators.

A closure is a joint that is excluded from the articulation, as the draft REP-0158 of ROS asks. The bodies are where
the first configuration has them, so that the loops are closed when the file is opened.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from itertools import combinations, permutations

import numpy as np
import numpy.typing as npt

from eurdf.diagnostics.extras import install_command
from eurdf.exceptions import MissingExtra
from eurdf.exporting.contacts import neighbours
from eurdf.exporting.coordinates import Coordinates, Part
from eurdf.exporting.exceptions import CannotExport
from eurdf.exporting.inertia import about_centre, accepted_inertia, has_inertia
from eurdf.exporting.mesh_file import mesh_names, report_unread
from eurdf.exporting.servo import position_gain
from eurdf.exporting.written import Exportable, Format, Written
from eurdf.loss import ACCELERATION, BEYOND_LIMITS, COMMON, NOT_REFERENCED, Effect, Losses, LossKind
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
from eurdf.mechanism.pose import IDENTITY, Pose, Quaternion, Vector3, direction
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.writing.names import UniqueNames

#: kg and kg·m² that a moving body without inertia gets: far below any of a robot, far above 0 in single precision.
LEAST = 1e-9

#: kg·m² that a principal moment of any body has at least.
LEAST_MOMENT = 1e-12

#: Damping of a position drive, as a time: damping = this · stiffness, in s.
DAMPING_TIME = 0.1

_DEGREES = 180.0 / math.pi
_UPRIGHT: Quaternion = (0.0, 0.0, 0.0, 1.0)

#: Axis tokens of directions that need no turn of the frame.
_TOKENS: dict[Vector3, str] = {(1.0, 0.0, 0.0): "X", (0.0, 1.0, 0.0): "Y", (0.0, 0.0, 1.0): "Z"}

#: Largest cosine of the axes of a universal joint that are perpendicular but for rounding.
_SKEW = 1e-9

LOSSES = (
    LossKind(
        "export-single-precision",
        "number",
        Effect.APPROXIMATE,
        "frames of joints, masses, limits and gains are in single precision, angles in degrees: relative error 6e-8",
        "this is far below what a simulator in single precision computes; for more, export to MJCF",
        error="6e-8 of each number",
    ),
    LossKind(
        "export-universal-joint",
        "universal joint",
        Effect.APPROXIMATE,
        "becomes a D6 joint: USD does not state the order of its rotations; the first is about x, as Newton has it",
        "check the joint away from its zero in a simulator other than Newton",
        error="none in Newton, and none at the joint's zero",
    ),
    LossKind(
        "export-skew-universal-joint",
        "universal joint",
        Effect.APPROXIMATE,
        f"becomes two joints with a body of {LEAST:g} kg and kg·m² between them, as its axes are not perpendicular",
        "use a simulator with reduced coordinates, to which light bodies do no harm",
        error=f"{LEAST:g} kg and kg·m² in the mass matrix",
        only="axes not perpendicular",
    ),
    LossKind(
        "export-helical-joint",
        "helical joint",
        Effect.DROPPED,
        "becomes a D6 joint that turns and advances independently: nothing in USD couples a rotation to a translation",
        "couple the two axes in the simulator, or export to MJCF",
    ),
    LossKind(
        "export-mimic-joint",
        "mimic joint",
        Effect.APPROXIMATE,
        "NewtonMimicAPI states its leader, as USD has no mimic joints: other simulators leave it free",
        "in simulators other than Newton, couple the two joints by hand",
        error="none in Newton; elsewhere the joint is free",
    ),
    LossKind(
        "export-mimic-joint-dropped",
        "mimic joint",
        Effect.DROPPED,
        "is free: NewtonMimicAPI does not relate a rotation to a translation",
        "couple the two joints in the simulator, or export to MJCF",
        only="a rotation and a translation",
    ),
    LossKind(
        "export-velocity-limit",
        "velocity limit",
        Effect.APPROXIMATE,
        "is in the schemas of Newton and PhysX, as USD has none; of several axes, the smallest",
        "in other simulators, limit velocities in the controller",
        error="none in Newton and PhysX; elsewhere there is no limit",
    ),
    LossKind(
        "export-effort-limit",
        "effort limit",
        Effect.DROPPED,
        "is left out: in USD, a drive has it, and the joint has none",
        "limit efforts in the controller",
        only="joints without a drive",
    ),
    LossKind(
        "export-ball-damping",
        "damping",
        Effect.APPROXIMATE,
        "is in the schema of Newton, as USD has no drive of spherical joints; of several axes, the mean",
        "in other simulators, damp the joint in the controller",
        error="none in Newton; elsewhere there is no damping",
        only="spherical joints",
    ),
    LossKind(
        "export-friction",
        "friction",
        Effect.APPROXIMATE,
        "is in the schema of Newton, as USD has none; of several axes, the mean",
        "set the friction of the joint in other simulators",
        error="none in Newton; elsewhere there is no friction",
    ),
    LossKind(
        "export-armature",
        "armature",
        Effect.APPROXIMATE,
        "is in the schemas of Newton and PhysX, as USD has none; of several axes, the mean",
        "set the armature of the joint in other simulators",
        error="none in Newton and PhysX; elsewhere there is no armature",
    ),
    LossKind(
        "export-mixed-axes",
        "armature",
        Effect.DROPPED,
        "armature, friction and velocity limit are left out: simulators have one number for rotations and translations",
        "set them in the simulator",
        only="planar, cylindrical and floating joints",
    ),
    LossKind(
        "export-gear-ratio",
        "gear ratio",
        Effect.EXACT,
        "drives are on the side of the joint; the rotor is in the armature, gear ratio² · rotor inertia",
        "divide commands of the motor side by the gear ratio",
    ),
    LossKind(
        "export-spring",
        "spring",
        Effect.DROPPED,
        "is left out: the joint has a position drive, and USD has one drive for an axis",
        "export with actuators 'motor'",
        sayable=True,
        only="--actuators position",
    ),
    LossKind(
        "export-coupling",
        "coupling",
        Effect.APPROXIMATE,
        "NewtonMimicAPI states it, as USD has no couplings: other simulators leave the joints free",
        "in simulators other than Newton, couple the two joints by hand",
        error="none in Newton; elsewhere the joints are free",
    ),
    LossKind(
        "export-coupling-dropped",
        "coupling",
        Effect.DROPPED,
        "is left out: NewtonMimicAPI relates two rotations or two translations, and gives a joint one leader",
        "couple the joints in the simulator",
        only="a rotation and a translation, or several leaders",
    ),
    LossKind(
        "export-compliance",
        "compliance",
        Effect.DROPPED,
        "is left out: USD has rigid joints alone",
        "set the compliance of the joint in the simulator",
    ),
    LossKind(
        "export-no-drive",
        "actuator",
        Effect.DROPPED,
        "is left out: USD has no drive of spherical joints",
        "apply torques to the two bodies",
        only="spherical joints",
    ),
    LossKind(
        "export-position-gain",
        "actuator",
        Effect.APPROXIMATE,
        "the description has no gain",
        "set stiffness and damping of the drive",
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
        "export-actuator-name",
        "actuator",
        Effect.DROPPED,
        "its name is left out: a drive has that of its joint",
        "use the name of the joint",
        only="its name",
    ),
    LossKind(
        "export-control-range",
        "control range",
        Effect.APPROXIMATE,
        "is not symmetric: a drive has the larger of its two magnitudes as its largest force",
        "limit commands in the controller",
        error="the smaller magnitude may be exceeded, up to the larger one",
        only="not symmetric",
    ),
    LossKind(
        "export-massless-link",
        "link without mass",
        Effect.APPROXIMATE,
        f"moves without inertia, and USD takes 0 for unknown: gets {LEAST:g} kg and kg·m²",
        "give the link its mass, or merge its joints into one of a type with several axes",
        error=f"{LEAST:g} kg and kg·m² in the mass matrix",
        only="links that move",
    ),
    LossKind(
        "export-massless-base",
        "link without mass",
        Effect.EXACT,
        "is fixed to the world, and USD takes 0 for unknown: gets 1 kg and 1 kg·m², without effect",
        "give the link its mass",
        only="the fixed base",
    ),
    LossKind(
        "export-inertia",
        "inertia",
        Effect.APPROXIMATE,
        "is not that of a body with volume, which simulators ask for: principal moments are raised",
        "correct the inertia in the URDF; `eurdf check` reports those that no body has",
        error="the message gives the change of a principal moment; none in mass and centre of mass",
        only="what no body has",
    ),
    LossKind(
        "export-convex-hull",
        "collision shape",
        Effect.APPROXIMATE,
        "the mesh collides as its convex hull",
        "set physics:approximation of the shape",
        error="the distance of the mesh to its convex hull",
        only="meshes",
    ),
    LossKind(
        "export-mesh-converted",
        "mesh",
        Effect.APPROXIMATE,
        "becomes a USD mesh",
        "add materials and normals to the mesh",
        error="6e-8 of the coordinates of vertices; materials, textures and normals in the file are left out",
    ),
    LossKind(
        "export-mesh-format",
        "mesh",
        Effect.DROPPED,
        "it cannot be read",
        "convert the mesh, and name the new file in the URDF",
        sayable=True,
    ),
    LossKind(
        "export-texture",
        "texture",
        Effect.DROPPED,
        "is left out; the color is kept",
        "add the texture to the material",
    ),
    LossKind(
        "export-configurations",
        "configuration",
        Effect.DROPPED,
        "is left out: a stage has one, where the bodies are",
        "export again with --configuration, or set the joints in the simulator",
        sayable=True,
        only="all but one",
    ),
    BEYOND_LIMITS,
    LossKind(
        "export-no-configuration",
        "configuration",
        Effect.DROPPED,
        "no closed configuration was found: the bodies are where all coordinates are 0, and the loops may be open",
        "find one with `eurdf assemble`, and write it to the description as 'assembled'",
        sayable=True,
        only="none is closed",
    ),
    NOT_REFERENCED,
    ACCELERATION,
    *COMMON,
)


@dataclass(frozen=True, slots=True)
class _Freedom:
    """A free axis of a USD joint.

    Attributes:
        axis: Its name: ``angular`` or ``linear`` of a joint with one axis, else ``transX`` to ``rotZ``.
        index: Index of the coordinate and the velocity of the joint that it has.
        advance: Of the translation of a helical joint its length for 1 rad, m; else None.
    """

    axis: str
    index: int
    advance: float | None = None

    @property
    def turns(self) -> bool:
        """Whether it is a rotation."""
        return self.axis == "angular" or self.axis.startswith("rot")


@dataclass(frozen=True, slots=True)
class _Step:
    """A USD joint: one of those, in order, that a joint of the mechanism is.

    Attributes:
        suffix: What its name has after that of the joint.
        kind: ``fixed``, ``revolute``, ``prismatic``, ``spherical`` or ``d6``.
        joint: The same joint in terms of the mechanism, for its transform.
        turn: Orientation of its frames in those of the joint.
        axis: Of a revolute or prismatic joint: ``X``, ``Y`` or ``Z`` of its frames.
        freedoms: Its free axes; none of a spherical joint.
    """

    suffix: str
    kind: str
    joint: Joint
    turn: Quaternion = _UPRIGHT
    axis: str = ""
    freedoms: tuple[_Freedom, ...] = ()


def write(given: Exportable) -> Written:
    """Write the USD of a robot: ``robot.usda``, and its meshes in ``meshes/``.

    Raises:
        MissingExtra: The extra ``usd`` is not installed.
        CannotExport: A link has a negative mass.
    """
    if find_spec("pxr") is None:
        message = "the package that writes USD is not installed; install it with: "
        raise MissingExtra(message + install_command("usd"), "usd")
    return _Writer(given).write()


class _Writer:
    """A stage while it is written."""

    def __init__(self, given: Exportable) -> None:
        from eurdf.exporting.usd_stage import UsdStage  # loads the libraries of USD

        self.given, self.mechanism = given, given.mechanism
        self.losses = Losses(LOSSES)
        self.bodies, self.joints, self.closures, self.shapes = (
            UniqueNames(self.losses, representable=_identifier) for _ in range(4)
        )
        name = UniqueNames(self.losses, representable=_identifier).new(self.mechanism.name)
        self.stage = UsdStage(name, self.mechanism.name)
        #: For each link, the path of the rigid body that has it, and its pose there.
        self.hosts: dict[str, tuple[str, Pose]] = {}
        self.poses: dict[str, Pose] = {}
        #: The USD joints of each joint.
        self.paths: dict[str, tuple[str, ...]] = {}
        self.steps: dict[str, tuple[_Step, ...]] = {}
        self.jointed: set[frozenset[str]] = set()
        self.followers: set[str] = set()
        self.parts: list[Part] = []
        self.start: Mapping[str, tuple[float, ...]] = next(iter(given.configurations.values()), {})
        self.mimics = drivers(
            {
                joint.name: joint.mimic
                for joint in self.mechanism.joints
                if joint.mimic is not None and joint.type.is_axial
            }
        )
        self.mesh_names = mesh_names(given.meshes)
        self.meshes: dict[str, str | None] = {}
        self.files: dict[str, bytes] = {}

    def write(self) -> Written:
        mechanism, losses = self.mechanism, self.losses
        losses.add("export-single-precision", mechanism.name)
        self._root_body(mechanism.bodies[0])
        for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
            self._joint(joint, body)
        for joint in mechanism.joints:
            self._followed(joint)
        for body in mechanism.bodies:
            self._shapes(body)
        for frame in mechanism.frames:
            host, pose = self.hosts[frame.body]
            self.stage.frame(host, self.shapes.new(frame.name), pose * frame.pose, frame.name)
        for closure in mechanism.closures:
            self._closure(closure)
        for coupling in mechanism.couplings:
            self._coupling(coupling)
        self._no_contacts()
        others = list(self.given.configurations)[1:]
        for name in others:
            losses.add("export-configurations", name)
        if mechanism.constraints and not self.given.configurations:
            losses.add("export-no-configuration", "assembled")
        if mechanism.metadata or mechanism.own_data:
            losses.add("export-metadata", mechanism.name)
        coordinates = Coordinates(tuple(self.parts), self.given.own, "xyzw", at_rest=False)
        return Written({"robot.usda": self.stage.content(), **self.files}, losses.found, coordinates)

    # -- bodies -----------------------------------------------------------------------------------------------------

    def _root_body(self, body: Body) -> None:
        fixed = self.mechanism.root == "fixed"
        pose = IDENTITY
        if not fixed and ROOT_JOINT in self.start:
            x, y, z, qx, qy, qz, qw = self.start[ROOT_JOINT]
            norm = math.hypot(qx, qy, qz, qw)
            pose = Pose((x, y, z), (qx / norm, qy / norm, qz / norm, qw / norm))
        path = self._rigid_body(body, pose)
        if fixed:
            robot = self.stage.robot
            name = self.joints.new(ROOT_JOINT)
            self.stage.joint("joints", name, "fixed", ((robot, IDENTITY), (path, IDENTITY)))
            self.stage.articulation_root(robot)
        else:
            self.stage.articulation_root(path)
            self.parts.append(Part((ROOT_JOINT,), ROOT_JOINT, JointType.FLOATING))

    def _rigid_body(self, body: Body, pose: Pose) -> str:
        path = self.stage.body(self.bodies.new(body.name), pose, body.name)
        self.hosts[body.name], self.poses[body.name] = (path, IDENTITY), pose
        mass = 0.0 if body.inertia is None else body.inertia.mass
        if 0.0 <= mass < LEAST and body is self.mechanism.bodies[0] and self.mechanism.root == "fixed":
            self.losses.add("export-massless-base", body.name)
            self.stage.mass(path, 1.0, (0.0, 0.0, 0.0), np.eye(3))
        else:
            inertia = accepted_inertia(body, self.losses, LEAST, LEAST_MOMENT)
            self.stage.mass(path, inertia.mass, inertia.pose.xyz, about_centre(inertia))
        return path

    def _fixed_frame(self, body: Body, parent: str, pose: Pose) -> None:
        """A link without mass that is fixed to another one: a frame of its body."""
        host, at = self.hosts[parent]
        self.hosts[body.name] = host, at * pose
        self.poses[body.name] = self.poses[parent] * pose
        if not body.virtual:
            self.stage.frame(host, self.shapes.new(body.name), at * pose, body.name)

    # -- joints -----------------------------------------------------------------------------------------------------

    def _joint(self, joint: Joint, body: Body) -> None:
        steps = _steps(joint)
        if joint.type.is_fixed and not has_inertia(body):
            self._fixed_frame(body, joint.parent, joint.placement * joint.offset)
            return
        if len(steps) > 1:
            self.losses.add("export-skew-universal-joint", joint.name)
        elif joint.type in (JointType.UNIVERSAL, JointType.HELICAL):
            self.losses.add(f"export-{joint.type}-joint", joint.name)
        coordinates = self._coordinates(joint)
        host, at = self.hosts[joint.parent]
        pose, placement = self.poses[joint.parent], joint.placement
        paths = []
        for number, step in enumerate(steps):
            last = number == len(steps) - 1
            offset = joint.offset if last else IDENTITY
            own = coordinates if len(steps) == 1 else (coordinates[number],)
            moved = step.joint.transform(own)
            pose = pose * placement * moved * offset
            name = self.joints.new(joint.name + step.suffix)
            if last:
                child = self._rigid_body(body, pose)
            else:
                child = self.stage.body(self.bodies.new(f"{name}_body"), pose)
                self.stage.mass(child, LEAST, (0.0, 0.0, 0.0), LEAST * np.eye(3))
            turn = Pose(quaternion=step.turn)
            ends = (host, at * placement * turn), (child, offset.inverse() * turn)
            shown = joint.name if len(steps) == 1 else ""
            path = self.stage.joint("joints", name, step.kind, ends, axis=step.axis, shown=shown)
            self.jointed.add(frozenset((host, child)))
            self._axes(joint, step, path, own)
            paths.append(path)
            host, at, placement = child, IDENTITY, IDENTITY
        self.paths[joint.name], self.steps[joint.name] = tuple(paths), steps
        self._part(joint, steps, [path.rpartition("/")[2] for path in paths])

    def _coordinates(self, joint: Joint) -> tuple[float, ...]:
        """Those of the start, as files have them."""
        mimic = self.mimics.get(joint.name)
        if mimic is not None:
            (leader,) = self.start.get(mimic.joint, (0.0,))
            return (mimic.multiplier * leader + mimic.offset,)
        return tuple(self.start.get(joint.name, joint.type.neutral))

    def _part(self, joint: Joint, steps: Sequence[_Step], names: Sequence[str]) -> None:
        if joint.type.is_fixed:
            return
        mimic = self.mimics.get(joint.name)
        if mimic is not None:
            ratios: tuple[tuple[int, float, float], ...] = ((0, mimic.multiplier, mimic.offset),)
            self.parts.append(Part(tuple(names), mimic.joint, joint.type, ratios, mimics=True))
        elif joint.type in (JointType.PLANAR, JointType.SPHERICAL, JointType.FLOATING):
            self.parts.append(Part(tuple(names), joint.name, joint.type))
        else:
            freedoms = (freedom for step in steps for freedom in step.freedoms)
            ratios = tuple((each.index, 1.0 if each.advance is None else each.advance, 0.0) for each in freedoms)
            self.parts.append(Part(tuple(names), joint.name, joint.type, ratios))

    def _axes(self, joint: Joint, step: _Step, path: str, own: Sequence[float]) -> None:
        """Limits, drives and states of the axes of a USD joint, and what only schemas of simulators have."""
        if step.kind == "d6":
            self.stage.lock_others(path, [freedom.axis for freedom in step.freedoms])
        for freedom in step.freedoms:
            if joint.type is JointType.FLOATING:  # its rotation has no coordinate for each axis
                position = None
            else:
                position = own[freedom.index if len(own) > 1 else 0] * (freedom.advance or 1.0)
                self.stage.state(path, freedom.axis, position)
            # The rotation of a floating joint has no coordinate for each axis.
            turns = joint.type is JointType.FLOATING and freedom.index >= 3
            unlimited = turns or freedom.advance is not None
            lower, upper = (-math.inf, math.inf) if unlimited else joint.ranges[freedom.index]
            self.stage.limits(path, freedom.axis, lower, upper)
            if freedom.advance is None:
                self._drive(joint, path, freedom, position or 0.0)
        if step.kind == "spherical":
            self._undriven(joint)
        if step.kind != "fixed":
            self._numbers_of_simulators(joint, step, path)

    def _drive(self, joint: Joint, path: str, freedom: _Freedom, position: float) -> None:
        properties, index = joint.properties, freedom.index
        damping = properties.damping[index] if properties.damping else 0.0
        stiffness = properties.stiffness[index] if properties.stiffness else 0.0
        target = properties.rest[index] if stiffness else 0.0
        effort = properties.effort[index] if properties.effort else math.inf
        shown = self._actuator(joint)
        if shown is None:
            if math.isfinite(effort):
                self.losses.add("export-effort-limit", joint.name)
            if damping or stiffness:
                self.stage.drive(path, freedom.axis, stiffness, damping, target, math.inf)
            return
        motor = self.mechanism.motor(joint.name)
        most = effort if effort > 0.0 else math.inf
        if motor.control is not None:
            lower, upper = motor.control
            if lower != -upper:
                self.losses.add("export-control-range", shown)
            most = min(most, max(-lower, upper))
        if self.given.actuators == "position":
            if stiffness:
                self.losses.add("export-spring", joint.name)
            stiffness, target = position_gain(effort), position
            damping += DAMPING_TIME * stiffness
            message = f"stiffness is {stiffness:g}, damping {damping:g} (N, m, rad, s)"
            self.losses.add("export-position-gain", shown, message)
        self.stage.drive(path, freedom.axis, stiffness, damping, target, most)

    def _actuator(self, joint: Joint) -> str | None:
        """The name of the actuator of a joint, if it is to have one; with what is lost of it."""
        if joint.name not in self.mechanism.actuators:
            return None
        shown = self.mechanism.motor(joint.name).name
        if self.given.actuators == "none":
            self.losses.add("export-no-actuator", shown)
            return None
        if shown != joint.name:
            self.losses.add("export-actuator-name", shown)
        if any(ratio != 1.0 for ratio in joint.properties.gear_ratio) or any(joint.properties.rotor_inertia):
            self.losses.add("export-gear-ratio", shown)
        return shown

    def _undriven(self, joint: Joint) -> None:
        """What a spherical joint loses, which has no drive."""
        shown = self._actuator(joint)
        if shown is not None:
            self.losses.add("export-no-drive", shown)
        if any(math.isfinite(effort) for effort in joint.properties.effort):
            self.losses.add("export-effort-limit", joint.name)

    def _numbers_of_simulators(self, joint: Joint, step: _Step, path: str) -> None:
        properties = joint.properties
        if properties.rates:
            self.losses.add(ACCELERATION.code, joint.name)
        ball = step.kind == "spherical"
        mine = [freedom.index for freedom in step.freedoms] or range(3)

        def mean(values: tuple[float, ...]) -> float:
            return math.fsum(values[index] for index in mine) / len(mine) if values else 0.0

        velocity = (
            min((properties.velocity[index] for index in mine), default=math.inf) if properties.velocity else math.inf
        )
        turning = {freedom.turns for freedom in step.freedoms} or {True}
        if len(turning) > 1:
            if any(properties.armature) or any(properties.friction) or math.isfinite(velocity):
                self.losses.add("export-mixed-axes", joint.name)
            return
        newton: dict[str, float] = {}
        physx: dict[str, float] = {}
        armature, friction = mean(properties.armature), mean(properties.friction)
        if armature:
            newton["newton:armature"] = physx["physxJoint:armature"] = armature
            self.losses.add("export-armature", joint.name)
        if friction:
            newton["newton:friction"] = friction
            self.losses.add("export-friction", joint.name)
        if ball and mean(properties.damping):
            newton["newton:damping"] = mean(properties.damping) / _DEGREES
            self.losses.add("export-ball-damping", joint.name)
        if math.isfinite(velocity):
            velocity *= _DEGREES if True in turning else 1.0
            newton["newton:velocityLimit"] = physx["physxJoint:maxJointVelocity"] = velocity
            self.losses.add("export-velocity-limit", joint.name)
        for schema, values in (("NewtonJointAPI", newton), ("PhysxJointAPI", physx)):
            if values:
                self.stage.numbers_of_simulators(path, schema, values)

    def _followed(self, joint: Joint) -> None:
        """The leader of a mimic joint."""
        mimic = self.mimics.get(joint.name)
        if mimic is not None:
            stated = self._mimic(joint.name, mimic)
            self.losses.add("export-mimic-joint" if stated else "export-mimic-joint-dropped", joint.name)

    def _mimic(self, name: str, mimic: Mimic) -> bool:
        """Let a joint follow another one; returns False if it cannot."""
        step, leader = self.steps[name][0], self.steps[mimic.joint][0]
        if name in self.followers or step.kind != leader.kind or step.kind not in ("revolute", "prismatic"):
            return False
        offset = mimic.offset * (_DEGREES if step.kind == "revolute" else 1.0)
        self.stage.mimic(self.paths[name][0], self.paths[mimic.joint][0], mimic.multiplier, offset)
        self.followers.add(name)
        return True

    # -- constraints ------------------------------------------------------------------------------------------------

    def _closure(self, closure: Closure) -> None:
        if closure.compliance.linear or closure.compliance.angular:
            self.losses.add("export-compliance", closure.name)
        turns: tuple[Quaternion, Quaternion] = (_UPRIGHT, _UPRIGHT)
        axis = ""
        match closure:
            case PointClosure():
                kind = "spherical"
            case FrameClosure():
                kind = "fixed"
            case HingeClosure():
                kind, axis = "revolute", "X"
                turns = _to_x(closure.axes[0]), _to_x(closure.axes[1])
            case DistanceClosure():
                kind = "distance"
            case _:
                raise CannotExport(f"closure '{closure.name}' has the type {closure.type}, which USD does not have")
        ends = []
        for anchor, turn in zip((closure.a, closure.b), turns, strict=True):
            host, pose = self.hosts[anchor.body]
            ends.append((host, pose * anchor.pose * Pose(quaternion=turn)))
        name = self.closures.new(closure.name)
        path = self.stage.joint("closures", name, kind, ends, axis=axis, closes=True, shown=closure.name)
        if isinstance(closure, DistanceClosure):
            self.stage.distance(path, closure.length)
        self.jointed.add(frozenset(host for host, _ in ends))

    def _coupling(self, coupling: Coupling) -> None:
        pairs = permutations(coupling.coefficients) if len(coupling.coefficients) == 2 else ()
        for (one, c), (other, d) in pairs:
            if self._mimic(one, Mimic(other, -d / c, coupling.offset / c)):
                self.losses.add("export-coupling", coupling.name)
                return
        self.losses.add("export-coupling-dropped", coupling.name)

    def _no_contacts(self) -> None:
        """Exclude contacts between bodies that a joint connects, except where a USD joint already excludes them."""
        mechanism = self.mechanism
        hosts = {name: path for name, (path, _) in self.hosts.items()}
        pairs = [(hosts[a], hosts[b]) for a, b in neighbours(mechanism, LEAST)]
        groups: dict[str, list[str]] = {}
        for name, root in rigid_roots(mechanism.bodies[0].name, mechanism.joints).items():
            groups.setdefault(root, []).append(name)
        solid = {body.name for body in mechanism.bodies if body.collisions}
        for group in groups.values():
            pairs += combinations(dict.fromkeys(hosts[name] for name in group if name in solid), 2)
        filtered: dict[str, dict[str, None]] = {}
        for one, other in pairs:
            if one != other and frozenset((one, other)) not in self.jointed:
                filtered.setdefault(one, {})[other] = None
        for one, others in filtered.items():
            self.stage.no_contact(one, others)

    # -- shapes -----------------------------------------------------------------------------------------------------

    def _mesh(self, uri: str) -> str | None:
        """The path of the file of a mesh, made if there is none yet; None if the mesh is left out."""
        from eurdf.exporting.usd_stage import mesh_file

        if uri in self.meshes:
            return self.meshes[uri]
        path = self.meshes[uri] = None
        if report_unread(self.given, uri, self.losses):
            return None
        if (triangles := self.given.read_mesh(self.given.meshes[uri])) is None:
            self.losses.add("export-mesh-format", uri)
        else:
            path = self.meshes[uri] = f"meshes/{self.mesh_names[uri]}.usdc"
            self.files[path] = mesh_file(triangles.vertices, triangles.triangles)
            self.losses.add("export-mesh-converted", uri)
            if self.given.mesh_files == "reference":
                self.losses.add("export-mesh-not-referenced", uri)
            if uri.startswith("package://"):
                self.losses.add("export-mesh-path", uri, f"becomes '{path}'")
        return path

    def _shapes(self, body: Body) -> None:
        host, pose = self.hosts[body.name]
        for use, shapes in (("visual", body.visuals), ("collision", body.collisions)):
            for number, shape in enumerate(shapes):
                self._shape(host, pose, f"{body.name}_{use}_{number}", shape, use)

    def _shape(self, host: str, pose: Pose, name: str, shape: Shape, use: str) -> None:
        if shape.texture:
            self.losses.add("export-texture", shape.texture)
        if shape.kind == "mesh":
            file = self._mesh(shape.filename)
            if file is None:
                return
            path = self.stage.mesh(host, self._shape_name(name), file, shape.size, pose * shape.pose)
        else:
            path = self.stage.shape(host, self._shape_name(name), shape.kind, shape.size, pose * shape.pose)
        if use == "collision":
            self.stage.collides(path)
            if shape.kind == "mesh":
                self.losses.add("export-convex-hull", shape.filename)
        elif shape.color is not None:
            self.stage.color(path, shape.color)

    def _shape_name(self, name: str) -> str:
        """A name that nobody gave: that it changes is no loss."""
        return self.shapes.new(_identifier(name))


def _steps(joint: Joint) -> tuple[_Step, ...]:
    """The USD joints, from the parent outwards, that a joint is."""
    match joint.type:
        case JointType.FIXED:
            return (_Step("", "fixed", joint),)
        case JointType.REVOLUTE | JointType.CONTINUOUS:
            return (_single("", "revolute", joint, joint.axes[0], 0),)
        case JointType.PRISMATIC:
            return (_single("", "prismatic", joint, joint.axes[0], 0),)
        case JointType.SPHERICAL:
            return (_Step("", "spherical", joint),)
        case JointType.CYLINDRICAL:
            return (_Step("", "d6", joint, _to_x(joint.axes[0]), "", _freedoms("transX", "rotX")),)
        case JointType.PLANAR:
            return (_Step("", "d6", joint, freedoms=_freedoms("transX", "transY", "rotZ")),)
        case JointType.FLOATING:
            axes = _freedoms("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
            return (_Step("", "d6", joint, freedoms=axes),)
        case JointType.HELICAL:
            advance = _Freedom("transX", 0, joint.pitch / (2.0 * math.pi))
            return (_Step("", "d6", joint, _to_x(joint.axes[0]), "", (advance, _Freedom("rotX", 0))),)
    first, second = (np.array(direction(axis)) for axis in joint.axes)
    if abs(first @ second) <= _SKEW:
        turn = _columns(np.stack((first, second, np.cross(first, second)), axis=1))
        return (_Step("", "d6", joint, turn, "", _freedoms("rotX", "rotY")),)
    halves = (replace(joint, type=JointType.REVOLUTE, axes=(axis,)) for axis in joint.axes)
    return tuple(_single(f"_{index + 1}", "revolute", half, half.axes[0], index) for index, half in enumerate(halves))


def _freedoms(*axes: str) -> tuple[_Freedom, ...]:
    return tuple(_Freedom(axis, index) for index, axis in enumerate(axes))


def _single(suffix: str, kind: str, joint: Joint, axis: Vector3, index: int) -> _Step:
    unit = direction(axis)
    token = _TOKENS.get(unit)
    freedom = _Freedom("angular" if kind == "revolute" else "linear", index)
    return _Step(suffix, kind, joint, _UPRIGHT if token else _to_x(axis), token or "X", (freedom,))


def _to_x(axis: Vector3) -> Quaternion:
    """An orientation whose x axis is along an axis: the smallest rotation."""
    x, y, z = direction(axis)
    if x < -1.0 + 1e-12:
        return 0.0, 0.0, 1.0, 0.0
    w = 1.0 + x
    norm = math.hypot(w, y, z)
    return 0.0, -z / norm, y / norm, w / norm


def _columns(R: npt.NDArray[np.float64]) -> Quaternion:
    """The quaternion of a rotation matrix."""
    one = Pose(quaternion=_to_x((R[0, 0], R[1, 0], R[2, 0])))
    y = one.inverse().rotate((R[0, 1], R[1, 1], R[2, 1]))
    half = math.atan2(y[2], y[1]) / 2.0
    return (one * Pose(quaternion=(math.sin(half), 0.0, 0.0, math.cos(half)))).quaternion


def _identifier(name: str) -> str:
    """The name, with ``_`` for what the name of a prim cannot contain; it begins with a letter or ``_``."""
    found = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return found if re.match(r"[A-Za-z_]", found) else f"_{found}"


FORMAT = Format("usd", "USD with UsdPhysics, for Isaac Sim, Newton and others", write, LOSSES)
