"""The mechanism: bodies, joints, closures, actuators and frames as plain data.

Everything before it knows files and positions; everything after it knows only this. Units are SI (m, rad, kg, s, N,
N·m). Every tuple of bodies and joints is in the order of a depth-first walk from the root in which the joints of one
body come in the byte order of their names: the order of Pinocchio's and urdfdom's models.
"""

from __future__ import annotations

import copyreg
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

from eurdf.mechanism.body import Body, Frame
from eurdf.mechanism.constraint import Closure, Constraint, Coupling
from eurdf.mechanism.joint import Joint, Mimic, drivers

Root = Literal["fixed", "floating"]

#: Name of the joint by which a floating root moves in the world, in every model.
ROOT_JOINT = "root_joint"


def root_joint(root: str) -> Joint:
    """The joint by which a floating root moves in the world."""
    return Joint.floating(ROOT_JOINT, root)


def _read_only(content: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(content)


# Python can neither pickle nor copy a read-only mapping by itself.
copyreg.pickle(MappingProxyType, lambda mapping: (_read_only, (mapping.copy(),)))


class Motor(NamedTuple):
    """What a description states of a motor beside its gear, which is a property of the joint.

    Attributes:
        name: Name of the actuator.
        control: Smallest and largest torque (N·m) or force (N) at each velocity of the joint, or None.
    """

    name: str
    control: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Mechanism:
    """A robot with closed kinematic chains.

    Attributes:
        name: Name of the robot in the URDF.
        version: Version of the description it was read from: ``1``, ``2.0``, ``2.1``, or empty for a bare URDF.
        root: Whether the root body is fixed to the world or floats in it.
        bodies: In depth-first order; the first is the root.
        joints: In depth-first order, fixed ones too; ``joints[i].child`` is ``bodies[i + 1]``.
        frames: Frames beside those of bodies and joints, in file order.
        closures: In file order.
        actuators: Names of the actuated joints, in file order.
        configurations: By name; for each joint its coordinates, for a floating root those of `ROOT_JOINT`. A joint left
            out is at its neutral.
        metadata: The file's metadata.
        own_data: User data in the file, as plain values, by the JSON pointer of their key.
        couplings: Linear relations of joint coordinates, in file order.
        motors: By actuated joint, the name of the actuator and its control range, where the file states one of them.
        contacts: Closures between the world, which has their frame A, and a body. They are no part of a description.
    """

    name: str
    version: str
    root: Root
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...] = ()
    closures: tuple[Closure, ...] = ()
    actuators: tuple[str, ...] = ()
    configurations: Mapping[str, Mapping[str, tuple[float, ...]]] = field(default_factory=lambda: MappingProxyType({}))
    metadata: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    own_data: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    couplings: tuple[Coupling, ...] = ()
    motors: Mapping[str, Motor] = field(default_factory=lambda: MappingProxyType({}))
    contacts: tuple[Closure, ...] = ()

    def motor(self, joint: str) -> Motor:
        """The motor of an actuated joint; by default, it has the name of the joint."""
        return self.motors.get(joint) or Motor(joint)

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """Every closure, then every coupling, then every contact: the order of their rows."""
        return *self.closures, *self.couplings, *self.contacts

    @property
    def leaders(self) -> dict[str, Mimic]:
        """For each mimic joint, the joint at the end of its chain of leaders, and the relation between the two."""
        return drivers({joint.name: joint.mimic for joint in self.joints if joint.mimic is not None})

    @property
    def nc(self) -> int:
        """Number of rows of all constraints."""
        return sum(constraint.rows for constraint in self.constraints)

    def __repr__(self) -> str:
        return (
            f"<Mechanism '{self.name}': {len(self.bodies)} bodies, {len(self.joints)} joints, "
            f"{len(self.closures)} closures, {len(self.couplings)} couplings, {len(self.actuators)} actuators>"
        )
