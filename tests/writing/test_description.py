"""A mechanism written as URDF and YAML is the same mechanism when it is read again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lxml import etree

import eurdf
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.body import Body, Shape
from eurdf.mechanism.constraint import Compliance
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, Motor
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.same_model import with_universal_joints
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.robot import build_robot
from eurdf.writing.description import DescriptionFiles, NotWritable, describe_mechanism
from support import by_hand
from support.every_joint import write_every_joint
from support.exported import random_robot
from support.places import ROBOTS
from support.same_mechanism import unlike


def read(files: DescriptionFiles) -> Mechanism:
    found = read_robot(files.yaml, urdf=files.urdf.decode())
    assert found.linked is not None, list(found.diagnostics)
    return found.mechanism


def mechanism_of(path: Any, **options: Any) -> Mechanism:
    found = read_robot(path, **options)
    assert found.linked is not None
    return found.mechanism


def test_robots_of_the_collection_are_the_same() -> None:
    for name in eurdf.collection_names():
        mechanism = mechanism_of(name)
        files = describe_mechanism(mechanism)
        assert files.version == mechanism.version
        # The last of three merged joints is a frame too, which a file with one joint in their place does not need.
        merged = [f".frames[{frame.name}].kind: joint and frame" for frame in mechanism.frames]
        assert [each for each in unlike(mechanism, read(files)) if each not in merged] == [], name


def test_description_does_not_change_when_written_again() -> None:
    first = describe_mechanism(mechanism_of("digit_leg"))
    assert describe_mechanism(read(first)).yaml == first.yaml


@pytest.mark.parametrize("name", ["digit_leg", "stewart_platform"])
def test_version_1_is_written_in_version_2(name: str) -> None:
    mechanism = mechanism_of(ROBOTS / name / "robot.v1.yaml")
    files = describe_mechanism(mechanism)
    assert files.version == "2.0"
    expected = replace(with_universal_joints(mechanism), version="2.0")
    assert unlike(expected, read(files)) == []


@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=10)
def test_random_mechanism_of_all_joint_types_is_the_same(seed: int, root: Any) -> None:
    mechanism = random_robot(seed, root)[0].mechanism
    rigid = rigid_roots(mechanism.bodies[0].name, mechanism.joints)
    assume(all(rigid[closure.a.body] != rigid[closure.b.body] for closure in mechanism.closures))
    files = describe_mechanism(mechanism)
    assert files.version == "2.1"
    assert unlike(mechanism, read(files)) == []


def test_properties_of_every_joint_type_are_the_same(tmp_path: Path) -> None:
    mechanism = mechanism_of(write_every_joint(tmp_path)[0])
    random = np.random.default_rng(1)
    joints = []
    for joint in mechanism.joints:
        if joint.type is JointType.FIXED or joint.mimic:
            joints.append(replace(joint, offset=Pose()))
            continue
        n, nv = len(joint.type.coordinates), joint.type.nv
        changes: dict[str, Any] = {
            key: tuple(random.uniform(0.5, 2.0, nv).tolist())
            for key in ("velocity", "effort", "damping", "friction", "armature")
        }
        if joint.type not in (JointType.PLANAR, JointType.FLOATING):
            changes |= {key: (random.uniform(0.5, 2.0),) * nv for key in ("acceleration", "deceleration", "jerk")}
        if joint.type.quaternion is None and joint.type is not JointType.PLANAR:
            changes |= {key: tuple(random.uniform(0.5, 2.0, nv).tolist()) for key in ("stiffness", "rest")}
            if joint.type is not JointType.CONTINUOUS:
                changes |= {"lower": (-1.0,) * n, "upper": tuple(random.uniform(0.5, 2.0, n).tolist())}
        joints.append(replace(joint, offset=Pose(), properties=replace(joint.properties, **changes)))
    compliant = replace(mechanism.closures[0], compliance=Compliance(1e-6, 1e-4))
    mechanism = replace(
        mechanism,
        version="2.1",
        joints=tuple(joints),
        closures=(compliant, *mechanism.closures[1:]),
        motors=MappingProxyType({"slide": Motor("lift", (-3.0, 5.0))}),
        frames=tuple(replace(frame, kind="frame") for frame in mechanism.frames),
        own_data=MappingProxyType({"/x-note": 7, "/actuators/0/x-serial": "A1", "/joints/ball/x-oil": True}),
    )
    assert unlike(mechanism, read(describe_mechanism(mechanism))) == []


def test_limit_of_one_side_is_kept() -> None:
    mechanism = random_robot(2, kinds=())[0].mechanism
    joints = tuple(
        replace(joint, properties=replace(joint.properties, lower=(-np.inf,) * n, upper=(0.5,) * n))
        if (n := len(joint.type.coordinates)) and joint.type in (JointType.CYLINDRICAL, JointType.HELICAL)
        else joint
        for joint in mechanism.joints
    )
    back = read(describe_mechanism(replace(mechanism, joints=joints, configurations={})))
    for joint in back.joints:
        if joint.type in (JointType.CYLINDRICAL, JointType.HELICAL):
            assert joint.properties.lower == (-np.inf,) * len(joint.type.coordinates)
            assert joint.properties.upper == (0.5,) * len(joint.type.coordinates)


def test_shapes_with_textures_are_the_same() -> None:
    color = (0.1, 0.2, 0.3, 1.0)
    shapes = (
        Shape("mesh", (1.0, -1.0, 0.001), Pose((1.0, 2.0, 3.0)), "package://a b/c&d.stl", color, "t.png"),
        Shape("capsule", (0.1, 0.25), texture="other.png"),
        Shape("box", (0.1, 0.2, 0.3), color=color),
    )
    bare = tuple(replace(shape, color=None, texture="") for shape in shapes)
    mechanism = Mechanism("r", "2.0", "fixed", (Body("base", visuals=shapes, collisions=bare),), ())
    assert unlike(mechanism, read(describe_mechanism(mechanism))) == []


def test_child_frame_away_from_its_joint_stays_there() -> None:
    robot, q = random_robot(3, kinds=())
    random = np.random.default_rng(0)
    joints = tuple(replace(joint, offset=by_hand.some_pose(random)) for joint in robot.mechanism.joints)
    robot = build_robot(replace(robot.mechanism, joints=joints), geometry=False)
    there = build_robot(read(describe_mechanism(robot.mechanism)), geometry=False)
    q2 = there.configuration(robot.joint_positions(q))
    for each, at in ((robot, q), (there, q2)):
        pin.framesForwardKinematics(each.model, each.data, at)
    for body in robot.mechanism.bodies:
        one, other = (each.data.oMf[each.model.getFrameId(body.name, pin.FrameType.BODY)] for each in (robot, there))
        np.testing.assert_allclose(other.homogeneous, one.homogeneous, atol=1e-12)


def test_comments_are_at_the_head_of_both_files() -> None:
    files = describe_mechanism(mechanism_of("four_bar"), schema="s.json", comments=("Made of a--b.",))
    assert files.yaml.startswith("# yaml-language-server: $schema=s.json\n# Made of a--b.\n")
    assert b"<!-- Made of a- -b. -->" in files.urdf
    read(files)


def test_materials_are_declared_once_and_used_by_name() -> None:
    steel, paint = (0.5, 0.5, 0.5, 1.0), (1.0, 0.0, 0.0, 1.0)
    shapes = tuple(Shape("sphere", (0.1,), color=color) for color in (steel, paint, steel, None))
    mechanism = Mechanism("r", "2.0", "fixed", (Body("base", visuals=shapes),), ())
    files = describe_mechanism(mechanism, materials={"steel": steel, "brass": (0.8, 0.6, 0.2, 1.0)})
    assert unlike(mechanism, read(files)) == []
    robot = etree.fromstring(files.urdf)
    assert [material.get("name") for material in robot.iterchildren("material")] == ["steel", "brass"]
    assert [material.get("name") for material in robot.iterfind("link/visual/material")].count("steel") == 2
    assert len(robot.findall("link/visual/material/color")) == 1


@pytest.mark.parametrize(
    ("body", "joint", "message"),
    [("a\x00b", "j", "has a name that XML cannot contain"), ("b", "x-ball", "needs an entry in the YAML file")],
)
def test_name_that_the_files_cannot_contain_is_refused(body: str, joint: str, message: str) -> None:
    base = Mechanism("r", "2.0", "fixed", (Body("base"), Body(body)), ())
    ball = replace(by_hand.some_joint(JointType.SPHERICAL, np.random.default_rng(0), "base", body), name=joint)
    with pytest.raises(NotWritable, match=message):
        describe_mechanism(replace(base, joints=(ball,)))
