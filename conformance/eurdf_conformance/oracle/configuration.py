"""Configurations by joint name, and the coordinates and velocities of all joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from eurdf_conformance.oracle.integration import integrate
from eurdf_conformance.oracle.joint_property import properties
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.spatial import Array
from eurdf_conformance.oracle.tree import Joint, Tree

Configuration = Mapping[str, Sequence[float]]

#: rad or m: how far a coordinate may be beyond its limits.
BEYOND = 1e-9


def neutral(tree: Tree) -> dict[str, Sequence[float]]:
    """The neutral coordinates of every joint that has coordinates of its own."""
    return {joint.name: joint.kind.neutral for joint in tree.joints if joint.kind.neutral and not joint.mimic}


def normalised(joint: Joint, coordinates: Sequence[float]) -> Array:
    """Coordinates of a joint with a quaternion of unit length, EU-CFG-006."""
    q = np.array(coordinates, dtype=float)
    if len(q) != len(joint.kind.neutral):
        raise NotRead(f"{len(q)} coordinates for {joint.name!r}")
    start = joint.kind.quaternion
    if start is not None:
        q[start:] /= np.linalg.norm(q[start:])
    return q


def stated(tree: Tree, configuration: Configuration) -> dict[str, Array]:
    """The coordinates that a configuration gives, for joints with coordinates of their own, EU-CFG-001."""
    joints = {joint.name: joint for joint in tree.joints if joint.kind.neutral and not joint.mimic}
    if unknown := configuration.keys() - joints.keys():
        raise NotRead(f"no coordinates of {sorted(unknown)}")
    return {name: normalised(joints[name], q) for name, q in configuration.items()}


def require_within_limits(tree: Tree, configuration: Configuration) -> None:
    """EU-CFG-004: the coordinates that a configuration gives, and the neutral ones of the joints that it leaves out."""
    q = stated(tree, neutral(tree) | dict(configuration))
    for joint in tree.joints:
        limits = properties(joint, None)
        for value, lower, upper in zip(q.get(joint.name, ()), limits.lower, limits.upper, strict=False):
            below = lower is not None and value < lower - BEYOND
            above = upper is not None and value > upper + BEYOND
            if (below or above) and not lower == upper == 0.0:
                raise NotRead(f"{joint.name!r} is at {value}, beyond {lower} to {upper}")


def coordinates(tree: Tree, configuration: Configuration) -> list[Array]:
    """Coordinates of every joint: neutral if left out, EU-CFG-005; of a mimic joint by its leader, EU-URD-032."""
    q = stated(tree, neutral(tree) | dict(configuration))
    found = []
    for joint, (driver, multiplier, offset) in zip(tree.joints, drivers(tree), strict=True):
        own = q.get(tree.joints[driver].name, np.zeros(0))
        found.append(multiplier * own + offset if joint.mimic else own)
    return found


def drivers(tree: Tree) -> list[tuple[int, float, float]]:
    """Of every joint the one whose coordinates it has, and multiplier and offset of these: a chain of mimics in one.

    q = m₁ (m₂ q₂ + o₂) + o₁ = m₁ m₂ q₂ + (m₁ o₂ + o₁).
    """
    index = {joint.name: i for i, joint in enumerate(tree.joints)}
    found = []
    for i, joint in enumerate(tree.joints):
        driver, multiplier, offset = i, 1.0, 0.0
        for _ in tree.joints:
            mimic = tree.joints[driver].mimic
            if mimic is None:
                break
            if mimic.joint not in index:
                raise NotRead(f"{joint.name!r} mimics what does not move")
            multiplier, offset = multiplier * mimic.multiplier, multiplier * mimic.offset + offset
            driver = index[mimic.joint]
        else:
            raise NotRead(f"{joint.name!r} mimics itself")
        found.append((driver, multiplier, offset))
    return found


def velocities(tree: Tree) -> list[tuple[str, int]]:
    """The columns of K and M: a joint and the index of its velocity, EU-JNT-026."""
    return [(joint.name, i) for joint in tree.joints if not joint.mimic for i in range(joint.kind.nv)]


def kinds(tree: Tree) -> str:
    """For each velocity whether it is angular, `a`, or linear, `l`."""
    return "".join(joint.kind.velocities for joint in tree.joints if not joint.mimic)


def sharing(tree: Tree) -> Array:
    """G, which maps the velocities of the mechanism to those of every joint: q̇ = multiplier · q̇_driver for mimics."""
    columns = {column: i for i, column in enumerate(velocities(tree))}
    G = np.zeros((sum(joint.kind.nv for joint in tree.joints), len(columns)))
    row = 0
    for driver, multiplier, _ in drivers(tree):
        joint = tree.joints[driver]
        for i in range(joint.kind.nv):
            G[row, columns[joint.name, i]] = multiplier
            row += 1
    return G


def moved(tree: Tree, configuration: Configuration, v: Array) -> dict[str, list[float]]:
    """The configuration q ⊕ v, with v in the order of `velocities`."""
    at = 0
    found = {}
    types = {joint.name: joint for joint in tree.joints}
    for name, q in stated(tree, neutral(tree) | dict(configuration)).items():
        kind = types[name].kind
        found[name] = integrate(types[name].type, q, v[at : at + kind.nv]).tolist()
        at += kind.nv
    return found
