"""The oracle against MuJoCo, which shares nothing with it: poses, K of closed loops, M, mass and centre of mass."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from eurdf_conformance.level import Version
from eurdf_conformance.oracle import OracleRobot, read
from eurdf_conformance.oracle.joint_kind import KINDS
from eurdf_conformance.properties.example import frozen_examples
from eurdf_conformance.properties.mechanism import Configuration, Mechanism
from eurdf_conformance.properties.property import SHARED
from eurdf_conformance.properties.query import all_frames
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.truth import truth
from support.mujoco_witness import Witness, mass_matrix, read_urdf
from support.wild import WILD

#: Of lengths relative to the size of the robot, of M to its largest entry.
NEAR = 1e-10

ROBOTS = Path(__file__).parents[2] / "robots"
#: MuJoCo has no planar joint, as the screw press does.
URDFS = sorted(
    path
    for path in (*ROBOTS.glob("*/robot.urdf"), *WILD.glob("*/*.urdf"))
    if 'type="planar"' not in path.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("version", SHARED)
def test_mujoco_and_oracle_agree_on_the_frozen_examples(version: Version) -> None:
    # Those for version 1 can be said in both versions: here it is by version 2.
    found = [example.mechanism for example in frozen_examples(version) if can_be_witnessed(example.mechanism)]
    for mechanism in found:
        robot, witness = truth(mechanism), Witness(mechanism)
        for name, q in mechanism.configurations.items():
            compare(robot, witness, q, is_closed=name == "assembled")
    moving = {kind for each in found for kind in each.types().values()}
    assert moving | {"fixed"} == KINDS.keys() - ({"cylindrical", "helical"} if version == "1" else set())


def can_be_witnessed(mechanism: Mechanism) -> bool:
    """Whether MuJoCo can have a mechanism: it merges no joints, and moves nothing that weighs nothing."""
    return not mechanism.merged and any(link.inertia for link in mechanism.links)


@pytest.mark.slow
@settings(max_examples=100, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(mechanisms().filter(can_be_witnessed))
def test_mujoco_and_oracle_agree_on_random_mechanisms(mechanism: Mechanism) -> None:
    robot, witness = truth(mechanism), Witness(mechanism)
    for name, q in mechanism.configurations.items():
        compare(robot, witness, q, is_closed=name == "assembled")


def compare(robot: OracleRobot, witness: Witness, q: Configuration, *, is_closed: bool) -> None:
    witness.at(q)
    size, frames = max(1.0, robot.size(q)), all_frames(witness.mechanism)
    given = robot.evaluate(q, frames, ("poses", "mass", "center_of_mass"))
    assert given.poses is not None
    for name in frames:
        R, p = witness.pose(f"frame/{name}")
        np.testing.assert_allclose(given.poses[name].rotation, R, atol=NEAR)
        np.testing.assert_allclose(given.poses[name].translation, p, atol=NEAR * size)
    T = witness.rates(q, robot.velocities)
    M = robot.mass_matrix(q) - np.diag(robot.armature)
    np.testing.assert_allclose(M, T.T @ witness.mass_matrix() @ T, atol=NEAR * np.abs(M).max(initial=0.0))
    assert given.mass == pytest.approx(witness.mass, rel=NEAR)
    if given.center_of_mass is not None:
        np.testing.assert_allclose(given.center_of_mass, witness.center_of_mass, atol=NEAR * size)
    if is_closed:
        for name, rows in robot.jacobians(q).items():
            np.testing.assert_allclose(rows, witness.jacobian(name) @ T, atol=NEAR * size)


@pytest.mark.parametrize("path", URDFS, ids=[path.parent.name for path in URDFS])
def test_mujoco_and_oracle_agree_on_the_urdf_of_a_robot(path: Path) -> None:
    robot, model = read(None, path), read_urdf(path)
    data = mujoco.MjData(model)
    q = robot.moved({}, np.random.default_rng(0).normal(size=len(robot.velocities)))
    for name, (value,) in q.items():
        data.joint(name).qpos[:] = value
    mujoco.mj_forward(model, data)
    at, size = robot.kinematics(q), robot.size(q)
    for link, place in robot.tree.links.items():
        if link != robot.urdf.root:  # the world itself
            M = at.pose(place)
            np.testing.assert_allclose(data.body(link).xmat.reshape(3, 3), M[:3, :3], atol=NEAR)
            np.testing.assert_allclose(data.body(link).xpos, M[:3, 3], atol=NEAR * size)
    order = [model.joint(name).dofadr[0] for name, _ in robot.velocities]
    assert sorted(order) == list(range(model.nv))
    M, given = robot.mass_matrix(q), mass_matrix(model, data)[np.ix_(order, order)]
    np.testing.assert_allclose(M, given, atol=NEAR * np.abs(M).max())
