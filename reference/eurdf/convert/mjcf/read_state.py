"""What is read of an MJCF file so far, and values of a compiled model as those of a mechanism."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from eurdf.convert.import_format import ImportInput
from eurdf.convert.mjcf.compiled import Element, MjcfModel
from eurdf.convert.names import UniqueNames
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Root
from eurdf.mechanism.pose import IDENTITY, Pose, Quaternion, Vector3

WORLD = "world"


@dataclass(frozen=True, slots=True)
class WholeJoint:
    """A joint of the mechanism that one or several joints of a body are.

    Attributes:
        name: Its name.
        type: Its type.
        joints: The MuJoCo joints that it is, in order.
        anchor: Its origin in the body at qpos0, m.
        turn: Orientation of its frame in the body.
        axes: Of the joint, in its frame.
        pitch: Of a helical joint, m per revolution.
    """

    name: str
    type: JointType
    joints: tuple[Element, ...]
    anchor: Vector3 = (0.0, 0.0, 0.0)
    axes: tuple[Vector3, ...] = ()
    turn: Pose = IDENTITY
    pitch: float = 0.0


class MjcfReading:
    """A file while it is read.

    Attributes:
        given: The file, and the meshes to write.
        losses: What is lost.
        model: The compiled model.
        links: Names of links.
        joint_names: Names of joints.
        equalities: Names of closures and couplings.
        children: For each body, those that it carries.
        joints_of: For each body, its joints in MuJoCo.
        root: Whether the root floats.
        root_body: The body that is the root.
        bodies: Link of each body, by its index.
        extra: Links without mass between the joints of a body.
        joints: The joints of the mechanism, by name.
        whole: For each joint of MuJoCo, by its index, the joint of the mechanism that it is a part of.
        consumed: Indices of the equalities that are read.
    """

    def __init__(self, given: ImportInput, model: MjcfModel) -> None:
        self.given, self.losses, self.model = given, given.losses, model
        self.links = UniqueNames(self.losses, "universe")
        self.joint_names = UniqueNames(self.losses, "universe", ROOT_JOINT)
        self.equalities = UniqueNames(self.losses)
        self.children: dict[int, list[int]] = {body.index: [] for body in model["body"]}
        for body in model["body"][1:]:
            self.children[body.parentid].append(body.index)
        self.joints_of: dict[int, list[Element]] = {body.index: [] for body in model["body"]}
        for joint in model["jnt"]:
            self.joints_of[joint.bodyid].append(joint)
        self.root, self.root_body = self._root()
        self.bodies: dict[int, Body] = {}
        self.extra: list[Body] = []
        self.joints: dict[str, Joint] = {}
        self.whole: dict[int, WholeJoint] = {}
        self.consumed: set[int] = set()

    def new_name(self, names: UniqueNames, element: Element, kind: str, made: str) -> str:
        """The name of an element that needs one; made if it has none."""
        stated = usable(element.name)
        name = names.new(stated or made)
        if not stated or stated != element.name:
            self.losses.add("import-name", name_of(element, kind), f"becomes '{name}'")
        return name

    @property
    def name(self) -> str:
        """Name of the robot: that of the model, else of the file."""
        name = self.model.name
        return self.given.path.stem if name in ("", "MuJoCo Model") else name

    def _root(self) -> tuple[Root, int]:
        """Whether the root floats, and the body that it is."""
        model = self.model
        top = self.children[0]
        moving = [body for body in top if self._moves(body)]
        joined = {body for each in model["eq"] if each.type in ("connect", "weld") for body in self._bodies_of(each)}
        free = [body for body in moving if self.kinds(body) == ["free"]]
        if len(moving) == 1 and free and joined <= set(self.below(free[0])):
            return "floating", free[0]
        solid = {geom.type for geom in model["geom"] if geom.bodyid == 0}
        is_empty = 0 not in joined and solid <= {"plane"} and not any(site.bodyid == 0 for site in model["site"])
        if len(top) == 1 and is_empty and not self.kinds(top[0]) and self.pose_of(top[0]) == IDENTITY:
            return "fixed", top[0]
        return "fixed", 0

    def _moves(self, body: int) -> bool:
        """Whether a body or one below it has a joint."""
        return bool(self.joints_of[body]) or any(map(self._moves, self.children[body]))

    def kinds(self, body: int) -> list[str]:
        """Types of the joints of a body, as MuJoCo calls them."""
        return [joint.type for joint in self.joints_of[body]]

    def _bodies_of(self, equality: Element) -> list[int]:
        ends = equality.obj1id, equality.obj2id
        return [self.model["site"][end].bodyid for end in ends] if equality.objtype == "site" else list(ends)

    def below(self, body: int) -> list[int]:
        """A body and all that it carries, depth first."""
        found, stack = [], [body]
        while stack:
            body = stack.pop()
            found.append(body)
            stack += reversed(self.children[body])
        return found

    def pose_of(self, body: int) -> Pose:
        """Pose of a body in its parent at the reference configuration."""
        return pose_from(self.model["body"][body].pos, self.model["body"][body].quat)

    def wraps(self, tendon: int) -> Sequence[Element]:
        """What a tendon goes by: its type, the index ``objid`` of the element, and the coefficient ``prm``."""
        found = self.model["tendon"][tendon]
        return self.model["wrap"][found.adr : found.adr + found.num]

    def driven(self, actuator: Element) -> Element | None:
        """The joint that an actuator acts on, if it acts on a joint."""
        return self.model["jnt"][actuator.trnid[0]] if actuator.trntype in ("joint", "jointinparent") else None


class NoDirection(ValueError):  # noqa: N818 - named as the other refusals are
    """A quaternion or an axis has no direction, as MuJoCo makes of numbers that overflow."""


def must_have_direction(what: str, values: Sequence[float]) -> float:
    """The length of a quaternion or an axis.

    Raises:
        NoDirection: It is zero, or not finite.
    """
    length = math.hypot(*values)
    if not 0.0 < length < math.inf:
        shown = " ".join(f"{value:g}" for value in values)
        raise NoDirection(f"the {what} {shown}; its length must be finite, and not zero")
    return length


def name_of(element: Element, kind: str) -> str:
    """How a loss names an element of a kind."""
    return element.name or f"{kind} {element.index}"


def usable(name: str) -> str:
    """A name that a description can contain wherever it names something: ``x-`` begins user data there."""
    return f"_{name}" if name.startswith("x-") else name


def vector(values: Iterable[float]) -> Vector3:
    """Three numbers."""
    x, y, z = map(float, values)
    return x, y, z


def xyzw(wxyz: Sequence[float]) -> Quaternion:
    """The unit quaternion x y z w along one of MuJoCo, w x y z.

    Raises:
        NoDirection: Its length is zero, or not finite.
    """
    norm = must_have_direction("quaternion", wxyz)
    w, x, y, z = (float(value) / norm for value in wxyz)
    return x, y, z, w


def pose_from(xyz: Sequence[float], wxyz: Sequence[float]) -> Pose:
    """The pose of a position, m, and a quaternion of MuJoCo."""
    return Pose(vector(xyz), xyzw(wxyz))


def flat(value: Any) -> Sequence[float]:
    """A number, or some, as a sequence."""
    return value if isinstance(value, list) else (value,)
