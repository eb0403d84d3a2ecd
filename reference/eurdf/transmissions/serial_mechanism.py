"""The mechanism of the serial twin: without the bodies of the linkage, whose masses are lumped onto the others."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from eurdf.array import Matrix
from eurdf.convert.coordinates import rotation_matrix
from eurdf.convert.inertia import about_centre
from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.joint import JointProperties
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose


def serial_mechanism(
    mechanism: Mechanism,
    bodies: Collection[str],
    coordinates: Mapping[str, Sequence[float]],
    joints: Sequence[str],
    motors: Collection[str],
) -> Mechanism:
    """A mechanism without the bodies of a linkage, whose masses are lumped onto what carries them.

    The mass, the centre of mass and the inertia of all bodies together stay as they are at the given coordinates. The
    joints become the actuators in place of the motors. Constraints and frames of the removed bodies are removed with
    them, and so are their shapes.

    Args:
        mechanism: The mechanism.
        bodies: Names of the bodies to remove; with a body go those that hang from it.
        coordinates: Of all joints that are not fixed, as files state them.
        joints: Names of the serial joints.
        motors: Names of the motors.
    """
    kept = tuple(joint for joint in mechanism.joints if joint.child not in bodies)
    names = {joint.name for joint in kept}
    gone = {joint.name for joint in mechanism.joints} - names
    stays = {body.name for body in mechanism.bodies} - set(bodies)
    return replace(
        mechanism,
        name=f"{mechanism.name}_serial",
        bodies=tuple(_lumped(mechanism, bodies, coordinates)),
        joints=kept,
        frames=tuple(frame for frame in mechanism.frames if frame.body in stays),
        closures=tuple(
            closure for closure in mechanism.closures if all(anchor.body in stays for anchor in closure.anchors)
        ),
        contacts=tuple(contact for contact in mechanism.contacts if contact.b.body in stays),
        couplings=tuple(coupling for coupling in mechanism.couplings if names.issuperset(coupling.joints)),
        actuators=_actuators(mechanism.actuators, joints, motors),
        configurations=MappingProxyType(
            {
                name: MappingProxyType({joint: own for joint, own in values.items() if joint not in gone})
                for name, values in mechanism.configurations.items()
            }
        ),
        own_data=MappingProxyType({}),
        motors=MappingProxyType({name: motor for name, motor in mechanism.motors.items() if name not in motors}),
    )


def with_properties(mechanism: Mechanism, properties: Mapping[str, JointProperties]) -> Mechanism:
    """The mechanism with other properties of some joints, by name."""
    return replace(
        mechanism,
        joints=tuple(
            joint.with_properties(properties[joint.name]) if joint.name in properties else joint
            for joint in mechanism.joints
        ),
    )


def springs_left_out(mechanism: Mechanism, bodies: Collection[str]) -> tuple[str, ...]:
    """A note on the springs of the joints that are left out with the bodies of the linkage."""
    gone = [joint.name for joint in mechanism.joints if joint.child in bodies and any(joint.properties.stiffness)]
    if not gone:
        return ()
    return (
        f"springs of the linkage are left out, those of {', '.join(map(repr, gone))}: add their torque to the drives",
    )


def _actuators(actuators: Iterable[str], joints: Sequence[str], motors: Collection[str]) -> tuple[str, ...]:
    """The actuators, with the joints in place of the first motor."""
    found: dict[str, None] = {}
    for name in actuators:
        found.update(dict.fromkeys(joints if name in motors else [name]))
    return tuple(found)


def _lumped(
    mechanism: Mechanism, bodies: Collection[str], coordinates: Mapping[str, Sequence[float]]
) -> Iterable[Body]:
    """The other bodies, with the masses of those that hang from them."""
    carriers: dict[str, tuple[str, Pose]] = {}  # of each removed body what carries it, and its pose there
    parts: dict[str, list[tuple[Pose, Inertia]]] = {}
    inertias = {body.name: body.inertia for body in mechanism.bodies}
    for joint in mechanism.joints:
        if joint.child not in bodies:
            continue
        carrier, pose = carriers.get(joint.parent, (joint.parent, IDENTITY))
        carriers[joint.child] = (
            carrier,
            pose * joint.placement * joint.transform(coordinates.get(joint.name, ())) * joint.offset,
        )
        inertia = inertias[joint.child]
        if inertia is not None:
            parts.setdefault(carrier, []).append((carriers[joint.child][1], inertia))
    for body in mechanism.bodies:
        if body.name in bodies:
            continue
        more = parts.get(body.name, [])
        if not more:
            yield body
            continue
        own = [] if body.inertia is None else [(IDENTITY, body.inertia)]
        yield replace(body, inertia=composite([*own, *more]))


def composite(parts: Sequence[tuple[Pose, Inertia]]) -> Inertia:
    """The inertia of bodies that are fixed to each other, each at its pose in a common frame."""
    mass = sum(inertia.mass for _, inertia in parts)
    centres = [np.array((pose * inertia.pose).xyz) for pose, inertia in parts]
    weighed = zip(centres, parts, strict=True)
    centre = sum((own.mass * at for at, (_, own) in weighed), np.zeros(3)) / mass if mass else np.zeros(3)
    total = np.zeros((3, 3))
    for at, (pose, inertia) in zip(centres, parts, strict=True):
        R = rotation_matrix(pose.quaternion)
        total += R @ about_centre(inertia) @ R.T + inertia.mass * _of_point(at - centre)
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = (0.5 * (total + total.T)).tolist()
    x, y, z = centre.tolist()
    return Inertia(float(mass), Pose((x, y, z)), (xx, xy, xz, yy, yz, zz))


def _of_point(at: Matrix) -> Matrix:
    """The inertia of a unit mass at a point."""
    return np.asarray(at @ at * np.eye(3) - np.outer(at, at))
