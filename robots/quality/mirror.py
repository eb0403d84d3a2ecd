"""The rule on mirrored legs: elements named left and right are exact mirror images in the plane y = 0.

A joint and its image mirror each other if their coordinates are equal up to signs. The twists of their velocities
determine the signs: with M = diag(1, -1, 1), the image of a twist (v, ω) is (M v, -M ω).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pinocchio as pin

import eurdf
from eurdf.array import Vector
from eurdf.closures.distance import DistanceClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.configuration import Slot, slots
from eurdf.pinocchio.frames import body_frame_ids
from eurdf.pinocchio.robot import Robot
from robots.quality.candidate import Candidate

_MIRROR = np.array((1.0, -1.0, 1.0))
_OF_TWIST = np.array((1.0, -1.0, 1.0, -1.0, 1.0, -1.0))
_LEFT = re.compile(r"(?<![a-z])left(?![a-z])")
_RIGHT = re.compile(r"(?<![a-z])right(?![a-z])")

_SAME_PLACE = 1e-12  # m
_SAME_TWIST = 1e-9  # rad/s; m/s at the world's origin
_SAME_DIRECTION = 1e-9  # of unit vectors, and of coefficients of a coupling
_SAME_INERTIA = 1e-9  # relative to the mass, or to the largest moment: the accuracy of the digits in files
_POSES = 3  # in addition to the pose with all coordinates zero
_REACH = 0.5  # range of the coordinates in them, rad or m


def is_mirrored(candidate: Candidate) -> list[str] | None:
    """Links, masses, inertias, constraints and limits of left and right are mirrored; None if there are none."""
    mechanism = candidate.robot.mechanism
    pairs, alone = _pairs(mechanism)
    if not pairs:
        return None
    if alone:
        return [f"'{name}' has no counterpart: there is no element of the mirrored name" for name in alone]
    # Mimic joints get their own coordinates, because they have to be mirrored, too.
    robot = eurdf.load(candidate.path, geometry=False, mimic=False)
    at = slots(robot.mechanism)
    joints = [(at[left], at[right]) for left, right in pairs.items() if left in at and right in at]
    signs = _signs(robot, joints)
    for (left, right), sign in zip(joints, signs, strict=True):
        if not sign.all():
            return [f"joint '{left.joint.name}' does not move as the mirror image of '{right.joint.name}'"]
    errors = [error for joint, sign in zip(joints, signs, strict=True) for error in _limits(*joint, sign)]
    errors += _couplings(robot, pairs)
    random = np.random.default_rng(0)
    for pose in range(1 + _POSES):
        v = np.zeros(robot.model.nv)
        for (left, right), sign in zip(joints, signs, strict=True):
            value = random.uniform(-_REACH, _REACH, left.nv) if pose else np.zeros(left.nv)
            v[left.idx_v : left.idx_v + left.nv] = value
            v[right.idx_v : right.idx_v + right.nv] = sign * value
        found = _unlike(robot, pairs, np.asarray(pin.integrate(robot.model, pin.neutral(robot.model), v)))
        if found:
            where = "with mirrored coordinates" if pose else "with every joint at zero"
            return errors + [f"{what}, {where}" for what in found]
    return errors


def _pairs(mechanism: Mechanism) -> tuple[dict[str, str], list[str]]:
    """For each body, joint or constraint on the left the one on the right; and the names without counterpart."""
    bodies, joints, constraints = mechanism.bodies, mechanism.joints, mechanism.constraints
    names = dict.fromkeys(
        [*(body.name for body in bodies), *(joint.name for joint in joints), *(each.name for each in constraints)]
    )
    pairs = {name: _LEFT.sub("right", name) for name in names if _LEFT.search(name)}
    images = set(pairs.values())
    alone = [name for name, image in pairs.items() if image not in names]
    alone += [name for name in names if _RIGHT.search(name) and name not in images]
    return {left: right for left, right in pairs.items() if right in names}, alone


def _signs(robot: eurdf.Robot, joints: list[tuple[Slot, Slot]]) -> list[Vector]:
    """For each pair of joints the signs (nv,) of mirrored velocities; 0 for velocities that are not mirrored."""
    J = pin.computeJointJacobians(robot.model, robot.model.createData(), pin.neutral(robot.model)).reshape(6, -1)
    signs = []
    for left, right in joints:
        sign = np.zeros(left.nv)
        if right.nv == left.nv:
            image = _OF_TWIST[:, None] * J[:, left.idx_v : left.idx_v + left.nv]
            other = J[:, right.idx_v : right.idx_v + right.nv]
            for candidate in (1.0, -1.0):
                sign[np.abs(image - candidate * other).max(axis=0) <= _SAME_TWIST] = candidate
        signs.append(sign)
    return signs


def _limits(left: Slot, right: Slot, sign: Vector) -> Iterator[str]:
    """Limits, damping, friction and springs that differ."""
    one, other = left.joint, right.joint
    limits = list(zip(one.properties.lower, one.properties.upper, strict=True))
    if len(limits) == len(sign):  # only joints with one coordinate per velocity have limits
        kept = zip(limits, (sign > 0.0).tolist(), strict=True)
        limits = [(low, high) if same else (-high, -low) for (low, high), same in kept]
    if limits != list(zip(other.properties.lower, other.properties.upper, strict=True)):
        yield f"'{one.name}' and '{other.name}' have different position limits"
    rest = tuple(at if same else -at for at, same in zip(one.properties.rest, (sign > 0.0).tolist(), strict=False))
    if (one.properties.stiffness, rest) != (other.properties.stiffness, other.properties.rest):
        yield f"'{one.name}' and '{other.name}' have different springs"
    if _drive(one) != _drive(other):
        yield f"'{one.name}' and '{other.name}' differ in velocity limit, effort limit, damping, friction or armature"


def _drive(joint: Joint) -> tuple[tuple[float, ...], ...]:
    has = joint.properties
    return (has.velocity, has.effort, has.damping, has.friction, has.armature)


def _couplings(robot: eurdf.Robot, pairs: Mapping[str, str]) -> Iterator[str]:
    """Couplings that are not mirrored: those on the right relate the mirrored coordinates in the same way."""
    couplings = {each.name: each for each in robot.constraints if isinstance(each, Coupling)}
    at = slots(robot.mechanism)
    for name, right in pairs.items():
        if name not in couplings:
            continue
        joints = [(at[joint], at[pairs.get(joint, joint)]) for joint in couplings[name].joints]
        image = {
            other.joint.name: c * float(sign[0])
            for (_, other), (_, c), sign in zip(
                joints, couplings[name].coefficients, _signs(robot, joints), strict=True
            )
        }
        other = couplings.get(right)
        if other is None or image.keys() != set(other.joints):
            yield f"couplings '{name}' and '{right}' do not relate mirrored joints"
            continue
        stated = dict(other.coefficients)
        # A joint in the middle, such as a motor behind gears, need not turn the other way in the mirror image.
        middle = image.keys() & set(couplings[name].joints)
        image |= {joint: math.copysign(image[joint], stated[joint]) for joint in middle}
        terms = np.array([(image[joint], stated[joint]) for joint in image] + [(couplings[name].offset, other.offset)])
        if min(np.abs(terms @ (1.0, sign)).max() for sign in (1.0, -1.0)) > _SAME_DIRECTION * np.abs(terms).max():
            yield f"couplings '{name}' and '{right}' are not mirror images"


def _unlike(robot: eurdf.Robot, pairs: Mapping[str, str], q: Vector) -> list[str]:
    """What is not mirrored at q (nq,): positions of links, centres of mass and closures, or inertias."""
    model = robot.model
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    frames = body_frame_ids(robot.mechanism)
    places = {name: data.oMf[frame].translation for name, frame in frames.items()}
    errors = [
        f"link '{left}' is {apart:.1e} m from the mirror image of '{right}'"
        for left, right in pairs.items()
        if left in places and (apart := _apart(places[left], places[right])) > _SAME_PLACE
    ]
    if errors:
        return errors[:1]  # links beyond it differ as well
    closures = {closure.name: closure for closure in robot.mechanism.closures}
    masses = {name: _inertia(model, data, model.getJointId(name)) for name in pairs if model.existJointName(name)}
    images = {name: _inertia(model, data, model.getJointId(pairs[name])) for name in masses}
    for name, (mass, center, moments) in masses.items():
        other_mass, other_center, other_moments = images[name]
        image = _MIRROR[:, None] * moments * _MIRROR
        if abs(mass - other_mass) > _SAME_INERTIA * mass:
            errors.append(f"the masses on joints '{name}' and '{pairs[name]}' differ")
        elif _apart(center, other_center) > _SAME_PLACE:
            errors.append(f"the centres of mass on joints '{name}' and '{pairs[name]}' are not mirror images")
        elif np.abs(image - other_moments).max() > _SAME_INERTIA * np.abs(moments).max():
            errors.append(f"the inertias on joints '{name}' and '{pairs[name]}' are not mirror images")
    for name in pairs:
        if name in closures:
            ends = _ends(robot, data, closures[name]), _ends(robot, data, closures[pairs[name]])
            if (
                any(_apart(one, other) > _SAME_PLACE for one, other in zip(*ends, strict=True))
                or not _have_same_form(closures[name], closures[pairs[name]])
                or not _axes_mirror(robot, data, closures[name], closures[pairs[name]])
            ):
                errors.append(f"closures '{name}' and '{pairs[name]}' are not mirror images")
    return errors


def _inertia(model: Any, data: Any, joint: int) -> tuple[float, Vector, Any]:
    """Mass (kg), centre of mass (3,) in the world (m), and moments (3, 3) about it in the world (kg·m²), of a joint."""
    carried, oMi = model.inertias[joint], data.oMi[joint]
    R = oMi.rotation
    return float(carried.mass), oMi.act(carried.lever), R @ carried.inertia @ R.T


def _ends(robot: Robot, data: Any, closure: Closure) -> list[Vector]:
    """Positions (3,) of its two frames in the world, m."""
    return [data.oMi[joint].act(placement.translation) for joint, placement in map(robot.tree.site, closure.anchors)]


def _have_same_form(left: Closure, right: Closure) -> bool:
    """Whether type, compliance and length are equal."""
    if isinstance(left, DistanceClosure) and isinstance(right, DistanceClosure):
        return left.compliance == right.compliance and abs(left.length - right.length) <= _SAME_PLACE
    return left.type == right.type and left.compliance == right.compliance


def _axes_mirror(robot: Robot, data: Any, left: Closure, right: Closure) -> bool:
    """Whether the axes of two hinges are mirror images; turning both axes of a hinge round does not change it."""
    if not (isinstance(left, HingeClosure) and isinstance(right, HingeClosure)):
        return True
    images = [_MIRROR * axis for axis in _axes(robot, data, left)]
    axes = _axes(robot, data, right)
    return any(
        all(np.abs(image - sign * axis).max() <= _SAME_DIRECTION for image, axis in zip(images, axes, strict=True))
        for sign in (1.0, -1.0)
    )


def _axes(robot: Robot, data: Any, hinge: HingeClosure) -> list[Vector]:
    """The axes (3,) of a hinge in its two frames, as unit vectors in the world."""
    found = []
    for (joint, placement), axis in zip(map(robot.tree.site, hinge.anchors), hinge.axes, strict=True):
        found.append(data.oMi[joint].rotation @ placement.rotation @ np.array(axis) / np.linalg.norm(axis))
    return found


def _apart(left: Vector, right: Vector) -> float:
    return float(np.abs(_MIRROR * left - right).max())
