"""The parts of rewriting a mechanism: its spanning tree, what must stay, and what a rewriting has changed."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

from eurdf.linking.merging import MASSLESS
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import ROTARY
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, root_joint
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.mechanism.spanning_tree import depth_first, rigid_poses

#: Coordinates of joints by name, as files have them.
Positions = Mapping[str, Sequence[float]]

#: A range, in rad, that limits nothing: a whole turn, rounded as files have it.
_WHOLE_TURN = math.tau - 1e-4

#: What three joints and a ball do in different ways.
_ACTING = ("damping", "friction", "armature", "stiffness")


@dataclass(frozen=True, slots=True)
class Rewriting:
    """A mechanism, rewritten.

    Attributes:
        mechanism: What it became, without named configurations if something was changed.
        changes: What was changed, one sentence each.
        kept: What could not be changed, and why.
        lost: What the new mechanism does not say.
        between: Names of the links between merged axes, which no longer turn.
        steps: From the positions of every moving joint to those of the new mechanism, one after the other.
    """

    mechanism: Mechanism
    changes: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()
    between: tuple[str, ...] = ()
    steps: tuple[Callable[[Positions], Positions], ...] = ()

    def then(self, second: Rewriting) -> Rewriting:
        """This rewriting, and another one of its result."""
        return Rewriting(
            second.mechanism,
            self.changes + second.changes,
            self.kept + second.kept,
            self.lost + second.lost,
            self.between + second.between,
            self.steps + second.steps,
        )

    def converted(self, positions: Positions) -> Positions:
        """The positions of joints of the new mechanism, with each link where it was."""
        for step in self.steps:
            positions = step(positions)
        return positions


@dataclass(frozen=True)
class MechanismTree:
    """The spanning tree of a mechanism."""

    mechanism: Mechanism

    @cached_property
    def links(self) -> dict[str, Body]:
        """The links by name."""
        return {body.name: body for body in self.mechanism.bodies}

    @cached_property
    def joints(self) -> dict[str, Joint]:
        """The joints by name."""
        return {joint.name: joint for joint in self.mechanism.joints}

    @cached_property
    def above(self) -> dict[str, Joint]:
        """By the name of a link, the joint that carries it."""
        return {joint.child: joint for joint in self.mechanism.joints}

    @cached_property
    def children(self) -> dict[str, list[Joint]]:
        """By the name of a link, the joints that it carries."""
        found: dict[str, list[Joint]] = {}
        for joint in self.mechanism.joints:
            found.setdefault(joint.parent, []).append(joint)
        return found

    @cached_property
    def rigid(self) -> Mapping[str, tuple[str, Pose]]:
        """What `rigid_poses` says of each link."""
        return rigid_poses(self.mechanism.bodies[0].name, self.mechanism.joints)

    @cached_property
    def why_not(self) -> dict[str, str]:
        """The joints that cannot become others without a change of the motion, and why."""
        joints = self.mechanism.joints
        coupled = {name for coupling in self.mechanism.couplings for name in coupling.joints}
        coupled.update(name for joint in joints if joint.mimic for name in (joint.name, joint.mimic.joint))
        actuated = set(self.mechanism.actuators)
        found = {}
        for joint in joints:
            acting = [name for name in _ACTING if any(getattr(joint.properties, name))]
            if joint.name in actuated:
                found[joint.name] = "is actuated"
            elif joint.name in coupled:
                found[joint.name] = "is coupled to another joint"
            elif acting:
                found[joint.name] = f"has {acting[0]}"
            elif joint.type in ROTARY and any(upper - lower < _WHOLE_TURN for lower, upper in joint.ranges):
                found[joint.name] = "has position limits, which a ball joint cannot have"
        return found

    def walk(self) -> Iterable[Joint]:
        """The joints, depth first."""
        return self.mechanism.joints

    def below(self, link: str) -> set[str]:
        """A link, and those that hang from it."""
        found = {link}
        found.update(joint.child for joint in self.mechanism.joints if joint.parent in found)
        return found

    def mass(self, *links: str) -> float:
        """The mass of links, kg."""
        return sum(inertia.mass for link in links if (inertia := self.links[link].inertia) is not None)

    def mass_of_whole(self, link: str) -> float:
        """The mass of a link with what is fixed to it, kg; infinite for what is fixed to the root body."""
        root = self.rigid[link][0]
        if root not in self.above:
            return math.inf
        return self.mass(*(name for name, (above, _) in self.rigid.items() if above == root))

    def is_heavy(self, link: str) -> bool:
        """Whether a link resists every motion by itself."""
        inertia = self.links[link].inertia
        if inertia is None or inertia.mass < MASSLESS:
            return False
        ixx, _, _, iyy, _, izz = inertia.moments
        return min(ixx, iyy, izz) > 0.0

    def is_bare(self, link: str, without: Joint) -> bool:
        """Whether a moving link, with what is fixed to it, would have no mass and carry nothing without a joint."""
        root = self.rigid[link][0]
        own = {name for name, (above, _) in self.rigid.items() if above == root}
        carried = (joint for joint in self.mechanism.joints if joint.parent in own and not joint.type.is_fixed)
        return not self.mass_of_whole(link) and all(joint is without for joint in carried)

    def is_rigid(self, links: Collection[str]) -> bool:
        """Whether no moving joint hangs from one of the links."""
        return not any(joint.parent in links and not joint.type.is_fixed for joint in self.mechanism.joints)

    def unused(self, name: str) -> str:
        """A name that no link, joint or frame has, made of this one."""
        taken = {*self.links, *self.joints, *(frame.name for frame in self.mechanism.frames), "universe", ROOT_JOINT}
        while name in taken:
            name += "_"
        return name

    def rebuilt(self, joints: Iterable[Joint], bodies: Iterable[Body] = (), **changes: object) -> Mechanism:
        """The mechanism with these joints in place of those of their names, or new, and with new bodies."""
        links = self.links | {body.name: body for body in bodies}
        root = self.mechanism.bodies[0].name
        ordered = depth_first(root, (self.joints | {joint.name: joint for joint in joints}).values())
        placed = (links[root], *(links[joint.child] for joint in ordered))
        own = {"bodies": placed, "joints": tuple(ordered), "configurations": MappingProxyType({}), **changes}
        return replace(self.mechanism, **own)  # type: ignore[arg-type]


def poses_of(mechanism: Mechanism, positions: Positions) -> dict[str, Pose]:
    """Pose of each body in the world, or in the root body if that is fixed."""
    root = mechanism.bodies[0].name
    poses = {root: IDENTITY}
    if mechanism.root == "floating":
        base = root_joint(root)
        poses[root] = base.transform(positions.get(ROOT_JOINT, base.type.neutral))
    for joint in mechanism.joints:
        turned = joint.transform(positions.get(joint.name, joint.type.neutral))
        poses[joint.child] = poses[joint.parent] * joint.placement * turned * joint.offset
    return poses


@dataclass(frozen=True, slots=True, repr=False)
class RobotSize:
    """The size of a robot.

    Attributes:
        nv: Velocities of the spanning tree.
        nc: Constraint rows.
    """

    nv: int
    nc: int

    def __repr__(self) -> str:
        return f"<RobotSize: nv {self.nv}, nc {self.nc}>"


def size_of(mechanism: Mechanism) -> RobotSize:
    """The size of a robot."""
    own = sum(joint.type.nv for joint in mechanism.joints if joint.mimic is None)
    return RobotSize(own + (6 if mechanism.root == "floating" else 0), mechanism.nc)
