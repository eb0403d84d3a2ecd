"""The bodies of a linkage, which the equivalent serial robot does not have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from eurdf.mechanism.joint import drivers
from eurdf.transmissions.motors import driven_loops

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def linkage_bodies(robot: Robot, joints: Sequence[str], motors: Sequence[str]) -> tuple[str, ...]:
    """The bodies that motors and rods add to a serial chain, in the mechanism's order: cranks, rods, pistons.

    They hang, directly or through others, from a motor or from a passive joint in the loops of the joints, unless that
    joint is one of them or lies between one of them and the root.

    Args:
        robot: The robot.
        joints: Names of the joints of the serial chain.
        motors: Names of the motors that move them.
    """
    mechanism, slots = robot.mechanism, robot.slots
    leaders = drivers({joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None})
    carrier = {joint.child: joint for joint in mechanism.joints}
    own = {slots[name].idx_v + k for name in joints for k in range(slots[name].nv)}
    inside = {slots[name].idx_v + k for name in motors for k in range(slots[name].nv)}
    for closing, _ in driven_loops(robot):
        if closing & own:
            inside |= closing
    kept = set(joints)
    for name in joints:
        joint = slots[name].joint
        while joint.parent in carrier:
            joint = carrier[joint.parent]
            kept.add(joint.name)
    found: set[str] = set()
    for joint in mechanism.joints:  # a parent comes before its children
        leader = leaders[joint.name].joint if joint.name in leaders else joint.name
        added = leader in slots and slots[leader].idx_v in inside and joint.name not in kept
        if added or joint.parent in found:
            found.add(joint.child)
    return tuple(joint.child for joint in mechanism.joints if joint.child in found)
