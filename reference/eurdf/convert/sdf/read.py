"""SDFormat, the format of Gazebo.

Facts of SDFormat that the importer relies on (its specification, versions 1.6 to 1.12): the pose of a link is in the
frame of the model, that of a joint in its child, unless ``relative_to`` names another frame; coordinates of joints are
zero where the links are placed; an axis is in the frame of the joint, unless ``expressed_in`` or (before 1.7)
``use_parent_model_frame`` says otherwise; ``screw_thread_pitch`` is in m per revolution, right-handed, and the older
``thread_pitch`` in rad/m, left-handed; the position of a mimic joint is multiplier · (leader - reference) + offset; a
link without inertia has 1 kg and 1 kg·m².
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from lxml import etree

from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.convert.import_format import (
    LOCKED,
    SIMULATION,
    TEXTURE,
    ImportFormat,
    ImportInput,
    RobotRead,
    loss_kinds,
)
from eurdf.convert.losses import dropped, exact
from eurdf.convert.names import UniqueNames
from eurdf.convert.sdf.read_model import WORLD, SdfModel, is_true, read_body, text_of
from eurdf.convert.steps import continuous_if_unlimited, without_locks
from eurdf.convert.xml_elements import inside, read_root
from eurdf.mechanism.body import Anchor, Body, Frame
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint, JointProperties, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, Root
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.mechanism.spanning_tree import depth_first

#: A limit beyond this is none: 1e16 is the default of SDFormat.
UNLIMITED = 1e15

#: Joints that have no equal here.
_GEARBOX = "gearbox"

_TYPES: Mapping[str, JointType] = {
    "revolute": JointType.REVOLUTE,
    "continuous": JointType.CONTINUOUS,
    "prismatic": JointType.PRISMATIC,
    "fixed": JointType.FIXED,
    "ball": JointType.SPHERICAL,
    "universal": JointType.UNIVERSAL,
    "revolute2": JointType.UNIVERSAL,
    "screw": JointType.HELICAL,
}

#: Elements of a model, a link and a joint that are no part of a description.
_SIMULATION = ("plugin", "sensor", "light", "particle_emitter", "projector", "audio_source", "gripper", "battery")

_LOSSES = {
    "loop": dropped(
        "joint",
        "closes a loop and is left out: loops are closed by ball, fixed and revolute joints",
        "let another joint of the loop close it",
    ),
    "loop-properties": dropped(
        "joint", "closes a loop: its limits, springs and losses are left out", "let another joint of the loop close it"
    ),
    "gearbox": dropped(
        "joint", "is a gearbox and is left out", "describe it by a coupling of the joints that it relates"
    ),
    "default-inertia": exact(
        "inertia", "is not stated: the link has the default of SDFormat, 1 kg and 1 kg·m²", "state the inertia"
    ),
    "ball-properties": dropped(
        "joint",
        "is a ball joint: the limits, springs and losses of its axis are left out",
        "state the losses in the description",
    ),
    "locked-joint": LOCKED,
    "mimic": dropped(
        "mimic joint", "is left out: one of the joints has several axes, or none", "describe the relation by a coupling"
    ),
    "shape": dropped(
        "shape", "is left out: URDF has no such shape", "replace it by boxes, spheres, capsules, cylinders or a mesh"
    ),
    "mesh": dropped(
        "mesh",
        "is left out: its file was not found, or is refused",
        "correct its uri, or name the folder of the file with --within (within= in Python)",
    ),
    "texture": TEXTURE,
    "simulation": SIMULATION,
}


@dataclass(frozen=True, slots=True)
class _SdfJoint:
    """A joint as written, with what it joins.

    Attributes:
        element: The element.
        name: Its name.
        type: As written.
        parent: Name of the link, or of the world.
        child: Likewise.
        in_child: Pose of the joint in its child.
    """

    element: etree._Element
    name: str
    type: str
    parent: str
    child: str
    in_child: Pose


def read(given: ImportInput) -> RobotRead:
    """Read an SDFormat file with one model.

    Raises:
        CannotImport: It is not such a file, has an error, or its links do not hang together.
    """
    inside(given.path, given.path.resolve(), given.folders)
    return _SdfReader(SdfModel(given, read_root(given.path))).read()


class _SdfReader:
    """The robot of a model while it is read."""

    def __init__(self, model: SdfModel) -> None:
        self.model, self.losses = model, model.losses
        self.names = UniqueNames(self.losses, "universe", ROOT_JOINT)

    def read(self) -> RobotRead:
        """Read all parts of the robot."""
        for name, link in self.model.links.items():
            self.model.in_model(name, link)
        joints = [self._joint(name, element) for name, element in self.model.joints.items()]
        tree, loops = self._spanning_tree([joint for joint in joints if joint.type != _GEARBOX])
        root_link, root = self._root(tree)
        bodies = {name: read_body(self.model, name, link) for name, link in self.model.links.items()}
        placed, _ = self.model.pose(self.model.element)
        base = placed
        if root_link == WORLD:
            bodies[WORLD] = Body(WORLD)
            base = IDENTITY
        built = [self._tree_joint(joint, placed) for joint in tree if joint.parent in bodies and joint.child in bodies]
        built = self._with_mimics(built)
        ordered = depth_first(root_link, built)
        reached = {root_link, *(joint.child for joint in ordered)}
        if missing := [name for name in bodies if name not in reached]:
            shown = ", ".join(f"'{name}'" for name in missing[:5])
            raise self.model.refuse(
                self.model.element,
                f"no chain of joints leads from '{root_link}' to the links {shown}; join them as children",
            )
        closures = tuple(closure for joint in loops if (closure := self._closure(joint)) is not None)
        mechanism = Mechanism(
            self.model.element.get("name") or self.model.given.path.stem,
            "",
            root,
            (bodies[root_link], *(bodies[joint.child] for joint in ordered)),
            tuple(ordered),
            self._frames(*bodies, *(joint.name for joint in ordered)),
            closures,
        )
        self._rest()
        start: dict[str, tuple[float, ...]] = {}
        if root == "floating":
            pose = base * self.model.in_model(root_link, self.model.element)
            start[ROOT_JOINT] = (*pose.xyz, *pose.quaternion)
        return RobotRead(mechanism, (self.model.given.path,), ("the pose of the links", MappingProxyType(start)))

    def _joint(self, name: str, element: etree._Element) -> _SdfJoint:
        kind = element.get("type", "")
        if kind not in _TYPES and kind != _GEARBOX:
            raise self.model.refuse(element, f"joint '{name}' has the type '{kind}', which SDFormat does not have")
        if kind == _GEARBOX:
            self.losses.add("import-gearbox", name)
        parent, child = (self.model.link_of(text_of(element, tag), element) for tag in ("parent", "child"))
        in_model = self.model.in_model(name, element)
        in_child = in_model if child == WORLD else self.model.in_model(child, element).inverse() * in_model
        own = element.find("pose")
        if own is None and text_of(element, "child") == child:
            in_child = IDENTITY
        elif own is not None and not own.get("relative_to") and text_of(element, "child") == child:
            in_child, _ = self.model.pose(element)
        return _SdfJoint(element, name, kind, parent, child, in_child)

    def _spanning_tree(self, joints: Sequence[_SdfJoint]) -> tuple[list[_SdfJoint], list[_SdfJoint]]:
        """The joints of the spanning tree, and those that close loops: a link hangs from the first joint that may."""
        tree: dict[str, _SdfJoint] = {}
        loops = []
        for joint in joints:
            above = {joint.child}
            at = joint.parent
            while at in tree and at not in above:
                above.add(at)
                at = tree[at].parent
            is_loop = is_true(joint.element, "physics/simbody/must_be_loop_joint")
            if is_loop or joint.child in tree or at in above or joint.child == WORLD:
                loops.append(joint)
            else:
                tree[joint.child] = joint
        return list(tree.values()), loops

    def _root(self, tree: Sequence[_SdfJoint]) -> tuple[str, Root]:
        """The root link, and whether it is fixed."""
        to_world = [joint for joint in tree if joint.parent == WORLD]
        hanging = {joint.child for joint in tree}
        if to_world:
            (first, *others) = to_world
            placed, _ = self.model.pose(self.model.element)
            at = placed * self.model.in_model(first.child, first.element)
            if first.type == "fixed" and not others and at == IDENTITY:
                return first.child, "fixed"
            return WORLD, "fixed"
        free = [name for name in self.model.links if name not in hanging]
        root = self.model.canonical() if self.model.canonical() in free else free[0]
        static = is_true(self.model.element, "static")
        return root, "fixed" if static else "floating"

    def _tree_joint(self, joint: _SdfJoint, placed: Pose) -> Joint:
        parent = IDENTITY if joint.parent == WORLD else placed * self.model.in_model(joint.parent, joint.element)
        child = placed * self.model.in_model(joint.child, joint.element)
        kind = _TYPES[joint.type]
        axes = self._axes(joint, placed)
        name = self.names.new(joint.name)
        if kind is JointType.FIXED:
            return Joint(name, kind, joint.parent, joint.child, parent.inverse() * child)
        placement = parent.inverse() * child * joint.in_child
        offset = joint.in_child.inverse() if joint.in_child != IDENTITY else IDENTITY
        pitch = self._pitch(joint) if kind is JointType.HELICAL else 0.0
        properties = self._properties(joint, kind)
        found = Joint(name, kind, joint.parent, joint.child, placement, offset, axes, pitch, properties)
        return continuous_if_unlimited(without_locks(found, self.losses))

    def _axes(self, joint: _SdfJoint, placed: Pose) -> tuple[Vector3, ...]:
        """The axes of a joint, in its frame."""
        kind = _TYPES[joint.type]
        tags = {JointType.FIXED: (), JointType.SPHERICAL: (), JointType.UNIVERSAL: ("axis", "axis2")}.get(
            kind, ("axis",)
        )
        found = []
        for tag in tags:
            axis = joint.element.find(tag)
            if axis is None:
                raise self.model.refuse(joint.element, f"joint '{joint.name}' has no <{tag}>")
            xyz = axis.find("xyz")
            x, y, z = (0.0, 0.0, 1.0)
            if xyz is not None:
                x, y, z = self.model.elements.numbers(xyz, xyz.text, 3, f"<xyz> of <{tag}>")
            if not any((x, y, z)):
                raise self.model.refuse(joint.element, f"an axis of joint '{joint.name}' is zero")
            frame = None if xyz is None else xyz.get("expressed_in")
            in_model = is_true(axis, "use_parent_model_frame")
            vector: Vector3 = (x, y, z)
            if frame or in_model:
                here = self.model.in_model(joint.child, joint.element) * joint.in_child
                there = self.model.in_model(frame, joint.element) if frame else IDENTITY
                vector = here.inverse().rotate(there.rotate(vector))
            found.append(vector)
        return tuple(found)

    def _pitch(self, joint: _SdfJoint) -> float:
        stated, older = joint.element.find("screw_thread_pitch"), joint.element.find("thread_pitch")
        if stated is not None:
            (pitch,) = self.model.elements.numbers(stated, stated.text, 1, "the pitch")
        elif older is not None:
            (turns,) = self.model.elements.numbers(older, older.text, 1, "the pitch")
            pitch = -2.0 * math.pi / turns if turns else 0.0
        else:
            pitch = -2.0 * math.pi  # the default of thread_pitch is 1 rad/m
        if not pitch:
            raise self.model.refuse(joint.element, f"the pitch of screw joint '{joint.name}' is 0")
        return pitch

    def _properties(self, joint: _SdfJoint, kind: JointType) -> JointProperties:
        free = JointProperties.unlimited(kind)
        axes = [joint.element.find(tag) for tag in ("axis", "axis2")[: kind.nv]]
        if kind is JointType.SPHERICAL:
            if any(
                axis is not None and (axis.find("limit") is not None or axis.find("dynamics") is not None)
                for axis in axes
            ):
                self.losses.add("import-ball-properties", joint.name)
            return free

        def each(path: str, default: float) -> tuple[float, ...]:
            infinite = path.startswith("limit/")
            return tuple(self.model.number(axis, path, default, infinite=infinite) for axis in axes)

        lower = tuple(value if value > -UNLIMITED else -math.inf for value in each("limit/lower", -math.inf))
        upper = tuple(value if value < UNLIMITED else math.inf for value in each("limit/upper", math.inf))
        if joint.type == "continuous":
            lower, upper = (-math.inf,), (math.inf,)
        for low, high in zip(lower, upper, strict=True):
            if low > high:
                raise self.model.refuse(joint.element, f"joint '{joint.name}': the lower limit is above the upper one")
        found: dict[str, Any] = {"lower": lower, "upper": upper}
        for name in ("effort", "velocity"):  # a negative one is none
            values = each(f"limit/{name}", -1.0)
            found[name] = tuple(value if 0.0 <= value < UNLIMITED else math.inf for value in values)
        for name in ("damping", "friction"):
            found[name] = each(f"dynamics/{name}", 0.0)
        stiffness = each("dynamics/spring_stiffness", 0.0)
        if any(stiffness):
            found |= {"stiffness": stiffness, "rest": each("dynamics/spring_reference", 0.0)}
        return replace(free, **found)

    def _with_mimics(self, joints: Sequence[Joint]) -> list[Joint]:
        """The joints, each that mimics another with its leader."""
        axial = {joint.name for joint in joints if joint.type.is_axial}
        found = []
        for joint in joints:
            element = self.model.joints.get(joint.name)
            mimics = [] if element is None else list(element.iter("mimic"))
            for mimic in mimics:
                leader = mimic.get("joint", "")
                factor = self.model.number(mimic, "multiplier", 1.0)
                offset = self.model.number(mimic, "offset", 0.0) - factor * self.model.number(mimic, "reference", 0.0)
                if leader in axial and joint.name in axial and len(mimics) == 1:
                    joint = replace(joint, mimic=Mimic(leader, factor, offset))
                else:
                    self.losses.add("import-mimic", joint.name)
            found.append(joint)
        return found

    # -- closures ---------------------------------------------------------------------------------------------------

    def _closure(self, joint: _SdfJoint) -> Closure | None:
        """The closure that a joint is whose child hangs from another joint."""
        kind = _TYPES[joint.type]
        closing = (JointType.SPHERICAL, JointType.FIXED, JointType.REVOLUTE, JointType.CONTINUOUS)
        if WORLD in (joint.parent, joint.child) or kind not in closing:
            self.losses.add("import-loop", joint.name)
            return None
        parent, child = (self.model.in_model(name, joint.element) for name in (joint.parent, joint.child))
        a = Anchor(joint.parent, parent.inverse() * child * joint.in_child)
        b = Anchor(joint.child, joint.in_child)
        if any(joint.element.find(f"axis/{tag}") is not None for tag in ("limit", "dynamics", "mimic")):
            self.losses.add("import-loop-properties", joint.name)
        name = self.names.new(joint.name)
        if kind is JointType.SPHERICAL:
            return PointClosure(name, a, b)
        if kind is JointType.FIXED:
            return FrameClosure(name, a, b)
        (axis,) = self._axes(joint, IDENTITY)
        return HingeClosure(name, a, b, (axis, axis))

    # -- the rest ---------------------------------------------------------------------------------------------------

    def _frames(self, *taken: str) -> tuple[Frame, ...]:
        names, found = UniqueNames(self.losses, *taken), []
        for name, element in self.model.frames.items():
            link = self.model.link_of(name, element)
            pose = self.model.in_model(link, element).inverse() * self.model.in_model(name, element)
            own = element.find("pose")
            if element.get("attached_to") == link and (own is None or not own.get("relative_to")):
                pose, _ = self.model.pose(element)
            found.append(Frame(names.new(name), link, pose))
        return tuple(found)

    def _rest(self) -> None:
        counts = {tag: sum(1 for _ in self.model.element.iter(tag)) for tag in _SIMULATION}
        shown = [f"{count} {tag}" for tag, count in counts.items() if count]
        surfaces = sum(1 for _ in self.model.element.iter("surface"))
        if surfaces:
            shown.append(f"{surfaces} contact surfaces")
        if shown:
            self.losses.add("import-simulation", self.model.element.get("name") or "", f"left out: {', '.join(shown)}")


FORMAT = ImportFormat(read, loss_kinds(_LOSSES))
