"""What is read of a model so far."""

from __future__ import annotations

from pathlib import Path

from eurdf.convert.losses import Losses
from eurdf.convert.names import UniqueNames
from eurdf.importing.mesh_copies import MeshCopies
from eurdf.importing.mjcf.losses import LOSSES
from eurdf.importing.mjcf.model import MjcfModel
from eurdf.importing.mjcf.step import Step
from eurdf.importing.mjcf.values import pose_from
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import ROOT_JOINT, Root
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.mesh_files.folders import Folders

WORLD = "world"


class MjcfReading:
    """A file while it is read.

    Attributes:
        model: The compiled model.
        path: The file.
        losses: What is lost.
        copies: Files of meshes to write.
        links: Names of links.
        joint_names: Names of joints.
        equalities: Names of closures and couplings.
        children: For each body, those that it carries.
        joints_of: For each body, its joints in MuJoCo.
        root: Whether the root floats.
        root_body: The body that is the root.
        bodies: Link of each body.
        extra: Links without mass between the joints of a body.
        joints: The joints of the mechanism.
        steps: For each joint of MuJoCo, the joint of the mechanism that it is a part of.
        consumed: Indices of the equalities that are read.
    """

    def __init__(self, model: MjcfModel, path: Path, folders: Folders) -> None:
        self.model, self.path = model, path
        self.losses = Losses(LOSSES)
        self.copies = MeshCopies(folders, self.losses)
        self.links = UniqueNames(self.losses, "universe", code="import-name")
        self.joint_names = UniqueNames(self.losses, "universe", ROOT_JOINT, code="import-name")
        self.children: dict[int, list[int]] = {}
        for body, parent in enumerate(model["body_parentid"][1:], 1):
            self.children.setdefault(parent, []).append(body)
        self.joints_of: dict[int, list[int]] = {}
        for joint, body in enumerate(model["jnt_bodyid"]):
            self.joints_of.setdefault(body, []).append(joint)
        self.root, self.root_body = self._root()
        self.bodies: dict[int, Body] = {}
        self.extra: list[Body] = []
        self.joints: list[Joint] = []
        self.steps: dict[int, Step] = {}
        self.consumed: set[int] = set()
        self.equalities = UniqueNames(self.losses, code="import-name")

    @property
    def name(self) -> str:
        """Name of the robot: that of the model, else of the file."""
        name = self.model.name
        return self.path.stem if name in ("", "MuJoCo Model") else name

    def _root(self) -> tuple[Root, int]:
        """Whether the root floats, and the body that it is."""
        model = self.model
        top = self.children.get(0, [])
        moving = [body for body in top if self._moves(body)]
        joined = {body for bodies in self._bodies_of_equalities() for body in bodies}
        free = [body for body in moving if self.kinds(body) == ["free"]]
        if len(moving) == 1 and free and joined <= set(self.below(free[0])):
            return "floating", free[0]
        at_world = 0 in joined
        empty = not at_world and 0 not in model["site_bodyid"]
        solid = [kind for body, kind in zip(model["geom_bodyid"], model["geom_type"], strict=True) if body == 0]
        if (
            len(top) == 1
            and empty
            and set(solid) <= {"plane"}
            and not self.kinds(top[0])
            and self.pose_of(top[0]) == IDENTITY
        ):
            return "fixed", top[0]
        return "fixed", 0

    def _moves(self, body: int) -> bool:
        """Whether a body or one below it has a joint."""
        return bool(self.joints_of.get(body)) or any(map(self._moves, self.children.get(body, ())))

    def kinds(self, body: int) -> list[str]:
        """Types of the joints of a body, as MuJoCo calls them."""
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

    def below(self, body: int) -> list[int]:
        """A body and all that it carries, depth first."""
        found, stack = [], [body]
        while stack:
            body = stack.pop()
            found.append(body)
            stack += reversed(self.children.get(body, []))
        return found

    def pose_of(self, body: int) -> Pose:
        """Pose of a body in its parent at the reference configuration."""
        return pose_from(self.model["body_pos"][body], self.model["body_quat"][body])

    def wraps(self, tendon: int) -> list[tuple[str, int, float]]:
        """What a tendon goes by: kind, index of the element, and coefficient."""
        model = self.model
        at, count = model["tendon_adr"][tendon], model["tendon_num"][tendon]
        return [(model["wrap_type"][i], model["wrap_objid"][i], model["wrap_prm"][i]) for i in range(at, at + count)]
