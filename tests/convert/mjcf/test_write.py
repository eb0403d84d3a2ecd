"""Robots exported to MJCF: MuJoCo finds what we find, and simulates them with their loops closed."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.body import Body
from eurdf.mechanism.constraint import Constraint, Coupling
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.writing.rewriting import MechanismTree
from support import by_hand
from support.exported import BALL, BODY, LIMIT, InMuJoCo, hanging, near, random_robot
from support.places import ROBOTS
from support.plain_urdf import inertial, joint_element, link_element
from support.plain_urdf import robot as robot_element
from support.stl import TETRAHEDRON

seeds = st.integers(0, 2**32 - 1)
roots: Any = st.sampled_from(["fixed", "floating"])
NAMES = eurdf.collection_names()
BALLS = [name for name in NAMES if "spherical" in (ROBOTS / name / "robot.yaml").read_text(encoding="utf-8")]


def in_our_terms(there: InMuJoCo, constraint: Constraint) -> tuple[Any, Any, int]:
    """Residual and K of MuJoCo's rows, and how many of ours they are: all but the angular rows of a hinge.

    MuJoCo's rows of a closure are A less B, in the world's axes. The angular ones of a weld are, along A's axes, the
    vector of the quaternion of A in B: -sin(θ/2) u for a rotation θ u from A to B, or, as it is one of two quaternions,
    minus that. Where θ is 0, their derivative is -ω/2.
    """
    residual, J = there.rows(constraint.name)
    if not len(residual):  # MuJoCo leaves out what no joint moves
        return np.zeros(0), J, 0
    if isinstance(constraint, Coupling):
        # An equality is of two joints, with the first's coefficient 1; more are the length of a tendon, as it is.
        first = constraint.coefficients[0][1] if len(constraint.coefficients) == 2 else 1.0
        return first * residual, first * J, 1
    if constraint.type == "distance":
        return residual, J, 1
    R = there.pose(f"{constraint.name}/a")[:3, :3]
    linear, turning = -R.T @ residual[:3], -R.T @ J[:3]
    if constraint.type != "6d":
        return linear, turning, 3
    half = np.linalg.norm(residual[3:])
    scale = -there.quaternion_sign(f"{constraint.name}/a", f"{constraint.name}/b")
    angle = scale * residual[3:] * (2.0 if half == 0.0 else 2.0 * np.arcsin(half) / half)
    return np.concatenate([linear, angle]), np.vstack([turning, 2.0 * scale * J[3:]]), 6


def assert_same_constraints(there: InMuJoCo, q: Any, *, closed: bool) -> None:
    there.at(q)
    residual, K = eurdf.residual_and_jacobian(there.robot, q)
    at = 0
    for constraint in there.robot.mechanism.constraints:
        found, J, rows = in_our_terms(there, constraint)
        if constraint.type == "6d" and rows and not closed:
            # log6 is not the origin of B where the frames are turned against each other: its angular part alone is.
            np.testing.assert_allclose(found[3:], residual[at + 3 : at + 6], atol=1e-9)
        else:
            np.testing.assert_allclose(found, residual[at : at + rows], atol=1e-9)
        if closed or constraint.type in ("distance", "coupling"):
            np.testing.assert_allclose(J, K[at : at + rows], atol=1e-9)
        if not rows:
            np.testing.assert_allclose(K[at : at + constraint.rows], 0.0, atol=1e-9)
        at += constraint.rows


@pytest.mark.parametrize("name", NAMES)
def test_constraints_and_keyframe_of_the_collection_are_the_same_in_mujoco(name: str) -> None:
    robot, export = eurdf.load(name, geometry=False), eurdf.export(name, "mjcf")
    there, assembled = InMuJoCo(robot, export), robot.configurations["assembled"]
    assert_same_constraints(there, near(robot, assembled)[0], closed=False)
    assert_same_constraints(there, assembled, closed=True)
    np.testing.assert_allclose(there.model.key("assembled").qpos, export.coordinates.to_q(assembled), atol=1e-12)


def actuated_acceleration(there: InMuJoCo, q: Any, u: Any) -> Any:
    """Of the robot's actuated joints at rest in MuJoCo, by its M, forces and Jacobian of equalities."""
    there.data.ctrl[:] = u
    there.at(q)
    data, nv = there.data, there.model.nv
    _, sizes, V = np.linalg.svd(data.efc_J.reshape(-1, nv)[: data.ne])
    free = V[(sizes > 1e-9 * sizes[0]).sum() :].T
    force = free.T @ (data.qfrc_actuator + data.qfrc_passive - data.qfrc_bias)
    a = free @ np.linalg.lstsq(free.T @ there.inertia_matrix @ free, force, rcond=1e-14)[0]
    return there.coordinates.from_v(data.qpos, a)[there.robot.actuation.idx_v]


@pytest.mark.parametrize("name", BALLS)
def test_balls_of_the_collection_can_be_hinges(name: str) -> None:
    export = eurdf.export(name, "mjcf", joints="hinge")
    robot = export.robot
    there, assembled = InMuJoCo(robot, export), robot.configurations["assembled"]
    assert mujoco.mjtJoint.mjJNT_BALL not in there.model.jnt_type
    open_loops, _ = near(robot, assembled)
    assert_same_constraints(there, open_loops, closed=False)
    assembly = eurdf.assemble(robot, open_loops)
    assert assembly.closes
    assert_same_constraints(there, assembly.q, closed=True)
    there.at(assembly.q)
    pin.framesForwardKinematics(robot.model, robot.data, assembly.q)
    for body in robot.mechanism.bodies:
        expected = robot.data.oMf[robot.model.getFrameId(body.name)].homogeneous
        np.testing.assert_allclose(there.pose(body.name), expected, atol=1e-9)
    u = np.linspace(0.05, 0.2, len(robot.actuation.idx_v))
    expected = eurdf.forward_dynamics(robot, assembly.q, np.zeros(robot.model.nv), u).a[robot.actuation.idx_v]
    np.testing.assert_allclose(actuated_acceleration(there, assembly.q, u), expected, atol=1e-8 * abs(expected).max())


def with_other_frame(mechanism: Mechanism, ball: Joint, pose: Pose) -> Mechanism:
    """The same mechanism, with the frame of a ball's link at a pose in its old one."""

    def moved(own: Any, name: str, at: str = "pose") -> Any:
        return replace(own, **{at: pose.inverse() * getattr(own, at)}) if own and name == ball.child else own

    turned = replace(ball, offset=ball.offset * pose)
    return replace(
        mechanism,
        bodies=tuple(replace(each, inertia=moved(each.inertia, each.name)) for each in mechanism.bodies),
        joints=tuple(turned if each is ball else moved(each, each.parent, "placement") for each in mechanism.joints),
        closures=tuple(
            replace(each, a=moved(each.a, each.a.body), b=moved(each.b, each.b.body)) for each in mechanism.closures
        ),
    )


@pytest.mark.parametrize(
    ("name", "universal", "fixed"),
    [("cassie_leg", 2, 2), ("digit_leg", 3, 3), ("digit_leg_3d", 3, 0), ("talos_leg", 1, 1)],
)
@given(seed=seeds)
@settings(max_examples=3)
def test_rods_without_ball_joints_lose_their_spin_alone(name: str, universal: int, fixed: int, seed: int) -> None:
    random, mechanism = np.random.default_rng(seed), eurdf.load(name, geometry=False).mechanism
    balls = [joint for joint in mechanism.joints if joint.type is JointType.SPHERICAL]
    for ball in balls:
        mechanism = with_other_frame(mechanism, ball, by_hand.some_pose(random))
    robot = build_robot(mechanism, geometry=False)
    idx_q, assembled = robot.actuation.idx_q, robot.configurations["assembled"]
    q, start = (
        eurdf.forward_kinematics(robot, assembled[idx_q] + random.uniform(-0.05, 0.05, len(idx_q))) for _ in range(2)
    )
    configurations = {"assembled": robot.joint_positions(start), "other": robot.joint_positions(q)}
    robot = build_robot(replace(mechanism, configurations=configurations), geometry=False)
    export = eurdf.export(robot, "mjcf", joints="hinge")
    codes = [loss.code for loss in export.losses if loss.concept == "spherical joint"]
    assert sorted(codes) == ["export-rod-closure"] * fixed + ["export-rod-universal"] * universal
    there = InMuJoCo(export.robot, export)
    assert mujoco.mjtJoint.mjJNT_BALL not in there.model.jnt_type
    assert export.robot.model.nv == robot.model.nv - universal - 3 * fixed
    same = export.robot.configurations["other"]
    for closed in export.robot.configurations.values():
        assert np.abs(eurdf.residual(export.robot, closed)).max() < 1e-9
    there.at(same)
    pin.framesForwardKinematics(robot.model, robot.data, q)
    rods = {body for joint in balls for body in MechanismTree(export.robot.mechanism).below(joint.child)}
    for body in {body.name for body in robot.mechanism.bodies} - rods:
        expected = robot.data.oMf[robot.model.getFrameId(body)].homogeneous
        np.testing.assert_allclose(there.pose(body), expected, atol=1e-9, err_msg=body)
    u = np.linspace(0.05, 0.2, len(robot.actuation.idx_v))
    expected = eurdf.forward_dynamics(robot, q, np.zeros(robot.model.nv), u).a[robot.actuation.idx_v]
    np.testing.assert_allclose(actuated_acceleration(there, same, u), expected, atol=1e-4 * abs(expected).max())


def test_rod_with_its_mass_beside_its_line_keeps_its_spin() -> None:
    mechanism = eurdf.load("digit_leg_3d", geometry=False).mechanism
    (ball,) = (joint for joint in mechanism.joints if joint.name == "ball_rod1")

    def bent(body: Body) -> Body:
        inertia = body.inertia
        return replace(body, inertia=inertia and replace(inertia, pose=Pose((0.0, 0.02, 0.0)) * inertia.pose))

    bodies = tuple(bent(body) if body.name == ball.child else body for body in mechanism.bodies)
    export = eurdf.export(build_robot(replace(mechanism, bodies=bodies), geometry=False), "mjcf", joints="hinge")
    assert [loss.name for loss in export.losses if loss.code == "export-spherical-hinges"] == ["ball_rod1"]


def with_turned_ball(angle: float) -> Robot:
    """A robot with armature in its ball, which starts turned about y, rad."""
    mechanism = random_robot(8, kinds=())[0].mechanism
    (ball,) = (joint.name for joint in mechanism.joints if joint.type is JointType.SPHERICAL)
    turned = {ball: (0.0, np.sin(angle / 2.0), 0.0, np.cos(angle / 2.0))}
    mechanism = replace(mechanism, configurations={"assembled": turned}, actuators=(ball,))
    return build_robot(mechanism, geometry=False)


def test_armature_on_the_hinges_of_a_ball_is_verified() -> None:
    verification = eurdf.export(with_turned_ball(0.7), "mjcf", joints="hinge").verify(seconds=0.0)
    assert verification.findings == ()
    assert [each for each in verification.listed if "export-hinge-armature" in each]


def test_start_where_the_hinges_of_a_ball_are_singular_is_an_error() -> None:
    with pytest.raises(eurdf.errors.CannotExport, match=r"the second is at -1\.571 rad"):
        eurdf.export(with_turned_ball(-np.pi / 2.0), "mjcf", joints="hinge")


def test_hinges_for_balls_are_for_mjcf_alone() -> None:
    with pytest.raises(
        ValueError, match="joints is 'hinge', which is for the format mjcf alone; leave it out for urdf"
    ):
        eurdf.export("delta", "urdf", joints="hinge")


@pytest.mark.parametrize(
    ("name", "joints"),
    [("battobot", "stated"), ("talos_leg", "stated"), ("unitree_g1_ankle", "stated"), ("digit_leg", "hinge")],
)
def test_loops_stay_closed_under_position_servos(name: str, joints: Any) -> None:
    export = eurdf.export(name, "mjcf", actuators="position", joints=joints)
    there = InMuJoCo(export.robot, export)
    mujoco.mj_resetDataKeyframe(there.model, there.data, 0)
    mujoco.mj_forward(there.model, there.data)
    there.data.ctrl[:] = there.data.actuator_length
    for _ in range(round(2.0 / there.model.opt.timestep)):
        mujoco.mj_step(there.model, there.data)
        assert np.abs(there.data.efc_pos[: there.data.ne]).max() < 1e-3


def test_closure_gives_way_as_the_hint_on_compliance_says() -> None:
    mass, compliance = 1.5, 1e-4
    urdf = robot_element(
        link_element("base"),
        link_element("weight", inertial(mass)),
        joint_element("lift", "prismatic", "base", "weight", '<axis xyz="0 0 1"/>' + LIMIT),
    )
    description = (
        'extended_urdf: "2.1"\n'
        f"closures: [{{name: pin, type: 3d, frames: [base, weight], compliance: {{linear: {compliance}}}}}]\n"
    )
    export = eurdf.export(description, "mjcf", urdf=urdf)
    (loss,) = (loss for loss in export.losses if loss.code == "export-compliance")
    assert loss.message == "0.0001 m/N is left out"
    factor = float(re.search(r"s = (\S+) · w / compliance", loss.hint)[1])
    model = mujoco.MjModel.from_xml_string(export.main.decode())
    data = mujoco.MjData(model)
    s = factor * model.body_invweight0[:, 0].sum() / compliance
    model.eq_solref[0] = -s, -2.0 * np.sqrt(s)
    for _ in range(30000):
        mujoco.mj_step(model, data)
    assert data.qpos[0] == pytest.approx(-mass * 9.81 * compliance, rel=1e-2)


@given(seed=seeds, root=roots)
@settings(max_examples=20)
def test_random_robot_has_the_same_constraints_in_mujoco(seed: int, root: Any) -> None:
    robot, q = random_robot(seed, root)
    there = InMuJoCo(robot, eurdf.export(robot, "mjcf"))
    assert_same_constraints(there, q, closed=True)
    assert_same_constraints(there, near(robot, q, seed)[0], closed=False)


def test_motors_of_a_ball_joint_act_along_its_axes() -> None:
    robot, q = random_robot(8, kinds=())
    (ball,) = (joint for joint in robot.mechanism.joints if joint.type is JointType.SPHERICAL)
    turned = tuple(
        replace(joint, offset=Pose.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))) if joint is ball else joint
        for joint in robot.mechanism.joints
    )
    robot = build_robot(replace(robot.mechanism, actuators=(ball.name,), joints=turned), geometry=False)
    there = InMuJoCo(robot, eurdf.export(robot, "mjcf"))
    there.data.ctrl[:] = 1.0, 2.0, 3.0
    there.at(q)
    force = there.coordinates.rates(q).T @ there.data.qfrc_actuator
    np.testing.assert_allclose(force, robot.actuation.selection @ [1.0, 2.0, 3.0], atol=1e-12)


LOSSES = '<dynamics damping="0.2" friction="0.1"/>'
PAIR = robot_element(
    link_element("base", BALL),
    link_element("arm", BODY + BALL),
    link_element("tip"),
    link_element("hand", BODY + BALL),
    joint_element("shoulder", "revolute", "base", "arm", LIMIT + LOSSES),
    joint_element("flange", "fixed", "arm", "tip"),
    joint_element("wrist", "prismatic", "tip", "hand", LIMIT),
)
DESCRIPTION = """\
extended_urdf: "2.1"
joints:
  shoulder: {stiffness: 30, rest: 0.4, armature: 0.3}
actuators:
  - {joint: shoulder, gear_ratio: 5, control: [-4, 6]}
  - wrist
"""


def pair(**options: Any) -> tuple[eurdf.convert.Export, Any]:
    export = eurdf.export(DESCRIPTION, "mjcf", urdf=PAIR, **options)
    return export, mujoco.MjModel.from_xml_string(export.main.decode())


def test_properties_of_joints_are_exported() -> None:
    _, model = pair()
    shoulder = model.joint("shoulder")
    at = shoulder.dofadr[0]
    assert shoulder.range.tolist() == [-1.0, 2.0]
    assert model.jnt_actfrcrange[shoulder.id].tolist() == [-7.0, 7.0]
    assert (model.dof_armature[at], model.dof_frictionloss[at]) == (0.3, 0.1)
    assert (np.ravel(shoulder.stiffness)[0], np.ravel(model.dof_damping[at])[0]) == (30.0, 0.2)
    assert model.qpos_spring[shoulder.qposadr[0]] == 0.4


def test_motor_has_the_control_range_of_the_description() -> None:
    export, model = pair()
    assert model.actuator("shoulder").ctrlrange.tolist() == [-4.0, 6.0]
    assert model.actuator("wrist").ctrlrange.tolist() == [-7.0, 7.0]
    assert [loss.effect for loss in export.losses if loss.code == "export-gear-ratio"] == ["exact"]


def test_armature_of_a_planar_joint_is_a_loss() -> None:
    urdf = PAIR.replace('"revolute"', '"planar"').replace(LIMIT + LOSSES, "")
    description = 'extended_urdf: "2.0"\njoints: {shoulder: {armature: [1, 2, 3]}}\n'
    export = eurdf.export(description, "mjcf", urdf=urdf)
    codes = {loss.code: loss.message for loss in export.losses if loss.name == "shoulder"}
    assert codes["export-unequal-armature"] == "armature 1, 2: the mean is written"
    assert "export-turning-armature" in codes
    model = mujoco.MjModel.from_xml_string(export.main.decode())
    assert model.dof_armature[:3].tolist() == [1.5, 1.5, 3.0]


def test_position_actuator_reaches_effort_limit_at_a_tenth() -> None:
    export, model = pair(actuators="position")
    wrist = model.actuator("wrist")
    assert wrist.gainprm[0] == 70.0
    assert wrist.ctrlrange.tolist() == [-1.0, 2.0]
    assert {loss.name for loss in export.losses if loss.code == "export-position-gain"} == {"shoulder", "wrist"}


def test_no_actuators_is_a_loss() -> None:
    export, model = pair(actuators="none")
    assert model.nu == 0
    assert {loss.name for loss in export.losses if loss.code == "export-no-actuator"} == {"shoulder", "wrist"}


def test_neighbours_do_not_collide() -> None:
    _, model = pair()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert [sorted(model.geom(g).bodyid[0] for g in contact.geom) for contact in data.contact] == [[0, 2]]  # base, hand


def test_equal_limits_hold_the_joint() -> None:
    export = eurdf.export(PAIR.replace('lower="-1" upper="2"', 'lower="0.5" upper="0.5"'), "mjcf")
    model = mujoco.MjModel.from_xml_string(export.main.decode())
    assert [model.equality(i).data[0] for i in range(model.neq)] == [0.5, 0.5]
    assert {loss.name for loss in export.losses if loss.code == "export-equal-limits"} == {"shoulder", "wrist"}


def with_mesh(folder: Path, name: str, content: bytes | None) -> Path:
    """A robot with a mesh, with an odd file name."""
    if content is not None:
        (folder / name).write_bytes(content)
    mesh = f'<visual><origin xyz="0 0 1"/><geometry><mesh filename="{name}" scale="2 2 2"/></geometry></visual>'
    path = folder / "robot.urdf"
    path.write_text(PAIR.replace(BODY + BALL, BODY + BALL + mesh, 1), encoding="utf-8")
    return path


@pytest.mark.parametrize("loaded", [False, True])
def test_mesh_is_copied_under_a_plain_name(tmp_path: Path, loaded: bool) -> None:
    path = with_mesh(tmp_path, "a $(b) c.STL", TETRAHEDRON)
    export = eurdf.export(eurdf.load(path) if loaded else path, "mjcf")
    assert export.files["meshes/a___b__c.stl"] == TETRAHEDRON
    written = export.write(tmp_path / "out")
    model = mujoco.MjModel.from_xml_path(str(written[0]))
    assert model.nmesh == 1
    assert np.ptp(model.mesh_vert, axis=0).max() == pytest.approx(2.0 * np.sqrt(2.0), rel=0.5)


def test_mesh_without_volume_is_compiled(tmp_path: Path) -> None:
    path = with_mesh(tmp_path, "thin.stl", TETRAHEDRON)
    path.write_text(
        path.read_text(encoding="utf-8").replace('scale="2 2 2"', 'scale="1e-3 1e-3 1e-12"'), encoding="utf-8"
    )
    export = eurdf.export(path, "mjcf")
    model = mujoco.MjModel.from_xml_string(export.main.decode(), {"thin.stl": export.files["meshes/thin.stl"]})
    assert model.nmesh == 1


def ascii_stl() -> bytes:
    """The solid of `TETRAHEDRON` as text."""
    triangles = np.frombuffer(TETRAHEDRON[84:], [("normal", "<f4", 3), ("vertices", "<f4", (3, 3)), ("end", "<u2")])[
        "vertices"
    ]
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*v) for v in t)
        + "endloop\nendfacet\n"
        for t in triangles
    )
    return f"solid a\n{facets}endsolid a\n".encode()


def test_mesh_that_mujoco_cannot_read_is_converted(tmp_path: Path) -> None:
    given = with_mesh(tmp_path, "a.stl", ascii_stl())
    export = eurdf.export(given, "mjcf")
    assert [loss.code for loss in export.losses if loss.concept == "mesh"] == ["export-mesh-converted"]
    codes = {loss.code for loss in eurdf.export(given, "mjcf", mesh_files="reference").losses}
    assert "export-mesh-not-referenced" in codes
    (path,) = set(export.files) - {"robot.xml"}
    lines = export.files[path].decode().split("\n")
    vertices = {tuple(map(float, line[2:].split())) for line in lines if line.startswith("v ")}
    assert (path, vertices) == ("meshes/a.stl.obj", {(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)})
    model = mujoco.MjModel.from_xml_path(str(export.write(tmp_path / "out")[0]))
    assert model.mesh_facenum.tolist() == [4]


@pytest.mark.parametrize(
    ("name", "content", "code"),
    [
        ("a.stl", None, "export-mesh-missing"),
        ("a.stl", b"solid a\nendsolid a\n", "export-mesh-format"),
        ("a.dae", b"<COLLADA/>", "export-mesh-format"),
    ],
)
def test_mesh_that_mujoco_cannot_read_is_a_loss(tmp_path: Path, name: str, content: bytes | None, code: str) -> None:
    export = eurdf.export(with_mesh(tmp_path, name, content), "mjcf")
    assert [(loss.code, loss.name) for loss in export.losses if loss.concept == "mesh"] == [(code, name)]
    assert list(export.files) == ["robot.xml"]
    mujoco.MjModel.from_xml_string(export.main.decode())


def test_coupling_of_three_joints_is_a_tendon() -> None:
    robot, q = random_robot(4, kinds=())
    names = {joint.type: joint.name for joint in robot.mechanism.joints if joint.mimic is None}
    terms = tuple(
        (names[kind], c) for kind, c in zip(("helical", "prismatic", "revolute"), (2.0, -1.5, 0.7), strict=True)
    )
    robot = build_robot(replace(robot.mechanism, couplings=(Coupling("mixed", terms, 0.3),)), geometry=False)
    there = InMuJoCo(robot, eurdf.export(robot, "mjcf"))
    there.at(q)
    residual, K = eurdf.residual_and_jacobian(robot, q)
    found, J = there.rows("mixed")
    np.testing.assert_allclose(found, residual, atol=1e-12)
    np.testing.assert_allclose(J, K, atol=1e-12)


def test_hinge_allows_rotation_about_its_axis_alone() -> None:
    robot, q = random_robot(1, kinds=("hinge",))
    there = InMuJoCo(robot, eurdf.export(robot, "mjcf"))
    there.at(q)
    J = np.vstack([there.rows(name)[1] for name in ("hinge", "hinge/axis")])
    K = eurdf.residual_and_jacobian(robot, q)[1]
    assert (
        np.linalg.matrix_rank(J, 1e-9)
        == np.linalg.matrix_rank(K, 1e-9)
        == np.linalg.matrix_rank(np.vstack([J, K]), 1e-9)
        == 5
    )


def assert_read_by_pinocchio(robot: Robot, folder: Path) -> None:
    export = eurdf.export(robot, "mjcf")
    (path,) = export.write(folder)
    model = pin.buildModelFromMJCF(str(path))
    assert (model.nq, model.nv) == (export.coordinates.nq, export.coordinates.nv)
    assert pin.computeTotalMass(model) == pytest.approx(pin.computeTotalMass(robot.model), rel=1e-9)


def test_pinocchio_reads_closures_and_bodies_on_a_base_without_mass(tmp_path: Path) -> None:
    for robot in ("digit_2legs", hanging('<mimic joint="j"/>')):
        assert_read_by_pinocchio(eurdf.load(robot, geometry=False), tmp_path / robot[:5].strip("<"))


def test_link_called_world_is_renamed() -> None:
    urdf = PAIR.replace('"base"', '"world"').replace(link_element("world", BALL), link_element("world", BODY))
    export = eurdf.export(urdf, "mjcf")
    assert [loss.message for loss in export.losses if loss.code == "export-name"] == ["becomes 'world_'"]
    mujoco.MjModel.from_xml_string(export.main.decode())


@pytest.mark.parametrize("to", ["mjcf", "urdf"])
def test_mesh_can_stay_where_it_is(tmp_path: Path, to: str) -> None:
    export = eurdf.export(with_mesh(tmp_path, "a.stl", TETRAHEDRON), to, mesh_files="reference")
    assert list(export.files) == [next(iter(export.files))]
    assert str(tmp_path / "a.stl").encode() in export.main
    assert not [loss for loss in export.losses if loss.concept == "mesh"]


def test_pipe_is_not_read_as_a_mesh(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.stl")
    export = eurdf.export(with_mesh(tmp_path, "a.stl", None), "mjcf")
    assert [loss.code for loss in export.losses if loss.concept == "mesh"] == ["export-mesh-missing"]


def test_generalized_forces_of_motors_are_those_of_the_actuation() -> None:
    robot, q = random_robot(8)
    there = InMuJoCo(robot, eurdf.export(robot, "mjcf"))
    u = np.linspace(0.5, 2.0, len(robot.actuation.idx_v))
    there.data.ctrl[:] = u
    there.at(q)
    force = there.coordinates.rates(q).T @ there.data.qfrc_actuator
    np.testing.assert_allclose(force, robot.actuation.selection @ u, atol=1e-12)
