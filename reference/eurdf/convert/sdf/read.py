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
    continuous_if_unlimited,
    loss_kinds,
    without_locks,
)
from eurdf.convert.losses import dropped, exact
from eurdf.convert.names import UniqueNames
from eurdf.convert.xml_elements import Elements, inside, named, read_root
from eurdf.mechanism.body import Body, Inertia, Shape
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.frame import Anchor, Frame
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, Root
from eurdf.mechanism.mimic import Mimic
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.mechanism.spanning_tree import depth_first
from eurdf.mesh_files.reader import RefusedFile

#: A limit beyond this is none: 1e16 is the default of SDFormat.
UNLIMITED = 1e15

#: Frames that a pose may refer to in turn.
DEPTH_LIMIT = 200

_WORLD = "world"

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
        "joint",
        "closes a loop: its limits, springs and losses are left out",
        "let another joint of the loop close it",
    ),
    "gearbox": dropped(
        "joint", "is a gearbox and is left out", "describe it by a coupling of the joints that it relates"
    ),
    "default-inertia": exact(
        "inertia",
        "is not stated: the link has the default of SDFormat, 1 kg and 1 kg·m²",
        "state the inertia",
    ),
    "ball-properties": dropped(
        "joint",
        "is a ball joint: the limits, springs and losses of its axis are left out",
        "state the losses in the description",
    ),
    "locked-joint": LOCKED,
    "mimic": dropped(
        "mimic joint",
        "is left out: one of the joints has several axes, or none",
        "describe the relation by a coupling",
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
    return _SdfReader(given, read_root(given.path)).read()


class _SdfReader:
    """A file while it is read."""

    def __init__(self, given: ImportInput, root: etree._Element) -> None:
        self.given, self.losses, self.elements = given, given.losses, Elements(given.path)
        if root.tag != "sdf":
            raise self.elements.refuse(root, f"the root element is {named(root)}; it must be <sdf>")
        self.model = self._only_model(root)
        self.links = {self._name(link): link for link in self.model.iterchildren("link")}
        if not self.links:
            raise self.elements.refuse(self.model, "the model has no link")
        self.joints = {self._name(joint): joint for joint in self.model.iterchildren("joint")}
        self.frames = {self._name(frame): frame for frame in self.model.iterchildren("frame")}
        for element in self.model.iterchildren("include", "model"):
            raise self.elements.refuse(element, f"{named(element)} is another model; merge the models into one first")
        #: Poses in the model.
        self.poses: dict[str, Pose] = {}
        self.names = UniqueNames(self.losses, "universe", ROOT_JOINT, code="import-name")

    def _only_model(self, root: etree._Element) -> etree._Element:
        models = list(root.iterchildren("model"))
        models += [model for world in root.iterchildren("world") for model in world.iterchildren("model")]
        if len(models) != 1:
            shown = ", ".join(f"'{model.get('name')}'" for model in models[:5]) or "none"
            raise self.elements.refuse(root, f"the file has {len(models)} models: {shown}; it must have one")
        return models[0]

    def _name(self, element: etree._Element) -> str:
        name = element.get("name")
        if not name:
            raise self.elements.refuse(element, f"{named(element)} has no name")
        return name

    # -- frames -----------------------------------------------------------------------------------------------------

    def _pose(self, element: etree._Element, default: str = "") -> tuple[Pose, str]:
        """The pose of an element, and the frame that it is in."""
        found = element.find("pose")
        if found is None or not (found.text or "").strip():
            return IDENTITY, default if found is None else found.get("relative_to") or default
        if found.get("rotation_format", "euler_rpy") != "euler_rpy" or found.get("degrees", "false") == "true":
            raise self.elements.refuse(found, "the pose must have roll, pitch and yaw in radians")
        x, y, z, roll, pitch, yaw = self.elements.numbers(found, found.text, 6, "the pose")
        return Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw)), found.get("relative_to") or default

    def _in_model(self, name: str, element: etree._Element, seen: tuple[str, ...] = ()) -> Pose:
        """The pose of a link, joint or frame in the model."""
        if name in ("", "__model__"):
            return IDENTITY
        if name in self.poses:
            return self.poses[name]
        if len(seen) > DEPTH_LIMIT:
            raise self.elements.refuse(
                element, f"the pose of '{seen[0]}' refers to more than {DEPTH_LIMIT} others in turn"
            )
        if name in seen:
            raise self.elements.refuse(element, f"poses refer to each other in a circle: {' -> '.join((*seen, name))}")
        if name in self.links:
            found, base = self._pose(self.links[name])
        elif name in self.joints:
            joint = self.joints[name]
            found, base = self._pose(joint, _text(joint, "child"))
        elif name in self.frames:
            frame = self.frames[name]
            found, base = self._pose(frame, frame.get("attached_to", ""))
        else:
            raise self.elements.refuse(element, f"there is no link, joint or frame '{name}'")
        pose = self.poses[name] = self._in_model(base, element, (*seen, name)) * found
        return pose

    def _in_link(self, link: str, element: etree._Element) -> Pose:
        """The pose of an element of a link in the link."""
        pose, frame = self._pose(element)
        if not frame:
            return pose
        return self._in_model(link, element).inverse() * self._in_model(frame, element) * pose

    def _link_of(self, name: str, element: etree._Element, seen: tuple[str, ...] = ()) -> str:
        """The link that a link, joint or frame is fixed to."""
        if name in self.links or name == _WORLD:
            return name
        if len(seen) > DEPTH_LIMIT:
            raise self.elements.refuse(element, f"'{seen[0]}' is attached to more than {DEPTH_LIMIT} others in turn")
        if name in seen:
            raise self.elements.refuse(element, f"frames are attached in a circle: {' -> '.join((*seen, name))}")
        if name in ("", "__model__"):
            return self._canonical()
        if name in self.frames:
            return self._link_of(self.frames[name].get("attached_to", ""), element, (*seen, name))
        if name in self.joints:
            return self._link_of(_text(self.joints[name], "child"), element, (*seen, name))
        raise self.elements.refuse(element, f"there is no link, joint or frame '{name}'")

    def _canonical(self) -> str:
        return self.model.get("canonical_link") or next(iter(self.links))

    # -- the tree ---------------------------------------------------------------------------------------------------

    def read(self) -> RobotRead:
        """Read all parts of the robot."""
        for name, link in self.links.items():
            self._in_model(name, link)
        joints = [self._joint(name, element) for name, element in self.joints.items()]
        tree, loops = self._spanning_tree([joint for joint in joints if joint.type != _GEARBOX])
        root_link, root = self._root(tree)
        bodies = {name: self._body(name, link) for name, link in self.links.items()}
        placed, _ = self._pose(self.model)
        base = placed
        if root_link == _WORLD:
            bodies[_WORLD] = Body(_WORLD)
            base = IDENTITY
        built = [self._tree_joint(joint, placed) for joint in tree if joint.parent in bodies and joint.child in bodies]
        built = self._with_mimics(built)
        ordered = depth_first(root_link, built)
        reached = {root_link, *(joint.child for joint in ordered)}
        if missing := [name for name in bodies if name not in reached]:
            shown = ", ".join(f"'{name}'" for name in missing[:5])
            raise self.elements.refuse(
                self.model, f"no chain of joints leads from '{root_link}' to the links {shown}; join them as children"
            )
        closures = tuple(closure for joint in loops if (closure := self._closure(joint)) is not None)
        mechanism = Mechanism(
            self.model.get("name") or self.given.path.stem,
            "",
            root,
            (bodies[root_link], *(bodies[joint.child] for joint in ordered)),
            tuple(ordered),
            self._frames(set(bodies) | {joint.name for joint in ordered}),
            closures,
        )
        self._rest()
        start: dict[str, tuple[float, ...]] = {}
        if root == "floating":
            pose = base * self._in_model(root_link, self.model)
            start[ROOT_JOINT] = (*pose.xyz, *pose.quaternion)
        return RobotRead(mechanism, (self.given.path,), ("the pose of the links", MappingProxyType(start)))

    def _joint(self, name: str, element: etree._Element) -> _SdfJoint:
        kind = element.get("type", "")
        if kind not in _TYPES and kind != _GEARBOX:
            raise self.elements.refuse(element, f"joint '{name}' has the type '{kind}', which SDFormat does not have")
        if kind == _GEARBOX:
            self.losses.add("import-gearbox", name)
        parent, child = (self._link_of(_text(element, tag), element) for tag in ("parent", "child"))
        in_model = self._in_model(name, element)
        in_child = in_model if child == _WORLD else self._in_model(child, element).inverse() * in_model
        own = element.find("pose")
        if own is None and _text(element, "child") == child:
            in_child = IDENTITY
        elif own is not None and not own.get("relative_to") and _text(element, "child") == child:
            in_child, _ = self._pose(element)
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
            is_loop = _is_true(joint.element, "physics/simbody/must_be_loop_joint")
            if is_loop or joint.child in tree or at in above or joint.child == _WORLD:
                loops.append(joint)
            else:
                tree[joint.child] = joint
        return list(tree.values()), loops

    def _root(self, tree: Sequence[_SdfJoint]) -> tuple[str, Root]:
        """The root link, and whether it is fixed."""
        to_world = [joint for joint in tree if joint.parent == _WORLD]
        hanging = {joint.child for joint in tree}
        if to_world:
            (first, *others) = to_world
            placed, _ = self._pose(self.model)
            if first.type == "fixed" and not others and placed * self._in_model(first.child, first.element) == IDENTITY:
                return first.child, "fixed"
            return _WORLD, "fixed"
        free = [name for name in self.links if name not in hanging]
        root = self._canonical() if self._canonical() in free else free[0]
        static = _is_true(self.model, "static")
        return root, "fixed" if static else "floating"

    def _tree_joint(self, joint: _SdfJoint, placed: Pose) -> Joint:
        parent = IDENTITY if joint.parent == _WORLD else placed * self._in_model(joint.parent, joint.element)
        child = placed * self._in_model(joint.child, joint.element)
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
                raise self.elements.refuse(joint.element, f"joint '{joint.name}' has no <{tag}>")
            xyz = axis.find("xyz")
            x, y, z = (0.0, 0.0, 1.0)
            if xyz is not None:
                x, y, z = self.elements.numbers(xyz, xyz.text, 3, f"<xyz> of <{tag}>")
            if not any((x, y, z)):
                raise self.elements.refuse(joint.element, f"an axis of joint '{joint.name}' is zero")
            frame = None if xyz is None else xyz.get("expressed_in")
            in_model = _is_true(axis, "use_parent_model_frame")
            vector: Vector3 = (x, y, z)
            if frame or in_model:
                here = self._in_model(joint.child, joint.element) * joint.in_child
                there = self._in_model(frame, joint.element) if frame else IDENTITY
                vector = here.inverse().rotate(there.rotate(vector))
            found.append(vector)
        return tuple(found)

    def _pitch(self, joint: _SdfJoint) -> float:
        stated, older = joint.element.find("screw_thread_pitch"), joint.element.find("thread_pitch")
        if stated is not None:
            (pitch,) = self.elements.numbers(stated, stated.text, 1, "the pitch")
        elif older is not None:
            (turns,) = self.elements.numbers(older, older.text, 1, "the pitch")
            pitch = -2.0 * math.pi / turns if turns else 0.0
        else:
            pitch = -2.0 * math.pi  # the default of thread_pitch is 1 rad/m
        if not pitch:
            raise self.elements.refuse(joint.element, f"the pitch of screw joint '{joint.name}' is 0")
        return pitch

    def _number(self, element: etree._Element | None, path: str, default: float, *, infinite: bool = False) -> float:
        """The number of an element; infinite ones only where they mean no limit."""
        found = None if element is None else element.find(path)
        if found is None or not (found.text or "").strip():
            return default
        text = (found.text or "").strip()
        if infinite and text.lstrip("+-").lower() in ("inf", "infinity"):
            return -math.inf if text.startswith("-") else math.inf
        return self.elements.numbers(found, text, 1, f"<{found.tag}>")[0]

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
            return tuple(self._number(axis, path, default, infinite=infinite) for axis in axes)

        lower = tuple(value if value > -UNLIMITED else -math.inf for value in each("limit/lower", -math.inf))
        upper = tuple(value if value < UNLIMITED else math.inf for value in each("limit/upper", math.inf))
        if joint.type == "continuous":
            lower, upper = (-math.inf,), (math.inf,)
        for low, high in zip(lower, upper, strict=True):
            if low > high:
                raise self.elements.refuse(
                    joint.element, f"joint '{joint.name}': the lower limit is above the upper one"
                )
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
            element = self.joints.get(joint.name)
            mimics = [] if element is None else list(element.iter("mimic"))
            for mimic in mimics:
                leader = mimic.get("joint", "")
                factor = self._number(mimic, "multiplier", 1.0)
                offset = self._number(mimic, "offset", 0.0) - factor * self._number(mimic, "reference", 0.0)
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
        if _WORLD in (joint.parent, joint.child) or kind not in _CLOSING:
            self.losses.add("import-loop", joint.name)
            return None
        parent, child = (self._in_model(name, joint.element) for name in (joint.parent, joint.child))
        a = Anchor(joint.parent, parent.inverse() * child * joint.in_child)
        b = Anchor(joint.child, joint.in_child)
        has = [path for path in ("axis/limit", "axis/dynamics", "axis/mimic") if joint.element.find(path) is not None]
        if has:
            self.losses.add("import-loop-properties", joint.name)
        name = self.names.new(joint.name)
        if kind is JointType.SPHERICAL:
            return PointClosure(name, a, b)
        if kind is JointType.FIXED:
            return FrameClosure(name, a, b)
        (axis,) = self._axes(joint, IDENTITY)
        return HingeClosure(name, a, b, (axis, axis))

    # -- links ------------------------------------------------------------------------------------------------------

    def _body(self, name: str, link: etree._Element) -> Body:
        visuals, collisions = (
            tuple(shape for element in link.iterchildren(use) if (shape := self._shape(element, name)) is not None)
            for use in ("visual", "collision")
        )
        return Body(name, self._inertia(name, link), visuals, collisions)

    def _inertia(self, name: str, link: etree._Element) -> Inertia:
        inertial = link.find("inertial")
        if inertial is None:
            self.losses.add("import-default-inertia", name)
            return Inertia(1.0, IDENTITY, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0))
        pose = self._in_link(name, inertial)
        xx, yy, zz = (self._number(inertial, f"inertia/{key}", 1.0) for key in ("ixx", "iyy", "izz"))
        xy, xz, yz = (self._number(inertial, f"inertia/{key}", 0.0) for key in ("ixy", "ixz", "iyz"))
        return Inertia(self._number(inertial, "mass", 1.0), pose, (xx, xy, xz, yy, yz, zz))

    def _shape(self, element: etree._Element, link: str) -> Shape | None:
        pose = self._in_link(link, element)
        geometry = element.find("geometry")
        shapes = [] if geometry is None else [child for child in geometry if isinstance(child.tag, str)]
        color = self._color(element)
        shown = f"{element.get('name', element.tag)} of {link}"
        for shape in shapes:
            match shape.tag:
                case "box":
                    size = self.elements.numbers(shape, shape.findtext("size"), 3, "<size>")
                    return Shape("box", size, pose, color=color)
                case "sphere":
                    return Shape("sphere", (self._number(shape, "radius", 1.0),), pose, color=color)
                case "cylinder" | "capsule":
                    size = self._number(shape, "radius", 1.0), self._number(shape, "length", 1.0)
                    return Shape("cylinder" if shape.tag == "cylinder" else "capsule", size, pose, color=color)
                case "mesh":
                    return self._mesh(shape, pose, color)
            self.losses.add("import-shape", shown, f"is left out: URDF has no shape of type {shape.tag}")
        return None

    def _mesh(self, mesh: etree._Element, pose: Pose, color: tuple[float, float, float, float] | None) -> Shape | None:
        uri = (mesh.findtext("uri") or "").strip()
        found = self.given.finder.find(uri) if uri else None
        if found is None:
            self.losses.add("import-mesh", uri)
            return None
        try:
            copy = self.given.copy(found)
        except RefusedFile as reason:
            self.losses.add("import-mesh", uri, f"is left out: {reason}")
            return None
        scale = (1.0, 1.0, 1.0)
        if mesh.find("scale") is not None:
            x, y, z = self.elements.numbers(mesh, mesh.findtext("scale"), 3, "<scale>")
            scale = x, y, z
        return Shape("mesh", scale, pose, copy, color)

    def _color(self, element: etree._Element) -> tuple[float, float, float, float] | None:
        material = element.find("material")
        if material is None:
            return None
        if material.find("script") is not None or material.find(".//albedo_map") is not None:
            self.losses.add("import-texture", element.get("name", ""))
        for tag in ("diffuse", "ambient"):
            found = material.find(tag)
            if found is not None:
                words = (found.text or "").split()
                text = " ".join([*words, "1"] if len(words) == 3 else words)
                red, green, blue, alpha = self.elements.numbers(found, text, 4, f"<{tag}>")
                return red, green, blue, alpha
        return None

    # -- the rest ---------------------------------------------------------------------------------------------------

    def _frames(self, taken: set[str]) -> tuple[Frame, ...]:
        found = []
        for name, element in self.frames.items():
            link = self._link_of(name, element)
            pose = self._in_model(link, element).inverse() * self._in_model(name, element)
            own = element.find("pose")
            if element.get("attached_to") == link and (own is None or not own.get("relative_to")):
                pose, _ = self._pose(element)
            shown = name
            while shown in taken:
                shown += "_"
                self.losses.add("import-name", name, f"becomes '{shown}'")
            taken.add(shown)
            found.append(Frame(shown, link, pose))
        return tuple(found)

    def _rest(self) -> None:
        counts = {tag: sum(1 for _ in self.model.iter(tag)) for tag in _SIMULATION}
        shown = [f"{count} {tag}" for tag, count in counts.items() if count]
        surfaces = sum(1 for _ in self.model.iter("surface"))
        if surfaces:
            shown.append(f"{surfaces} contact surfaces")
        if shown:
            self.losses.add("import-simulation", self.model.get("name") or "", f"left out: {', '.join(shown)}")


_CLOSING = (JointType.SPHERICAL, JointType.FIXED, JointType.REVOLUTE, JointType.CONTINUOUS)


def _text(element: etree._Element, path: str) -> str:
    return (element.findtext(path) or "").strip()


def _is_true(element: etree._Element, path: str) -> bool:
    return _text(element, path) in ("true", "1")


FORMAT = ImportFormat("sdf", read, loss_kinds(_LOSSES))
