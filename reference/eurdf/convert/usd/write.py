"""USD with the UsdPhysics schema, for Isaac Sim, Newton and other simulators.

A closure is a joint that is excluded from the articulation, as the draft REP-0158 of ROS asks. The bodies are where
the first configuration has them, so that the loops are closed when the file is opened.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from importlib.util import find_spec
from itertools import combinations, permutations

import numpy as np

from eurdf.closures.hinge import HingeClosure
from eurdf.convert.conventions import LIGHT, neighbours, position_gain
from eurdf.convert.coordinates import Coordinates
from eurdf.convert.export_format import ExportInput, ExportOutput, Format, coordinates_at
from eurdf.convert.inertia import about_centre, accepted_inertia, has_inertia
from eurdf.convert.losses import Losses
from eurdf.convert.meshes import MeshFiles
from eurdf.convert.names import UniqueNames
from eurdf.convert.parts import Part, part_of
from eurdf.convert.steps import in_series
from eurdf.convert.usd.facts import CLOSURES, DAMPING_TIME, EXACT, LEAST_MOMENT, ROWS
from eurdf.convert.usd.joints import KINDS, WHOLE, Freedom, axis_and_frame, freedoms, turns
from eurdf.diagnostics.extras import install_command
from eurdf.errors import MissingExtra
from eurdf.mechanism.body import Body, Shape
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint, JointProperties, Mimic
from eurdf.mechanism.mechanism import ROOT_JOINT, root_joint
from eurdf.mechanism.pose import IDENTITY, IDENTITY_QUATERNION, Pose, turn_from_x
from eurdf.mechanism.spanning_tree import rigid_roots

_DEGREES = 180.0 / math.pi


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the USD of a robot: ``robot.usda``, and its meshes in ``meshes/``.

    Raises:
        MissingExtra: The extra ``usd`` is not installed.
        CannotExport: A link has a negative mass.
    """
    if find_spec("pxr") is None:
        message = "the package that writes USD is not installed; install it with: "
        raise MissingExtra(message + install_command("usd"), "usd")
    return _UsdWriter(given, losses).write()


class _UsdWriter:
    """A stage while it is written."""

    def __init__(self, given: ExportInput, losses: Losses) -> None:
        from eurdf.convert.usd.stage import UsdStage, mesh_file  # loads the libraries of USD

        self.given, self.mechanism, self.losses = given, given.mechanism, losses
        self.bodies, self.joints, self.closures, self.shapes = (
            UniqueNames(losses, representable=_identifier) for _ in range(4)
        )
        name = UniqueNames(losses, representable=_identifier).new(self.mechanism.name)
        self.stage = UsdStage(name, self.mechanism.name)
        #: For each link, the path of the rigid body that has it, and its pose there.
        self.hosts: dict[str, tuple[str, Pose]] = {}
        self.poses: dict[str, Pose] = {}
        #: The first USD joint of each joint: its path and its kind.
        self.first: dict[str, tuple[str, str]] = {}
        self.jointed: set[frozenset[str]] = set()
        self.followers: set[str] = set()
        self.parts: list[Part] = []
        self.mimics = given.mechanism.leaders
        self.meshes = MeshFiles(given, losses, lambda name, content: False, (".usdc", mesh_file))

    def write(self) -> ExportOutput:
        mechanism, losses = self.mechanism, self.losses
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
            if closure.type in CLOSURES:
                self._closure(closure)
        for coupling in mechanism.couplings:
            self._coupling(coupling)
        self._no_contacts()
        others = list(self.given.configurations)[1:]
        for name in others:
            losses.add("export-configurations", name)
        coordinates = Coordinates(tuple(self.parts), self.given.own, "xyzw", at_rest=False)
        return ExportOutput({"robot.usda": self.stage.content(), **self.meshes.files}, coordinates)

    # -- bodies -----------------------------------------------------------------------------------------------------

    def _root_body(self, body: Body) -> None:
        fixed = self.mechanism.root == "fixed"
        pose = IDENTITY
        if not fixed and ROOT_JOINT in self.given.start:
            x, y, z, qx, qy, qz, qw = self.given.start[ROOT_JOINT]
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
            self.parts.append(part_of(root_joint(""), (ROOT_JOINT,), ()))

    def _rigid_body(self, body: Body, pose: Pose) -> str:
        path = self.stage.body(self.bodies.new(body.name), pose, body.name)
        self.hosts[body.name], self.poses[body.name] = (path, IDENTITY), pose
        mass = 0.0 if body.inertia is None else body.inertia.mass
        if 0.0 <= mass < LIGHT and body is self.mechanism.bodies[0] and self.mechanism.root == "fixed":
            self.losses.add("export-massless-base", body.name)
            self.stage.mass(path, 1.0, (0.0, 0.0, 0.0), np.eye(3))
        else:
            inertia = accepted_inertia(body, self.losses, LIGHT, LEAST_MOMENT)
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
        if joint.type.is_fixed and not has_inertia(body):
            self._fixed_frame(body, joint.parent, joint.placement * joint.offset)
            return
        coordinates = coordinates_at(self.given.start, joint, self.mimics.get(joint.name))
        host, at = self.hosts[joint.parent]
        pose, placement = self.poses[joint.parent], joint.placement
        names, ratios = [], []
        steps = in_series(joint, WHOLE)
        for step in steps:
            last = step is steps[-1]
            offset = joint.offset if last else IDENTITY
            own = step.of(coordinates)
            pose = pose * placement * step.joint.transform(own) * offset
            name = self.joints.new(step.joint.name)
            if last:
                child = self._rigid_body(body, pose)
            else:
                child = self.stage.body(self.bodies.new(f"{name}_body"), pose)
                self.stage.mass(child, LIGHT, (0.0, 0.0, 0.0), LIGHT * np.eye(3))
            kind, (axis, orientation) = KINDS.get(step.joint.type, "d6"), axis_and_frame(step.joint)
            turn = Pose(quaternion=orientation)
            ends = (host, at * placement * turn), (child, offset.inverse() * turn)
            shown = joint.name if len(steps) == 1 else ""
            path = self.stage.joint("joints", name, kind, ends, axis=axis, shown=shown)
            self.jointed.add(frozenset((host, child)))
            self.first.setdefault(joint.name, (path, kind))
            free = list(freedoms(step.joint))
            self._axes(joint.name, step.joint, kind, path, own, free)
            names.append(name)
            ratios += [(step.velocities[each.index], each.lead or 1.0, 0.0) for each in free]
            host, at, placement = child, IDENTITY, IDENTITY
        if not joint.type.is_fixed:
            self.parts.append(part_of(joint, names, ratios, self.mimics.get(joint.name)))

    def _axes(
        self, name: str, joint: Joint, kind: str, path: str, own: Sequence[float], freedoms: Sequence[Freedom]
    ) -> None:
        """Limits, drives and states of the axes of a USD joint, and what only schemas of simulators have."""
        if kind == "d6":
            self.stage.lock_others(path, [freedom.axis for freedom in freedoms])
        turns_as_ball = joint.type.quaternion is not None  # then, no rotation has a coordinate of its own
        for freedom in freedoms:
            position = 0.0
            if not turns_as_ball:
                position = own[freedom.index] * (freedom.lead or 1.0)
                self.stage.state(path, freedom.axis, position)
            is_unlimited = (turns_as_ball and turns(freedom.axis)) or freedom.lead is not None
            lower, upper = (-math.inf, math.inf) if is_unlimited else joint.ranges[freedom.index]
            self.stage.limits(path, freedom.axis, lower, upper)
            if freedom.lead is None:
                self._drive(name, joint.properties, path, freedom, position)
        if kind == "spherical" and any(map(math.isfinite, joint.properties.effort)):
            self.losses.add("export-effort-limit", name)
        if kind != "fixed":
            self._numbers_of_simulators(name, joint.properties, freedoms, path)

    def _drive(self, name: str, properties: JointProperties, path: str, freedom: Freedom, position: float) -> None:
        index = freedom.index
        damping = properties.damping[index] if properties.damping else 0.0
        stiffness = properties.stiffness[index] if properties.stiffness else 0.0
        target = properties.rest[index] if stiffness else 0.0
        effort = properties.effort[index] if properties.effort else math.inf
        if name not in self.mechanism.actuators or self.given.actuators == "none":
            if math.isfinite(effort):
                self.losses.add("export-effort-limit", name)
            if damping or stiffness:
                self.stage.drive(path, freedom.axis, stiffness, damping, target, math.inf)
            return
        motor = self.mechanism.motor(name)
        most = effort if effort > 0.0 else math.inf
        if motor.control is not None:
            lower, upper = motor.control
            most = min(most, max(-lower, upper))
        if self.given.actuators == "position":
            if stiffness:
                self.losses.add("export-spring", name)
            stiffness, target = position_gain(effort), position
            damping += DAMPING_TIME * stiffness
            message = f"stiffness is {stiffness:g}, damping {damping:g} (N, m, rad, s)"
            self.losses.add("export-position-gain", motor.name, message)
        self.stage.drive(path, freedom.axis, stiffness, damping, target, most)

    def _numbers_of_simulators(
        self, name: str, properties: JointProperties, freedoms: Sequence[Freedom], path: str
    ) -> None:
        """What Newton and PhysX have of a joint, and USD does not; it is one number for all axes."""
        mine = [freedom.index for freedom in freedoms] or range(3)  # a spherical joint

        def mean(values: tuple[float, ...]) -> float:
            return math.fsum(values[index] for index in mine) / len(mine) if values else 0.0

        armature, friction, damping = map(mean, (properties.armature, properties.friction, properties.damping))
        velocity = min((properties.velocity[index] for index in mine if properties.velocity), default=math.inf)
        turning = {turns(freedom.axis) for freedom in freedoms} or {True}
        if len(turning) > 1:
            if any(properties.armature) or any(properties.friction) or math.isfinite(velocity):
                self.losses.add("export-mixed-axes", name)
            return
        newton: dict[str, float] = {}
        physx: dict[str, float] = {}
        if armature:
            newton["newton:armature"] = physx["physxJoint:armature"] = armature
            self.losses.add("export-armature", name)
        if friction:
            newton["newton:friction"] = friction
            self.losses.add("export-friction", name)
        if damping and not freedoms:
            newton["newton:damping"] = damping / _DEGREES
        if math.isfinite(velocity):
            velocity *= _DEGREES if True in turning else 1.0
            newton["newton:velocityLimit"] = physx["physxJoint:maxJointVelocity"] = velocity
            self.losses.add("export-velocity-limit", name)
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
        (path, kind), (leader, other) = self.first[name], self.first[mimic.joint]
        if name in self.followers or kind != other or kind not in ("revolute", "prismatic"):
            return False
        offset = mimic.offset * (_DEGREES if kind == "revolute" else 1.0)
        self.stage.mimic(path, leader, mimic.multiplier, offset)
        self.followers.add(name)
        return True

    # -- constraints ------------------------------------------------------------------------------------------------

    def _closure(self, closure: Closure) -> None:
        axis, frames = "", (IDENTITY_QUATERNION, IDENTITY_QUATERNION)
        if isinstance(closure, HingeClosure):
            axis, frames = "X", (turn_from_x(closure.axes[0]), turn_from_x(closure.axes[1]))
        ends = []
        for anchor, turn in zip(closure.anchors, frames, strict=True):
            host, pose = self.hosts[anchor.body]
            ends.append((host, pose * anchor.pose * Pose(quaternion=turn)))
        kind, name = CLOSURES[closure.type], self.closures.new(closure.name)
        path = self.stage.joint("closures", name, kind, ends, axis=axis, closes=True, shown=closure.name)
        if "length" in closure.own:
            self.stage.distance(path, closure.own["length"])
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
        pairs = [(hosts[a], hosts[b]) for a, b in neighbours(mechanism, LIGHT)]
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

    def _shapes(self, body: Body) -> None:
        host, pose = self.hosts[body.name]
        for use, shapes in (("visual", body.visuals), ("collision", body.collisions)):
            for number, shape in enumerate(shapes):
                self._shape(host, pose, f"{body.name}_{use}_{number}", shape, use)

    def _shape(self, host: str, pose: Pose, name: str, shape: Shape, use: str) -> None:
        if shape.kind == "mesh":
            file = self.meshes.path(shape.filename)
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


def _identifier(name: str) -> str:
    """The name, with ``_`` for what the name of a prim cannot contain; it begins with a letter or ``_``."""
    found = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return found if re.match(r"[A-Za-z_]", found) else f"_{found}"


FORMAT = Format(write, ROWS, EXACT)
