"""The spanning tree of a mechanism, for arrays of configurations, without Pinocchio.

Configurations and velocities are those of the robot's model, with elements last: q (nq, B), v (nv, B).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.batch import rigid
from eurdf.kinematics.batch.joints import Floating, Motion, Screw, motions
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.pinocchio.configuration import slots
from eurdf.pinocchio.mimic import following

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """Where a frame is fixed to.

    Attributes:
        joint: Index of the joint that moves it; 0 is the world.
        rotation: Its rotation (3, 3) in that joint's moving frame.
        position: Its origin (3,) there, m.
    """

    joint: int
    rotation: Matrix
    position: Vector


@dataclass(frozen=True, slots=True, eq=False)
class MovingJoint:
    """A joint that moves.

    Attributes:
        parent: Index of its parent, which is lower.
        rotation: Rotation (3, 3) of its frame at rest in its parent's moving frame.
        position: Origin (3,) of it there, m.
        motion: How it moves.
        idx_q: Index of its first coordinate; of a mimic joint that of its leader.
        idx_v: Index of its first velocity; of a mimic joint that of its leader.
        multiplier: Of its leader's coordinate; 1 for a joint with its own.
        offset: Added to it, rad or m.
        mimics: Whether it is a mimic joint.
    """

    parent: int
    rotation: Matrix
    position: Vector
    motion: Motion
    idx_q: int
    idx_v: int
    multiplier: float = 1.0
    offset: float = 0.0
    mimics: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Where the moving frames of some joints are, seen from a common frame.

    Attributes:
        rotation: For each joint its rotations (3, 3, B).
        position: For each joint its origins (3, B), m.
    """

    rotation: Mapping[int, Matrix]
    position: Mapping[int, Matrix]


class BatchTree:
    """A spanning tree; plain data, which can be pickled.

    Attributes:
        nq: Number of coordinates.
        nv: Number of velocities.
        joints: The moving joints, parents first; joint 0 is the world.
        sites: For each body, by name, where its frame is.
    """

    def __init__(self, robot: Robot) -> None:
        mechanism, led = robot.mechanism, following(robot.mechanism)
        self.nq, self.nv = robot.tree.nq, robot.tree.nv
        world = MovingJoint(0, np.eye(3), np.zeros(3), Screw(np.zeros(3), 0.0, 0.0), 0, 0)
        self.joints: list[MovingJoint] = [world]
        at = slots(mechanism)
        places: dict[str, tuple[int, Pose]] = {mechanism.bodies[0].name: (0, IDENTITY)}
        if mechanism.root == "floating":
            self.joints.append(MovingJoint(0, np.eye(3), np.zeros(3), Floating(), 0, 0))
            places[mechanism.bodies[0].name] = (1, IDENTITY)
        for joint in mechanism.joints:
            parent, pose = places[joint.parent]
            pose = pose * joint.placement
            if joint.type.is_fixed:
                places[joint.child] = parent, pose * joint.offset
                continue
            mimic = led.mimics.get(joint.name)
            slot = at[joint.name if mimic is None else mimic.joint]
            # A mimic joint of a (cos, sin) pair turns with an integer multiple of its leader.
            for number, part in enumerate(motions(joint, unwrapped=mimic is not None or slot.nq == 1)):
                self.joints.append(
                    MovingJoint(
                        len(self.joints) - 1 if number else parent,
                        *_numbers(IDENTITY if number else pose),
                        part,
                        slot.idx_q + number,
                        slot.idx_v + number,
                        *((1.0, 0.0) if mimic is None else (mimic.multiplier, mimic.offset)),
                        mimics=mimic is not None,
                    )
                )
            places[joint.child] = len(self.joints) - 1, joint.offset
        self.sites = {name: Site(joint, *_numbers(pose)) for name, (joint, pose) in places.items()}
        self._leaders = {joint.idx_q: joint.motion for joint in self.joints[1:] if not joint.mimics}
        # Pinocchio's joints have those that only hold the coordinate of a late leader after the floating root.
        self._held = range(1 + (mechanism.root == "floating"), 1 + (mechanism.root == "floating") + len(led.late))
        own = [joint for joint in self.joints[1:] if not joint.mimics]
        self._curved = [joint for joint in own if type(joint.motion).integrate is not Motion.integrate]
        flat = [joint for joint in own if type(joint.motion).integrate is Motion.integrate]
        self._flat_q = np.array([joint.idx_q + k for joint in flat for k in range(joint.motion.nq)], dtype=np.intp)
        self._flat_v = np.array([joint.idx_v + k for joint in flat for k in range(joint.motion.nv)], dtype=np.intp)

    def joint_of(self, joint: int) -> int:
        """The index here of a joint of the robot's model."""
        return joint if joint < self._held.start else joint - len(self._held)

    def site(self, body: str, pose: Pose) -> Site:
        """Where a frame with a pose in a body is."""
        base, R = self.sites[body], _numbers(pose)
        return Site(base.joint, base.rotation @ R[0], base.position + base.rotation @ R[1])

    def path(self, joint: int, above: int = 0) -> list[int]:
        """The joints from one up to an ancestor, which is left out."""
        found = []
        while joint != above:
            found.append(joint)
            joint = self.joints[joint].parent
        return found

    def between(self, a: int, b: int) -> dict[int, float]:
        """The joints between two: +1 for those that move b against a, -1 for those that move a."""
        signs = {}
        while a != b:
            if a > b:  # a parent has a lower index than its child
                signs[a], a = -1.0, self.joints[a].parent
            else:
                signs[b], b = 1.0, self.joints[b].parent
        return signs

    def coordinates(self, joint: MovingJoint, q: Matrix) -> Matrix:
        """The coordinates (nq, B) of a joint as its `Motion` has them."""
        if not joint.mimics:
            return q[joint.idx_q : joint.idx_q + joint.motion.nq]
        value = q[joint.idx_q]
        if isinstance(self._leaders[joint.idx_q], Screw):
            return np.asarray(joint.multiplier * value + joint.offset)[None]
        return np.asarray(joint.multiplier * np.arctan2(q[joint.idx_q + 1], value) + joint.offset)[None]

    def place(self, joints: Sequence[int], q: Matrix) -> Place:
        """Moving frames of joints, seen from where the first of each path hangs.

        Args:
            joints: In ascending order. A parent that is not among them counts as at rest at the origin.
            q: Configurations (nq, B).
        """
        rotation: dict[int, Matrix] = {}
        position: dict[int, Matrix] = {}
        for index in joints:
            joint = self.joints[index]
            R, p = joint.motion.pose(self.coordinates(joint, q))
            R = np.einsum("ij,jkb->ikb", joint.rotation, R)
            p = joint.position[:, None] + joint.rotation @ p
            if joint.parent in rotation:
                above = rotation[joint.parent]
                R, p = rigid.product(above, R), position[joint.parent] + rigid.turned(above, p)
            rotation[index], position[index] = R, p
        return Place(rotation, position)

    def twists(self, index: int, q: Matrix, R: Matrix) -> tuple[Matrix, Matrix]:
        """Linear and angular parts (3, nv, B) of a joint's twists for unit velocities, where its rotation is R."""
        joint = self.joints[index]
        linear, angular = joint.motion.twists(self.coordinates(joint, q))
        if joint.mimics:
            linear, angular = joint.multiplier * linear, joint.multiplier * angular
        return rigid.product(R, linear), rigid.product(R, angular)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """The configurations (nq, B) that v (nv, B) leads to in unit time, normalized."""
        moved = np.array(q)
        moved[self._flat_q] += v[self._flat_v]
        for joint in self._curved:
            own, by = _of_joint(joint)
            moved[own] = joint.motion.normalized(joint.motion.integrate(q[own], v[by]))
        return moved

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """The velocities (nv, B) that lead from q to the other configurations in unit time."""
        v = np.empty((self.nv, q.shape[1]))
        v[self._flat_v] = other[self._flat_q] - q[self._flat_q]
        for joint in self._curved:
            own, by = _of_joint(joint)
            v[by] = joint.motion.difference(q[own], other[own])
        return v

    def difference_derivative_times(self, q: Matrix, other: Matrix, forces: Matrix) -> Matrix:
        """Jᵀ f (nv, B), J the derivative of `difference` by the motion of the other configurations."""
        times = np.array(forces)
        for joint in self._curved:
            own, by = _of_joint(joint)
            J = joint.motion.difference_derivative(q[own], other[own])
            times[by] = rigid.turned_back(J, forces[by])
        return times

    def normalized(self, q: Matrix) -> Matrix:
        """The configurations with quaternions, and cosines and sines, of unit length."""
        result = np.array(q)
        for joint in self._curved:
            own, _ = _of_joint(joint)
            result[own] = joint.motion.normalized(q[own])
        return result


def _of_joint(joint: MovingJoint) -> tuple[slice, slice]:
    return (
        slice(joint.idx_q, joint.idx_q + joint.motion.nq),
        slice(joint.idx_v, joint.idx_v + joint.motion.nv),
    )


def _numbers(pose: Pose) -> tuple[Matrix, Vector]:
    return rigid.of_quaternion(np.array(pose.quaternion)), np.array(pose.xyz)
