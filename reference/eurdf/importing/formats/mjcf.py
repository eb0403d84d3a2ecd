"""MJCF, the format of MuJoCo.

Facts of MuJoCo that the importer relies on (documentation: Modeling, XML reference, mjModel): joints of one body act in
order, each about its anchor ``pos`` and along its ``axis``, both given in the body at the reference configuration
qpos0; quaternions are w x y z; equalities of joints and tendons are relative to qpos0; the data of a compiled
``connect`` are its anchors in body 1 and in body 2, those of a ``weld`` its anchors in body 2 and in body 1 and the
orientation of body 2 in body 1; the pose of a compiled mesh shape is that of the mesh's own inertial frame.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

from eurdf.importing.exceptions import CannotImport
from eurdf.importing.mesh_copies import MeshCopies
from eurdf.importing.mjcf_model import MjcfModel, compile_mjcf
from eurdf.importing.orientation import orientation
from eurdf.importing.robot_read import ImportFormat, RobotRead
from eurdf.importing.xml_files import included_files
from eurdf.linking.configurations import within_limits
from eurdf.loss import Effect, Losses, LossKind
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.constraint import (
    Closure,
    Coupling,
    DistanceClosure,
    FrameClosure,
    HingeClosure,
    PointClosure,
)
from eurdf.mechanism.frame import Anchor, Frame
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_transform import joint_transform
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, Root
from eurdf.mechanism.mimic import Mimic
from eurdf.mechanism.motor import Motor
from eurdf.mechanism.pose import IDENTITY, Pose, Quaternion, Vector3
from eurdf.mechanism.spanning_tree import depth_first, rigid_roots
from eurdf.writing.names import UniqueNames

#: A bound beyond this is none, rad or m.
UNLIMITED = 1e10

#: Mass (kg) and moments (kg·m²) up to this are those of a link without inertia, which MuJoCo does not allow to move.
LEAST = 1e-13

#: Lengths (m), and parts of unit vectors, that differ by no more are equal.
_SAME = 1e-9

_WORLD = "world"
_DEFAULT_RGBA = (0.5, 0.5, 0.5, 1.0)

LOSSES = (
    LossKind(
        "import-name",
        "name",
        Effect.EXACT,
        "is changed: the name is missing, reserved, or used by another element",
        "give the element a unique name in the file",
    ),
    LossKind(
        "import-scenery",
        "world",
        Effect.DROPPED,
        "the shapes of the world, and bodies that nothing moves, are left out: the root of the robot floats",
        "import the file of the robot alone",
    ),
    LossKind(
        "import-softness",
        "equality",
        Effect.APPROXIMATE,
        "becomes rigid: solref and solimp are left out",
        "give the closure a compliance, if simulators should know it",
    ),
    LossKind("import-inactive-equality", "equality", Effect.DROPPED, "is not active, and is left out", "activate it"),
    LossKind(
        "import-equality",
        "equality",
        Effect.DROPPED,
        "is left out: it is no closure of two bodies and no linear relation of joints",
        "describe it by a closure, a coupling or a mimic joint",
    ),
    LossKind(
        "import-redundant-equality",
        "equality",
        Effect.EXACT,
        "is left out: it joins two bodies that are fixed to each other, or repeats another equality",
        "remove it",
    ),
    LossKind(
        "import-locked-joint", "joint", Effect.EXACT, "is fixed where an equality holds it", "make it a fixed body"
    ),
    LossKind(
        "import-tendon",
        "tendon",
        Effect.DROPPED,
        "its limits, springs and losses are left out",
        "describe what it does by springs of joints or couplings",
    ),
    LossKind(
        "import-tendon-actuator",
        "actuator",
        Effect.APPROXIMATE,
        "pulls a tendon: becomes a motor of the one joint that moves all others of the tendon",
        "check which joint the motor should drive",
    ),
    LossKind(
        "import-actuator",
        "actuator",
        Effect.DROPPED,
        "is left out: it does not act on one joint",
        "name the actuated joint in the description",
    ),
    LossKind(
        "import-second-actuator",
        "actuator",
        Effect.DROPPED,
        "is left out: its joint has another actuator",
        "keep one actuator of a joint",
    ),
    LossKind(
        "import-actuator-gain",
        "actuator",
        Effect.DROPPED,
        "its gain, bias and dynamics are left out: it becomes a source of torque or force",
        "keep its controller beside the description",
    ),
    LossKind(
        "import-effort-limit",
        "effort limit",
        Effect.APPROXIMATE,
        "is not stated: the largest torque or force of the actuator is taken",
        "correct it in the description",
    ),
    LossKind(
        "import-unequal-effort",
        "effort limit",
        Effect.APPROXIMATE,
        "is not the same in both directions: the larger one is taken",
        "give the actuator a control range",
    ),
    LossKind(
        "import-ball-limit",
        "position limit",
        Effect.DROPPED,
        "is left out: a spherical joint has no limits",
        "limit the angle of the joint in the simulator",
    ),
    LossKind(
        "import-ball-spring",
        "spring",
        Effect.DROPPED,
        "is left out: spherical and floating joints have no springs",
        "add the spring in the simulator",
    ),
    LossKind(
        "import-nonlinear-spring",
        "spring",
        Effect.DROPPED,
        "the nonlinear part of its stiffness or damping is left out",
        "add it in the simulator",
    ),
    LossKind(
        "import-gravity-compensation",
        "link",
        Effect.DROPPED,
        "its gravity compensation is left out",
        "compensate gravity in the controller",
    ),
    LossKind(
        "import-mocap",
        "link",
        Effect.APPROXIMATE,
        "is moved by the user (mocap): becomes fixed",
        "make it a body with a free joint",
    ),
    LossKind(
        "import-shape",
        "shape",
        Effect.DROPPED,
        "is left out: URDF has no planes, ellipsoids, height fields and signed distance fields",
        "replace it by boxes, spheres, capsules, cylinders or a mesh",
    ),
    LossKind(
        "import-hidden-shape",
        "shape",
        Effect.DROPPED,
        "is left out: it is neither visible nor touches anything",
        "remove it",
    ),
    LossKind("import-mesh", "mesh", Effect.DROPPED, "is left out", "correct its file, and import again"),
    LossKind(
        "import-mesh-converted",
        "mesh",
        Effect.APPROXIMATE,
        "is not in a file that URDF can name: its vertices, in single precision, are written as OBJ",
        "save it as STL or OBJ",
    ),
    LossKind("import-texture", "texture", Effect.DROPPED, "is left out; the color is kept", "add it to the URDF"),
    LossKind(
        "import-frame", "frame", Effect.DROPPED, "a site without a name is left out", "give it a name in the file"
    ),
    LossKind(
        "import-configuration",
        "configuration",
        Effect.DROPPED,
        "is left out: a coordinate is beyond its limits",
        "correct the keyframe or the limits",
    ),
    LossKind(
        "import-simulation",
        "simulation",
        Effect.DROPPED,
        "is no part of a description",
        "keep it in a file of the simulator",
    ),
)


@dataclass(frozen=True, slots=True)
class _Step:
    """A joint of the mechanism that one or several joints of a body are.

    Attributes:
        name: Its name.
        type: Its type.
        joints: Indices of the MuJoCo joints that it is, in order.
        anchor: Its origin in the body at qpos0, m.
        turn: Orientation of its frame in the body.
        axes: Of the joint, in its frame.
        pitch: Of a helical joint, m per revolution.
    """

    name: str
    type: JointType
    joints: tuple[int, ...]
    anchor: Vector3
    axes: tuple[Vector3, ...] = ()
    turn: Pose = IDENTITY
    pitch: float = 0.0


def read(path: Path, within: Path) -> RobotRead:
    """Read an MJCF file.

    Raises:
        CannotImport: It is not MJCF, or MuJoCo refuses it, or one of its files is outside the folder ``within``.
        MissingExtra: The extra ``mujoco`` is not installed.
    """
    sources = included_files(path, within)
    return replace(_Reader(compile_mjcf(path), path).read(), sources=sources)


class _Reader:
    """A file while it is read."""

    def __init__(self, model: MjcfModel, path: Path) -> None:
        self.model, self.path = model, path
        self.losses = Losses(LOSSES)
        self.copies = MeshCopies()
        self.links = UniqueNames(self.losses, "universe", code="import-name")
        self.joint_names = UniqueNames(self.losses, "universe", ROOT_JOINT, code="import-name")
        self.children: dict[int, list[int]] = {}
        for body, parent in enumerate(model["body_parentid"][1:], 1):
            self.children.setdefault(parent, []).append(body)
        self.joints_of: dict[int, list[int]] = {}
        for joint, body in enumerate(model["jnt_bodyid"]):
            self.joints_of.setdefault(body, []).append(joint)
        self.root, self.root_body = self._root()
        #: Link of each body, and the pose of the body in it.
        self.bodies: dict[int, Body] = {}
        self.extra: list[Body] = []
        self.joints: list[Joint] = []
        #: For each MuJoCo joint, the step that it is in.
        self.steps: dict[int, _Step] = {}
        self.consumed: set[int] = set()

    def read(self) -> RobotRead:
        """Read all parts of the robot."""
        for body in self._below(self.root_body):
            self.bodies[body] = self._body(body)
        root = self.bodies[self.root_body].name
        for body in list(self.bodies):
            if body != self.root_body:
                self._joints(body)
        self._scenery()
        closures = self._closures()
        couplings = self._couplings()
        actuators, motors = self._actuators()
        frames = self._frames()
        ordered = depth_first(root, self.joints)
        by_name = {body.name: body for body in (*self.bodies.values(), *self.extra)}
        mechanism = Mechanism(
            self._name(),
            "",
            self.root,
            (by_name[root], *(by_name[joint.child] for joint in ordered)),
            tuple(ordered),
            frames,
            (),
            actuators,
            couplings=couplings,
            motors=MappingProxyType(motors),
        )
        mechanism = replace(mechanism, closures=self._movable(closures, mechanism))
        configurations, start = self._configurations(mechanism)
        self._rest()
        mechanism = replace(mechanism, configurations=MappingProxyType(configurations))
        return RobotRead(mechanism, self.losses.found, self.copies.files, start)

    def _name(self) -> str:
        name = self.model.name
        return self.path.stem if name in ("", "MuJoCo Model") else name

    # -- the tree ---------------------------------------------------------------------------------------------------

    def _root(self) -> tuple[Root, int]:
        """Whether the root floats, and the body that it is."""
        model = self.model
        top = self.children.get(0, [])
        moving = [body for body in top if self._moves(body)]
        joined = {body for bodies in self._bodies_of_equalities() for body in bodies}
        free = [body for body in moving if self._kinds(body) == ["free"]]
        if len(moving) == 1 and free and joined <= set(self._below(free[0])):
            return "floating", free[0]
        at_world = 0 in joined
        empty = not at_world and 0 not in model["site_bodyid"]
        solid = [kind for body, kind in zip(model["geom_bodyid"], model["geom_type"], strict=True) if body == 0]
        if (
            len(top) == 1
            and empty
            and set(solid) <= {"plane"}
            and not self._kinds(top[0])
            and self._pose(top[0]) == IDENTITY
        ):
            return "fixed", top[0]
        return "fixed", 0

    def _moves(self, body: int) -> bool:
        """Whether a body or one below it has a joint."""
        return bool(self.joints_of.get(body)) or any(map(self._moves, self.children.get(body, ())))

    def _kinds(self, body: int) -> list[str]:
        return [self.model["jnt_type"][joint] for joint in self.joints_of.get(body, ())]

    def _bodies_of_equalities(self) -> list[tuple[int, ...]]:
        model = self.model
        found = []
        for kind, object_, one, other in zip(
            model["eq_type"], model["eq_objtype"], model["eq_obj1id"], model["eq_obj2id"], strict=True
        ):
            if kind in ("connect", "weld"):
                pair = (one, other) if object_ == "body" else tuple(model["site_bodyid"][site] for site in (one, other))
                found.append(pair)
        return found

    def _below(self, body: int) -> list[int]:
        """A body and all that it carries, depth first."""
        found, stack = [], [body]
        while stack:
            body = stack.pop()
            found.append(body)
            stack += reversed(self.children.get(body, []))
        return found

    def _pose(self, body: int) -> Pose:
        return _pose(self.model["body_pos"][body], self.model["body_quat"][body])

    def _body(self, body: int) -> Body:
        model = self.model
        stated = model.names["body"][body]
        name = self.links.new(_usable(stated) or (f"body_{body}" if body else _WORLD))
        if not stated or _usable(stated) != stated:
            self.losses.add("import-name", stated or f"body {body}", f"becomes '{name}'")
        if model["body_gravcomp"][body]:
            self.losses.add("import-gravity-compensation", name)
        if model["body_mocapid"][body] >= 0:
            self.losses.add("import-mocap", name)
        visuals, collisions = self._shapes(body)
        return Body(name, self._inertia(body), tuple(visuals), tuple(collisions))

    def _inertia(self, body: int) -> Inertia | None:
        model = self.model
        mass, principal = model["body_mass"][body], model["body_inertia"][body]
        if mass <= LEAST and max(principal) <= LEAST:
            return None
        full = model.full_inertia.get(body)
        # The compiler may have scaled or balanced it.
        if full is not None and math.isclose(sum(full[:3]), sum(principal), rel_tol=1e-12):
            xx, yy, zz, xy, xz, yz = full
            return Inertia(mass, Pose(_vector(model["body_ipos"][body])), (xx, xy, xz, yy, yz, zz))
        xx, yy, zz = principal
        pose = _pose(model["body_ipos"][body], model["body_iquat"][body])
        return Inertia(mass, pose, (xx, 0.0, 0.0, yy, 0.0, zz))

    def _joints(self, body: int) -> None:
        """The joints between a body and its parent, with links without mass between them."""
        link = self.bodies[body].name
        parent = self.bodies[self.model["body_parentid"][body]].name
        steps = self._grouped(body)
        pose = self._pose(body)
        if not steps:
            name = self.joint_names.new(f"{link}_fixed")
            self.joints.append(Joint(name, JointType.FIXED, parent, link, pose))
            return
        before = pose
        if self._kinds(body) == ["free"]:
            before = IDENTITY  # the coordinates of a free joint are the pose in the world
        for index, step in enumerate(steps):
            last = index == len(steps) - 1
            here = Pose(step.anchor) * step.turn
            placement = before * here
            moved = self._reference(step)
            if moved is not IDENTITY:
                placement = placement * moved.inverse()
            child = link
            if not last:
                child = self.links.new(f"{step.name}_link")
                self.extra.append(Body(child))
            offset = here.inverse() if last and here != IDENTITY else IDENTITY
            self.joints.append(
                Joint(
                    step.name,
                    step.type,
                    parent,
                    child,
                    placement,
                    offset,
                    step.axes,
                    step.pitch,
                    self._properties(step),
                )
            )
            for joint in step.joints:
                self.steps[joint] = step
            parent, before = child, here.inverse()

    def _reference(self, step: _Step) -> Pose:
        """How far a joint has moved its child at qpos0."""
        if step.type in (JointType.FLOATING, JointType.SPHERICAL):
            return IDENTITY
        coordinates = self._coordinates(step, self.model["qpos0"])
        bare = Joint(step.name, step.type, "", "", axes=step.axes, pitch=step.pitch)
        return joint_transform(bare, coordinates) if any(coordinates) else IDENTITY

    def _grouped(self, body: int) -> list[_Step]:
        """The joints of a body. Those that an export made of one joint, by their names, are that joint again."""
        joints = self.joints_of.get(body, [])
        group = self._group(joints)
        if group is not None:
            return [group]
        return [self._single(joint, body) for joint in joints]

    def _single(self, joint: int, body: int) -> _Step:
        model = self.model
        stated = model.names["joint"][joint]
        made = f"{self.bodies[body].name}_joint" if joint == self.joints_of[body][0] else f"joint_{joint}"
        name = self.joint_names.new(_usable(stated) or made)
        if not stated or _usable(stated) != stated:
            self.losses.add("import-name", stated or f"joint {joint}", f"becomes '{name}'")
        anchor, axis = _vector(model["jnt_pos"][joint]), _vector(model["jnt_axis"][joint])
        match model["jnt_type"][joint]:
            case "free":
                return _Step(name, JointType.FLOATING, (joint,), (0.0, 0.0, 0.0))
            case "ball":
                return _Step(name, JointType.SPHERICAL, (joint,), anchor)
            case "slide":
                return _Step(name, JointType.PRISMATIC, (joint,), (0.0, 0.0, 0.0), (axis,))
        kind = JointType.REVOLUTE if any(map(math.isfinite, self._range(joint))) else JointType.CONTINUOUS
        return _Step(name, kind, (joint,), anchor, (axis,))

    def _group(self, joints: Sequence[int]) -> _Step | None:
        """The one joint that an export splits into these."""
        model = self.model
        names = [model.names["joint"][joint] for joint in joints]
        kinds = [model["jnt_type"][joint] for joint in joints]
        suffixes, kind = _EXPORTED.get(tuple(kinds), ((), None))
        for ends, type_ in ((suffixes, kind), (("_slide", ""), JointType.HELICAL)):
            if type_ is None or len(ends) != len(names) or (type_ is JointType.HELICAL and kinds != ["slide", "hinge"]):
                continue
            stem = names[0].removesuffix(ends[0])
            if not stem or [stem + end for end in ends] != names or _usable(stem) != stem:
                continue
            axes = [_vector(model["jnt_axis"][joint]) for joint in joints]
            anchors = [_vector(model["jnt_pos"][j]) for j, each in zip(joints, kinds, strict=True) if each != "slide"]
            if any(math.dist(anchor, anchors[0]) > _SAME for anchor in anchors) or not self._is_one(joints, type_):
                continue
            turn, pitch = IDENTITY, 0.0
            match type_:
                case JointType.CYLINDRICAL | JointType.HELICAL:
                    if math.dist(*axes) > _SAME:
                        continue
                    if type_ is JointType.HELICAL:
                        advance = self._advance(*joints)
                        if not advance:
                            continue
                        pitch = 2.0 * math.pi * advance
                    axes = axes[:1]
                case JointType.UNIVERSAL:
                    if math.hypot(*_cross(*axes)) < 1e-6:
                        continue
                case _:
                    if math.dist(_cross(axes[0], axes[1]), axes[2]) > _SAME or abs(_dot(axes[0], axes[1])) > _SAME:
                        continue
                    turn, axes = orientation(axes[0], axes[1], axes[2]), []
            return _Step(self.joint_names.new(stem), type_, tuple(joints), anchors[0], tuple(axes), turn, pitch)
        return None

    def _is_one(self, joints: Sequence[int], kind: JointType) -> bool:
        """Whether nothing acts on one of the joints alone."""
        model = self.model
        used = {
            joint
            for kind_, one, other in zip(model["eq_type"], model["eq_obj1id"], model["eq_obj2id"], strict=True)
            if kind_ == "joint"
            for joint in (one, other)
        }
        if kind is JointType.HELICAL:
            return True
        driven = [joint in self._driven() for joint in joints]
        if kind is JointType.FLOATING:
            driven = driven[:3]
        sprung = kind in (JointType.PLANAR, JointType.FLOATING) and any(model["jnt_stiffness"][j] for j in joints)
        return used.isdisjoint(joints) and all(driven) == any(driven) and not sprung

    def _driven(self) -> set[int]:
        model = self.model
        kinds = zip(model["actuator_trntype"], model["actuator_trnid"], strict=True)
        return {ids[0] for kind, ids in kinds if kind in ("joint", "jointinparent")}

    def _advance(self, slide: int, hinge: int) -> float:
        """m/rad by which an equality makes a slide follow a hinge; 0 if none does."""
        model = self.model
        for index, kind in enumerate(model["eq_type"]):
            pair = model["eq_obj1id"][index], model["eq_obj2id"][index]
            data = model["eq_data"][index]
            if kind == "joint" and pair == (slide, hinge) and not data[0] and not any(data[2:5]):
                self.consumed.add(index)
                return float(data[1])
        return 0.0

    # -- what a joint has -------------------------------------------------------------------------------------------

    def _range(self, joint: int) -> tuple[float, float]:
        if not self.model["jnt_limited"][joint]:
            return -math.inf, math.inf
        lower, upper = self.model["jnt_range"][joint]
        return (lower if lower > -UNLIMITED else -math.inf), (upper if upper < UNLIMITED else math.inf)

    def _properties(self, step: _Step) -> JointProperties:
        model = self.model
        free = JointProperties.unlimited(step.type)
        dofs = [dof for joint in step.joints for dof in self._dofs(joint)]
        joints, stiff = list(step.joints), {}
        if step.type is JointType.HELICAL:
            joints, dofs = joints[1:], dofs[1:]
        for joint in step.joints:
            if any(_row(model["jnt_stiffnesspoly"], joint)) or any(
                any(_row(model["dof_dampingpoly"], dof)) for dof in dofs
            ):
                self.losses.add("import-nonlinear-spring", step.name)
        if step.type in (JointType.SPHERICAL, JointType.FLOATING, JointType.PLANAR):
            if any(model["jnt_stiffness"][joint] for joint in joints):
                self.losses.add("import-ball-spring", step.name)
            if any(model["jnt_limited"][joint] for joint in joints):
                self.losses.add("import-ball-limit", step.name)
            bounds = list(zip(free.lower, free.upper, strict=True))
        else:
            bounds = [self._range(joint) for joint in joints]
            stiffness = tuple(float(model["jnt_stiffness"][joint]) for joint in joints)
            if any(stiffness):
                addresses = [model["jnt_qposadr"][joint] for joint in joints]
                stiff = {"stiffness": stiffness, "rest": tuple(model["qpos_spring"][at] for at in addresses)}
        return replace(
            free,
            lower=tuple(lower for lower, _ in bounds),
            upper=tuple(upper for _, upper in bounds),
            effort=self._efforts(joints, len(dofs)),
            damping=tuple(float(model["dof_damping"][dof]) for dof in dofs),
            friction=tuple(float(model["dof_frictionloss"][dof]) for dof in dofs),
            armature=tuple(float(model["dof_armature"][dof]) for dof in dofs),
            **stiff,
        )

    def _dofs(self, joint: int) -> range:
        start = self.model["jnt_dofadr"][joint]
        return range(start, start + {"free": 6, "ball": 3}.get(self.model["jnt_type"][joint], 1))

    def _efforts(self, joints: Sequence[int], nv: int) -> tuple[float, ...]:
        """The effort limits that joints state."""
        found: list[float] = []
        for joint in joints:
            effort = math.inf
            if self.model["jnt_actfrclimited"][joint]:
                effort = self._largest(self.model["jnt_actfrcrange"][joint], self.model.names["joint"][joint])
            found += [effort] * len(self._dofs(joint))
        return tuple(found[:nv])

    def _largest(self, bounds: Sequence[float], name: str) -> float:
        lower, upper = bounds
        if -lower != upper:
            self.losses.add("import-unequal-effort", name, f"is {lower:g} to {upper:g}: the larger one is taken")
        return float(max(abs(lower), abs(upper)))

    def _coordinates(self, step: _Step, qpos: Sequence[float]) -> tuple[float, ...]:
        """The coordinates of a joint, as files have them, at a configuration of MuJoCo."""
        found: list[float] = []
        joints = step.joints[1:] if step.type is JointType.HELICAL else step.joints
        for joint in joints:
            at = self.model["jnt_qposadr"][joint]
            match self.model["jnt_type"][joint]:
                case "free":
                    found += [*qpos[at : at + 3], *_xyzw(qpos[at + 3 : at + 7])]
                case "ball":
                    found += _xyzw(qpos[at : at + 4])
                case _:
                    found.append(float(qpos[at]))
        if step.type in (JointType.FLOATING, JointType.SPHERICAL) and step.turn is not IDENTITY:
            turned = step.turn.inverse() * Pose(quaternion=cast(Quaternion, tuple(found[-4:]))) * step.turn
            found[-4:] = turned.quaternion
        return tuple(found)

    # -- shapes -----------------------------------------------------------------------------------------------------

    def _shapes(self, body: int) -> tuple[list[Shape], list[Shape]]:
        """The visual and the collision shapes of a body."""
        model = self.model
        visuals, collisions = [], []
        for geom, owner in enumerate(model["geom_bodyid"]):
            if owner != body:
                continue
            shape = self._shape(geom)
            if shape is None:
                continue
            touches = bool(model["geom_contype"][geom] or model["geom_conaffinity"][geom])
            visible = model["geom_group"][geom] < 3  # MuJoCo shows the groups 0 to 2 by default
            if visible:
                visuals.append(shape)
            if touches:
                collisions.append(replace(shape, color=None))
            if not visible and not touches:
                self.losses.add("import-hidden-shape", self._geom_name(geom))
        return visuals, collisions

    def _geom_name(self, geom: int) -> str:
        model = self.model
        return (
            model.names["geom"][geom] or f"geom {geom} of {model.names['body'][model['geom_bodyid'][geom]] or 'a body'}"
        )

    def _shape(self, geom: int) -> Shape | None:
        model = self.model
        kind, size = model["geom_type"][geom], model["geom_size"][geom]
        pose = _pose(model["geom_pos"][geom], model["geom_quat"][geom])
        color = self._color(geom)
        match kind:
            case "box":
                return Shape("box", tuple(2.0 * side for side in size), pose, color=color)
            case "sphere":
                return Shape("sphere", (size[0],), pose, color=color)
            case "cylinder":
                return Shape("cylinder", (size[0], 2.0 * size[1]), pose, color=color)
            case "capsule":
                return Shape("capsule", (size[0], 2.0 * size[1]), pose, color=color)
            case "mesh":
                return self._mesh(model["geom_dataid"][geom], pose, color)
        self.losses.add("import-shape", self._geom_name(geom), f"is left out: URDF has no shape of type {kind}")
        return None

    def _mesh(self, mesh: int, pose: Pose, color: tuple[float, float, float, float] | None) -> Shape:
        model = self.model
        given, name = model.meshes[mesh], model.names["mesh"][mesh]
        if given.obj:
            self.losses.add("import-mesh-converted", name)
            return Shape("mesh", given.scale, pose, self.copies.content(name, ".obj", given.obj.encode()), color)
        try:
            uri = self.copies.file(Path(given.path))
        except OSError as error:
            raise CannotImport(self.path, f"mesh '{given.path}': {error.strerror or error}") from None
        own = _pose(model["mesh_pos"][mesh], model["mesh_quat"][mesh])
        return Shape("mesh", given.scale, pose * own.inverse(), uri, color)

    def _color(self, geom: int) -> tuple[float, float, float, float] | None:
        """The color of a shape; None where the file states none."""
        model = self.model
        rgba, material = tuple(model["geom_rgba"][geom]), model["geom_matid"][geom]
        if material >= 0 and rgba == _DEFAULT_RGBA:
            rgba = tuple(model["mat_rgba"][material])
            if any(each >= 0 for each in _flat(model["mat_texid"][material])):
                self.losses.add("import-texture", self._geom_name(geom))
        elif rgba == _DEFAULT_RGBA:
            return None
        red, green, blue, alpha = (round(float(value), 7) for value in rgba)  # single precision
        return red, green, blue, alpha

    # -- constraints ------------------------------------------------------------------------------------------------

    def _closures(self) -> list[Closure]:
        model = self.model
        self.equalities = UniqueNames(self.losses, code="import-name")
        found: list[Closure] = []
        by_name = {name: index for index, name in enumerate(model.names["equality"]) if name}
        for index, kind in enumerate(model["eq_type"]):
            if index in self.consumed:
                continue
            name = model.names["equality"][index]
            if not model["eq_active0"][index]:
                self.consumed.add(index)
                self.losses.add("import-inactive-equality", name or f"equality {index}")
            elif kind in ("connect", "weld"):
                self.consumed.add(index)
                a, b = self._anchors(index)
                name = self.equalities.new(name or f"{a.body}_{b.body}")
                self.losses.add("import-softness", name)
                if kind == "weld":
                    found.append(FrameClosure(name, a, b))
                    continue
                second = by_name.get(f"{model.names['equality'][index]}/axis")
                axes = None if second is None or not name else self._hinge_axes(a, b, second)
                if axes is None or second is None:
                    found.append(PointClosure(name, a, b))
                else:
                    self.consumed.add(second)
                    found.append(HingeClosure(name, a, b, axes))
            elif kind == "tendon" and (distance := self._distance(index)) is not None:
                self.consumed.add(index)
                found.append(distance)
        return found

    def _anchors(self, index: int) -> tuple[Anchor, Anchor]:
        model = self.model
        one, other = model["eq_obj1id"][index], model["eq_obj2id"][index]
        if model["eq_objtype"][index] == "site":
            return self._site_anchor(one), self._site_anchor(other)
        data = model["eq_data"][index]
        if model["eq_type"][index] == "connect":
            poses = Pose(_vector(data[:3])), Pose(_vector(data[3:6]))
        else:
            poses = _pose(data[3:6], data[6:10]), Pose(_vector(data[:3]))
        return Anchor(self.bodies[one].name, poses[0]), Anchor(self.bodies[other].name, poses[1])

    def _site_anchor(self, site: int) -> Anchor:
        model = self.model
        pose = _pose(model["site_pos"][site], model["site_quat"][site])
        return Anchor(self.bodies[model["site_bodyid"][site]].name, pose)

    def _hinge_axes(self, a: Anchor, b: Anchor, second: int) -> tuple[Vector3, Vector3] | None:
        """The axes of the hinge that a second point makes of a first one; None if it does not."""
        model = self.model
        if model["eq_type"][second] != "connect" or not model["eq_active0"][second]:
            return None
        c, d = self._anchors(second)
        one, other = a.pose.inverse().act(c.pose.xyz), b.pose.inverse().act(d.pose.xyz)
        lengths = math.hypot(*one), math.hypot(*other)
        if (a.body, b.body) != (c.body, d.body) or min(lengths) < _SAME or abs(lengths[0] - lengths[1]) > _SAME:
            return None
        return one, other

    def _distance(self, index: int) -> DistanceClosure | None:
        """The closure that keeps the length of a tendon between two sites."""
        model = self.model
        tendon, data = model["eq_obj1id"][index], model["eq_data"][index]
        wraps = self._wraps(tendon)
        length = model["tendon_length0"][tendon] + data[0]
        if [kind for kind, _, _ in wraps] != ["site", "site"] or model["eq_obj2id"][index] >= 0 or length < 1e-4:
            return None
        (_, one, _), (_, other, _) = wraps
        stated = model.names["equality"][index] or model.names["tendon"][tendon]
        name = self.equalities.new(stated or f"distance_{index}")
        self.losses.add("import-softness", name)
        return DistanceClosure(name, self._site_anchor(one), self._site_anchor(other), length)

    def _wraps(self, tendon: int) -> list[tuple[str, int, float]]:
        """What a tendon goes by: kind, index of the element, and coefficient."""
        model = self.model
        at, count = model["tendon_adr"][tendon], model["tendon_num"][tendon]
        return [(model["wrap_type"][i], model["wrap_objid"][i], model["wrap_prm"][i]) for i in range(at, at + count)]

    def _movable(self, closures: Sequence[Closure], mechanism: Mechanism) -> tuple[Closure, ...]:
        """The closures of bodies that can move against each other, each once."""
        rigid = rigid_roots(mechanism.bodies[0].name, mechanism.joints)
        found: dict[frozenset[tuple[str, Pose]], Closure] = {}
        for closure in closures:
            pair = frozenset((end.body, end.pose) for end in (closure.a, closure.b))
            if pair in found and found[pair].type != closure.type:
                self.losses.add("import-equality", closure.name, "is left out: another one joins the same two frames")
            elif rigid[closure.a.body] == rigid[closure.b.body] or pair in found:
                self.losses.add("import-redundant-equality", closure.name)
            else:
                found[pair] = closure
        return tuple(found.values())

    def _couplings(self) -> tuple[Coupling, ...]:
        """The linear relations of joints; those that an export made of mimic joints are mimic joints again."""
        model = self.model
        found: list[Coupling] = []
        seen: set[tuple[tuple[str, float], ...]] = set()
        for index in range(len(model["eq_type"])):
            if index in self.consumed:
                continue
            stated = model.names["equality"][index] or f"equality {index}"
            terms = self._terms(index)
            if terms is None:
                self.losses.add("import-equality", stated)
                continue
            coefficients, offset = terms
            if len(coefficients) < 2:
                self._lock(coefficients, offset, stated)
                continue
            (first, _), *_ = coefficients.items()
            if len(coefficients) == 2 and stated == f"{first}/mimic" and self._mimic(coefficients, offset):
                self.losses.add("import-softness", first)
                continue
            terms_ = sorted(coefficients.items())
            direction = tuple((name, value / terms_[0][1]) for name, value in terms_)
            if direction in seen:
                self.losses.add("import-redundant-equality", stated)
                continue
            seen.add(direction)
            name = self.equalities.new(model.names["equality"][index] or "_".join(coefficients))
            found.append(Coupling(name, tuple(coefficients.items()), offset))
            self.losses.add("import-softness", name)
        return tuple(found)

    def _terms(self, index: int) -> tuple[dict[str, float], float] | None:
        """Coefficients by joint, and offset, of a linear equality; None if it is no such equality."""
        model = self.model
        kind, data = model["eq_type"][index], model["eq_data"][index]
        if kind not in ("joint", "tendon") or any(data[2:5]):
            return None
        sides = []
        for element in (model["eq_obj1id"][index], model["eq_obj2id"][index]):
            terms: dict[str, float] = {}
            offset = 0.0
            wraps = [("joint", element, 1.0)] if kind == "joint" else self._wraps(element) if element >= 0 else []
            for what, joint, coefficient in wraps if element >= 0 else ():
                step = self.steps.get(joint)
                if what != "joint" or step is None or step.type not in _SCALAR:
                    return None
                terms[step.name] = terms.get(step.name, 0.0) + coefficient
                offset += coefficient * model["qpos0"][model["jnt_qposadr"][joint]]
            sides.append((terms, offset))
        (coefficients, offset), (others, other) = sides
        for name, value in others.items():
            coefficients[name] = coefficients.get(name, 0.0) - data[1] * value
        offset += data[0] - data[1] * other
        return {name: float(value) for name, value in coefficients.items() if value}, float(offset)

    def _lock(self, coefficients: Mapping[str, float], offset: float, stated: str) -> None:
        """A joint that an equality holds at a value."""
        if not coefficients:
            self.losses.add("import-redundant-equality", stated)
            return
        ((name, c),) = coefficients.items()
        value = offset / c
        (index,) = (i for i, joint in enumerate(self.joints) if joint.name == name)
        joint = self.joints[index]
        if stated == f"{name}/locked" and value:  # as an export writes equal limits
            kind = JointType.REVOLUTE if joint.type is JointType.CONTINUOUS else joint.type
            properties = replace(joint.properties, lower=(value,), upper=(value,))
            self.joints[index] = replace(joint, type=kind, properties=properties)
            return
        placement = joint.placement * joint_transform(joint, (value,))
        self.joints[index] = Joint(name, JointType.FIXED, joint.parent, joint.child, placement, joint.offset)
        self.losses.add("import-locked-joint", name, f"is fixed at {value:g}, where an equality holds it")

    def _mimic(self, coefficients: Mapping[str, float], offset: float) -> bool:
        """Make the first of two joints mimic the other; False if it cannot."""
        (follower, c), (leader, k) = coefficients.items()
        for index, joint in enumerate(self.joints):
            if joint.name == follower and joint.type in _SCALAR and joint.type is not JointType.HELICAL:
                self.joints[index] = replace(joint, mimic=Mimic(leader, -k / c, offset / c))
                return True
        return False

    # -- actuators --------------------------------------------------------------------------------------------------

    def _actuators(self) -> tuple[tuple[str, ...], dict[str, Motor]]:
        model = self.model
        groups: dict[str, list[tuple[int, int]]] = {}
        for index in range(len(model["actuator_trntype"])):
            stated = model.names["actuator"][index] or f"actuator {index}"
            joint = self._driven_joint(index, stated)
            step = None if joint is None else self.steps.get(joint)
            if joint is None or step is None:
                if joint is not None or model["actuator_trntype"][index] != "tendon":
                    self.losses.add("import-actuator", stated)
                continue
            mine = groups.setdefault(step.name, [])
            most = 3 if step.type is JointType.SPHERICAL else 6 if step.type is JointType.FLOATING else len(step.joints)
            alone = most == 1 or step.type is JointType.HELICAL
            if (mine and alone) or (joint in [each for _, each in mine] and self._kind(joint) != "ball"):
                self.losses.add("import-second-actuator", stated)
            else:
                mine.append((index, joint))
        motors: dict[str, Motor] = {}
        fixed = {joint.name for joint in self.joints if joint.type is JointType.FIXED or joint.mimic}
        actuated = []
        for name, group in groups.items():
            if name in fixed:
                for index, _ in group:
                    self.losses.add("import-actuator", model.names["actuator"][index] or f"actuator {index}")
                continue
            motor = self._motor(name, group)
            if motor is not None:
                motors[name] = motor
            actuated.append(name)
        return tuple(actuated), motors

    def _kind(self, joint: int) -> str:
        return str(self.model["jnt_type"][joint])

    def _driven_joint(self, index: int, stated: str) -> int | None:
        """The MuJoCo joint that an actuator drives, if it is one."""
        model = self.model
        kind, (element, *_) = model["actuator_trntype"][index], model["actuator_trnid"][index]
        if kind in ("joint", "jointinparent"):
            return int(element)
        if kind != "tendon":
            return None
        wraps = self._wraps(element)
        joints = [joint for what, joint, _ in wraps if what == "joint"]
        leaders = {self._leader(joint) for joint in joints}
        if not wraps or len(joints) < len(wraps) or len(leaders) != 1:
            self.losses.add("import-actuator", stated, "is left out: its tendon moves several joints independently")
            return None
        self.losses.add("import-tendon-actuator", stated)
        return leaders.pop()

    def _leader(self, joint: int) -> int:
        """The joint that moves a joint: at the end of a chain of equalities between two joints."""
        model, visited = self.model, {joint}
        found = True
        while found:
            found = False
            for index, kind in enumerate(model["eq_type"]):
                follower, leader = model["eq_obj1id"][index], model["eq_obj2id"][index]
                if kind == "joint" and model["eq_active0"][index] and follower == joint and leader >= 0:
                    if leader in visited:
                        return joint
                    visited.add(leader)
                    joint, found = leader, True
        return joint

    def _motor(self, name: str, group: Sequence[tuple[int, int]]) -> Motor | None:
        """Give a joint the gear and the effort limit of its actuators; its motor, if it says more than these."""
        model = self.model
        (at,) = (i for i, joint in enumerate(self.joints) if joint.name == name)
        joint = self.joints[at]
        nv = joint.coordinates.nv
        stated = [model.names["actuator"][index] for index, _ in group]
        shown = stated[0] or name
        if nv > 1 and all(each == f"{stated[0].removesuffix('_1')}_{i + 1}" for i, each in enumerate(stated)):
            shown = stated[0].removesuffix("_1")
        bounds = [self._bounds(index, shown) for index, _ in group]
        control = bounds[0] if len(set(bounds)) == 1 else None
        gear = float(model["actuator_gear"][group[0][0]][0])
        changes: dict[str, tuple[float, ...]] = {}
        if nv == 1 and gear not in (0.0, 1.0):
            changes["gear_ratio"] = (gear,)
        effort = joint.properties.effort
        if control is not None and not any(map(math.isfinite, effort)):
            largest = self._largest(control, shown)
            changes["effort"] = effort = (largest,) * nv
            self.losses.add(
                "import-effort-limit", name, f"is not stated: {largest:g}, the most of its actuator, is taken"
            )
        self.joints[at] = replace(joint, properties=replace(joint.properties, **changes))
        if control is not None and all(control == (-each, each) for each in effort):
            control = None
        return Motor(shown, control) if shown != name or control is not None else None

    def _bounds(self, index: int, shown: str) -> tuple[float, float] | None:
        """The range of the torque or force of an actuator on its joint; None if it has none."""
        model = self.model
        gear = float(model["actuator_gear"][index][0]) or 1.0
        if model["jnt_type"] and self._kind_of(index) in ("ball", "free"):
            gear = 1.0  # several numbers: the axis
        kinds = (model["actuator_gaintype"][index], model["actuator_biastype"][index], model["actuator_dyntype"][index])
        is_motor = kinds == ("fixed", "none", "none")
        limits = []
        if is_motor and model["actuator_ctrllimited"][index]:
            at = index if not model["actuator_ctrladr"] else model["actuator_ctrladr"][index]
            gain = float(model["actuator_gainprm"][index][0])
            limits.append(sorted(gain * each for each in model["actuator_ctrlrange"][at]))
        if not is_motor:
            self.losses.add("import-actuator-gain", shown)
        if model["actuator_forcelimited"][index]:
            limits.append(model["actuator_forcerange"][index])
        if not limits:
            return None
        lower, upper = sorted((gear * max(each[0] for each in limits), gear * min(each[1] for each in limits)))
        return lower, upper

    def _kind_of(self, index: int) -> str:
        model = self.model
        if model["actuator_trntype"][index] not in ("joint", "jointinparent"):
            return ""
        return self._kind(model["actuator_trnid"][index][0])

    # -- frames, configurations, the rest ---------------------------------------------------------------------------

    def _frames(self) -> tuple[Frame, ...]:
        """The sites with names, except the ends of closures, whose poses the closures state."""
        model = self.model
        ends: set[int] = set()
        for index, kind in enumerate(model["eq_objtype"]):
            if kind == "site":
                ends |= {model["eq_obj1id"][index], model["eq_obj2id"][index]}
        for tendon in range(len(model["tendon_adr"])):
            ends |= {site for what, site, _ in self._wraps(tendon) if what == "site"}
        taken = {body.name for body in (*self.bodies.values(), *self.extra)} | {joint.name for joint in self.joints}
        names = UniqueNames(self.losses, "universe", ROOT_JOINT, *taken, code="import-name")
        found = []
        for site, body in enumerate(model["site_bodyid"]):
            name = _usable(model.names["site"][site])
            if body not in self.bodies or site in ends:
                continue
            if not name:
                self.losses.add("import-frame", f"site {site} of {self.bodies[body].name}")
                continue
            pose = _pose(model["site_pos"][site], model["site_quat"][site])
            found.append(Frame(names.new(name), self.bodies[body].name, pose))
        return tuple(found)

    def _configurations(
        self, mechanism: Mechanism
    ) -> tuple[dict[str, Mapping[str, tuple[float, ...]]], tuple[str, Mapping[str, tuple[float, ...]]]]:
        """The keyframes that are within limits; and the configuration to assemble from."""
        model = self.model
        names = UniqueNames(self.losses, code="import-name")
        found: dict[str, Mapping[str, tuple[float, ...]]] = {}
        keys: dict[str, Mapping[str, tuple[float, ...]]] = {}
        for index, qpos in enumerate(model["key_qpos"]):
            name = names.new(_usable(model.names["key"][index]) or f"key_{index}")
            coordinates = self._at(qpos, mechanism)
            keys[name] = coordinates
            beyond = _beyond(mechanism, coordinates)
            if beyond:
                self.losses.add("import-configuration", name, f"is left out: '{beyond}' is beyond its limits")
            else:
                found[name] = coordinates
        for name in ("assembled", "home", *keys):
            if name in keys:
                return found, (f"keyframe '{name}'", keys[name])
        return found, ("the reference pose", self._at(model["qpos0"], mechanism))

    def _at(self, qpos: Sequence[float], mechanism: Mechanism) -> Mapping[str, tuple[float, ...]]:
        """The coordinates of all joints with some of their own at a configuration of MuJoCo."""
        found: dict[str, tuple[float, ...]] = {}
        if mechanism.root == "floating":
            (joint,) = self.joints_of[self.root_body]
            at = self.model["jnt_qposadr"][joint]
            found[ROOT_JOINT] = (*qpos[at : at + 3], *_xyzw(qpos[at + 3 : at + 7]))
        steps = {step.name: step for step in self.steps.values()}
        for joint_ in mechanism.joints:
            if joint_.name in steps and joint_.type is not JointType.FIXED and joint_.mimic is None:
                found[joint_.name] = self._coordinates(steps[joint_.name], qpos)
        return MappingProxyType(found)

    def _scenery(self) -> None:
        """Bodies that are not part of the robot."""
        left = [body for body in range(len(self.model["body_parentid"])) if body not in self.bodies]
        for body in left:
            geoms = [geom for geom, owner in enumerate(self.model["geom_bodyid"]) if owner == body]
            if body or geoms:
                self.losses.add(
                    "import-scenery", self.model.names["body"][body] or (f"body {body}" if body else _WORLD)
                )

    def _rest(self) -> None:
        """What the model has beside the robot."""
        model = self.model
        for each in model.left_out:
            self.losses.add(
                "import-mesh" if each.kind == "mesh" else "import-shape", each.name, f"is left out: {each.reason}"
            )
        equal = {
            (model["eq_obj1id"][i], model["eq_obj2id"][i])
            for i, kind in enumerate(model["eq_type"])
            if kind == "tendon"
        }
        used = {tendon for pair in equal for tendon in pair}
        kinds = zip(model["actuator_trntype"], model["actuator_trnid"], strict=True)
        used |= {ids[0] for kind, ids in kinds if kind == "tendon"}
        for tendon, name in enumerate(model.names["tendon"]):
            passive = any(
                any(_flat(model[f"tendon_{what}"][tendon]))
                for what in ("limited", "stiffness", "damping", "frictionloss")
            )
            if passive or tendon not in used:
                self.losses.add("import-tendon", name or f"tendon {tendon}")
        shown = [f"{count} {_COUNTED[name]}" for name, count in model.counts.items() if count]
        if shown:
            self.losses.add("import-simulation", self._name(), f"left out: {', '.join(shown)}")


#: Types whose one coordinate equalities and tendons relate.
_SCALAR = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.HELICAL)

#: By the types of the joints of a body, the ends of their names, and the joint that an export splits into them.
_EXPORTED: Mapping[tuple[str, ...], tuple[tuple[str, ...], JointType]] = {
    ("slide", "hinge"): (("_slide", "_turn"), JointType.CYLINDRICAL),
    ("hinge", "hinge"): (("_1", "_2"), JointType.UNIVERSAL),
    ("slide", "slide", "hinge"): (("_x", "_y", "_angle"), JointType.PLANAR),
    ("slide", "slide", "slide", "ball"): (("_x", "_y", "_z", "_ball"), JointType.FLOATING),
}

_COUNTED = {
    "nsensor": "sensors",
    "ncam": "cameras",
    "nlight": "lights",
    "npair": "contact pairs",
    "nexclude": "contact exclusions",
    "nflex": "flexible bodies",
    "nskin": "skins",
    "nhfield": "height fields",
    "nplugin": "plugins",
}


def _usable(name: str) -> str:
    """A name that a description can contain wherever it names something: ``x-`` begins user data there."""
    return f"_{name}" if name.startswith("x-") else name


def _beyond(mechanism: Mechanism, coordinates: Mapping[str, Sequence[float]]) -> str:
    """The first joint whose coordinates are beyond its limits; empty for none."""
    for joint in mechanism.joints:
        if joint.name not in coordinates or joint.coordinates.quaternion is not None:
            continue
        for value, lower, upper in zip(
            coordinates[joint.name], joint.properties.lower, joint.properties.upper, strict=True
        ):
            if not within_limits(value, lower, upper):
                return joint.name
    return ""


def _vector(values: Sequence[float]) -> Vector3:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _xyzw(wxyz: Sequence[float]) -> Quaternion:
    norm = math.hypot(*wxyz)
    w, x, y, z = (float(value) / norm for value in wxyz)
    return x, y, z, w


def _pose(xyz: Sequence[float], wxyz: Sequence[float]) -> Pose:
    return Pose(_vector(xyz), _xyzw(wxyz))


def _cross(a: Vector3, b: Vector3) -> Vector3:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _dot(a: Vector3, b: Vector3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _row(rows: Sequence[Any], index: int) -> Sequence[float]:
    """A row of an array that a release of MuJoCo may not have."""
    return _flat(rows[index]) if rows else ()


def _flat(value: Any) -> Sequence[float]:
    return value if isinstance(value, list) else (value,)


FORMAT = ImportFormat("mjcf", "MJCF, for MuJoCo", read, LOSSES)
