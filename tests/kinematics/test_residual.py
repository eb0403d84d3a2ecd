"""The residual of the closures and its derivative."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.kinematics.analysis import analyze
from eurdf.kinematics.evaluate import evaluator, few_tree, many_tree
from eurdf.kinematics.residual import closure_openings, openings_once, residual, residual_and_jacobian
from support.linkage import (
    JOINTS,
    Linkage,
    branching,
    closure,
    drift_by_differences,
    far_from_half_a_turn,
    somewhere,
    translation,
)
from support.mechanisms import KINDS, some_robot

seeds = st.integers(0, 2**32 - 1)


def differences(linkage: Linkage, q: Any, step: float = 1e-4) -> Any:
    """Derivative of the residual along q ⊕ v by central differences of the fourth order."""

    def at(v: Any) -> Any:
        return residual(linkage, pin.integrate(linkage.model, q, v))

    return np.column_stack(
        [
            (8.0 * (at(step * v) - at(-step * v)) - at(2.0 * step * v) + at(-2.0 * step * v)) / (12.0 * step)
            for v in np.eye(linkage.model.nv)
        ]
    )


@given(seed=seeds, kinds=st.lists(st.sampled_from(sorted(JOINTS)), min_size=3, max_size=9))
@settings(max_examples=50, deadline=None)
def test_jacobian_is_derivative_in_any_tree(seed: int, kinds: list[str]) -> None:
    random = np.random.default_rng(seed)
    linkage = branching([JOINTS[kind]() for kind in kinds], random)
    q = somewhere(linkage.model, random)
    assume(far_from_half_a_turn(linkage, q))
    _, K = residual_and_jacobian(linkage, q)
    np.testing.assert_allclose(K, differences(linkage, q), rtol=0.0, atol=1e-7 * np.abs(K).max())


@pytest.mark.parametrize("name", eurdf.collection_names())
def test_motion_on_closed_path_has_the_constraint_acceleration(name: str) -> None:
    robot, h = eurdf.load(name, geometry=False), 2e-3
    q = eurdf.assemble(robot).q
    v = eurdf.project_velocity(robot, q, np.random.default_rng(0).normal(size=robot.model.nv))
    there, back = (
        pin.difference(robot.model, q, eurdf.project_configuration(robot, pin.integrate(robot.model, q, step * v)))
        for step in (h, -h)
    )
    v, a = (there - back) / (2.0 * h), (there + back) / h**2
    k = eurdf.kinematics.constraint_acceleration(robot, q, v)
    _, K = eurdf.residual_and_jacobian(robot, q)
    np.testing.assert_allclose(K @ a, k, atol=1e-3 * (1.0 + np.abs(k).max()))
    np.testing.assert_allclose(k, -drift_by_differences(robot, q, v), atol=1e-8 * (1.0 + np.abs(k).max()))
    many = eurdf.batch.constraint_acceleration(robot, [q] * 3, [v, -v, 2.0 * v])
    np.testing.assert_allclose(many, [k, k, 4.0 * k], atol=1e-9 * (1.0 + np.abs(k).max()))


@given(seed=seeds, kinds=st.lists(st.sampled_from(sorted(JOINTS)), min_size=3, max_size=9))
@settings(max_examples=50, deadline=None)
def test_few_equal_many_in_any_tree(seed: int, kinds: list[str]) -> None:
    random = np.random.default_rng(seed)
    check_few_equal_many(branching([JOINTS[kind]() for kind in kinds], random), random)


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_few_equal_many_for_every_kind_of_joint_and_constraint(seed: int) -> None:
    random = np.random.default_rng(seed)
    check_few_equal_many(some_robot(random, KINDS * 2), random)


@pytest.mark.parametrize("name", ["digit_2legs", "kangaroo_2legs", "stewart_platform", "bennett"])
def test_loops_without_common_joints_have_small_models(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    check_few_equal_many(robot, np.random.default_rng(0))
    bundles = evaluator(robot, few=True)._pairs._bundles
    assert sum(len(bundle.which) for bundle in bundles) == len(robot.constraints)
    assert all(bundle._model.nv <= 60 for bundle in bundles)
    assert (len(bundles) > 1) == name.endswith("_2legs")


def check_few_equal_many(robot: Any, random: np.random.Generator) -> None:
    """Residual, K, drift and openings of some constraints, and the tree, at three configurations."""
    tree, few, many = robot.tree, few_tree(robot), many_tree(robot)
    start = np.tile(tree.neutral(), (3, 1))
    q = few.integrate(start, random.uniform(-1.0, 1.0, (3, tree.nv)))
    v, w = random.uniform(-1.0, 1.0, (2, 3, tree.nv))
    some = np.flatnonzero(random.random(tree.nv) < 0.8)
    chosen = random.permutation(len(robot.constraints))[: random.integers(1, len(robot.constraints) + 1)].tolist()
    one, other = (evaluator(robot, chosen, some, few=is_few) for is_few in (True, False))
    at, at_other = one.at(q), one.at(q[:1])  # the one after the other
    near(one.residual(at), other.residual(other.at(q)))
    near(one.residual(at_other), other.residual(other.at(q[:1])))
    near(one.jacobian(at), other.jacobian(other.at(q)))
    near(one.drift(q, v), other.drift(q, v))
    for found, expected in zip(one.openings(at), other.openings(other.at(q)), strict=True):
        near(found, expected)
    moved = few.integrate(q, w)
    near(many.integrate(q, w), moved)
    for function in ("difference", "difference_derivative"):
        near(getattr(many, function)(q, moved), getattr(few, function)(q, moved))
    little = few.integrate(q, w * [[1e-9], [1e-4], [2.0]])
    near(many.integrate(q, w * [[1e-9], [1e-4], [2.0]]), little)
    np.testing.assert_allclose(many.difference(q, little), few.difference(q, little), rtol=0.0, atol=1e-9)
    near(many.integrate_derivative(q, w), few.integrate_derivative(q, w))
    near(many.normalized(2.0 * q), few.normalized(2.0 * q))


def near(found: Any, expected: Any) -> None:
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max(initial=1.0))


def test_opening_is_distance_and_angle() -> None:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "body")
    linkage = Linkage(
        model,
        [
            closure(model, 0, translation(0.0, 3.0, 0.0), joint, translation(4.0, 0.0, 0.0), "6d", "welded"),
            closure(model, 0, translation(0.0, 3.0, 0.0), joint, translation(4.0, 0.0, 0.0), "3d", "pinned"),
        ],
    )
    turned = pin.SE3ToXYZQUAT(
        translation(4.0, 0.0, 0.0)
        * pin.SE3(pin.exp3(np.array([0.0, 0.5, 0.0])), np.zeros(3))
        * translation(-4.0, 0.0, 0.0)
    )
    welded, pinned = closure_openings(linkage, turned)
    assert (welded.name, pinned.name) == ("welded", "pinned")
    assert welded.position == pytest.approx(5.0)
    assert welded.angle == pytest.approx(0.5)
    assert pinned.position == pytest.approx(5.0)
    assert pinned.angle == 0.0


@given(seed=seeds, kinds=st.lists(st.sampled_from(sorted(JOINTS)), min_size=3, max_size=9))
@settings(max_examples=20, deadline=None)
def test_openings_at_once_equal_those_in_memory(seed: int, kinds: list[str]) -> None:
    random = np.random.default_rng(seed)
    linkage = branching([JOINTS[kind]() for kind in kinds], random)
    q = somewhere(linkage.model, random)
    assume(far_from_half_a_turn(linkage, q))
    once, kept = (
        np.array([(each.position, each.angle) for each in openings(linkage, q)])
        for openings in (openings_once, closure_openings)
    )
    np.testing.assert_allclose(once, kept, rtol=0.0, atol=1e-10)


def test_openings_at_once_do_not_depend_on_place_of_root() -> None:
    robot = eurdf.load("digit_leg", root="floating", geometry=False)
    q = robot.configurations["assembled"]
    q[:3] = 1e9, -1e9, 1e9
    assert not any(opening.is_open for opening in openings_once(robot, q))


@pytest.mark.parametrize("joints", [0, 1])
def test_smallest_robots_have_a_jacobian(joints: int) -> None:
    model = pin.Model()
    if joints:
        model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "hinge")
    linkage = Linkage(model, [closure(model, 0, translation(1.0, 0.0, 0.0), joints, pin.SE3.Identity())])
    r, K = residual_and_jacobian(linkage, np.zeros(joints))
    np.testing.assert_allclose(r, [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-12)
    assert K.shape == (6, joints)
    assert analyze(linkage).residual > 0.5


def test_long_chain_needs_no_data_or_recursion(monkeypatch: pytest.MonkeyPatch) -> None:
    model, parent, length = pin.Model(), 0, 2000
    for index in range(length):
        parent = model.addJoint(parent, pin.JointModelRZ(), translation(0.01, 0.0, 0.0), f"joint{index}")
    linkage = Linkage(model, [closure(model, 0, translation(0.0, 0.0, 0.5), parent, pin.SE3.Identity(), "3d")])

    def refused(self: Any) -> Any:
        raise AssertionError("pin.Data of a large model")

    monkeypatch.setattr(pin.Model, "createData", refused)
    q = np.full(length, np.pi / length)  # half a circle
    r, K = residual_and_jacobian(linkage, q)
    np.testing.assert_allclose(r[[1, 2]], [2 * length * 0.01 / np.pi, -0.5], rtol=1e-3)
    np.testing.assert_allclose(K[0, 0], -r[1], rtol=1e-9)
