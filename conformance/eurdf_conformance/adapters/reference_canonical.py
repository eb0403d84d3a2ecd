"""What `eurdf` has read, as a canonical description."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from eurdf.closures.distance import DistanceClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.mechanism.body import Shape
from eurdf.mechanism.constraint import RIGID, Compliance
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, Motor
from eurdf.mechanism.pose import Vector3
from eurdf.pinocchio.frames import placement_of
from eurdf_conformance.level import Version
from eurdf_conformance.protocol.message import (
    CanonicalActuator,
    CanonicalClosure,
    CanonicalCompliance,
    CanonicalCoupling,
    CanonicalJoint,
    CanonicalMimic,
    CanonicalRobot,
    CanonicalShape,
    Pose,
)

#: As the protocol calls them; a bare URDF is of version 2.
_VERSIONS: Mapping[str, Version] = {"1": "1", "2.0": "2", "2.1": "2.1", "": "2"}

# Nothing can bound their coordinates.
_UNBOUNDED = frozenset({JointType.SPHERICAL, JointType.PLANAR, JointType.FLOATING})


def canonical_robot(mechanism: Mechanism) -> CanonicalRobot:
    """EU-CAN-001 to -004: the mechanism without style.

    Args:
        mechanism: Read from a description, of any version.
    """
    joints = {joint.name: joint for joint in mechanism.joints}
    return CanonicalRobot(
        name=mechanism.name,
        version=_VERSIONS[mechanism.version],
        root=mechanism.root,
        links=[body.name for body in mechanism.bodies if not body.virtual],
        frames=[frame.name for frame in mechanism.frames if frame.kind == "frame"],
        joints=[_joint(joint) for joint in mechanism.joints if joint.type is not JointType.FIXED],
        closures=[
            CanonicalClosure(
                name=closure.name,
                type=closure.type,  # type: ignore[arg-type]  # any that files can have
                a=closure.a.body,
                b=closure.b.body,
                axes=[_unit(axis) for axis in closure.axes] if isinstance(closure, HingeClosure) else None,
                length=closure.length if isinstance(closure, DistanceClosure) else None,
                compliance=_compliance(closure.compliance),
            )
            for closure in mechanism.closures
        ],
        actuators=[
            CanonicalActuator(
                joint=name,
                gear_ratio=list(joints[name].properties.gear_ratio),
                rotor_inertia=list(joints[name].properties.rotor_inertia),
                name=mechanism.motors[name].name if name in mechanism.motors else None,
                control=_control(mechanism.motors.get(name)),
            )
            for name in mechanism.actuators
        ],
        configurations={
            name: {joint: list(coordinates) for joint, coordinates in configuration.items()}
            for name, configuration in mechanism.configurations.items()
        },
        couplings=[
            CanonicalCoupling(name=coupling.name, joints=dict(coupling.coefficients), offset=coupling.offset)
            for coupling in mechanism.couplings
        ],
        shapes=[
            _shape(body.name, use, shape)
            for body in mechanism.bodies
            for use, shapes in (("visual", body.visuals), ("collision", body.collisions))
            for shape in shapes
        ],
        own=dict(mechanism.own_data),
    )


def _shape(link: str, use: Any, shape: Shape) -> CanonicalShape:
    placement = placement_of(shape.pose)
    return CanonicalShape(
        link=link,
        use=use,
        type=shape.kind,
        size=list(shape.size),
        file=shape.filename or None,
        pose=Pose(rotation=placement.rotation.tolist(), translation=placement.translation.tolist()),
    )


def _joint(joint: Joint) -> CanonicalJoint:
    bounded = joint.type not in _UNBOUNDED
    mimic = joint.mimic
    kind: Any = joint.type.value  # any of the types but fixed
    return CanonicalJoint(
        name=joint.name,
        type=kind,
        parent=joint.parent,
        child=joint.child,
        lower=_limits(joint.properties.lower) if bounded else [],
        upper=_limits(joint.properties.upper) if bounded else [],
        velocity=_limits(joint.properties.velocity),
        effort=_limits(joint.properties.effort),
        damping=list(joint.properties.damping),
        friction=list(joint.properties.friction),
        armature=list(joint.properties.armature),
        stiffness=list(joint.properties.stiffness) or None,
        rest=list(joint.properties.rest) or None,
        mimic=None
        if mimic is None
        else CanonicalMimic(joint=mimic.joint, multiplier=mimic.multiplier, offset=mimic.offset),
    )


def _unit(axis: Vector3) -> list[float]:
    largest = max(map(abs, axis))  # of any length, also of one whose square is out of range
    scaled = [number / largest for number in axis]
    return [number / math.hypot(*scaled) for number in scaled]


def _compliance(compliance: Compliance) -> CanonicalCompliance | None:
    return None if compliance == RIGID else CanonicalCompliance(linear=compliance.linear, angular=compliance.angular)


def _control(motor: Motor | None) -> list[float] | None:
    return None if motor is None or motor.control is None else list(motor.control)


def _limits(values: Iterable[float]) -> list[float | None]:
    """None where there is no limit."""
    return [None if math.isinf(value) else value for value in values]
