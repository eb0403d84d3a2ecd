"""The Pinocchio model is the one Pinocchio's own URDF parser builds, and goes on where that parser stops."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from eurdf.closures.frame import FrameClosure
from eurdf.closures.point import PointClosure
from eurdf.mechanism.body import Anchor, Body, Frame
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.actuation import build_actuation
from eurdf.pinocchio.configuration import configuration_vector, joint_coordinates, slots
from eurdf.pinocchio.constraint import build_constraint_models
from eurdf.pinocchio.frames import body_frame_ids
from eurdf.pinocchio.model import build_model
from eurdf.pinocchio.robot import build_robot
from eurdf.pinocchio.tree import build_tree
from support import by_hand
from support.places import WILD
from support.plain_urdf import (
    Root,
    inertial,
    joint_element,
    link_element,
    mechanism_of,
    pinocchios_own,
    robot,
    trees,
    vector,
)

ROOTS = st.sampled_from(["fixed", "floating"])
INF = math.inf
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def assert_equal(model: pin.Model, expected: pin.Model) -> None:
    assert model == expected
    # Every number, also what == does not look at; but a zero may have either sign.
    assert re.sub(r"-(?=0\.0+e\+00)", "", model.saveToString()) == re.sub(
        r"-(?=0\.0+e\+00)", "", expected.saveToString()
    )


@given(text=trees(), root=ROOTS, mimic=st.booleans())
@settings(deadline=None)
def test_plain_urdf_gives_identical_pinocchio_model(text: str, root: Root, mimic: bool) -> None:
    assert_equal(build_model(mechanism_of(text, root, mimic)), pinocchios_own(text, root, mimic))


@pytest.mark.parametrize("root", ["fixed", "floating"])
@pytest.mark.skipif(
    not WILD.is_dir(), reason="no published robots: put their folder at ../shared/wild, beside the checkout"
)
def test_published_robots_match_pinocchio(root: Root) -> None:
    for path in sorted(WILD.glob("*/robot.urdf")):
        text = path.read_text(encoding="utf-8")
        assert_equal(build_model(mechanism_of(text, root)), pinocchios_own(text, root))


@given(
    axis=st.tuples(*[st.floats(-1e15, 1e15)] * 3).filter(lambda axis: math.hypot(*axis) > 1e-3),
    kind=st.sampled_from(["revolute", "continuous", "prismatic"]),
)
@example(axis=(0.0, 0.0, 1.0 + 9e-13), kind="revolute")
@example(axis=(0.0, 0.0, 1.0 + 1.1e-12), kind="revolute")
@example(axis=(9e-13, 0.0, 1.0), kind="continuous")
@example(axis=(0.0, 1.0, 1.1e-12), kind="prismatic")
@settings(max_examples=200, deadline=None)
def test_axis_is_aligned_and_rounded_as_in_pinocchio(axis: tuple[float, float, float], kind: str) -> None:
    content = f'<axis xyz="{vector(axis)}"/><limit effort="1" velocity="1"/>'
    text = robot(link_element("a"), link_element("b"), joint_element("j", kind, "a", "b", content))
    assert_equal(build_model(mechanism_of(text)), pinocchios_own(text))


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic", "helical"])
@pytest.mark.parametrize("size", [1e-200, 1e-160, 1e160, 1e200])
def test_axis_with_overflowing_square_keeps_direction(kind: str, size: float) -> None:
    # Pinocchio's own parser loses it: the axis becomes zero, or not a number.
    joint = Joint("j", JointType(kind), "a", "b", axes=((3 * size, 0.0, 4 * size),), pitch=2 * math.pi)
    mechanism = Mechanism("m", "", "fixed", (Body("a"), Body("b")), (joint,))
    model = build_model(mechanism)
    q = configuration_vector(mechanism, model, {"j": (0.5,)})
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    expected = by_hand.poses(replace(mechanism, joints=(replace(joint, axes=((0.6, 0.0, 0.8),)),)), {"j": (0.5,)})
    np.testing.assert_allclose(data.oMi[1].homogeneous, expected["b"], atol=1e-12)


def test_link_and_joint_of_one_name_are_two_frames() -> None:
    text = robot(
        link_element("arm"),
        link_element("hand"),
        link_element("base"),
        joint_element("hand", "revolute", "base", "arm"),
        joint_element("arm", "fixed", "arm", "hand", ""),
    )
    model = build_model(mechanism_of(text))
    assert_equal(model, pinocchios_own(text))
    assert model.getFrameId("arm", pin.FrameType.BODY) != model.getFrameId("arm", pin.FrameType.FIXED_JOINT)


# -- mimic joints -----------------------------------------------------------------------------------------------------

FOLLOWING = {
    "a joint that follows a later one": ("revolute", "later", "revolute"),
    "a joint that follows one below it": ("revolute", "below", "prismatic"),
    "a joint that follows a follower": ("revolute", "chain", "prismatic"),
    "a slider that follows a wheel": ("prismatic", "before", "continuous"),
    "a wheel that follows a slider": ("continuous", "before", "prismatic"),
    "a hinge that follows a later wheel": ("revolute", "later", "continuous"),
    "a wheel that follows a later wheel": ("continuous", "later", "continuous"),
}


def _coupled(kind: str, place: str, leader_kind: str) -> str:
    names = {"later": ("a", "b"), "below": ("a", "b"), "before": ("b", "a"), "chain": ("c", "a")}
    follower, leader = names[place]
    law = '<mimic joint="{}" multiplier="{}" offset="{}"/>'
    tilted = '<axis xyz="0.6 0 0.8"/><limit lower="-2" upper="1" effort="3" velocity="7"/>'
    elements = [
        *(
            link_element(name, inertial(1.0, '<origin xyz="0.1 0.2 0.3"/>'))
            for name in ("base", "left", "right", "end")
        ),
        joint_element(leader, leader_kind, "left" if place == "below" else "base", "right", tilted),
        joint_element("end", "revolute", "right", "end", tilted, '<origin xyz="0.2 0 0.1"/>'),
    ]
    if place == "chain":
        elements.append(link_element("middle", inertial()))
        elements.append(joint_element("b", "prismatic", "right", "middle", tilted + law.format(leader, -2, 0.1)))
        leader = "b"
    own = tilted + law.format(leader, 3, 0.5)
    elements.append(joint_element(follower, kind, "base", "left", own, '<origin xyz="0 0.3 0" rpy="1 0 0"/>'))
    return robot(*elements)


@pytest.mark.parametrize("root", ["fixed", "floating"])
@pytest.mark.parametrize("title", FOLLOWING)
def test_mimic_joints_move_as_constrained_free_joints(title: str, root: Root) -> None:
    mechanism, uncoupled = (mechanism_of(_coupled(*FOLLOWING[title]), root, mimic) for mimic in (True, False))
    coupled, free = build_model(mechanism), build_model(uncoupled)
    followers = [joint.name for joint in mechanism.joints if joint.mimic]
    assert coupled.nv == free.nv - len(followers)
    random = np.random.default_rng(3)
    given_ = {joint.name: by_hand.some_coordinates(joint.type, random) for joint in mechanism.joints if not joint.mimic}
    if root == "floating":
        given_["root_joint"] = by_hand.some_coordinates(JointType.FLOATING, random)
    q = configuration_vector(mechanism, coupled, given_)
    coordinates = joint_coordinates(mechanism, coupled, q)
    by_name = {joint.name: joint for joint in mechanism.joints}
    for name in followers:
        law = by_name[name].mimic
        assert law is not None
        assert coordinates[name][0] == pytest.approx(law.multiplier * coordinates[law.joint][0] + law.offset)
    q_free = configuration_vector(uncoupled, free, coordinates)

    # G takes the velocities of the coupled model to those of the free one.
    G = np.zeros((free.nv, coupled.nv))
    if root == "floating":
        G[:6, :6] = np.eye(6)
    for joint in mechanism.joints:
        leader, factor = joint, 1.0
        while leader.mimic:
            factor *= leader.mimic.multiplier
            leader = by_name[leader.mimic.joint]
        row = free.joints[free.getJointId(joint.name)].idx_v
        G[row, coupled.joints[coupled.getJointId(leader.name)].idx_v] = factor

    data, data_free = coupled.createData(), free.createData()
    pin.framesForwardKinematics(coupled, data, q)
    pin.framesForwardKinematics(free, data_free, q_free)
    for body in mechanism.bodies:
        mine, other = (model.getFrameId(body.name, pin.FrameType.BODY) for model in (coupled, free))
        np.testing.assert_allclose(data.oMf[mine].homogeneous, data_free.oMf[other].homogeneous, atol=1e-12)
        J = pin.computeFrameJacobian(coupled, coupled.createData(), q, mine, pin.LOCAL).reshape(6, coupled.nv)
        J_free = pin.computeFrameJacobian(free, free.createData(), q_free, other, pin.LOCAL)
        np.testing.assert_allclose(J, J_free @ G, atol=1e-12)
    v, a = random.uniform(-1, 1, coupled.nv), random.uniform(-1, 1, coupled.nv)
    effort = pin.rnea(free, data_free, q_free, G @ v, G @ a)
    np.testing.assert_allclose(pin.rnea(coupled, data, q, v, a), G.T @ effort, atol=1e-10)
    M, M_free = pin.crba(coupled, data, q), pin.crba(free, data_free, q_free)
    np.testing.assert_allclose(np.triu(M), np.triu(G.T @ _symmetric(M_free) @ G), atol=1e-10)


def _symmetric(M: np.ndarray) -> np.ndarray:
    return np.triu(M) + np.triu(M, 1).T


def test_late_leader_keeps_coordinate_limits_and_motor() -> None:
    mechanism = mechanism_of(_coupled("revolute", "later", "revolute"), "floating")
    mechanism = replace(mechanism, actuators=("b",))
    model = build_model(mechanism)
    leader = model.joints[model.getJointId("b")]
    assert model.names[2] == "b/coordinate"
    assert (leader.idx_q, leader.idx_v) == (7, 6)  # after the root, whose coordinates stay the first
    assert (model.lowerPositionLimit[7], model.upperPositionLimit[7]) == (-2.0, 1.0)
    assert (model.upperVelocityLimit[6], model.upperEffortLimit[6]) == (7.0, 3.0)
    actuation = build_actuation(mechanism, model, slots(mechanism))
    assert (actuation.idx_q.tolist(), actuation.idx_v.tolist()) == ([7], [6])


def test_helper_joint_of_late_leader_gets_free_name() -> None:
    text = _coupled("revolute", "later", "revolute").replace('name="end" type', 'name="b/coordinate" type')
    model = build_model(mechanism_of(text))
    assert list(model.names) == ["universe", "b/coordinate'", "a", "b", "b/coordinate"]


def test_wheel_leading_slider_has_unwrapped_angle() -> None:
    mechanism = mechanism_of(_coupled("prismatic", "before", "continuous"))
    model = build_model(mechanism)
    turns = 20.0
    q = configuration_vector(mechanism, model, {"a": (turns,)})
    assert joint_coordinates(mechanism, model, q)["b"] == (3 * turns + 0.5,)
    index = model.joints[model.getJointId("a")].idx_q
    assert (model.lowerPositionLimit[index], model.upperPositionLimit[index]) == (-INF, INF)


# -- what URDF lacks --------------------------------------------------------------------------------------------------


def _hand_made(joint: Joint, **changes: object) -> Mechanism:
    before = Joint("before", JointType.SPHERICAL, "base", "first")
    after = Joint("then", JointType.PRISMATIC, "second", "third", axes=(Z,))
    joint = replace(joint, parent="first", child="second")
    bodies = tuple(Body(name) for name in ("base", "first", "second", "third"))
    return replace(Mechanism("hand-made", "", "fixed", bodies, (before, joint, after)), **changes)


@pytest.mark.parametrize("kind", by_hand.MOVING)
def test_joint_properties_are_at_its_velocities(kind: JointType) -> None:
    joint = by_hand.some_joint(kind, np.random.default_rng(0))
    nv = joint.type.nv
    names = ("velocity", "effort", "damping", "friction", "armature", "gear_ratio", "rotor_inertia")
    values = {name: tuple(10.0 * row + column for column in range(nv)) for row, name in enumerate(names, 1)}
    model = build_model(_hand_made(replace(joint, properties=JointProperties(**values))))
    own = slice(3, 3 + nv)
    expected = {
        "upperVelocityLimit": "velocity",
        "upperEffortLimit": "effort",
        "damping": "damping",
        "upperDryFrictionLimit": "friction",
        "armature": "armature",
        "rotorGearRatio": "gear_ratio",
        "rotorInertia": "rotor_inertia",
    }
    defaults = {"upperVelocityLimit": INF, "upperEffortLimit": INF, "rotorGearRatio": 1.0}
    for of_model, of_joint in expected.items():
        vector_ = getattr(model, of_model)
        np.testing.assert_array_equal(vector_[own], values[of_joint])
        np.testing.assert_array_equal(np.delete(vector_, own), np.full(4, defaults.get(of_model, 0.0)))
    np.testing.assert_array_equal(model.lowerEffortLimit, -model.upperEffortLimit)
    np.testing.assert_array_equal(model.lowerDryFrictionLimit, -model.upperDryFrictionLimit)
    np.testing.assert_array_equal(np.abs(model.lowerVelocityLimit), model.upperVelocityLimit)


UNIT = 1.01
LIMITS = {
    "revolute": ([-1.0], [2.0]),
    "continuous": ([-UNIT] * 2, [UNIT] * 2),
    "prismatic": ([-1.0], [2.0]),
    "helical": ([-1.0], [2.0]),
    "universal": ([-1.0, -1.5], [2.0, 2.5]),
    "cylindrical": ([-1.0, -1.5], [2.0, 2.5]),
    "planar": ([-1.0, -1.5, -UNIT, -UNIT], [2.0, 2.5, UNIT, UNIT]),
    "spherical": ([-UNIT] * 4, [UNIT] * 4),
    "floating": ([-1.0, -1.5, -2.0, *[-UNIT] * 4], [2.0, 2.5, 3.0, *[UNIT] * 4]),
}


@pytest.mark.parametrize("kind", LIMITS)
def test_position_limits_are_at_pinocchio_coordinates(kind: str) -> None:
    joint = by_hand.some_joint(JointType(kind), np.random.default_rng(0))
    count = len(joint.type.coordinates)
    lower = tuple(-1.0 - 0.5 * index for index in range(count))
    upper = tuple(2.0 + 0.5 * index for index in range(count))
    model = build_model(_hand_made(replace(joint, properties=JointProperties(lower, upper))))
    expected_lower, expected_upper = LIMITS[kind]
    np.testing.assert_array_equal(model.lowerPositionLimit, [*[-UNIT] * 4, *expected_lower, -INF])
    np.testing.assert_array_equal(model.upperPositionLimit, [*[UNIT] * 4, *expected_upper, INF])


def test_body_without_link_has_no_frame() -> None:
    mechanism = _hand_made(
        Joint("j_X", JointType.REVOLUTE, "", "", axes=(X,)),
        closures=(PointClosure("loop", Anchor("second"), Anchor("third")),),
    )
    bodies = tuple(replace(body, virtual=body.name == "second") for body in mechanism.bodies)
    mechanism = replace(mechanism, bodies=bodies)
    model = build_model(mechanism)
    assert not model.existFrame("second")
    carried = model.frames[model.getFrameId("then")]
    assert model.frames[carried.parentFrame].name == "j_X"
    ids = body_frame_ids(mechanism)
    assert [model.frames[ids[body.name]].name for body in bodies] == ["base", "first", "j_X", "third"]
    [constraint] = build_constraint_models(mechanism.constraints, build_tree(mechanism, model, slots(mechanism)))
    assert (constraint.joint1_id, constraint.joint2_id) == (model.getJointId("j_X"), model.getJointId("then"))


@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_frames_are_found_by_name(root: Root) -> None:
    random = np.random.default_rng(5)
    mechanism = by_hand.tree_of_all_types(random)
    frames = tuple(
        Frame(f"on_{body.name}", body.name, by_hand.some_pose(random), "joint" if index % 2 else "frame")
        for index, body in enumerate(mechanism.bodies)
    )
    mechanism = replace(mechanism, root=root, frames=frames)
    model = build_model(mechanism)
    coordinates = {joint.name: by_hand.some_coordinates(joint.type, random) for joint in mechanism.joints}
    coordinates = {name: values for name, values in coordinates.items() if values}
    data = model.createData()
    pin.framesForwardKinematics(model, data, configuration_vector(mechanism, model, coordinates))
    poses = by_hand.poses(mechanism, coordinates)
    bodies = body_frame_ids(mechanism)
    for frame in frames:
        index = model.getFrameId(frame.name)
        expected = poses[frame.body] @ by_hand.pose_matrix(frame.pose)
        np.testing.assert_allclose(data.oMf[index].homogeneous, expected, atol=1e-12)
        assert model.frames[index].parentFrame == bodies[frame.body]
        kind = pin.FrameType.OP_FRAME if frame.kind == "frame" else pin.FrameType.FIXED_JOINT
        assert model.frames[index].type == kind
    for name, index in bodies.items():
        assert (model.frames[index].name, model.frames[index].type) == (name, pin.FrameType.BODY)
    for joint in mechanism.joints:
        np.testing.assert_allclose(data.oMf[model.getFrameId(joint.name)].homogeneous, poses[joint.child], atol=1e-12)


def test_frames_keep_inertias_identical() -> None:
    mechanism = by_hand.tree_of_all_types(np.random.default_rng(2))
    frames = tuple(Frame(f"on_{body.name}", body.name, Pose((0.1, 0.2, 0.3))) for body in mechanism.bodies)
    framed = build_model(replace(mechanism, frames=frames))
    for mine, other in zip(framed.inertias, build_model(mechanism).inertias, strict=True):
        assert mine == other


# -- closures, actuation, robot ---------------------------------------------------------------------------------------


def test_robot_unpacks_into_its_parts() -> None:
    half = math.sqrt(0.5)
    mechanism = _hand_made(
        Joint("wheel", JointType.CONTINUOUS, "", "", axes=(X,)),
        closures=(FrameClosure("loop", Anchor("base"), Anchor("third")),),
        actuators=("wheel",),
        configurations={"assembled": {"wheel": (math.pi / 2,), "before": (half, 0.0, 0.0, half)}},
    )
    built = build_robot(mechanism, geometry=True)
    model, constraint_models, actuation, visual_model, collision_model = built
    assert model is built.model
    assert [constraint.name for constraint in constraint_models] == ["loop"]
    assert actuation.joints == ("wheel",)
    assert (visual_model.ngeoms, collision_model.ngeoms) == (0, 0)
    np.testing.assert_allclose(built.configurations["assembled"], [half, 0, 0, half, 0, 1, 0], atol=1e-12)
    assert built.data is built.data
    assert len(built.data.oMi) == model.njoints
    assert repr(built) == "<Robot 'hand-made': nq 7, nv 5, 1 closures, 1 actuators>"
