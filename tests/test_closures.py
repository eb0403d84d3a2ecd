"""Hinge, distance and coupling: against differences, against the same in the tree, and against MuJoCo."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.closures import REGISTRY
from eurdf.closures.distance import DistanceClosure
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.closures.se3 import plane_across
from eurdf.closures.turn import HeldTurn
from eurdf.commands.robot_info import robot_info
from eurdf.kinematics.residual import acceleration_drift
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure, Constraint, Coupling
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import Robot, build_robot
from support.described import LIMITED, body, load, revolute
from support.linkage import Linkage, X, loop, pose_of
from support.mechanisms import KINDS, some_robot
from support.plain_urdf import joint_element
from support.plain_urdf import robot as urdf

seeds = st.integers(0, 2**32 - 1)


def at(body: str, *xyz: float) -> Anchor:
    return Anchor(body, Pose(tuple(map(float, xyz))))  # type: ignore[arg-type]


def constrained(base: Robot, *constraints: Constraint) -> Robot:
    """The robot with these constraints in place of its own."""
    mechanism = replace(
        base.mechanism,
        closures=tuple(each for each in constraints if isinstance(each, Closure)),
        couplings=tuple(each for each in constraints if isinstance(each, Coupling)),
    )
    return build_robot(mechanism, geometry=False)


def placed(xyz: str) -> str:
    return f'<origin xyz="{xyz}" rpy="0 0 0"/>'


# --- three mechanisms of mobility 1, and each once more without the new kind -----------------------------------------

CRANK = [body("base"), body("crank"), revolute("j0", "base", "crank", (0, 0.1, 1))]
ROCKER = [body("rocker"), revolute("j2", "base", "rocker", (0, 0.1, 1), placed("1 0 0"))]
COUPLER = [body("coupler"), revolute("j1", "crank", "coupler", (0, 0.1, 1), placed("0.4 0 0"))]
AXIS = (0.0, 0.1, 1.0)


def hinge() -> Robot:
    """A four-bar, cut at the pin of coupler and rocker."""
    pin_ = HingeClosure("pin", at("coupler", 1, 0, 0), at("rocker", 0.8, 0, 0), (AXIS, AXIS))
    return constrained(load(urdf(*CRANK, *COUPLER, *ROCKER), "actuators: [j0]\n"), pin_)


def hinge_in_the_tree() -> Robot:
    """The same, with the pin a joint, and the cut behind it."""
    end = ['<link name="end"/>', revolute("j3", "coupler", "end", AXIS, placed("1 0 0"))]
    text = urdf(*CRANK, *COUPLER, *end, *ROCKER)
    return constrained(
        load(text, "actuators: [j0]\n"), FrameClosure("cut", at("end", 0, 0, 0), at("rocker", 0.8, 0, 0))
    )


SKEW_ROCKER = [body("rocker"), revolute("j2", "base", "rocker", (0.3, 0.1, 1), placed("1 0 0.1"))]


def distance() -> Robot:
    """A crank and a rocker about skew axes, with a rod between two balls."""
    rod = DistanceClosure("rod", at("crank", 0.4, 0, 0), at("rocker", 0.8, 0, 0), 1.0)
    return constrained(load(urdf(*CRANK, *SKEW_ROCKER), "actuators: [j0]\n"), rod)


def distance_in_the_tree() -> Robot:
    """The same, with a massless rod; it does not spin, for one of its balls is a universal joint."""
    rod = [
        '<link name="rod"/>',
        joint_element("ball", "revolute", "crank", "rod", LIMITED.format("0 0 1"), placed("0.4 0 0")),
    ]
    text = urdf(*CRANK, *rod, *SKEW_ROCKER)
    tree = load(text, "joints: {ball: {type: universal, axes: yz}}\nactuators: [j0]\n")
    return constrained(tree, PointClosure("tip", at("rod", 1, 0, 0), at("rocker", 0.8, 0, 0)))


def arm(content: str = "", kind: str = "revolute") -> str:
    limits = LIMITED if kind == "revolute" else '<axis xyz="{}"/>'
    joints = [
        joint_element("j0", kind, "base", "upper", limits.format("0 0.6 0.8")),
        joint_element("j1", kind, "upper", "lower", limits.format("0 1 0") + content, placed("0.5 0 0.1")),
    ]
    return urdf(body("base"), body("upper"), body("lower"), *joints)


def coupling(kind: str = "revolute") -> Robot:
    """Two joints of an arm, the second of which turns by half of the first and 0.2 rad."""
    law = Coupling("belt", (("j1", 2.0), ("j0", -1.0)), 0.4)
    return constrained(load(arm(kind=kind), "actuators: [j0]\n"), law)


def coupling_in_the_tree(kind: str = "revolute") -> Robot:
    return load(arm('<mimic joint="j0" multiplier="0.5" offset="0.2"/>', kind), "actuators: [j0]\n")


PAIRS: dict[str, tuple[Callable[[], Robot], Callable[[], Robot]]] = {
    "hinge": (hinge, hinge_in_the_tree),
    "distance": (distance, distance_in_the_tree),
    "coupling": (coupling, coupling_in_the_tree),
    "coupling of continuous joints": (lambda: coupling("continuous"), lambda: coupling_in_the_tree("continuous")),
}
of_each_kind = pytest.mark.parametrize("build", [pair[0] for pair in PAIRS.values()], ids=PAIRS.keys())
pairs = pytest.mark.parametrize(("build", "twin"), PAIRS.values(), ids=PAIRS.keys())


def state(robot: Robot, angle: float, speed: float) -> tuple[Any, Any]:
    """The closed configuration with j0 at an angle, on the branch of the assembled one, and its velocity."""
    q = eurdf.forward_kinematics(robot, {"j0": angle}, start(robot))
    return q, eurdf.kinematics.dq_dq_actuated(robot, q)[:, 0] * speed


def start(robot: Robot) -> Any:
    """A closed configuration with the coupler above."""
    known = {"j0": 0.9, "j1": -0.4, "j2": 1.7}
    q = pin.neutral(robot.model)
    for name, angle in known.items():
        if robot.model.existJointName(name) and robot.model.joints[robot.model.getJointId(name)].nq == 1:
            q[robot.model.joints[robot.model.getJointId(name)].idx_q] = angle
    assembly = eurdf.assemble(robot, q)
    assert assembly.closes
    return assembly.q


def of_joints(robot: Robot, v: Any, names: Sequence[str]) -> Any:
    return np.array([v[robot.model.joints[robot.model.getJointId(name)].idx_v] for name in names])


SHARED = {"hinge": ("j0", "j1", "j2"), "distance": ("j0", "j2"), "coupling": ("j0",)}


# --- derivatives -----------------------------------------------------------------------------------------------------


def far_from_half_a_turn(robot: Robot, q: Any) -> bool:
    """Where two frames, or two axes, are half a turn apart, the rotation between them has no derivative."""
    closures = {closure.name for closure in robot.mechanism.closures}
    found = eurdf.kinematics.closure_openings(robot, q)
    return all(opening.angle < np.pi - 0.2 for opening in found if opening.name in closures)


@pytest.mark.parametrize("kinds", [*((kind,) for kind in KINDS), KINDS, KINDS[:4] * 2], ids=str)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_jacobian_and_drift_are_derivatives_of_the_residual(kinds: Sequence[str], seed: int) -> None:
    random = np.random.default_rng(seed)
    check_derivatives(some_robot(random, kinds), random)


@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_held_turn_has_the_derivatives_of_its_residual(seed: int) -> None:
    random = np.random.default_rng(seed)
    base = some_robot(random, ("6d",))
    (cut,) = base.mechanism.closures
    turns = [HeldTurn(axis, cut.a, cut.b, axis="xyz".index(axis)) for axis in "zx"]
    check_derivatives(constrained(base, *turns), random)
    q = pin.randomConfiguration(base.model, -np.ones(base.model.nq), np.ones(base.model.nq))
    rows = eurdf.residual(base, q)[[5, 3]]
    np.testing.assert_allclose(eurdf.residual(constrained(base, *turns), q), rows, atol=1e-12)


def check_derivatives(robot: Robot, random: np.random.Generator) -> None:
    model, v = robot.model, random.uniform(-1.0, 1.0, robot.model.nv)
    q = pin.integrate(model, pin.neutral(model), random.uniform(-1.5, 1.5, model.nv))
    assume(far_from_half_a_turn(robot, q))

    def r(t: float, along: Any) -> Any:
        return eurdf.residual(robot, pin.integrate(model, q, t * along))

    def derivative(f: Callable[[float], Any], step: float = 1e-4) -> Any:
        return (8.0 * (f(step) - f(-step)) - f(2.0 * step) + f(-2.0 * step)) / (12.0 * step)

    def Kv(t: float) -> Any:  # noqa: N802 - the field's own symbol
        return eurdf.residual_and_jacobian(robot, pin.integrate(model, q, t * v))[1] @ v

    _, K = eurdf.residual_and_jacobian(robot, q)
    assert K.shape == (robot.mechanism.nc, model.nv)
    expected = np.column_stack([derivative(lambda t, e=e: r(t, e)) for e in np.eye(model.nv)])
    np.testing.assert_allclose(K, expected, rtol=0.0, atol=1e-7 * np.abs(K).max(initial=1.0))
    drift, differences = acceleration_drift(robot, q, v), derivative(Kv)
    np.testing.assert_allclose(drift, differences, rtol=0.0, atol=1e-6 * np.abs(differences).max(initial=1.0))


def hinged(turn: Any) -> Linkage:
    """A body that turns about x, with a hinge about the axis z of A and that of B, turned by ``turn``."""
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "j0")
    z = (0.0, 0.0, 1.0)
    return Linkage(model, [HingeClosure("pin", Anchor("universe"), Anchor(model.names[joint], pose_of(turn)), (z, z))])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 0.3, 0.499999, 0.500001, 1.5, 3.1])
def test_hinge_residual_is_the_rotation_vector_between_the_axes(angle: float) -> None:
    linkage, q = hinged(pin.SE3.Identity()), np.array([angle])
    r, K = eurdf.residual_and_jacobian(linkage, q)
    np.testing.assert_allclose(r, [0.0, 0.0, 0.0, angle, 0.0], atol=1e-12)
    np.testing.assert_allclose(K[:, 0], [0.0, 0.0, 0.0, 1.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(acceleration_drift(linkage, q, np.ones(1)), 0.0, atol=1e-6)


@pytest.mark.parametrize(("off", "first"), [(0.9e-9, 1.0), (1.1e-9, -1.0), (5e-9, -1.0), (1e-3, -1.0)])
def test_plane_across_an_axis_near_minus_z_is_orthonormal(off: float, first: float) -> None:
    a = np.array([math.sin(off), 0.0, -math.cos(off)])
    across = plane_across(a)
    np.testing.assert_allclose(np.column_stack((across, a)).T @ np.column_stack((across, a)), np.eye(3), atol=1e-8)
    np.testing.assert_allclose(across, [[first, 0.0], [0.0, -first], [0.0, 0.0]], atol=2e-3)


def test_opposite_hinge_axes_are_half_a_turn_apart() -> None:
    linkage = hinged(pin.SE3(np.diag([1.0, -1.0, -1.0]), np.zeros(3)))
    r, K = eurdf.residual_and_jacobian(linkage, np.zeros(1))
    assert np.linalg.norm(r) == pytest.approx(np.pi)
    assert np.isfinite(K).all()
    (opening,) = eurdf.kinematics.closure_openings(linkage, np.zeros(1))
    assert (opening.position, opening.angle) == (0.0, pytest.approx(np.pi))


def test_distance_at_one_point_has_a_direction() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "j0")
    linkage = Linkage(model, [DistanceClosure("rod", Anchor("universe"), Anchor("j0"), 2.0)])
    r, K = eurdf.residual_and_jacobian(linkage, np.zeros(1))
    np.testing.assert_allclose((r[0], K[0, 0]), (-2.0, 1.0))
    assert np.isfinite(acceleration_drift(linkage, np.zeros(1), np.ones(1))).all()
    assert eurdf.assemble(linkage).q[0] == pytest.approx(2.0)


REFERENCE = Path(eurdf.__file__).parent


def files_with(pattern: str) -> set[str]:
    """The modules of the package in whose code a pattern occurs."""
    return {
        path.relative_to(REFERENCE).as_posix()
        for path in REFERENCE.rglob("*.py")
        if re.search(pattern, path.read_text(encoding="utf-8"))
    }


def test_no_function_of_kinematics_asks_for_a_kind() -> None:
    kinds = "|".join(kind.__name__ for kind in REGISTRY.values())
    asking = files_with(rf"""\b({kinds})\b|["'][36]d["']|residualSize|CONTACT_""")
    assert {path for path in asking if path.startswith("kinematics/")} <= {"kinematics/batch/constraints.py"}
    by_pinocchio = {f"pinocchio/{name}.py" for name in ("constraint", "tree_few")}
    assert files_with("CONTACT_[36]D") == by_pinocchio


# --- mobility --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "rank", "mobility"), [("3d", 3, 2), ("hinge", 4, 1), ("6d", 5, 0)])
def test_sarrus_cut_at_a_pin_moves_as_its_closure_says(kind: str, rank: int, mobility: int) -> None:
    legs = [((1, 0, 0), (0, 1, 0)), ((1.5, 0, 1), (0, 1, 0)), ((1, 0, 2), (0, 1, 0)), ((0, 1, 2), X), ((0, 1.5, 1), X)]
    cut = loop([("R", point, axis) for point, axis in legs], "3d", (0.0, 1.0, 0.0))
    (end,) = cut.constraints
    assert isinstance(end, Closure)
    if kind == "hinge":
        end = HingeClosure(end.name, end.a, end.b, (X, X))
    elif kind == "6d":
        end = FrameClosure(end.name, end.a, end.b)
    analysis = eurdf.analyze(replace(cut, constraints=[end]))
    assert (analysis.nv, analysis.nc, analysis.rank, analysis.mobility) == (5, end.rows, rank, mobility)


@of_each_kind
def test_new_kinds_leave_one_motion(build: Callable[[], Robot]) -> None:
    robot = build()
    analysis = eurdf.analyze(robot, start(robot))
    assert (analysis.mobility, analysis.uncontrolled, len(analysis.loops)) == (1, 0, 1)
    assert analysis.singularity is not None
    assert analysis.singularity > 0.01
    info = robot_info(robot, analysis)
    assert (info.nc, info.mobility) == (robot.mechanism.nc, 1)
    assert info.residual is not None
    assert info.residual < 1e-9


# --- against the same in the tree ------------------------------------------------------------------------------------


@pairs
@pytest.mark.parametrize("angle", [0.7, 1.3])
def test_new_kinds_move_as_their_twins(build: Callable[[], Robot], twin: Callable[[], Robot], angle: float) -> None:
    robot, other = build(), twin()
    names = next(names for kind, names in SHARED.items() if kind in {each.type for each in robot.constraints})
    (q, v), (q_twin, v_twin) = state(robot, angle, 1.5), state(other, angle, 1.5)
    np.testing.assert_allclose(of_joints(robot, v, names), of_joints(other, v_twin, names), rtol=1e-7)
    torque = np.array([0.6])
    found = eurdf.forward_dynamics(robot, q, v, torque)
    expected = eurdf.forward_dynamics(other, q_twin, v_twin, torque)
    np.testing.assert_allclose(of_joints(robot, found.a, names), of_joints(other, expected.a, names), rtol=1e-6)
    back = eurdf.inverse_dynamics(robot, q, v, found.a)
    np.testing.assert_allclose(back.u, torque, rtol=1e-6)
    assert [len(force) for force in found.forces] == [each.rows for each in robot.constraints]
    np.testing.assert_allclose(np.concatenate(back.forces), np.concatenate(found.forces), rtol=1e-5, atol=1e-8)


@pairs
def test_new_kinds_reach_as_far_as_their_twins(build: Callable[[], Robot], twin: Callable[[], Robot]) -> None:
    ends = []
    for robot in (build(), twin()):
        found = eurdf.sweep(robot, "j0", start(robot), steps=20)
        ends.append((found.lower.end, found.upper.end, found.lower.reached, found.upper.reached))
        assert max(found.lower.residual, found.upper.residual) < 1e-9
    assert ends[0][:2] == ends[1][:2]
    np.testing.assert_allclose(ends[0][2:], ends[1][2:], atol=2e-3)


# --- every function --------------------------------------------------------------------------------------------------


@of_each_kind
def test_new_kinds_are_assembled_projected_and_reached(build: Callable[[], Robot]) -> None:
    robot = build()
    model, random = robot.model, np.random.default_rng(3)
    q, v = state(robot, 1.1, 0.8)
    away = pin.integrate(model, q, random.uniform(-0.1, 0.1, model.nv))
    assembly = eurdf.assemble(robot, away)
    assert assembly.converged
    assert [opening.name for opening in assembly.open] == [each.name for each in robot.constraints]
    nearest = eurdf.project_configuration(robot, away)
    assert np.abs(eurdf.residual(robot, nearest)).max() <= 1e-9
    moved, other = (np.linalg.norm(pin.difference(model, away, each)) for each in (nearest, assembly.q))
    assert moved <= other + 1e-9
    K = eurdf.residual_and_jacobian(robot, q)[1]
    np.testing.assert_allclose(K @ eurdf.project_velocity(robot, q, random.normal(size=model.nv)), 0.0, atol=1e-9)
    a = eurdf.project_acceleration(robot, q, v, random.normal(size=model.nv))
    np.testing.assert_allclose(K @ a + acceleration_drift(robot, q, v), 0.0, atol=1e-8)
    frame = robot.mechanism.bodies[-1].name
    pin.framesForwardKinematics(model, robot.data, q)
    target = pin.SE3(robot.data.oMf[model.getFrameId(frame)])
    found = eurdf.inverse_kinematics(robot, {frame: target}, start(robot), limits=False)
    assert found.converged
    assert np.linalg.norm(eurdf.differential_inverse_kinematics(robot, frame, q, np.ones(6)).v) > 1e-3


@of_each_kind
def test_locking_the_motor_leaves_nothing_that_moves(build: Callable[[], Robot]) -> None:
    robot = build()
    q, _ = state(robot, 1.1, 0.0)
    locked = eurdf.lock(robot, "j0", q)
    assert eurdf.analyze(locked, q[locked.idx_q]).mobility == 0
    np.testing.assert_allclose(eurdf.residual(locked, q[locked.idx_q]), 0.0, atol=1e-9)
    rigid = eurdf.lock(robot, [joint.name for joint in robot.mechanism.joints], q)
    assert rigid.dropped_closures == tuple(each.name for each in robot.constraints)
    assert rigid.constraints == ()


def test_coupling_of_large_coefficients_closes_as_one_of_small() -> None:
    for size in (1e-3, 1.0, 1e4):
        robot = coupling()
        law = Coupling("belt", (("j1", 2.0 * size), ("j0", -1.0 * size)), 0.4 * size)
        robot = constrained(robot, law)
        (opening,) = eurdf.kinematics.closure_openings(robot, np.zeros(2))
        assert (opening.position, opening.angle) == (0.0, pytest.approx(0.2))
        assert eurdf.assemble(robot).closes
        analysis = eurdf.analyze(robot)
        assert (analysis.rank, analysis.singularity) == (1, pytest.approx(np.hypot(1.0, 0.5)))


def test_coupled_joints_are_in_one_group_without_a_loop() -> None:
    robot = coupling()
    (group,) = eurdf.analyze(robot).loops
    assert (group.closures, group.joints) == (("belt",), ("j0", "j1"))
    beside = [body("beside"), revolute("j5", "base", "beside", (0, 0, 1), placed("3 0 0"))]
    text = urdf(*CRANK, *COUPLER, *ROCKER, *beside)
    pin_ = hinge().constraints[0]
    law = Coupling("belt", (("j5", 1.0), ("j0", -1.0)))
    both = constrained(load(text, "actuators: [j0]\n"), pin_, law)
    assert [loops.closures for loops in eurdf.analyze(both, start(both)).loops] == [("pin", "belt")]


# --- Pinocchio, and MuJoCo -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("build", [distance, coupling])
def test_constraint_models_name_the_constraint_that_has_none(build: Callable[[], Robot]) -> None:
    robot = build()
    (constraint,) = robot.constraints
    with pytest.raises(eurdf.errors.NoConstraintModel, match=f"'{constraint.name}'") as raised:
        _, _, *_ = robot
    assert (raised.value.constraint, raised.value.type) == (constraint.name, constraint.type)


MJCF = """<mujoco><compiler angle="radian"/><option gravity="0 0 0"/><worldbody>
  <site name="ground" pos="0.3 0.2 0.9"/>
  <body name="upper" pos="0 0 0"><joint name="j0" axis="0 0.6 0.8"/><geom size="0.1"/>
    <body name="lower" pos="0.5 0 0.1"><joint name="j1" axis="0 1 0"/><geom size="0.1"/>
      <body name="tip" pos="0.4 0.1 0"><joint name="j2" axis="1 0 0"/><geom size="0.1"/>
        <site name="end" pos="0.2 0 0.1"/>
  </body></body></body></worldbody>
  <tendon><spatial name="rod"><site site="ground"/><site site="end"/></spatial></tendon>
  <equality><joint joint1="j2" joint2="j0" polycoef="0.3 0.5 0 0 0"/>
    <connect body1="tip" anchor="0.2 0 0.1"/><connect body1="tip" anchor="0.2 0.7 0.1"/></equality></mujoco>"""


def test_mujoco_has_the_same_distance_coupling_and_hinge() -> None:
    chain = [
        joint_element("j0", "revolute", "base", "upper", LIMITED.format("0 0.6 0.8")),
        joint_element("j1", "revolute", "upper", "lower", LIMITED.format("0 1 0"), placed("0.5 0 0.1")),
        joint_element("j2", "revolute", "lower", "tip", LIMITED.format("1 0 0"), placed("0.4 0.1 0")),
    ]
    tree = load(urdf(*map(body, ("base", "upper", "lower", "tip")), *chain))
    model = mujoco.MjModel.from_xml_string(MJCF)
    data = mujoco.MjData(model)
    y = (0.0, 1.0, 0.0)
    robot = constrained(
        tree,
        # Closed at zero, where the two points that MuJoCo holds are on the axis y of the tip.
        HingeClosure("pin", at("base", 1.1, 0.1, 0.2), at("tip", 0.2, 0, 0.1), (y, y)),
        DistanceClosure("rod", at("base", 0.3, 0.2, 0.9), at("tip", 0.2, 0, 0.1), 0.4),
        Coupling("belt", (("j2", 1.0), ("j0", -0.5)), 0.3),
    )
    for q in (np.zeros(3), np.array([0.4, -0.7, 1.1])):
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        r, K = eurdf.residual_and_jacobian(robot, q)
        np.testing.assert_allclose(r[5] + 0.4, data.ten_length[0], atol=1e-12)
        np.testing.assert_allclose(K[5], data.ten_J.reshape(-1), atol=1e-12)
        efc = data.efc_J.reshape(-1, 3)
        np.testing.assert_allclose(K[6], efc[0], atol=1e-12)
        np.testing.assert_allclose(r[6], data.efc_pos[0], atol=1e-12)
        if not q.any():  # closed: the rows that two points have span the same space as those of the hinge
            points = efc[1:]
            np.testing.assert_allclose(r[:5], 0.0, atol=1e-12)
            rank = np.linalg.matrix_rank(points, 1e-9)
            assert rank == np.linalg.matrix_rank(K[:5], 1e-9) == np.linalg.matrix_rank(np.vstack([K[:5], points]), 1e-9)
