"""Exports that are imported again: the same links, masses and constraints at the same configuration."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.convert.inertia import about_centre
from eurdf.convert.losses import Effect
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.robot import Robot, build_robot
from support.exported import random_robot, values_of_parts

#: Kinds of constraint that a format states.
KINDS = {
    "mjcf": ("3d", "6d", "hinge", "distance", "coupling"),
    "drake": ("3d", "6d", "hinge", "coupling"),
    "loop-joint": ("3d", "6d", "hinge"),
    "sdf": ("3d", "6d", "hinge"),
}


def there_and_back(robot: Robot, to: str, folder: Path) -> tuple[eurdf.Export, Robot]:
    export = eurdf.export(robot, to)
    mechanism = eurdf.import_robot(export.write(folder, force=True)[0]).mechanism
    return export, build_robot(mechanism, geometry=False)


def matched(export: eurdf.Export, there: Robot, robot: Robot, q: Any) -> Any:
    """The configuration of the robot that was imported. From MJCF, it has the joints that the robot had."""
    if export.format == "mjcf":
        return there.configuration({name: c for name, c in robot.coordinates(q).items() if name in _known(there)})
    map_ = export.coordinates
    values, coordinates, at = [value for mine in values_of_parts(map_, q) for value in mine], {}, 0
    for part in map_.parts:
        if part.joint == ROOT_JOINT:
            w, x, y, z = values[:4] if part.orientation_first else values[3:7]
            xyz = values[4:7] if part.orientation_first else values[:3]
            if export.format == "loop-joint":
                w, x, y, z = values[6], *values[3:6]
            if there.mechanism.root == "floating":
                coordinates[ROOT_JOINT] = [*xyz, x, y, z, w]
            at = 7
            continue
        for name in part.names:
            kind = there.slots[name].joint.type if name in there.slots else None
            n = 0 if kind is None else len(there.slots[name].joint.type.coordinates)
            if kind is None:  # a mimic joint
                at += 1
            elif kind is JointType.SPHERICAL and part.rotation == "rpy":
                coordinates[name] = pin.Quaternion(pin.rpy.rpyToMatrix(np.array(values[at : at + 3]))).coeffs().tolist()
                at += 3
            else:
                coordinates[name] = values[at : at + n]
                if kind is JointType.SPHERICAL:
                    coordinates[name] = [*values[at + 1 : at + 4], values[at]]
                at += n
    return there.configuration(coordinates)


def _known(robot: Robot) -> set[str]:
    return {*robot.slots, *([ROOT_JOINT] if robot.mechanism.root == "floating" else [])}


def assert_same_mechanism(robot: Robot, export: eurdf.Export, there: Robot, q: Any) -> None:
    """At q, a closed configuration, and at one near it."""
    v = np.random.default_rng(0).uniform(-0.3, 0.3, robot.model.nv)
    base = robot.mechanism.bodies[0].name
    for each in (q, pin.integrate(robot.model, q, v)):
        same = matched(export, there, robot, each)
        for one, at in ((robot, each), (there, same)):
            pin.framesForwardKinematics(one.model, one.data, at)
        poses = [
            {body.name: _pose(one, base).actInv(_pose(one, body.name)) for body in robot.mechanism.bodies}
            for one in (robot, there)
        ]
        for name, pose in poses[0].items():
            np.testing.assert_allclose(poses[1][name].homogeneous, pose.homogeneous, atol=1e-9, err_msg=name)
    closed = matched(export, there, robot, q)
    assert np.abs(eurdf.residual(there, closed)).max() < 1e-9
    before, after = eurdf.analyze(robot, q), eurdf.analyze(there, closed)
    assert after.mobility == before.mobility - _lost_freedoms(robot, there)
    found = {(constraint.name, constraint.type) for constraint in there.mechanism.constraints}
    assert found >= {(closure.name, closure.type) for closure in robot.mechanism.closures}
    assert len(found) == len(robot.mechanism.constraints)
    inertias = {body.name: body.inertia for body in there.mechanism.bodies}
    for body in robot.mechanism.bodies:
        assert_same_inertia(inertias[body.name], body.inertia)


def _lost_freedoms(robot: Robot, there: Robot) -> int:
    """A floating root is no part of a URDF."""
    return 6 if robot.mechanism.root == "floating" and there.mechanism.root == "fixed" else 0


def assert_same_inertia(found: Inertia | None, expected: Inertia | None) -> None:
    assert found is not None
    assert expected is not None
    assert found.mass == pytest.approx(expected.mass)
    np.testing.assert_allclose(found.pose.xyz, expected.pose.xyz, atol=1e-9)
    np.testing.assert_allclose(about_centre(found), about_centre(expected), atol=1e-9)


def _pose(robot: Robot, link: str) -> Any:
    return robot.data.oMf[robot.model.getFrameId(link, pin.FrameType.BODY)]


# MuJoCo's compiler runs in a process of its own, which takes time to start.
@pytest.mark.parametrize("to", [pytest.param("mjcf", marks=pytest.mark.slow), "drake", "loop-joint", "sdf"])
@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=3)
def test_random_robot_comes_back(to: str, tmp_path_factory: pytest.TempPathFactory, seed: int, root: Any) -> None:
    robot, q = random_robot(seed, root, kinds=KINDS[to])
    # No description has a closure that joins two links of one rigid body.
    rigid = rigid_roots(robot.mechanism.bodies[0].name, robot.mechanism.joints)
    assume(all(rigid[each.a.body] != rigid[each.b.body] for each in robot.mechanism.closures))
    export, there = there_and_back(robot, to, tmp_path_factory.mktemp("export"))
    assert_same_mechanism(robot, export, there, q)


@pytest.mark.slow
@pytest.mark.parametrize("to", KINDS)
@pytest.mark.parametrize("name", eurdf.collection_names())
def test_robot_of_the_collection_comes_back(to: str, name: str, tmp_path: Path) -> None:
    robot = eurdf.load(name, geometry=False)
    losses = eurdf.export(robot, to).losses
    dropped = {loss.name for loss in losses if loss.effect is Effect.DROPPED and loss.code != "export-compliance"}
    unsaid = [each.type for each in robot.constraints if each.name in dropped]
    assert not set(unsaid).intersection(KINDS[to])
    if unsaid:
        return
    export, there = there_and_back(robot, to, tmp_path)
    assert len(there.mechanism.closures) == len(robot.mechanism.closures)
    closed = matched(export, there, robot, robot.configurations["assembled"])
    assert np.abs(eurdf.residual(there, closed)).max() < 1e-6
    before = eurdf.analyze(robot, robot.configurations["assembled"])
    assert eurdf.analyze(there, closed).mobility == before.mobility - _lost_freedoms(robot, there)
