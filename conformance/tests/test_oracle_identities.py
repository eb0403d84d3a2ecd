"""What must hold of any robot that the oracle reads: K is a derivative, ½ vᵀ M v an energy, mass is kept."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.oracle import OracleRobot
from eurdf_conformance.oracle.description import Description
from eurdf_conformance.oracle.integration import integrate
from eurdf_conformance.oracle.joint_kind import KINDS
from eurdf_conformance.oracle.logarithm import log3, log6, log6_derivative
from eurdf_conformance.oracle.spatial import Array, from_quaternion, pose, rotation, skew, unit
from eurdf_conformance.oracle.transform import motion, transform
from eurdf_conformance.oracle.tree import build
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.truth import truth
from written import chain, joint, link, robot, two

T = 1e-5


def differentiated(function: Any) -> Any:
    """The derivative at 0, to order T⁴: of numbers near 1 it is good to about 1e-10."""
    one, two = (np.asarray(function(k * T)) - function(-k * T) for k in (1, 2))
    return (8.0 * one - two) / (12.0 * T)


def placed(found: OracleRobot, seed: int) -> tuple[dict[str, list[float]], Array]:
    """A random configuration, and a random velocity."""
    random = np.random.default_rng(seed)
    nv = len(found.velocities)
    return found.moved({}, random.normal(size=nv)), random.normal(size=nv)


ROBOTS = mechanisms("1", 1).map(lambda found: truth(found, "1")) | mechanisms("2", 1).map(truth)
SEEDS = st.integers(0, 2**32 - 1)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(ROBOTS, SEEDS)
def test_k_is_the_derivative_of_the_residual_along_every_velocity(found: OracleRobot, seed: int) -> None:
    q, v = placed(found, seed)
    r = found.residual(q)
    turns = [float(np.linalg.norm(rows[3:])) for rows in found.residuals(q).values()]
    if any(turn > 3.1 for turn in turns):
        return  # log6 jumps at a half turn
    along = differentiated(lambda t: found.residual(found.moved(q, t * v)))
    np.testing.assert_allclose(found.jacobian(q) @ v, along, atol=1e-7 * (1.0 + float(np.max(np.abs(r), initial=0.0))))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(ROBOTS, SEEDS)
def test_m_is_symmetric_and_gives_the_kinetic_energy(found: OracleRobot, seed: int) -> None:
    q, v = placed(found, seed)
    M = found.mass_matrix(q) - np.diag(found.armature)
    np.testing.assert_allclose(M, M.T, atol=1e-12 * np.max(np.abs(M), initial=0.0))
    links = list(found.tree.links)

    def poses(t: float) -> Any:
        at = found.evaluate(found.moved(q, t * v), links, ["poses"]).poses
        assert at is not None
        return [np.column_stack([at[name].rotation, at[name].translation]) for name in links]

    energy = 0.0
    for name, M_now, rate in zip(links, poses(0.0), differentiated(poses), strict=True):
        inertia = found.urdf.links[name].inertia
        if inertia is not None:
            velocity = rate @ [*inertia.center, 1.0]
            W = M_now[:, :3].T @ rate[:, :3]  # [ω]×, seen from the link
            turning = np.array([W[2, 1], W[0, 2], W[1, 0]])
            energy += (inertia.mass * velocity @ velocity + turning @ inertia.moments @ turning) / 2.0
    assert v @ M @ v / 2.0 == pytest.approx(energy, rel=1e-8, abs=1e-12)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(mechanisms("2"))
def test_merging_and_locking_preserve_mass_and_neutral_poses(mechanism: Mechanism) -> None:
    found = truth(mechanism)
    plain = OracleRobot(found.urdf, Description(), build(found.urdf, Description()))
    frames = list(plain.tree.links)
    one, other = (each.evaluate({}, frames, ["poses", "mass", "center_of_mass"]) for each in (found, plain))
    assert one.mass == pytest.approx(other.mass, rel=1e-12)
    np.testing.assert_allclose(one.center_of_mass or 0.0, other.center_of_mass or 0.0, atol=1e-12)
    for name in frames:
        a, b = (each.poses[name] for each in (one, other))  # type: ignore[index]
        np.testing.assert_allclose(a.translation, b.translation, atol=1e-12)
        np.testing.assert_allclose(a.rotation, b.rotation, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_the_motion_subspace_is_the_derivative_of_the_transform(kind: str) -> None:
    random = np.random.default_rng(1)
    axes, pitch = np.array([unit(random.normal(size=3)) for _ in range(2)]), 0.7
    q, v = np.array(KINDS[kind].neutral), random.normal(size=KINDS[kind].nv)
    q = integrate(kind, integrate(kind, q, v), v[::-1])
    M = transform(kind, axes, pitch, q)
    rate = np.linalg.inv(M) @ differentiated(lambda t: transform(kind, axes, pitch, integrate(kind, q, t * v)))
    twist = motion(kind, axes, pitch, q) @ v
    np.testing.assert_allclose(rate[:3], np.column_stack([skew(twist[3:]), twist[:3]]), atol=1e-10)


@pytest.mark.parametrize("kind", ["planar", "spherical", "floating"])
def test_two_half_steps_equal_one_step(kind: str) -> None:
    random = np.random.default_rng(2)
    nothing = np.array(KINDS[kind].neutral)
    for scale in (1e-9, 1e-3, 0.09, 0.3, 3.0, 7.0):
        v = random.normal(size=KINDS[kind].nv) * scale
        q = integrate(kind, nothing, random.normal(size=len(v)))
        whole, halves = integrate(kind, q, v), integrate(kind, integrate(kind, q, v / 2), v / 2)
        np.testing.assert_allclose(whole, halves, atol=1e-12 * (1.0 + scale))


@settings(derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1e-200, 1e-9, 1e-4, 0.5, 2.0, 3.0, np.pi - 1e-9]))
def test_the_exponential_of_log6_is_the_pose(seed: int, angle: float) -> None:
    random = np.random.default_rng(seed)
    x = np.array([*random.normal(size=3), *(angle * unit(random.normal(size=3)))])
    reached = integrate("floating", np.array(KINDS["floating"].neutral), x)
    found = log6(pose(from_quaternion(reached[3:]), reached[:3]))
    np.testing.assert_allclose(found, x, atol=1e-12 if angle < 3.1 else 1e-7)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3), [1, 1, 0], [-1, 2, 3]])
def test_log3_of_a_half_turn_is_either_vector(axis: Any) -> None:
    w = log3(rotation(unit(np.array(axis, dtype=float)), np.pi))
    np.testing.assert_allclose(np.abs(w), np.pi * np.abs(unit(np.array(axis, dtype=float))), atol=1e-12)


@settings(derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1e-6, 0.1, 1.0, 2.5, 3.1]))
def test_the_derivative_of_log6_matches_differences(seed: int, angle: float) -> None:
    random = np.random.default_rng(seed)
    x = np.array([*random.normal(size=3), *(angle * unit(random.normal(size=3)))])
    twist = random.normal(size=6)

    def moved(t: float) -> Array:
        q = integrate("floating", np.array(KINDS["floating"].neutral), t * twist)
        reached = integrate("floating", q, x)  # seen from the left: the twist comes first
        return log6(pose(from_quaternion(reached[3:]), reached[:3]))

    np.testing.assert_allclose(log6_derivative(x) @ twist, differentiated(moved), atol=1e-8 if angle < 3 else 1e-4)


def test_a_distant_root_leaves_residuals_k_and_m_unchanged() -> None:
    elements = [*chain(joint("a", "revolute", "base", "end", (1, 2, 3), (1, 0, 0)))[:1], link("end", 1.0, (1, 1, 1))]
    elements.append(joint("a", "revolute", "base", "end", (1, 2, 3), (1, 0, 0)))
    found = robot(elements, two("root: floating\nclosures: [{name: c, type: 6d, frames: [end, base]}]"))
    near, far = ({"a": [1.0], "root_joint": [x, 0, 0, 0, 0, 0, 1]} for x in (0.0, 1e9))
    np.testing.assert_allclose(found.residual(near), found.residual(far), atol=1e-12)
    np.testing.assert_allclose(found.jacobian(near), found.jacobian(far), atol=1e-12)
    np.testing.assert_allclose(found.mass_matrix(near), found.mass_matrix(far), atol=1e-12)


def test_the_order_of_elements_has_no_effect() -> None:
    parts = [
        joint("b", "revolute", "one", "two", (0, 1, 0), (0, 0, 1)),
        joint("a", "prismatic", "zero", "one", more='<mimic joint="b"/><limit velocity="1" effort="1"/>'),
    ]
    one, other = (robot(chain(*order)) for order in (parts, parts[::-1]))
    assert canonical_differences(one.canonical(), other.canonical(), one.bodies) == []
    q = {"b": [0.3]}
    assert one.evaluate(q, ["two"], ["poses"]) == other.evaluate(q, ["two"], ["poses"])
