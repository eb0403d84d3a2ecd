"""Locked joints hold still; all else of the robot is where it was, moves as it did and has kept its name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.closures.frame import FrameClosure
from eurdf.closures.point import PointClosure
from eurdf.errors import CannotLock, LockedOpen
from eurdf.kinematics.locking import LockedRobot, lock, lock_joints
from eurdf.kinematics.residual import residual, residual_and_jacobian
from eurdf.mechanism.body import Anchor, Frame, Shape
from eurdf.mechanism.joint import Joint, JointProperties, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.described import LIMITED, body, load, mass_matrix, q_of, revolute
from support.places import WILD
from support.plain_urdf import joint_element, link_element
from support.plain_urdf import robot as urdf_of

AXIAL = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
LIMITS = ("lowerPositionLimit", "upperPositionLimit")
PROPERTIES = (
    "upperVelocityLimit",
    "upperEffortLimit",
    "damping",
    "upperDryFrictionLimit",
    "armature",
    "rotorGearRatio",
)

Coordinates = dict[str, Sequence[float]]


def frame_placements(robot: Robot, q: Any) -> list[tuple[str, Any]]:
    """Name and pose of every frame, in order, but between two joints that are one joint of the robot."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    frames = [each for each in enumerate(robot.model.frames) if each[1].parentJoint not in robot.tree.in_series]
    return [(frame.name, data.oMf[index].homogeneous) for index, frame in frames]


def geometry_placements(geometry_model: Any, model: Any, q: Any) -> list[tuple[str, Any]]:
    data, geometry_data = model.createData(), geometry_model.createData()
    pin.updateGeometryPlacements(model, data, geometry_model, geometry_data, q)
    return [(found.name, geometry_data.oMg[k].homogeneous) for k, found in enumerate(geometry_model.geometryObjects)]


def assert_same_places(before: list[tuple[str, Any]], after: list[tuple[str, Any]], atol: float = 1e-12) -> None:
    assert [name for name, _ in before] == [name for name, _ in after]
    np.testing.assert_allclose([M for _, M in after], [M for _, M in before], atol=atol)


def rows_kept(robot: Robot, locked: LockedRobot) -> list[int]:
    rows, first = [], 0
    for closure in robot.mechanism.closures:
        if closure.name not in locked.dropped_closures:
            rows += range(first, first + closure.rows)
        first += closure.rows
    return rows


def assert_same_robot_at(robot: Robot, locked: LockedRobot, whole: Any, atol: float = 1e-12) -> None:
    """At a configuration of the first robot that has the locked joints where they are locked."""
    q = whole[locked.idx_q]
    assert_same_places(frame_placements(robot, whole), frame_placements(locked, q), atol)
    for kind in ("visual_model", "collision_model"):
        if getattr(robot, kind) is not None:
            before = geometry_placements(getattr(robot, kind), robot.model, whole)
            assert_same_places(before, geometry_placements(getattr(locked, kind), locked.model, q), atol)
    M = mass_matrix(robot.model, whole)[np.ix_(locked.idx_v, locked.idx_v)]
    np.testing.assert_allclose(mass_matrix(locked.model, q), M, atol=atol * max(1.0, np.abs(M).max(initial=0.0)))
    rows = rows_kept(robot, locked)
    before_r, before_K = residual_and_jacobian(robot, whole)
    r, K = residual_and_jacobian(locked, q)
    np.testing.assert_allclose(r, before_r[rows], atol=atol)
    np.testing.assert_allclose(K, before_K[np.ix_(rows, locked.idx_v)], atol=10 * atol)


def pose_of(M: Any) -> Pose:
    x, y, z, qx, qy, qz, qw = pin.SE3ToXYZQUAT(M).tolist()
    return Pose((x, y, z), (qx, qy, qz, qw))


def some_robot(random: np.random.Generator, mimic: bool, root: str = "fixed") -> tuple[Robot, Coordinates]:
    """A tree of all joint types with followers, shapes, frames, and closures that are closed at the coordinates."""
    tree = by_hand.tree_of_all_types(random)
    followers: dict[str, Mimic] = {}
    axial = random.permutation([joint.name for joint in tree.joints if joint.type in AXIAL]).tolist()
    for index in range(1, int(random.integers(1, 4)) if mimic else 1):
        followers[axial[index]] = Mimic(axial[random.integers(index)], *random.uniform(-2, 2, 2).tolist())
    joints = [
        replace(
            joint,
            mimic=followers.get(joint.name),
            offset=by_hand.some_pose(random) if joint.type is JointType.SPHERICAL else joint.offset,
            properties=JointProperties(
                lower=(-2.0,) * joint.type.nv if joint.type in AXIAL else (),
                upper=(3.0,) * joint.type.nv if joint.type in AXIAL else (),
                effort=tuple(random.uniform(1, 2, joint.type.nv).tolist()),
                armature=tuple(random.uniform(1, 2, joint.type.nv).tolist()),
                gear_ratio=tuple(random.uniform(1, 2, joint.type.nv).tolist()),
            ),
        )
        for joint in tree.joints
    ]
    shapes = (Shape("box", (1.0, 2.0, 3.0), by_hand.some_pose(random)), Shape("sphere", (0.4,)))
    names = [found.name for found in tree.bodies]
    rigid = rigid_roots(names[0], joints)
    mechanism = replace(
        tree,
        root=root,  # type: ignore[arg-type]
        bodies=tuple(replace(found, visuals=shapes, collisions=shapes[1:]) for found in tree.bodies),
        joints=tuple(joints),
        frames=tuple(Frame(f"f_{name}", name, by_hand.some_pose(random)) for name in random.choice(names, 2, False)),
        actuators=tuple(joint.name for joint in joints if joint.type in AXIAL and not joint.mimic),
    )
    coordinates: Coordinates = {joint.name: by_hand.some_coordinates(joint.type, random) for joint in moving(mechanism)}
    if mechanism.root == "floating":
        coordinates["root_joint"] = by_hand.some_coordinates(JointType.FLOATING, random)
    open_robot = build_robot(mechanism, geometry=False)
    data = open_robot.model.createData()
    pin.framesForwardKinematics(open_robot.model, data, q_of(open_robot, coordinates))
    closures = []
    for index in range(3):
        a, b = random.choice(sorted(set(rigid.values())), 2, False).tolist()
        oMa, oMb = (data.oMf[open_robot.model.getFrameId(name, pin.FrameType.BODY)] for name in (a, b))
        closures.append(
            (PointClosure, FrameClosure)[index % 2](f"c{index}", Anchor(a), Anchor(b, pose_of(oMb.actInv(oMa))))
        )
    configurations = {"here": {name: tuple(c) for name, c in coordinates.items() if name not in followers}}
    mechanism = replace(mechanism, closures=tuple(closures), configurations=configurations)
    return build_robot(mechanism, geometry=True), coordinates


def moving(mechanism: Mechanism) -> list[Joint]:
    return [joint for joint in mechanism.joints if joint.type is not JointType.FIXED]


def leader_of(mechanism: Mechanism, name: str) -> str:
    by_name = {joint.name: joint for joint in mechanism.joints}
    while (mimic := by_name[name].mimic) is not None:
        name = mimic.joint
    return name


# -- any robot ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mimic", [True, False])
@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=40)
def test_locked_robot_moves_as_original_with_held_joints(mimic: bool, seed: int) -> None:
    random = np.random.default_rng(seed)
    robot, coordinates = some_robot(random, mimic, str(random.choice(["fixed", "floating"])))
    chosen = [joint.name for joint in robot.mechanism.joints if random.random() < 0.5]
    if mimic:
        chosen = [leader_of(robot.mechanism, name) for name in chosen]
    q = q_of(robot, coordinates)
    locked = lock(robot, chosen, q)
    still = set(locked.locked_joints)
    expected = set(chosen)
    if mimic:
        expected |= {joint.name for joint in robot.mechanism.joints if leader_of(robot.mechanism, joint.name) in chosen}
    assert still == expected & {joint.name for joint in moving(robot.mechanism)}
    np.testing.assert_array_equal(
        [getattr(locked.model, name) for name in PROPERTIES],
        [getattr(robot.model, name)[locked.idx_v] for name in PROPERTIES],
    )
    np.testing.assert_array_equal(
        [getattr(locked.model, name) for name in LIMITS], [getattr(robot.model, name)[locked.idx_q] for name in LIMITS]
    )
    kinds = {joint.name: joint.type for joint in robot.mechanism.joints} | {"root_joint": JointType.FLOATING}
    for _ in range(2):
        free = {name: by_hand.some_coordinates(kinds[name], random) for name in coordinates if name not in still}
        whole = q_of(robot, coordinates | free)
        np.testing.assert_allclose(q_of(locked, free), whole[locked.idx_q], atol=1e-12)
        assert_same_robot_at(robot, locked, whole)
    assert locked.dropped_configurations == ()
    np.testing.assert_allclose(locked.configurations["here"], q[locked.idx_q], atol=1e-12)


@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=20)
def test_locking_in_sequence_equals_locking_together(seed: int) -> None:
    random = np.random.default_rng(seed)
    robot, coordinates = some_robot(random, mimic=True)
    leaders = [joint.name for joint in moving(robot.mechanism) if not joint.mimic]
    one, other = random.choice(leaders, 2, False).tolist()
    q = q_of(robot, coordinates)
    first = lock(robot, [one], q)
    second, at_once = lock(first, [other], q[first.idx_q]), lock(robot, [one, other], q)
    np.testing.assert_array_equal(first.idx_q[second.idx_q], at_once.idx_q)
    assert_same_places(
        frame_placements(at_once, q[at_once.idx_q]), frame_placements(second, q[first.idx_q][second.idx_q])
    )
    names = [constraint.name for constraint in at_once.constraint_models]
    assert [constraint.name for constraint in second.constraint_models] == names
    assert {*first.dropped_closures, *second.dropped_closures} == {*at_once.dropped_closures}


@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=20)
def test_locking_nothing_gives_equal_robot(seed: int) -> None:
    robot, _ = some_robot(np.random.default_rng(seed), mimic=True)
    locked = lock(robot, [])
    assert locked.model == robot.model
    assert locked.mechanism == robot.mechanism
    assert locked.constraint_models == robot.constraint_models
    assert list(locked.visual_model.geometryObjects) == list(robot.visual_model.geometryObjects)
    np.testing.assert_array_equal(locked.actuation.selection, robot.actuation.selection)
    np.testing.assert_array_equal(locked.configurations["here"], robot.configurations["here"])
    assert locked.locked_joints == locked.dropped_closures == locked.dropped_actuators == ()


@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=20)
def test_locking_all_joints_gives_one_body(seed: int) -> None:
    robot, coordinates = some_robot(np.random.default_rng(seed), mimic=True)
    q = q_of(robot, coordinates)
    locked = lock(robot, [joint.name for joint in robot.mechanism.joints], q)
    assert (locked.model.nq, locked.model.nv, locked.model.njoints) == (0, 0, 1)
    assert locked.constraint_models == []
    assert locked.dropped_closures == tuple(closure.name for closure in robot.mechanism.closures)
    assert locked.dropped_actuators == robot.mechanism.actuators
    assert locked.actuation.selection.shape == (0, 0)
    assert_same_robot_at(robot, locked, q)
    analysis = eurdf.analyze(locked)
    assert (analysis.nv, analysis.nc, analysis.mobility) == (0, 0, 0)


# -- robots of the collection ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def digit_leg() -> Robot:
    return eurdf.load("digit_leg")


@pytest.fixture(scope="module")
def four_bar() -> Robot:
    return eurdf.load("four_bar")


def test_digit_leg_spins_three_rods_with_motors_locked(digit_leg: Robot) -> None:
    locked = lock(digit_leg, digit_leg.actuation.joints)
    analysis = eurdf.analyze(locked)
    assert (analysis.nv, analysis.rank, analysis.mobility, analysis.actuated) == (21, 18, 3, 0)
    assert locked.dropped_actuators == digit_leg.actuation.joints
    assert len(locked.constraint_models) == 3
    assert locked.dropped_closures == ()


def test_unlocked_motors_keep_their_order(digit_leg: Robot) -> None:
    locked = lock(digit_leg, ["motor_hip_z"])
    assert locked.actuation.joints == tuple(name for name in digit_leg.actuation.joints if name != "motor_hip_z")
    np.testing.assert_array_equal(locked.idx_v[locked.actuation.idx_v], np.delete(digit_leg.actuation.idx_v, 1))
    assert eurdf.analyze(locked).mobility == 8


def test_four_bar_with_locked_crank_is_immobile(four_bar: Robot) -> None:
    q = eurdf.assemble(four_bar, q_of(four_bar, {"motor_crank": (0.6,)}), hold=["motor_crank"]).q
    locked = lock(four_bar, ["motor_crank"], q)
    analysis = eurdf.analyze(locked, q[locked.idx_q])
    assert (analysis.nv, analysis.mobility) == (2, 0)
    np.testing.assert_allclose(analysis.q, q[locked.idx_q], atol=1e-9)
    assert_same_robot_at(four_bar, locked, q)


def test_locked_joint_is_fixed_joint_of_same_name(four_bar: Robot) -> None:
    locked = lock(four_bar, ["motor_crank"])
    assert not locked.model.existJointName("motor_crank")
    frame = locked.model.frames[locked.model.getFrameId("motor_crank")]
    assert frame.type == pin.FrameType.FIXED_JOINT
    joint = next(joint for joint in locked.mechanism.joints if joint.name == "motor_crank")
    assert joint.type is JointType.FIXED


def test_original_robot_is_unchanged(four_bar: Robot) -> None:
    before = four_bar.model.copy(), four_bar.visual_model.copy(), four_bar.mechanism
    q = q_of(four_bar, {"motor_crank": (0.6,)})
    lock(four_bar, ["motor_crank"], q)
    assert (four_bar.model, four_bar.mechanism) == (before[0], before[2])
    assert list(four_bar.visual_model.geometryObjects) == list(before[1].geometryObjects)


def test_default_is_assembled_configuration(digit_leg: Robot) -> None:
    q = digit_leg.configurations["assembled"]
    assert lock(digit_leg, ["motor_knee"]).mechanism == lock(digit_leg, ["motor_knee"], q).mechanism


def test_robot_without_geometry_has_none_when_locked() -> None:
    locked = lock(eurdf.load("four_bar", geometry=False), ["motor_crank"])
    assert locked.visual_model is locked.collision_model is None


# -- closures that nothing moves ---------------------------------------------------------------------------------------


def test_closure_within_one_rigid_body_is_dropped(four_bar: Robot) -> None:
    q = eurdf.assemble(four_bar, q_of(four_bar, {"motor_crank": (0.6,)}), hold=["motor_crank"]).q
    locked = lock(four_bar, [joint.name for joint in four_bar.mechanism.joints], q)
    assert locked.dropped_closures == ("rocker_pin",)
    assert locked.constraint_models == []
    assert locked.mechanism.closures == ()


def test_only_closures_without_moving_joints_are_dropped(digit_leg: Robot) -> None:
    q = digit_leg.configurations["assembled"]
    path = on_the_path(digit_leg, "rod1")
    locked = lock(digit_leg, path, q)
    assert locked.dropped_closures == ("rod1",)
    kept = [constraint.name for constraint in locked.constraint_models]
    assert kept == ["achilles", "rod2"]
    np.testing.assert_allclose(residual(locked, q[locked.idx_q]), 0.0, atol=1e-6)


def on_the_path(robot: Robot, closure: str) -> list[str]:
    """Names of the joints that move the two frames of a closure against each other."""
    found = next(found for found in robot.mechanism.closures if found.name == closure)
    carried = {joint.child: joint for joint in robot.mechanism.joints}

    def upwards(body: str) -> set[str]:
        names = set()
        while body in carried:
            names.add(carried[body].name)
            body = carried[body].parent
        return names

    return sorted(upwards(found.a.body) ^ upwards(found.b.body))


def test_closure_locked_open_is_refused_with_opening(four_bar: Robot) -> None:
    q = q_of(four_bar, {"motor_crank": (0.3,)})
    joints = [joint.name for joint in four_bar.mechanism.joints]
    distance = np.linalg.norm(residual(four_bar, q))
    with pytest.raises(LockedOpen, match=f"'rocker_pin' by {distance * 1e3:.3g} mm;") as refusal:
        lock(four_bar, joints, q)
    (opening,) = refusal.value.openings
    assert (opening.name, opening.position, opening.angle) == ("rocker_pin", pytest.approx(distance), 0.0)
    assert refusal.value.tolerance == 1e-6
    assert lock(four_bar, joints, q, tolerance=distance).dropped_closures == ("rocker_pin",)


def test_closable_closure_may_be_open(four_bar: Robot) -> None:
    locked = lock(four_bar, ["motor_crank"], q_of(four_bar, {"motor_crank": (0.3,)}))
    assert locked.dropped_closures == ()
    assert eurdf.assemble(locked).converged


# -- followers ---------------------------------------------------------------------------------------------------------

LAW = '<axis xyz="0 0 1"/><mimic joint="{}" multiplier="{}" offset="{}"/><limit effort="1" velocity="1" {}/>'
RANGE = 'lower="-3" upper="3"'
GRIPPER = urdf_of(
    *(body(name) for name in ("base", "a", "b", "c", "d")),
    revolute("m_lead", "base", "a"),
    joint_element("a_first", "revolute", "a", "b", LAW.format("m_lead", -2, 0.5, RANGE)),  # comes before its leader
    joint_element("z_second", "prismatic", "a", "c", LAW.format("a_first", 0.5, -0.1, RANGE)),
    revolute("other", "a", "d"),
)


def test_mimic_joints_are_locked_with_leader() -> None:
    robot = load(GRIPPER)
    locked = lock(robot, ["m_lead"], q_of(robot, {"m_lead": (0.4,)}))
    assert locked.locked_joints == ("m_lead", "a_first", "z_second")
    assert (locked.model.nv, list(locked.model.names)[1:]) == (1, ["other"])
    data = locked.model.createData()
    pin.framesForwardKinematics(locked.model, data, np.zeros(1))
    angles = {name: pin.rpy.matrixToRpy(data.oMf[locked.model.getFrameId(name)].rotation)[2] for name in "ab"}
    assert angles == pytest.approx({"a": 0.4, "b": 0.4 - 2 * 0.4 + 0.5})
    assert data.oMf[locked.model.getFrameId("c")].translation[2] == pytest.approx(0.5 * (-2 * 0.4 + 0.5) - 0.1)


@pytest.mark.parametrize("name", ["a_first", "z_second"])
def test_mimic_joint_alone_is_refused(name: str) -> None:
    with pytest.raises(
        CannotLock, match=f"'{name}' cannot be locked: it is a mimic joint of 'm_lead'; lock 'm_lead' instead"
    ) as refusal:
        lock(load(GRIPPER), [name, "other"])
    assert (refusal.value.joint, refusal.value.leader) == (name, "m_lead")


def test_mimic_joint_named_with_leader_is_locked() -> None:
    assert lock(load(GRIPPER), ["z_second", "m_lead"]).locked_joints == ("m_lead", "a_first", "z_second")


def test_mimic_joints_loaded_free_are_locked_alone() -> None:
    robot = load(GRIPPER, mimic=False)
    locked = lock(robot, ["a_first"], q_of(robot, {"a_first": (0.4,)}))
    assert locked.locked_joints == ("a_first",)
    assert list(locked.model.names)[1:] == ["m_lead", "other", "z_second"]
    assert len(locked.model.mimicking_joints) == 0
    by_name = {joint.name: joint for joint in locked.mechanism.joints}
    assert by_name["z_second"].mimic is None


# -- what else a robot has ---------------------------------------------------------------------------------------------


def test_differing_named_configurations_are_dropped_and_listed() -> None:
    text = urdf_of(
        *(body(name) for name in ("base", "a", "b")),
        joint_element("wheel", "continuous", "base", "a", '<axis xyz="0 0 1"/>'),
        revolute("knee", "a", "b"),
    )
    yaml = """configurations:
  same: {wheel: 0.5, knee: 1}
  a_turn_on: {wheel: 6.783185307179586, knee: 2}
  elsewhere: {wheel: 0.50001}
  neutral: {knee: 0.1}
"""
    robot = load(text, yaml)
    locked = lock(robot, ["wheel"], q_of(robot, {"wheel": (0.5,)}))
    assert {name: dict(of) for name, of in locked.mechanism.configurations.items()} == {
        "same": {"knee": (1.0,)},
        "a_turn_on": {"knee": (2.0,)},
    }
    assert {name: q.tolist() for name, q in locked.configurations.items()} == {"same": [1.0], "a_turn_on": [2.0]}
    assert locked.dropped_configurations == ("elsewhere", "neutral")


def test_configuration_tolerance_is_one_micrometre() -> None:
    text = urdf_of(body("base"), body("a"), joint_element("slide", "prismatic", "base", "a", LIMITED.format("0 0 1")))
    robot = load(text, "configurations:\n  same: {slide: 0.5000009}\n  other: {slide: 0.5000011}\n")
    assert lock(robot, ["slide"], q_of(robot, {"slide": (0.5,)})).dropped_configurations == ("other",)


def test_opposite_quaternions_are_the_same_configuration() -> None:
    text = urdf_of(body("base"), body("a"), revolute("ball", "base", "a"))
    yaml = "joints: {ball: spherical}\nconfigurations: {opposite: {ball: [0, 0, -0.6, -0.8]}}"
    robot = load(text, yaml)
    locked = lock(robot, ["ball"], q_of(robot, {"ball": (0.0, 0.0, 0.6, 0.8)}))
    assert locked.dropped_configurations == ()


def test_meshes_are_shared_and_not_read_again(tmp_path: Path) -> None:
    corners = ("0 0 0", "0 1 0", "1 0 0")
    facet = "facet normal 0 0 1\nouter loop\n" + "".join(f"vertex {corner}\n" for corner in corners)
    mesh = tmp_path / "part.stl"
    mesh.write_text(f"solid part\n{facet}endloop\nendfacet\nendsolid part\n", encoding="utf-8")
    shape = '<visual><origin xyz="1 2 3"/><geometry><mesh filename="part.stl"/></geometry></visual>'
    text = urdf_of(
        link_element("base"), body("a", shape), revolute("knee", "base", "a", origin='<origin xyz="1 0 0"/>')
    )
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    robot = eurdf.load(tmp_path / "robot.urdf")
    assert robot.diagnostics is not None
    mesh.unlink()
    locked = lock(robot, ["knee"], q_of(robot, {"knee": (math.pi / 2,)}))
    (before,), (after,) = robot.visual_model.geometryObjects, locked.visual_model.geometryObjects
    assert after.geometry == before.geometry
    assert isinstance(after.geometry, coal.BVHModelBase)
    assert (after.parentJoint, after.meshPath) == (0, str(mesh))
    np.testing.assert_allclose(after.placement.translation, (-1.0, 1.0, 3.0), atol=1e-12)


def test_geometry_and_pairs_added_by_hand_are_kept() -> None:
    robot = eurdf.load("four_bar")
    crank = robot.model.getJointId("motor_crank")
    for name, joint in (("tool", crank), ("obstacle", 0)):
        placement = pin.SE3(np.eye(3), np.array((0.1, 0.2, 0.3)))
        robot.collision_model.addGeometryObject(pin.GeometryObject(name, joint, placement, coal.Sphere(0.1)))
    robot.collision_model.addCollisionPair(
        pin.CollisionPair(*(robot.collision_model.getGeometryId(name) for name in ("tool", "obstacle")))
    )
    q = q_of(robot, {"motor_crank": (0.6,)})
    locked = lock(robot, ["motor_crank"], q)
    assert list(locked.collision_model.collisionPairs) == list(robot.collision_model.collisionPairs)
    assert locked.collision_model.existGeometryName("tool")
    assert_same_robot_at(robot, locked, q)


def test_diagnostics_survive_locking() -> None:
    light = urdf_of(body("base"), link_element("a"), revolute("knee", "base", "a"))
    robot = load(light)
    assert robot.diagnostics
    assert lock(robot, []).diagnostics == robot.diagnostics


# -- what is refused ---------------------------------------------------------------------------------------------------


def test_unknown_joint_is_refused_with_suggestion(four_bar: Robot) -> None:
    with pytest.raises(
        CannotLock, match="'motor_crnk' cannot be locked: the robot has no such joint; did you mean 'motor_crank'"
    ) as refusal:
        lock(four_bar, ["motor_crnk"])
    assert refusal.value.joint == "motor_crnk"
    with pytest.raises(CannotLock, match="'motor'"):
        lock(four_bar, "motor")


def test_single_joint_name_is_accepted(four_bar: Robot) -> None:
    assert lock(four_bar, "motor_crank").locked_joints == ("motor_crank",)


def test_floating_root_is_refused_with_hint() -> None:
    robot = eurdf.load("four_bar", root="floating")
    with pytest.raises(CannotLock, match="root='fixed'"):
        lock(robot, ["root_joint"])
    assert lock(robot, ["motor_crank"]).model.nv == robot.model.nv - 1


def test_invalid_configuration_is_refused(four_bar: Robot) -> None:
    with pytest.raises(ValueError, match="has the shape"):
        lock(four_bar, ["motor_crank"], np.zeros(2))


def test_plain_data_is_locked_at_given_coordinates() -> None:
    joints = (
        Joint("lead", JointType.PRISMATIC, "base", "a", axes=((0.0, 0.0, 2.0),)),
        Joint("led", JointType.PRISMATIC, "a", "b", axes=((1.0, 0.0, 0.0),), mimic=Mimic("lead", 3.0, 1.0)),
    )
    bodies = tuple(replace(found, inertia=None) for found in by_hand.tree_of_all_types(np.random.default_rng(0)).bodies)
    bodies = tuple(replace(found, name=name) for found, name in zip(bodies, ("base", "a", "b"), strict=False))
    locked = lock_joints(Mechanism("slide", "", "fixed", bodies, joints), ["lead"], {"lead": (0.5,), "led": (9.0,)})
    assert [joint.placement.xyz for joint in locked.mechanism.joints] == [(0.0, 0.0, 0.5), (2.5, 0.0, 0.0)]
    assert [joint.type for joint in locked.mechanism.joints] == [JointType.FIXED, JointType.FIXED]


# -- published robots --------------------------------------------------------------------------------------------------

WILD_ROBOTS = sorted(found.parent.name for found in WILD.glob("*/robot.yaml"))


@pytest.mark.skipif(
    not WILD_ROBOTS, reason="no published robots: put their folder at ../shared/wild, beside the checkout"
)
@pytest.mark.parametrize("name", WILD_ROBOTS or [""])
def test_mobility_with_locked_motors_is_uncontrolled_mobility(name: str) -> None:
    robot = eurdf.load(WILD / name, geometry=False)
    before = eurdf.analyze(robot)
    locked = lock(robot, robot.actuation.joints, before.q)
    assert_same_robot_at(robot, locked, before.q, atol=1e-10)
    after = eurdf.analyze(locked, before.q[locked.idx_q])
    assert (after.nv, after.actuated) == (before.nv - before.actuated, 0)
    if before.closes:
        assert after.mobility == before.uncontrolled
