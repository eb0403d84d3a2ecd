"""A drawing as a mechanism."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from eurdf.closures.distance import DistanceClosure
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.mechanism.body import Anchor, Body, Frame, Inertia, Shape
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, Motor
from eurdf.mechanism.pose import Pose, Vector3
from robots.builder import drawing as drawn
from robots.builder import joint as drawn_joint
from robots.builder.shape import Box, Cylinder, Matrix3, along, rotation_of, rpy_of
from robots.builder.shape import Shape as DrawnShape
from robots.builder.solid import Solid, solid_of

#: Decimals kept of a length (m) or an angle (rad): far below what closes a loop, above the noise of the last bit.
DECIMALS = 14

#: Significant digits kept of a mass (kg) or a moment of inertia (kg·m²).
DIGITS = 12


def mechanism_of(drawing: drawn.Drawing) -> Mechanism:
    """The mechanism, assembled where every joint is at its neutral.

    Bodies and joints are in the order drawn. Each end of a closure is a link of its own, welded to its body, with the
    axes of the world: a name of the URDF, which every version can refer to.
    """
    bodies = list(drawing.bodies.values())
    ends = [
        (frame, drawing.bodies[body], at)
        for closure in drawing.closures
        for frame, body, at in zip(closure.frames, closure.bodies, closure.points, strict=True)
    ]
    welds = (
        Joint(f"weld_{name}", JointType.FIXED, body.name, name, _pose(body, at, np.eye(3))) for name, body, at in ends
    )
    motors = {joint.name: joint.motor for joint in drawing.joints if joint.motor}
    return Mechanism(
        name=drawing.name,
        version="",
        root=drawing.root,
        bodies=(*(_body(body, drawing) for body in bodies), *(Body(name) for name, _, _ in ends)),
        joints=(*(_joint(body.joint, body, drawing) for body in bodies if body.joint), *welds),
        frames=tuple(
            Frame(frame.name, frame.body, _pose(drawing.bodies[frame.body], frame.at, rotation_of(frame.rpy)))
            for frame in drawing.frames
        ),
        closures=tuple(map(_closure, drawing.closures)),
        actuators=tuple(motors),
        configurations={
            "assembled": {},
            **{
                name: {joint: _coordinates(value) for joint, value in coordinates.items()}
                for name, coordinates in drawing.configurations.items()
            },
        },
        metadata=drawing.metadata,
        couplings=tuple(Coupling(each.name, tuple(each.joints.items())) for each in drawing.couplings),
        motors={
            name: Motor(motor.name or name, motor.control)
            for name, motor in motors.items()
            if motor.name or motor.control
        },
    )


def _coordinates(value: drawn.Coordinates) -> tuple[float, ...]:
    return _lengths((value,) if isinstance(value, float | int) else value)


def _body(body: drawn.Body, drawing: drawn.Drawing) -> Body:
    color = drawing.materials[body.material]
    collisions = tuple(_shape(shape, body) for shape in body.contacts)
    visuals = tuple(replace(_shape(shape, body), color=color) for shape in body.shapes)
    solid = body.solid or (solid_of(body.shapes) if body.shapes else None)
    return Body(body.name, _inertia(solid, body) if solid else None, visuals, collisions)


def _inertia(solid: Solid, body: drawn.Body) -> Inertia:
    """The moments are about the body's own axes, so that the inertial frame need not be turned."""
    moments = body.rotation.T @ solid.inertia @ body.rotation
    # What is nothing but rounding beside the largest is zero.
    moments[np.abs(moments) <= 1e-12 * moments.max()] = 0.0
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = ([_weight(value) for value in row] for row in moments.tolist())
    return Inertia(_weight(solid.mass), Pose(_position(body, solid.center)), (xx, xy, xz, yy, yz, zz))


def _shape(shape: DrawnShape, body: drawn.Body) -> Shape:
    at = _position(body, shape.center)
    if isinstance(shape, Box):
        turned = body.rotation.T @ rotation_of(shape.rpy)
        return Shape("box", _lengths(shape.size), Pose.from_xyz_rpy(at, _vector(rpy_of(turned))))
    if isinstance(shape, Cylinder):
        axis = body.rotation.T @ np.subtract(shape.end, shape.start)
        size = _lengths((shape.radius, shape.length))
        return Shape("cylinder", size, Pose.from_xyz_rpy(at, _vector(along(axis))))
    return Shape("sphere", _lengths((shape.radius,)), Pose(at))


def _joint(joint: drawn_joint.Joint, body: drawn.Body, drawing: drawn.Drawing) -> Joint:
    kind = JointType(joint.type)
    if kind is JointType.REVOLUTE and not joint.stops:
        kind = JointType.CONTINUOUS
    axes = {"universal": joint.axes[:2], "spherical": ()}.get(joint.type, (joint.axis,))
    return Joint(
        joint.name,
        kind,
        joint.parent,
        body.name,
        _pose(drawing.bodies[joint.parent], joint.at, joint.rotation),
        axes=tuple(_vector(joint.rotation.T @ axis) for axis in axes),
        properties=_properties(joint, kind),
    )


def _properties(joint: drawn_joint.Joint, kind: JointType) -> JointProperties:
    properties = JointProperties.unlimited(kind)
    if joint.damping or joint.friction:
        properties = replace(properties, damping=(joint.damping,), friction=(joint.friction,))
    if joint.stops:
        properties = replace(properties, lower=joint.stops[:1], upper=joint.stops[1:])
    if joint.stops or joint.motor:
        motor = joint.motor or drawn_joint.PASSIVE
        properties = replace(
            properties,
            velocity=(motor.velocity,),
            effort=(motor.effort,),
            armature=(motor.reflected_inertia,),
            gear_ratio=(motor.gear_ratio,),
            rotor_inertia=(motor.rotor_inertia,),
        )
    if joint.spring:
        properties = replace(properties, stiffness=(joint.spring.stiffness,), rest=(joint.spring.rest,))
    return properties


def _closure(closure: drawn.Closure) -> Closure:
    a, b = (Anchor(frame, frame=frame) for frame in closure.frames)
    match closure.type:
        case "3d":
            return PointClosure(closure.name, a, b)
        case "6d":
            return FrameClosure(closure.name, a, b)
        case "hinge":
            assert closure.axis is not None
            return HingeClosure(closure.name, a, b, axes=(closure.axis, closure.axis))
        case "distance":
            return DistanceClosure(closure.name, a, b, length=round(math.dist(*closure.points), DECIMALS))


def _pose(parent: drawn.Body, at: Vector3, rotation: Matrix3) -> Pose:
    """The pose of a frame in a body: given is its pose in the world."""
    return Pose.from_xyz_rpy(_position(parent, at), _vector(rpy_of(parent.rotation.T @ rotation)))


def _position(parent: drawn.Body, at: Vector3) -> Vector3:
    return _vector(parent.rotation.T @ np.subtract(at, parent.origin))


def _vector(values: Iterable[float]) -> Vector3:
    x, y, z = _lengths(values)
    return x, y, z


def _lengths(values: Iterable[float]) -> tuple[float, ...]:
    """Lengths (m), angles (rad) or components of a unit vector, without the noise of the last bits."""
    return tuple(round(float(value), DECIMALS) + 0.0 for value in values)


def _weight(value: float) -> float:
    """A mass (kg) or a moment of inertia (kg·m²), without the noise of the last bits."""
    return float(f"{value:.{DIGITS}g}") + 0.0
