"""`eurdf.batch` against the functions for one element, and how batches are divided."""

from __future__ import annotations

import multiprocessing
import re
import tracemalloc
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.collection import collection_names
from eurdf.kinematics.batch import linear, rigid
from eurdf.kinematics.batch.joints import motions
from eurdf.kinematics.batch.problem import problem
from eurdf.kinematics.batch.stack import BatchStack
from eurdf.kinematics.batch.tree import BatchTree
from eurdf.mechanism.constraint import Closure
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.actuated import robot_called
from support.closed_tree import closed_tree
from support.described import body, load, revolute
from support.plain_urdf import robot as urdf

EQUAL = 1e-9

seeds = st.integers(0, 2**32 - 1)
#: Robots whose tests take long.
LARGE = ("toddlerbot_2legs", "unitree_g1")
#: Those of which a leg is a robot of its own, which is tested; and one of them.
TWICE = {f"{name.removesuffix('_leg')}_2legs" for name in collection_names()} - {"digit_2legs"}
of_every_robot = pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * (name in LARGE))
        for name in collection_names()
        if name not in TWICE
    ],
)
#: Of each kind of joint, closure and root, with a rank that is full or not: where the loops are closed again and again.
of_some_robots = pytest.mark.parametrize(
    "name",
    [
        "battobot",
        "bennett",
        "cassie_leg",
        "delta",
        "digit_2legs",
        "doggo_leg",
        "double_wishbone",
        "excavator",
        "five_bar",
        "kangaroo_leg",
        "robotiq_2f85",
        "screw_press",
        "stewart_platform",
        "tello",
    ],
)


def near(robot: Robot, random: np.random.Generator, count: int, spread: float = 0.3, q: Any = None) -> Any:
    """Configurations around one, closed or not."""
    q = eurdf.assemble(robot).q if q is None else q
    return np.array(
        [pin.integrate(robot.model, q, random.uniform(-spread, spread, robot.model.nv)) for _ in range(count)]
    )


def motors_near(robot: Robot, q: Any, random: np.random.Generator, count: int, spread: float) -> Any:
    """Actuated coordinates around those of q."""
    v = np.zeros((count, robot.model.nv))
    v[:, robot.actuation.idx_v] = random.uniform(-spread, spread, (count, len(robot.actuation.idx_v)))
    return np.array([pin.integrate(robot.model, q, each)[robot.actuation.idx_q] for each in v])


def one_by_one(robot: Robot, values: Any, q0: Any) -> list[Any]:
    """Results of the function for one element; None where it does not converge."""
    found = []
    for own, start in zip(values, np.broadcast_to(q0, (len(values), robot.model.nq)), strict=True):
        try:
            found.append(eurdf.forward_kinematics(robot, own, start))
        except eurdf.NotClosable:
            found.append(None)
    return found


def assert_same_forward_kinematics(robot: Robot, values: Any, q0: Any) -> Any:
    batch, singles = eurdf.batch.forward_kinematics(robot, values, q0), one_by_one(robot, values, q0)
    for q, converged, residual, reason, single in zip(
        batch.q, batch.converged, batch.residual, batch.reason, singles, strict=True
    ):
        assert converged == (single is not None)
        assert converged == (reason is None)
        assert residual == pytest.approx(np.linalg.norm(eurdf.residual(robot, q)), abs=EQUAL)
        if converged:
            np.testing.assert_allclose(q, single, atol=EQUAL)
    return batch


def moved(robot: Robot, q: Any, random: np.random.Generator, count: int, spread: float) -> Any:
    """Configurations around one; the loops are open there."""
    return np.array(
        [pin.integrate(robot.model, q, random.uniform(-spread, spread, robot.model.nv)) for _ in range(count)]
    )


def assert_same_residual(robot: Robot, q: Any) -> None:
    r, K = eurdf.batch.residual_and_jacobian(robot, q)
    np.testing.assert_array_equal(eurdf.batch.residual(robot, q), r)
    for own_r, own_K, own_q in zip(r, K, q, strict=True):
        single_r, single_K = eurdf.residual_and_jacobian(robot, own_q)
        np.testing.assert_allclose(own_r, single_r, atol=EQUAL)
        np.testing.assert_allclose(own_K, single_K, atol=EQUAL)


# --- every robot, every kind of joint and constraint -----------------------------------------------------------------


@of_every_robot
def test_residual_and_jacobian_equal_single_ones(name: str) -> None:
    robot, random = robot_called(name), np.random.default_rng(0)
    assert_same_residual(robot, moved(robot, eurdf.assemble(robot).q, random, 4, 0.5))


@settings(max_examples=25, deadline=None)
@given(seed=seeds, root=st.sampled_from(["fixed", "floating"]))
def test_residual_of_every_joint_and_constraint_equals_single_one(seed: int, root: Any) -> None:
    random = np.random.default_rng(seed)
    robot, q = closed_tree(random, root=root)
    assert np.abs(eurdf.batch.residual(robot, q[None])).max() <= EQUAL
    assert_same_residual(robot, moved(robot, q, random, 3, 0.4))


@of_some_robots
def test_forward_kinematics_equals_single_one(name: str) -> None:
    robot, random = robot_called(name), np.random.default_rng(1)
    q0 = eurdf.assemble(robot).q
    spread = 0.002 if name.startswith(("kangaroo", "wl16", "disney", "tesla")) else 0.2
    batch = assert_same_forward_kinematics(robot, motors_near(robot, q0, random, 3, spread), q0)
    assert batch.converged.any()


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(
    seed=seeds,
    kind=st.sampled_from(["3d", "hinge", "distance", "coupling"]),
    root=st.sampled_from(["fixed", "floating"]),
)
def test_forward_kinematics_of_random_mechanisms_equals_single_one(seed: int, kind: str, root: Any) -> None:
    random = np.random.default_rng(seed)
    robot, q0 = closed_tree(random, (kind,), root)
    assert_same_forward_kinematics(robot, motors_near(robot, q0, random, 3, 0.2), q0)


@of_some_robots
def test_projection_equals_single_one(name: str) -> None:
    robot = robot_called(name)
    q = moved(robot, eurdf.assemble(robot).q, np.random.default_rng(7), 2, 0.1)
    q = np.concatenate((q, eurdf.assemble(robot).q[None]))  # one that is closed stays where it is
    found = eurdf.batch.project_configuration(robot, q)
    for own, place, residual in zip(found.q, q, found.residual, strict=True):
        np.testing.assert_allclose(own, eurdf.project_configuration(robot, place), atol=EQUAL)
        assert residual == pytest.approx(np.linalg.norm(eurdf.residual(robot, own)), abs=EQUAL)
    assert found.converged.all()


def test_projection_in_a_metric_equals_single_one() -> None:
    robot, random = robot_called("digit_leg_3d"), np.random.default_rng(8)
    q = moved(robot, eurdf.assemble(robot).q, random, 3, 0.2)
    weights = eurdf.mass_matrix(robot, q[0]) + 0.1 * np.eye(robot.model.nv)
    found = eurdf.batch.project_configuration(robot, q, weights)
    for own, place in zip(found.q, q, strict=True):
        np.testing.assert_allclose(own, eurdf.project_configuration(robot, place, weights), atol=EQUAL)


@of_some_robots
def test_actuated_jacobian_equals_single_one(name: str) -> None:
    robot, random = robot_called(name), np.random.default_rng(9)
    q = eurdf.batch.project_configuration(robot, moved(robot, eurdf.assemble(robot).q, random, 2, 0.01)).q
    frame = robot.mechanism.bodies[-1].name
    metrics = (None, random.uniform(0.5, 2.0, robot.model.nv), None)
    for reference, weights in zip((pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED), metrics, strict=True):
        found = eurdf.batch.actuated_jacobian(robot, q, frame, reference, weights)
        for J, own in zip(found.jacobian, q, strict=True):
            single = eurdf.actuated_jacobian(robot, own, frame, reference, weights)
            np.testing.assert_allclose(J, single, atol=EQUAL * np.abs(single).max())
        assert found.converged.all()


def targets_near(robot: Robot, random: np.random.Generator, count: int, spread: float) -> tuple[str, list[Any]]:
    """Poses that the last link can reach."""
    link, data = robot.mechanism.bodies[-1].name, robot.model.createData()
    index = robot.model.getFrameId(link, pin.FrameType.BODY)
    found = []
    for q in moved(robot, eurdf.assemble(robot).q, random, count, spread):
        pin.framesForwardKinematics(robot.model, data, eurdf.assemble(robot, q).q)
        found.append(pin.SE3(data.oMf[index]))
    return link, found


@of_some_robots
def test_inverse_kinematics_equals_single_one(name: str) -> None:
    robot = robot_called(name)
    link, poses = targets_near(robot, np.random.default_rng(10), 2, 0.1)
    for targets in (poses, np.array([pose.translation for pose in poses])):
        found = eurdf.batch.inverse_kinematics(robot, {link: targets}, limits=False)
        for index, target in enumerate(targets):
            single = eurdf.inverse_kinematics(robot, {link: target}, limits=False)
            np.testing.assert_allclose(found.q[index], single.q, atol=EQUAL)
            assert found.converged[index]
            assert found.position_error[index, 0] == pytest.approx(single.errors[0].position, abs=EQUAL)
            assert found.angle_error[index, 0] == pytest.approx(single.errors[0].angle, abs=EQUAL)


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


@pytest.mark.parametrize(
    ("targets", "complaint"),
    [
        ({"foot": np.zeros((2, 4))}, "targets['foot'] has the shape (2, 4); expected (B, 3): one row for each element"),
        ({"foot": np.zeros((2, 4, 4))}, "targets['foot'][0] is not a pose: its rotation is not orthonormal"),
        ({"foot": np.full((2, 3), np.inf)}, "targets['foot'][0, 0] is inf, not finite"),
        (
            {"foot": np.zeros((2, 3)), "thigh": np.zeros((3, 3))},
            "targets['thigh'] has 3 elements; the first frame has 2",
        ),
        ({"fot": np.zeros((2, 3))}, "the model has no frame 'fot'; did you mean 'foot'?"),
    ],
)
def test_wrong_targets_are_named(targets: Any, complaint: str) -> None:
    with pytest.raises(ValueError, match=re.escape(complaint)):
        eurdf.batch.inverse_kinematics(robot_called("digit_leg"), targets)


def test_jacobian_of_dependent_actuators_says_so() -> None:
    robot = four_bar(2.5, 2.5, 2.0, "crank_pin, rocker_pin")
    q = eurdf.assemble(robot, np.array([1.0, -0.5, 1.7])).q
    found = eurdf.batch.actuated_jacobian(robot, q[None], "rocker")
    assert (found.converged.tolist(), found.reason) == ([False], ("dependent actuators",))
    assert np.isnan(found.jacobian).all()
    with pytest.raises(eurdf.DependentActuators):
        eurdf.actuated_jacobian(robot, q, "rocker")


def test_numbers_that_overflow_leave_others_alone() -> None:
    robot = four_bar(2.5, 2.5, 2.0, "crank_pin")
    q = np.array([[1.0, -0.5, 1.7], [1e300, 1e300, -1e300], [1.1, -0.5, 1.7]])
    projected = eurdf.batch.project_configuration(robot, q)
    for index in (0, 2):
        np.testing.assert_allclose(projected.q[index], eurdf.project_configuration(robot, q[index]), atol=EQUAL)
    start = projected.q[[0, 0, 2]]
    moved_by = eurdf.batch.forward_kinematics(robot, [[1.05], [1e300], [1.2]], start)
    assert moved_by.converged[[0, 2]].all()


# --- elements do not affect each other -------------------------------------------------------------------------------


def test_element_that_cannot_be_reached_says_why_and_leaves_others_alone() -> None:
    robot, random = robot_called("digit_leg"), np.random.default_rng(2)
    q0 = eurdf.assemble(robot).q
    values = motors_near(robot, q0, random, 5, 0.1)
    alone = eurdf.batch.forward_kinematics(robot, np.delete(values, 2, axis=0), q0)
    values[2, 3] += 2.5  # beyond what the rod can follow
    together = assert_same_forward_kinematics(robot, values, q0)
    assert together.converged.tolist() == [True, True, False, True, True]
    assert together.reason[2] is not None
    np.testing.assert_allclose(np.delete(together.q, 2, axis=0), alone.q, atol=1e-12)


def four_bar(
    ground: float, coupler: float, rocker: float, actuator: str, assembled: tuple[float, ...] | None = None
) -> Robot:
    """Planar, with a crank of 1 m; all bars along x at zero."""
    pins = [
        revolute("crank_pin", "base", "crank"),
        revolute("coupler_pin", "crank", "coupler", origin=placed("1 0 0")),
        revolute("rocker_pin", "base", "rocker", origin=placed(f"{ground} 0 0")),
    ]
    text = urdf(*map(body, ("base", "crank", "coupler", "rocker")), *pins)
    ends = f"{{link: coupler, xyz: [{coupler}, 0, 0]}}, {{link: rocker, xyz: [{rocker}, 0, 0]}}"
    robot = load(text, f"actuators: [{actuator}]\nclosures: [{{name: pin, type: 3d, frames: [{ends}]}}]\n")
    if assembled is None:
        return robot
    closed = robot.coordinates(eurdf.assemble(robot, np.array(assembled)).q)
    return build_robot(replace(robot.mechanism, configurations={"assembled": closed}), geometry=False)


def placed(xyz: str) -> str:
    return f'<origin xyz="{xyz}" rpy="0 0 0"/>'


def test_values_beyond_a_dead_point_say_whether_the_loops_close_there() -> None:
    robot = four_bar(2.5, 2.5, 2.0, "rocker_pin")
    q0 = eurdf.assemble(robot, np.array([1.0, -0.5, 1.7])).q
    found = assert_same_forward_kinematics(robot, np.array([[0.0], [1.5], [2.0], [3.1], [4.5], [6.0]]), q0)
    assert found.reason == ("not closed", None, None, "not closed", "blocked", "not closed")
    np.testing.assert_array_equal(found.residual > 1e-3, [reason == "not closed" for reason in found.reason])


def test_start_whose_loops_cannot_be_closed_is_the_reason() -> None:
    robot = four_bar(6.0, 2.5, 2.0, "crank_pin")
    for q0 in (np.zeros(3), np.zeros((2, 3))):
        found = eurdf.batch.forward_kinematics(robot, [[0.1], [0.2]], q0)
        assert found.reason == ("start open", "start open")
        assert (found.residual > 0.4).all()


def test_each_element_stays_on_the_branch_of_its_start() -> None:
    robot, random = robot_called("five_bar"), np.random.default_rng(3)
    assembled = eurdf.assemble(robot).q
    other = next(
        found.q
        for found in (
            eurdf.assemble(robot, place, hold=robot.actuation.joints)
            for place in moved(robot, assembled, random, 50, 3.0)
            for place in [np.where(np.isin(np.arange(robot.model.nq), robot.actuation.idx_q), assembled, place)]
        )
        if found.closes and np.abs(found.q - assembled).max() > 0.5
    )
    starts = np.array([assembled, other, assembled, other])
    values = motors_near(robot, assembled, random, 4, 0.1)
    found = assert_same_forward_kinematics(robot, values, starts)
    assert found.converged.all()
    np.testing.assert_array_less(np.abs(found.q - starts).max(axis=1), 0.5)


def test_forward_kinematics_from_a_singular_start_equals_single_one() -> None:
    parallelogram, q0 = four_bar(2.0, 2.0, 1.0, "crank_pin"), np.zeros(3)
    r, K = eurdf.batch.residual_and_jacobian(parallelogram, q0[None])
    assert not r.any()
    assert np.linalg.matrix_rank(K[0, :, 1:]) == 1
    found = assert_same_forward_kinematics(parallelogram, np.array([[-0.5], [0.0], [0.5]]), q0)
    assert found.reason == ("blocked", None, "blocked")


def test_values_in_any_order_give_the_same() -> None:
    robot = robot_called("digit_leg")
    values = motors_near(robot, eurdf.assemble(robot).q, np.random.default_rng(4), 7, 0.3)
    order = [3, 1, 6, 0, 2, 5, 4]
    forward, shuffled = (eurdf.batch.forward_kinematics(robot, each) for each in (values, values[order]))
    np.testing.assert_allclose(shuffled.q, forward.q[order], atol=1e-12)


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
def test_process_pool_gives_the_same() -> None:
    robot, values = some_values(9)
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        found = eurdf.batch.forward_kinematics(robot, values, executor=pool, block=5)
    np.testing.assert_allclose(found.q, eurdf.batch.forward_kinematics(robot, values).q, atol=1e-12)


@pytest.mark.slow
def test_dask_cluster_gives_the_same() -> None:
    distributed = pytest.importorskip("distributed", reason="distributed is not installed: pip install -e '.[cluster]'")
    robot, values = some_values(9)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        found = eurdf.batch.forward_kinematics(robot, values, executor=client.get_executor(), block=5)
    np.testing.assert_allclose(found.q, eurdf.batch.forward_kinematics(robot, values).q, atol=1e-12)


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


# --- errors ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"values": np.zeros(6)}, r"values has the shape (6,); expected (B, 6): one row for each element"),
        ({"values": np.zeros((2, 5))}, r"values has the shape (2, 5); expected (B, 6)"),
        ({"values": [[0.0] * 6, [0.0] * 5]}, r"values has the shape ()"),
        ({"values": np.full((2, 6), np.nan)}, r"values[0, 0] is nan, not finite"),
        ({"q0": np.zeros((3, 33))}, r"q0[0] has a quaternion, or a (cos, sin) pair, whose length is zero"),
        ({"q0": np.ones((2, 33))}, r"q0 has 2 rows; expected 3, one for each element, or one configuration"),
        ({"q0": np.zeros(32)}, r"q0 has the shape (32,); expected (33,)"),
        ({"tolerance": -1.0}, "tolerance is -1.0"),
        ({"block": 0}, "block is 0; expected an integer of at least 1"),
        ({"threads": 1.5}, "threads is 1.5; expected an integer of at least 1"),
        ({"threads": 2, "executor": Eager()}, "both threads and executor are given; use one of them"),
    ],
)
def test_wrong_argument_is_named(arguments: Any, complaint: str) -> None:
    robot = robot_called("digit_leg")
    with pytest.raises(ValueError, match=re.escape(complaint)):
        eurdf.batch.forward_kinematics(robot, **{"values": np.zeros((3, 6)), **arguments})


def test_error_in_a_block_is_raised() -> None:
    robot, values = some_values(8)

    def interrupt(done: int, total: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        eurdf.batch.forward_kinematics(robot, values, block=2, threads=2, progress=interrupt)


def test_constraint_of_an_unknown_kind_is_refused() -> None:
    @dataclass(frozen=True, slots=True)
    class Belt(Closure):
        type: ClassVar[str] = "belt"
        units: ClassVar[tuple[Any, ...]] = ("m",)

    robot = robot_called("digit_leg")
    first = robot.mechanism.closures[0]
    odd = replace(robot, mechanism=replace(robot.mechanism, closures=(Belt("belt", first.a, first.b),)))
    with pytest.raises(NotImplementedError, match="does not support constraints of type 'belt'"):
        BatchStack(BatchTree(robot), odd.constraints, np.arange(robot.model.nv), {})


def test_every_joint_type_is_supported() -> None:
    for kind in by_hand.MOVING:
        joint = by_hand.some_joint(kind, np.random.default_rng(0))
        assert sum(each.nv for each in motions(joint, unwrapped=False)) == joint.type.nv


# --- the tree --------------------------------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(seed=seeds, size=st.sampled_from([1e-9, 1e-4, 0.02, 0.5, 2.0]))
def test_configurations_of_every_joint_move_as_in_pinocchio(seed: int, size: float) -> None:
    random = np.random.default_rng(seed)
    robot, q = closed_tree(random, (), "floating")
    tree, model = problem(robot).tree, robot.model
    v, force = random.uniform(-size, size, model.nv), random.uniform(-1.0, 1.0, model.nv)
    other = pin.integrate(model, q, v)
    at, there = q[:, None], other[:, None]
    np.testing.assert_allclose(tree.integrate(at, v[:, None])[:, 0], pin.normalize(model, other), atol=EQUAL)
    np.testing.assert_allclose(tree.difference(at, there)[:, 0], pin.difference(model, q, other), atol=EQUAL)
    by_pinocchio = pin.dDifference(model, q, other, pin.ARG1).T @ force
    np.testing.assert_allclose(
        tree.difference_derivative_times(at, there, force[:, None])[:, 0], by_pinocchio, atol=1e-8
    )


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-5, 0.099, 0.101, 1.0, 3.0, 3.14])
def test_logarithms_and_their_derivatives_are_exact(angle: float) -> None:
    random = np.random.default_rng(6)
    axes = random.normal(size=(20, 3))
    turns = angle * axes / np.linalg.norm(axes, axis=1)[:, None]
    poses = [pin.SE3(pin.exp3(turn), random.normal(size=3)) for turn in turns]
    R, p = np.stack([pose.rotation for pose in poses], axis=-1), np.stack([pose.translation for pose in poses], axis=-1)
    linear, angular = rigid.log6(R, p)
    np.testing.assert_allclose(angular, turns.T, atol=1e-12)
    np.testing.assert_allclose(rigid.of_quaternion(rigid.quaternion_exp(angular)), R, atol=1e-14)
    np.testing.assert_allclose(rigid.translation_exp(linear, angular), p, atol=1e-12)
    J, h = rigid.jacobian_log6(R, p), 1e-5
    for column, unit in enumerate(np.eye(6)):
        ends = [pose * pin.exp6(sign * h * unit) for pose in poses for sign in (1.0, -1.0)]
        logs = np.concatenate(
            rigid.log6(np.stack([e.rotation for e in ends], axis=-1), np.stack([e.translation for e in ends], axis=-1))
        )
        np.testing.assert_allclose((logs[:, ::2] - logs[:, 1::2]) / (2.0 * h), J[:, column], atol=1e-6)


@pytest.mark.parametrize("n", [1, 5, 61])  # the last one by LAPACK
def test_systems_are_solved_and_those_without_full_rank_named(n: int) -> None:
    random = np.random.default_rng(n)
    A, b = random.normal(size=(n, n + 2, 4)), random.normal(size=(n, 2, 4))
    A[-1, :, 1] = A[0, :, 1] if n > 1 else 0.0
    G = np.array(linear.gram(A))
    G[0, 0, 2] = np.nan
    G[0, 0, 3] = -1.0
    x, pivot = linear.solve(G, b)
    np.testing.assert_allclose(G[:, :, 0] @ x[:, :, 0], b[:, :, 0], atol=1e-8)
    assert pivot[0] > 1e-8
    assert (pivot[1:] < 1e-12).all()
    np.testing.assert_allclose(linear.solve(G, b[:, 0])[0][:, 0], x[:, 0, 0])
