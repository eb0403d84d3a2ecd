"""`eurdf.batch` against the functions for one element, and how batches are divided."""

from __future__ import annotations

import multiprocessing
import re
import tracemalloc
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.collection import collection_names
from eurdf.pinocchio.robot import Robot, build_robot
from support.actuated import robot_called
from support.described import body, load, revolute
from support.mechanisms import closed_tree
from support.plain_urdf import robot as urdf

EQUAL = 1e-9
seeds = st.integers(0, 2**32 - 1)

#: How many elements: one, few as Pinocchio answers them, and many as NumPy does.
COUNTS = (1, 3, 40)

#: Robots with each kind of joint, closure and root, with a rank that is full or not.
SOME = ("cassie_leg", "delta", "digit_2legs", "double_wishbone", "five_bar", "screw_press", "stewart_platform", "tello")
#: Robots whose tests take long.
LARGE = ("toddlerbot_2legs", "unitree_g1")
#: Those of which a leg is a robot of its own; one of them is in `SOME`.
TWICE = {f"{name.removesuffix('_leg')}_2legs" for name in collection_names()}
EVERY = [
    pytest.param(name, marks=[pytest.mark.slow] * (name in LARGE)) for name in collection_names() if name not in TWICE
]


def moved(robot: Robot, q: Any, random: np.random.Generator, count: int, spread: float) -> Any:
    """Configurations around one; the loops are open there."""
    v = random.uniform(-spread, spread, (count, robot.model.nv))
    return np.array([pin.integrate(robot.model, q, each) for each in v])


def motors_near(robot: Robot, q: Any, random: np.random.Generator, count: int, spread: float) -> Any:
    """Actuated coordinates around those of q."""
    v = np.zeros((count, robot.model.nv))
    v[:, robot.actuation.idx_v] = random.uniform(-spread, spread, (count, len(robot.actuation.idx_v)))
    return np.array([pin.integrate(robot.model, q, each)[robot.actuation.idx_q] for each in v])


def targets_near(robot: Robot, random: np.random.Generator, count: int, spread: float) -> tuple[str, list[Any]]:
    """Poses that the last link can reach."""
    link, data = robot.mechanism.bodies[-1].name, robot.model.createData()
    index = robot.model.getFrameId(link, pin.FrameType.BODY)
    found = []
    for q in moved(robot, eurdf.assemble(robot).q, random, count, spread):
        pin.framesForwardKinematics(robot.model, data, eurdf.assemble(robot, q).q)
        found.append(pin.SE3(data.oMf[index]))
    return link, found


# --- the answers of the single functions -----------------------------------------------------------------------------


def same_residual(robot: Robot, q: Any) -> None:
    r, K = eurdf.batch.residual_and_jacobian(robot, q)
    np.testing.assert_allclose(eurdf.batch.residual(robot, q), r, atol=1e-12)
    for own_r, own_K, own_q in zip(r, K, q, strict=True):
        single_r, single_K = eurdf.residual_and_jacobian(robot, own_q)
        np.testing.assert_allclose(own_r, single_r, atol=EQUAL)
        np.testing.assert_allclose(own_K, single_K, atol=EQUAL)


def same_forward_kinematics(robot: Robot, values: Any, q0: Any) -> Any:
    batch = eurdf.batch.forward_kinematics(robot, values, q0)
    starts = np.broadcast_to(q0, (len(values), robot.model.nq))
    for index, (own, start) in enumerate(zip(values, starts, strict=True)):
        q = batch.q[index]
        assert batch.converged[index] == (batch.reason[index] is None)
        assert batch.residual[index] == pytest.approx(np.linalg.norm(eurdf.residual(robot, q)), abs=EQUAL)
        if batch.converged[index]:
            np.testing.assert_allclose(q, eurdf.forward_kinematics(robot, own, start), atol=EQUAL)
        else:
            with pytest.raises(eurdf.errors.NotClosable):
                eurdf.forward_kinematics(robot, own, start)
    return batch


def same_projection(robot: Robot, q: Any, weights: Any = None) -> None:
    found = eurdf.batch.project_configuration(robot, q, weights=weights)
    for own, place, residual in zip(found.q, q, found.residual, strict=True):
        np.testing.assert_allclose(own, eurdf.project_configuration(robot, place, weights=weights), atol=EQUAL)
        assert residual == pytest.approx(np.linalg.norm(eurdf.residual(robot, own)), abs=EQUAL)
    assert found.converged.all()


def same_jacobian(robot: Robot, q: Any, weights: Any) -> None:
    frame = robot.mechanism.bodies[-1].name
    for reference in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
        found = eurdf.batch.actuated_jacobian(robot, frame, q, reference=reference, weights=weights)
        for J, own in zip(found.jacobian, q, strict=True):
            single = eurdf.actuated_jacobian(robot, frame, own, reference=reference, weights=weights)
            np.testing.assert_allclose(J, single, atol=EQUAL * np.abs(single).max())
        assert found.converged.all()


def same_inverse_kinematics(robot: Robot, link: str, targets: Any) -> None:
    found = eurdf.batch.inverse_kinematics(robot, {link: targets}, limits=False)
    for index, target in enumerate(targets):
        single = eurdf.inverse_kinematics(robot, {link: target}, limits=False)
        np.testing.assert_allclose(found.q[index], single.q, atol=EQUAL)
        assert found.converged[index]
        assert found.position_error[index, 0] == pytest.approx(single.errors[0].position, abs=EQUAL)
        assert found.angle_error[index, 0] == pytest.approx(single.errors[0].angle, abs=EQUAL)


def _forward(robot: Robot, q: Any, random: np.random.Generator, count: int) -> None:
    assert same_forward_kinematics(robot, motors_near(robot, q, random, count, 0.2), q).converged.any()


def _project(robot: Robot, q: Any, random: np.random.Generator, count: int) -> None:
    same_projection(robot, np.concatenate((moved(robot, q, random, count, 0.1), q[None])))
    same_projection(robot, q[None], eurdf.mass_matrix(robot, q) + 0.1 * np.eye(robot.model.nv))


def _jacobian(robot: Robot, q: Any, random: np.random.Generator, count: int) -> None:
    closed = eurdf.batch.project_configuration(robot, moved(robot, q, random, count, 0.01)).q
    same_jacobian(robot, closed, random.uniform(0.5, 2.0, robot.model.nv) if count == 1 else None)


def _inverse(robot: Robot, q: Any, random: np.random.Generator, count: int) -> None:
    link, poses = targets_near(robot, random, min(count, 3), 0.1)
    for targets in (poses, np.array([pose.translation for pose in poses])):
        same_inverse_kinematics(robot, link, targets)


Compare = Callable[[Robot, Any, np.random.Generator, int], None]


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("count", COUNTS)
def test_residuals_and_jacobians_are_those_of_each_element(name: str, count: int) -> None:
    robot = robot_called(name)
    same_residual(robot, moved(robot, eurdf.assemble(robot).q, np.random.default_rng(0), count, 0.5))


@pytest.mark.parametrize("name", SOME)
@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("compare", [_forward, _project, _jacobian, _inverse])
def test_results_are_those_of_each_element(compare: Compare, count: int, name: str) -> None:
    robot = robot_called(name)
    compare(robot, eurdf.assemble(robot).q, np.random.default_rng(1), count)


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    kind=st.sampled_from(["3d", "hinge", "distance", "coupling"]),
    root=st.sampled_from(["fixed", "floating"]),
)
def test_forward_kinematics_of_random_mechanisms_is_that_of_each_element(seed: int, kind: str, root: Any) -> None:
    random = np.random.default_rng(seed)
    robot, q0 = closed_tree(random, (kind,), root)
    same_forward_kinematics(robot, motors_near(robot, q0, random, 3, 0.2), q0)


@pytest.mark.parametrize("name", ["digit_leg", "cassie_leg", "tesla_optimus_ankle", "five_bar", "delta", "talos_leg"])
def test_inverse_kinematics_out_of_reach_or_limits_gives_reason_of_single_one(name: str) -> None:
    robot = robot_called(name)
    link, poses = targets_near(robot, np.random.default_rng(11), 2, 0.4)
    positions = np.array([pose.translation for pose in poses])
    positions[1] += 5.0
    found = eurdf.batch.inverse_kinematics(robot, {link: positions}, restarts=1)
    singles = [eurdf.inverse_kinematics(robot, {link: position}, restarts=1) for position in positions]
    assert found.reason == tuple(single.reason for single in singles)
    assert found.reason[1] is not None
    np.testing.assert_allclose(found.position_error[:, 0], [each.errors[0].position for each in singles], atol=1e-4)


def test_inverse_kinematics_takes_poses_as_matrices_and_several_frames() -> None:
    robot = robot_called("digit_leg")
    link, poses = targets_near(robot, np.random.default_rng(12), 2, 0.1)
    other = robot.mechanism.bodies[5].name
    index, data, places = robot.model.getFrameId(other, pin.FrameType.BODY), robot.model.createData(), []
    for q in eurdf.batch.inverse_kinematics(robot, {link: poses}).q:
        pin.framesForwardKinematics(robot.model, data, q)
        places.append(np.array(data.oMf[index].translation))
    matrices = np.array([pose.homogeneous for pose in poses])
    found = eurdf.batch.inverse_kinematics(robot, {link: matrices, other: np.array(places)})
    assert found.converged.all()
    assert found.position_error.shape == (2, 2)
    assert found.position_error.max() <= 1e-8


# --- elements do not affect each other -------------------------------------------------------------------------------


def four_bar(
    ground: float, coupler: float, rocker: float, actuator: str, assembled: tuple[float, ...] | None = None
) -> Robot:
    """Planar, with a crank of 1 m; all bars along x at zero."""
    pins = [
        revolute("crank_pin", "base", "crank"),
        revolute("coupler_pin", "crank", "coupler", origin='<origin xyz="1 0 0"/>'),
        revolute("rocker_pin", "base", "rocker", origin=f'<origin xyz="{ground} 0 0"/>'),
    ]
    text = urdf(*map(body, ("base", "crank", "coupler", "rocker")), *pins)
    ends = f"{{link: coupler, xyz: [{coupler}, 0, 0]}}, {{link: rocker, xyz: [{rocker}, 0, 0]}}"
    robot = load(text, f"actuators: [{actuator}]\nclosures: [{{name: pin, type: 3d, frames: [{ends}]}}]\n")
    if assembled is None:
        return robot
    closed = robot.joint_positions(eurdf.assemble(robot, np.array(assembled)).q)
    return build_robot(replace(robot.mechanism, configurations={"assembled": closed}), geometry=False)


def test_element_that_cannot_be_reached_says_why_and_leaves_others_alone() -> None:
    robot, random = robot_called("digit_leg"), np.random.default_rng(2)
    q0 = eurdf.assemble(robot).q
    values = motors_near(robot, q0, random, 5, 0.1)
    alone = eurdf.batch.forward_kinematics(robot, np.delete(values, 2, axis=0), q0)
    values[2, 3] += 2.5  # beyond what the rod can follow
    together = same_forward_kinematics(robot, values, q0)
    assert together.converged.tolist() == [True, True, False, True, True]
    assert together.reason[2] is not None
    np.testing.assert_allclose(np.delete(together.q, 2, axis=0), alone.q, atol=1e-12)


def test_jacobian_of_dependent_actuators_says_so() -> None:
    robot = four_bar(2.5, 2.5, 2.0, "crank_pin, rocker_pin")
    q = eurdf.assemble(robot, np.array([1.0, -0.5, 1.7])).q
    found = eurdf.batch.actuated_jacobian(robot, "rocker", q[None])
    assert (found.converged.tolist(), found.reason) == ([False], ("dependent actuators",))
    assert np.isnan(found.jacobian).all()
    with pytest.raises(eurdf.errors.DependentActuators):
        eurdf.actuated_jacobian(robot, "rocker", q)


def test_numbers_that_overflow_leave_others_alone() -> None:
    robot = four_bar(2.5, 2.5, 2.0, "crank_pin")
    q = np.array([[1.0, -0.5, 1.7], [1e300, 1e300, -1e300], [1.1, -0.5, 1.7]])
    projected = eurdf.batch.project_configuration(robot, q)
    for index in (0, 2):
        np.testing.assert_allclose(projected.q[index], eurdf.project_configuration(robot, q[index]), atol=EQUAL)
    start = projected.q[[0, 0, 2]]
    moved_by = eurdf.batch.forward_kinematics(robot, [[1.05], [1e300], [1.2]], start)
    assert moved_by.converged[[0, 2]].all()


@pytest.mark.parametrize(("name", "reason"), [("delta", "blocked"), ("digit_leg", None)])
def test_joints_do_not_go_round_thousands_of_times(name: str, reason: str | None) -> None:
    # Not step by step: outside of the loops, as the first joint of the leg is, in one; in them, not at all.
    robot = robot_called(name)
    values, _ = eurdf.split_configuration(robot, eurdf.assemble(robot).q)
    many = np.tile(values, (3, 1))
    many[1, 0] = 1e9
    found = eurdf.batch.forward_kinematics(robot, many)
    assert found.reason == (None, reason, None)


def test_values_beyond_a_dead_point_say_whether_the_loops_close_there() -> None:
    robot = four_bar(2.5, 2.5, 2.0, "rocker_pin")
    q0 = eurdf.assemble(robot, np.array([1.0, -0.5, 1.7])).q
    found = same_forward_kinematics(robot, np.array([[0.0], [1.5], [2.0], [3.1], [4.5], [6.0]]), q0)
    assert found.reason == ("not closed", None, None, "not closed", "blocked", "not closed")
    np.testing.assert_array_equal(found.residual > 1e-3, [reason == "not closed" for reason in found.reason])


def test_forward_kinematics_from_a_singular_start_is_blocked() -> None:
    parallelogram, q0 = four_bar(2.0, 2.0, 1.0, "crank_pin"), np.zeros(3)
    r, K = eurdf.batch.residual_and_jacobian(parallelogram, q0[None])
    assert not r.any()
    assert np.linalg.matrix_rank(K[0, :, 1:]) == 1
    found = same_forward_kinematics(parallelogram, np.array([[-0.5], [0.0], [0.5]]), q0)
    assert found.reason == ("blocked", None, "blocked")


# --- blocks, threads and executors -----------------------------------------------------------------------------------


class Eager(Executor):
    """Does at once what it is given, as an executor of another library may; records it."""

    def __init__(self) -> None:
        self.lengths: list[int] = []

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        result = fn(*args, **kwargs)
        self.lengths.append(len(result[0]))
        future.set_result(result)
        return future


def some_values(count: int) -> tuple[Robot, Any]:
    """A robot and values, all but the second of which can be reached."""
    robot = four_bar(2.5, 2.5, 2.0, "rocker_pin", assembled=(1.0, -0.5, 1.7))
    values = np.linspace(1.5, 2.0, count)[:, None]
    values[1] = 0.0
    return robot, values


@pytest.mark.parametrize(
    "division", [{"block": 1}, {"block": 4}, {"threads": 2, "block": 3}, {"executor": Eager(), "block": 5}]
)
def test_result_does_not_depend_on_the_division(division: Any) -> None:
    robot, values = some_values(11)
    whole, parts = (eurdf.batch.forward_kinematics(robot, values, **each) for each in ({}, division))
    np.testing.assert_allclose(parts.q, whole.q, atol=1e-12)
    np.testing.assert_allclose(parts.residual, whole.residual, atol=1e-12)
    assert parts.reason == whole.reason
    assert sum(reason is not None for reason in whole.reason) == 1


def test_executor_is_given_every_block() -> None:
    robot, executor = robot_called("digit_leg"), Eager()
    q = np.repeat(eurdf.assemble(robot).q[None], 200, axis=0)
    eurdf.batch.residual(robot, q, executor=executor, block=2)
    assert executor.lengths == [2] * 100


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["processes", "dask"])
def test_other_processes_give_the_same(kind: str) -> None:
    robot, values = some_values(9)

    def found(executor: Any) -> Any:
        return eurdf.batch.forward_kinematics(robot, values, executor=executor, block=5).q

    if kind == "processes":
        with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
            q = found(pool)
    else:
        missing = "distributed is not installed: pip install -e '.[cluster]'"
        distributed = pytest.importorskip("distributed", reason=missing)
        options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "host": "127.0.0.1"}
        with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
            q = found(client.get_executor())
    np.testing.assert_allclose(q, eurdf.batch.forward_kinematics(robot, values).q, atol=1e-12)


def test_progress_counts_elements() -> None:
    robot, values = some_values(10)
    seen: list[tuple[int, int]] = []
    eurdf.batch.forward_kinematics(robot, values, block=4, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(4, 10), (8, 10), (10, 10)]


def test_memory_does_not_grow_with_the_number_of_elements() -> None:
    robot, values = some_values(3)
    peaks = []
    for count in (4_000, 16_000):
        many = np.repeat(values[:1], count, axis=0)
        tracemalloc.start()
        eurdf.batch.forward_kinematics(robot, many)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    results = 12_000 * (robot.model.nq + 3) * 8
    assert peaks[1] - peaks[0] < 4 * results


def test_no_elements_give_empty_results() -> None:
    robot = robot_called("digit_leg")
    found = eurdf.batch.forward_kinematics(robot, np.empty((0, 6)))
    assert (found.q.shape, found.converged.shape, found.reason) == ((0, 33), (0,), ())
    r, K = eurdf.batch.residual_and_jacobian(robot, np.empty((0, 33)))
    assert (r.shape, K.shape) == ((0, 18), (0, 18, 27))


def test_error_in_a_block_is_raised() -> None:
    robot, values = some_values(8)

    def interrupt(done: int, total: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        eurdf.batch.forward_kinematics(robot, values, block=2, threads=2, progress=interrupt)


# --- the tree --------------------------------------------------------------------------------------------------------


# --- errors ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"values": np.zeros(6)}, "values has the shape (6,); expected (B, 6): one row for each element"),
        ({"values": np.full((2, 6), np.nan)}, "values[0, 0] is nan, not finite"),
        ({"q0": np.zeros((3, 33))}, "q0[0] has a quaternion, or a (cos, sin) pair, whose length is zero"),
        ({"q0": np.ones((2, 33))}, "q0 has 2 rows; expected 3, one for each element, or one configuration"),
        ({"q0": np.zeros(32)}, "q0 has the shape (32,); expected (33,)"),
        ({"block": 0}, "block is 0; expected an integer of at least 1"),
        ({"threads": 2, "executor": Eager()}, "both threads and executor are given; use one of them"),
    ],
)
def test_wrong_argument_is_named(arguments: Any, complaint: str) -> None:
    robot = robot_called("digit_leg")
    with pytest.raises(ValueError, match=re.escape(complaint)):
        eurdf.batch.forward_kinematics(robot, **{"values": np.zeros((3, 6)), **arguments})


def test_frame_must_be_a_name() -> None:
    robot = robot_called("digit_leg")
    q = eurdf.assemble(robot).q
    for function in (eurdf.actuated_jacobian, eurdf.batch.actuated_jacobian):
        with pytest.raises(ValueError, match=r"(?s)q is 'foot'|frame is array\(.*it must be the name of a frame"):
            function(robot, q[None], "foot")  # type: ignore[arg-type]
