"""Robots exported to USD: the same bodies, joints and closures, read back by the library of USD."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.closures.hinge import HingeClosure
from eurdf.commands.main import main
from eurdf.mechanism.constraint import Coupling
from eurdf.mechanism.joint_types import JointType
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.exported import BALL, BODY, LIMIT, random_robot
from support.in_usd import D6_AXES, InUsd
from support.plain_urdf import joint_element, link_element
from support.plain_urdf import robot as robot_element
from support.stl import TETRAHEDRON

from pxr import UsdGeom, UsdPhysics, UsdShade  # isort: skip - after it was asked for

#: What single precision leaves of lengths of a few metres, m; of angles, rad.
CLOSE = 1e-6


def rotation_about(M: Any, axis: int) -> float:
    """The angle of a rotation (4, 4) about a coordinate axis, which it must be."""
    y, z = (axis + 1) % 3, (axis + 2) % 3
    assert M[axis, axis] == pytest.approx(1.0, abs=CLOSE)
    return math.atan2(M[z, y], M[y, y])


def assert_same_robot(there: InUsd, robot: Robot, q: Any) -> None:
    """Poses, and frames of joints; `test_verification.py` compares masses, inertias and openings."""
    assert there.errors() == []
    mechanism = robot.mechanism
    pin.framesForwardKinematics(robot.model, robot.data, q)

    def pose(body: str) -> Any:
        return robot.data.oMf[robot.model.getFrameId(body, pin.FrameType.BODY)].homogeneous

    for body in mechanism.bodies:
        np.testing.assert_allclose(there.pose(there.named(body.name)), pose(body.name), atol=1e-9)
    for frame in mechanism.frames:
        expected = pose(frame.body) @ by_hand.pose_matrix(frame.pose)
        np.testing.assert_allclose(there.pose(there.named(frame.name)), expected, atol=1e-9)
    joints = there.prims("joints")
    coordinates = robot.joint_positions(q)
    for joint in mechanism.joints:
        if joint.name in joints:
            a, _ = there.frames(joints[joint.name])
            expected = pose(joint.parent) @ by_hand.pose_matrix(joint.placement)
            np.testing.assert_allclose(a[:3, 3], expected[:3, 3], atol=CLOSE)
            if joint.mimic is None:
                assert_moved(there, joints[joint.name], joint, coordinates.get(joint.name, ()))
        elif joint.type is JointType.UNIVERSAL:  # its axes are not perpendicular
            for number, angle in enumerate(coordinates[joint.name], 1):
                assert_moved(there, joints[f"{joint.name}_{number}"], joint, (angle,))
        else:
            assert joint.type is JointType.FIXED
    closures = there.prims("closures")
    assert set(closures) == {closure.name for closure in mechanism.closures}
    for closure in mechanism.closures:
        prim = closures[closure.name]
        assert UsdPhysics.Joint(prim).GetExcludeFromArticulationAttr().Get()
        if isinstance(closure, HingeClosure):
            rotation_about(there.between(prim), 0)
            axis = np.array(closure.axes[0]) / np.linalg.norm(closure.axes[0])
            expected = pose(closure.a.body)[:3, :3] @ by_hand.pose_matrix(closure.a.pose)[:3, :3] @ axis
            np.testing.assert_allclose(there.frames(prim)[0][:3, 0], expected, atol=CLOSE)


def state(prim: Any, axis: str) -> float:
    """The coordinate of an axis, m or rad."""
    value = prim.GetAttribute(f"state:{axis}:physics:position").Get()
    return value if axis == "linear" or axis.startswith("trans") else math.radians(value)


def assert_moved(there: InUsd, prim: Any, joint: Any, own: Any) -> None:
    """The frames of a joint are where its coordinates, as stated there and as in the robot, bring them."""
    M = there.between(prim)
    match prim.GetTypeName():
        case "PhysicsFixedJoint":
            np.testing.assert_allclose(M, np.eye(4), atol=CLOSE)
        case "PhysicsRevoluteJoint":
            angle = rotation_about(M, "XYZ".index(UsdPhysics.RevoluteJoint(prim).GetAxisAttr().Get()))
            assert math.remainder(angle - state(prim, "angular"), 2 * math.pi) == pytest.approx(0.0, abs=CLOSE)
            assert math.remainder(angle - own[0], 2 * math.pi) == pytest.approx(0.0, abs=CLOSE)
        case "PhysicsPrismaticJoint":
            axis = "XYZ".index(UsdPhysics.PrismaticJoint(prim).GetAxisAttr().Get())
            np.testing.assert_allclose(M[:3, 3], np.eye(3)[axis] * state(prim, "linear"), atol=CLOSE)
            assert state(prim, "linear") == pytest.approx(own[0], abs=CLOSE)
        case "PhysicsSphericalJoint":
            np.testing.assert_allclose(M, by_hand.motion(joint, own), atol=CLOSE)
        case "PhysicsJoint":
            free = {axis for axis in D6_AXES if UsdPhysics.LimitAPI(prim, axis).GetLowAttr().Get() < 1.0}
            assert all(UsdPhysics.LimitAPI(prim, axis) for axis in D6_AXES)
            expected = {
                JointType.UNIVERSAL: {"rotX", "rotY"},
                JointType.CYLINDRICAL: {"transX", "rotX"},
                JointType.HELICAL: {"transX", "rotX"},
                JointType.PLANAR: {"transX", "transY", "rotZ"},
                JointType.FLOATING: set(D6_AXES),
            }
            assert free == expected[joint.type]
            if joint.type is JointType.FLOATING:
                return
            moved = np.eye(4)
            for index, axis in enumerate(D6_AXES):
                if axis not in free:
                    continue
                if index < 3:
                    moved[index, 3] = state(prim, axis)
                else:
                    moved[:3, :3] = moved[:3, :3] @ by_hand.rotation(np.eye(3)[index - 3], state(prim, axis))
            np.testing.assert_allclose(M, moved, atol=CLOSE)


@pytest.mark.parametrize(("seed", "root"), [(0, "fixed"), (1, "floating")])
def test_random_robot_of_all_joints_and_closures_is_the_same(seed: int, root: Any, tmp_path: Path) -> None:
    robot, q = random_robot(seed, root)
    random = np.random.default_rng(seed)
    joints = tuple(
        replace(joint, offset=by_hand.some_pose(random)) if joint.type is JointType.SPHERICAL else joint
        for joint in robot.mechanism.joints
    )
    moved = build_robot(replace(robot.mechanism, joints=joints, closures=()), geometry=False)
    assert_same_robot(InUsd(eurdf.export(robot, "usd"), tmp_path / "closed"), robot, q)
    assert_same_robot(InUsd(eurdf.export(moved, "usd"), tmp_path / "offset"), moved, q)


#: Robots with universal joints, and with 3d and 6d closures; the others take long.
FIRST = ("delta", "kangaroo_leg")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name not in FIRST)) for name in eurdf.collection_names()]
)
def test_robot_of_the_collection_is_the_same(name: str, tmp_path: Path) -> None:
    robot = eurdf.load(name, geometry=False)
    assert_same_robot(InUsd(eurdf.export(robot, "usd"), tmp_path), robot, robot.configurations["assembled"])


COLOR = '<material name="m"><color rgba="0.5 1 0 0.25"/></material>'
BOX = f'<visual><geometry><box size="1 2 3"/></geometry>{COLOR}</visual>'
PAIR = robot_element(
    link_element("base", BALL),
    link_element("arm", BODY + BALL + BOX),
    link_element("tip"),
    link_element("1st hand", BODY + BALL),
    joint_element("shoulder", "revolute", "base", "arm", LIMIT + '<dynamics damping="0.2" friction="0.1"/>'),
    joint_element("flange", "fixed", "arm", "tip"),
    joint_element("wrist", "prismatic", "tip", "1st hand", LIMIT),
)
DESCRIPTION = """\
extended_urdf: "2.1"
joints:
  shoulder: {stiffness: 30, rest: 0.4, armature: 0.3}
actuators:
  - {joint: wrist, name: lift, control: [-4, 6]}
configurations:
  raised: {shoulder: 0.5}
"""


def losses(export: eurdf.convert.Export) -> set[tuple[str, str]]:
    return {(loss.code, loss.name) for loss in export.losses}


def test_properties_of_joints_are_in_degrees_and_newtons(tmp_path: Path) -> None:
    export = eurdf.export(DESCRIPTION, "usd", urdf=PAIR, configuration="raised")
    there = InUsd(export, tmp_path)
    shoulder, wrist = (there.prims("joints")[name] for name in ("shoulder", "wrist"))
    turn = UsdPhysics.RevoluteJoint(shoulder)
    degrees = 180.0 / math.pi
    assert turn.GetLowerLimitAttr().Get() == pytest.approx(-degrees)
    assert turn.GetUpperLimitAttr().Get() == pytest.approx(2.0 * degrees)
    assert UsdPhysics.PrismaticJoint(wrist).GetUpperLimitAttr().Get() == 2.0
    spring = UsdPhysics.DriveAPI(shoulder, "angular")
    assert spring.GetStiffnessAttr().Get() == pytest.approx(30.0 / degrees)
    assert spring.GetDampingAttr().Get() == pytest.approx(0.2 / degrees)
    assert spring.GetTargetPositionAttr().Get() == pytest.approx(0.4 * degrees)
    assert math.isinf(spring.GetMaxForceAttr().Get())
    motor = UsdPhysics.DriveAPI(wrist, "linear")
    assert (motor.GetStiffnessAttr().Get(), motor.GetMaxForceAttr().Get()) == (0.0, 6.0)
    assert shoulder.GetAttribute("newton:armature").Get() == pytest.approx(0.3)
    assert shoulder.GetAttribute("physxJoint:armature").Get() == pytest.approx(0.3)
    assert shoulder.GetAttribute("newton:friction").Get() == pytest.approx(0.1)
    assert shoulder.GetAttribute("newton:velocityLimit").Get() == pytest.approx(3.0 * degrees)
    assert wrist.GetAttribute("physxJoint:maxJointVelocity").Get() == 3.0
    assert state(shoulder, "angular") == pytest.approx(0.5)
    assert {
        ("export-armature", "shoulder"),
        ("export-friction", "shoulder"),
        ("export-velocity-limit", "shoulder"),
        ("export-effort-limit", "shoulder"),
        ("export-control-range", "lift"),
        ("export-actuator-name", "lift"),
    } <= losses(export)


def test_position_drive_holds_the_start(tmp_path: Path) -> None:
    description = DESCRIPTION.replace("joint: wrist, name: lift, control: [-4, 6]", "joint: shoulder")
    export = eurdf.export(description, "usd", urdf=PAIR, configuration="raised", actuators="position")
    there = InUsd(export, tmp_path)
    drive = UsdPhysics.DriveAPI(there.prims("joints")["shoulder"], "angular")
    assert drive.GetStiffnessAttr().Get() == pytest.approx(math.radians(70.0))
    assert drive.GetTargetPositionAttr().Get() == pytest.approx(math.degrees(0.5))
    assert {("export-spring", "shoulder"), ("export-position-gain", "shoulder")} <= losses(export)
    without = eurdf.export(DESCRIPTION, "usd", urdf=PAIR, actuators="none")
    assert ("export-no-actuator", "lift") in losses(without)


def test_bodies_are_those_with_mass_and_the_base(tmp_path: Path) -> None:
    export = eurdf.export(DESCRIPTION, "usd", urdf=PAIR)
    there = InUsd(export, tmp_path)
    assert set(there.prims("bodies")) == {"base", "arm", "1st hand"}
    assert there.prims("bodies")["1st hand"].GetName() == "_1st_hand"
    assert there.named("tip").GetParent().GetName() == "arm"
    assert there.inertia(there.prims("bodies")["base"])[0] == 1.0
    assert {("export-massless-base", "base"), ("export-name", "1st hand")} <= losses(export)
    hidden = eurdf.export(PAIR.replace(link_element("arm", BODY + BALL + BOX), link_element("arm", BALL)), "usd")
    assert ("export-massless-link", "arm") in losses(hidden)


def test_articulation_begins_at_the_world_or_the_floating_root(tmp_path: Path) -> None:
    for root, path in (("fixed", "/robot"), ("floating", "/robot/bodies/base")):
        there = InUsd(eurdf.export(PAIR, "usd", root=root), tmp_path / root)
        prims = [prim for prim in there.stage.Traverse() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]
        assert [str(prim.GetPath()) for prim in prims] == [path]
        assert ("root_joint" in there.prims("joints")) == (root == "fixed")


def test_shapes_have_sizes_colors_and_purposes(tmp_path: Path) -> None:
    there = InUsd(eurdf.export(PAIR, "usd"), tmp_path)
    arm = there.prims("bodies")["arm"]
    box, ball = arm.GetChild("arm_visual_0"), arm.GetChild("arm_collision_0")
    np.testing.assert_allclose(there.pose(box)[:3, :3] * UsdGeom.Cube(box).GetSizeAttr().Get(), np.diag((1, 2, 3)))
    material = UsdShade.MaterialBindingAPI(box).ComputeBoundMaterial()[0]
    surface = material.ComputeSurfaceSource()[0]
    # 0.5 in sRGB is 0.2140 of full light.
    np.testing.assert_allclose(surface.GetInput("diffuseColor").Get(), (0.21404, 1.0, 0.0), atol=1e-5)
    assert surface.GetInput("opacity").Get() == 0.25
    assert UsdGeom.Sphere(ball).GetRadiusAttr().Get() == pytest.approx(0.05)
    assert ball.HasAPI(UsdPhysics.CollisionAPI)
    assert not box.HasAPI(UsdPhysics.CollisionAPI)
    assert UsdGeom.Imageable(ball).GetPurposeAttr().Get() == "guide"


def test_neighbours_across_a_fixed_link_do_not_collide(tmp_path: Path) -> None:
    urdf = PAIR.replace(link_element("tip"), link_element("tip", BODY + BALL))
    there = InUsd(eurdf.export(urdf, "usd"), tmp_path)
    bodies = there.prims("bodies")
    pairs = {
        frozenset((name, target.name))
        for name, body in bodies.items()
        for target in UsdPhysics.FilteredPairsAPI(body).GetFilteredPairsRel().GetTargets()
    }
    assert pairs == {frozenset(("base", "tip")), frozenset(("arm", "_1st_hand"))}


def mimicking(joint: str, kind: str) -> str:
    """PAIR with a third moving link, on a joint that mimics another one."""
    mimic = f'<mimic joint="{joint}" multiplier="-2" offset="0.5"/>'
    third = link_element("third", BODY), joint_element("follower", kind, "1st hand", "third", LIMIT + mimic)
    return PAIR.replace("</robot>", "".join(third) + "</robot>")


def test_mimic_of_the_same_kind_is_stated_for_newton(tmp_path: Path) -> None:
    export = eurdf.export(mimicking("shoulder", "revolute"), "usd")
    there = InUsd(export, tmp_path)
    follower = there.prims("joints")["follower"]
    assert follower.GetRelationship("newton:mimicJoint").GetTargets() == ["/robot/joints/shoulder"]
    assert follower.GetAttribute("newton:mimicCoef1").Get() == -2.0
    assert follower.GetAttribute("newton:mimicCoef0").Get() == pytest.approx(math.degrees(0.5))
    assert state(follower, "angular") == pytest.approx(0.5)
    assert ("export-mimic-joint", "follower") in losses(export)


def test_coupling_of_two_rotations_is_stated_for_newton(tmp_path: Path) -> None:
    third = link_element("third", BODY), joint_element("other", "revolute", "1st hand", "third", LIMIT)
    robot = eurdf.load(PAIR.replace("</robot>", "".join(third) + "</robot>"), geometry=False)
    terms = (("shoulder", 2.0), ("other", 3.0))
    for kept, coefficients in ((True, terms), (False, (terms[0], ("wrist", 3.0)))):
        couplings = (Coupling("gear", coefficients, 0.4),)
        export = eurdf.export(build_robot(replace(robot.mechanism, couplings=couplings), geometry=False), "usd")
        assert ("export-coupling" if kept else "export-coupling-dropped", "gear") in losses(export)
        there = InUsd(export, tmp_path / str(kept))
        shoulder = there.prims("joints")["shoulder"]
        assert shoulder.HasRelationship("newton:mimicJoint") == kept
        if kept:
            assert shoulder.GetAttribute("newton:mimicCoef1").Get() == -1.5
            assert shoulder.GetAttribute("newton:mimicCoef0").Get() == pytest.approx(math.degrees(0.2))


def test_mesh_becomes_a_payload(tmp_path: Path) -> None:
    (tmp_path / "a $(b).STL").write_bytes(TETRAHEDRON)
    (tmp_path / "broken.stl").write_bytes(b"solid")
    uses = "".join(
        f'<{use}><geometry><mesh filename="{file}" scale="2 2 2"/></geometry></{use}>'
        for use, file in (
            ("visual", "a $(b).STL"),
            ("collision", "a $(b).STL"),
            ("visual", "broken.stl"),
            ("visual", "no"),
        )
    )
    path = tmp_path / "robot.urdf"
    path.write_text(PAIR.replace(BODY + BALL + BOX, BODY + uses), encoding="utf-8")
    export = eurdf.export(path, "usd")
    there = InUsd(export, tmp_path / "out")
    assert list(export.files) == ["robot.usda", "meshes/a___b_.stl.usdc"]
    assert there.errors() == []
    for use in ("visual", "collision"):
        mesh = UsdGeom.Mesh(there.prims("bodies")["arm"].GetChild(f"arm_{use}_0"))
        assert np.ptp(np.array(mesh.GetPointsAttr().Get()), axis=0).tolist() == [1.0, 1.0, 1.0]
        assert len(mesh.GetFaceVertexIndicesAttr().Get()) == 12
        np.testing.assert_allclose(there.pose(mesh.GetPrim())[:3, :3], 2.0 * np.eye(3))
    missing = {
        ("export-mesh-missing", "no"),
        ("export-mesh-format", "broken.stl"),
        ("export-convex-hull", "a $(b).STL"),
    }
    assert missing <= losses(export)
    referenced = losses(eurdf.export(path, "usd", mesh_files="reference"))
    assert referenced - losses(export) == {("export-mesh-not-referenced", "a $(b).STL")}


def test_names_that_usd_cannot_have_are_shown(tmp_path: Path) -> None:
    there = InUsd(eurdf.export(PAIR.replace('name="robot"', 'name="mÿ robot"'), "usd"), tmp_path)
    assert (there.robot.GetName(), there.robot.GetDisplayName()) == ("m__robot", "mÿ robot")


def test_missing_extra_is_named(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.convert.usd.write.find_spec", lambda name: None)
    assert main(["export", "four_bar", "--to", "usd"]) == 2
    assert "the package that writes USD is not installed; install it with: " in (err := capsys.readouterr().err)
    assert "[usd]" in err


def test_mimic_of_another_kind_is_dropped() -> None:
    export = eurdf.export(mimicking("shoulder", "prismatic"), "usd")
    assert ("export-mimic-joint-dropped", "follower") in losses(export)
    assert b"newton:mimicJoint" not in export.main


def test_coordinates_name_the_joints_of_the_file(tmp_path: Path) -> None:
    robot, q = random_robot(2)
    export = eurdf.export(robot, "usd")
    there = InUsd(export, tmp_path)
    prims = there.prims("joints").values()
    moving = {prim.GetName() for prim in prims if prim.GetTypeName() != "PhysicsFixedJoint"}
    assert set(export.coordinates.names) == moving
    np.testing.assert_allclose(export.coordinates.from_q(export.coordinates.to_q(q)), q, atol=1e-12)


@pytest.mark.slow
def test_other_formats_do_not_load_usd() -> None:
    code = (
        "import sys, eurdf; eurdf.export('four_bar', 'urdf'); assert not any(m.startswith('pxr') for m in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
