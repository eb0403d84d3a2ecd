"""SDFormat that is imported: poses, axes and closures as computed by hand, and every loss listed."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.mechanism.joint import Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT
from support import by_hand

INERTIAL = "<inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"


def link(name: str, pose: str, more: str = INERTIAL, relative: str = "") -> str:
    return f'<link name="{name}"><pose{relative}>{pose}</pose>{more}</link>'


def joint(name: str, kind: str, parent: str, child: str, more: str = "") -> str:
    return f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{more}</joint>'


def axis(xyz: str, more: str = "", tag: str = "axis") -> str:
    return f"<{tag}><xyz>{xyz}</xyz>{more}</{tag}>"


def sdf(*content: str, version: str = "1.11") -> str:
    return f'<sdf version="{version}"><model name="m">{"".join(content)}</model></sdf>'


def imported(folder: Path, text: str) -> eurdf.convert.Import:
    path = folder / "robot.sdf"
    path.write_text(text)
    return eurdf.import_robot(path)


def codes(found: eurdf.convert.Import) -> set[str]:
    return {loss.code for loss in found.losses}


LIMIT = "<limit><lower>-1</lower><upper>2</upper><effort>7</effort><velocity>-1</velocity></limit>"
SPRING = (
    "<dynamics><damping>0.3</damping><friction>0.2</friction><spring_stiffness>9</spring_stiffness>"
    "<spring_reference>0.1</spring_reference></dynamics>"
)
#: A link turned by 90 degrees about z, with a joint off its origin; then one of each other type.
CHAIN = sdf(
    link("base", "0 0 1 0 0 0"),
    link("one", f"1 0 1 0 0 {math.pi / 2}"),
    link("two", "1 2 1 0 0 0"),
    link("three", "0 0 0.5 0 0 0", relative=' relative_to="two"'),
    link("four", "1 2 3 0 0 0"),
    link("five", "2 2 3 0 0 0"),
    link("six", "3 2 3 0 0 0"),
    joint("turn", "revolute", "base", "one", f"<pose>0.1 0 0 0 0 0</pose>{axis('0 0 2', LIMIT + SPRING)}"),
    joint("slide", "prismatic", "one", "two", axis("1 0 0", "<limit><lower>-1</lower></limit>")),
    joint("ball", "ball", "two", "three"),
    joint("cardan", "universal", "three", "four", axis("1 0 0") + axis("0 1 0", tag="axis2")),
    joint("screw", "screw", "four", "five", axis("0 0 1") + "<screw_thread_pitch>0.02</screw_thread_pitch>"),
    joint("spin", "continuous", "five", "six", axis("0 1 0")),
    '<frame name="tool" attached_to="six"><pose>0 0 0.1 0 0 0</pose></frame>',
)


def test_links_are_where_they_are_computed_by_hand(tmp_path: Path) -> None:
    found = imported(tmp_path, CHAIN)
    found.write(tmp_path / "out")
    robot = eurdf.load(tmp_path / "out", geometry=False)
    turned = {"turn": (math.pi / 2,), "slide": (0.5,), "screw": (math.pi,)}
    coordinates = {"root_joint": (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), **turned}
    q = robot.configuration(coordinates)
    pin.framesForwardKinematics(robot.model, robot.data, q)

    def pose(name: str) -> pin.SE3:
        return robot.data.oMf[robot.model.getFrameId(name, pin.FrameType.BODY)]

    # The joint is at (1, 0.1, 1), and turns `one` about z there: its origin goes from (1, 0) to (1.1, 0.1).
    np.testing.assert_allclose(pose("one").translation, (1.1, 0.1, 1.0), atol=1e-12)
    np.testing.assert_allclose(pose("one").rotation, by_hand.rotation((0, 0, 1), math.pi), atol=1e-12)
    # `two` was at (0, 2) from there; it slides by 0.5 along its own x, which points to y now.
    np.testing.assert_allclose(pose("two").translation, (1.0 - 1.9, 0.1 + 0.5, 1.0), atol=1e-12)
    # The screw advances by half its pitch.
    before = robot.configuration({**coordinates, "screw": (0.0,)})
    height = pose("five").translation[2]
    pin.framesForwardKinematics(robot.model, robot.data, before)
    np.testing.assert_allclose(height - pose("five").translation[2], 0.01, atol=1e-12)


def test_limits_of_zero_lock(tmp_path: Path) -> None:
    zero = "<limit><lower>0</lower><upper>0</upper></limit>"
    locked = CHAIN.replace("<limit><lower>-1</lower></limit>", zero)
    locked = locked.replace(
        axis("1 0 0") + axis("0 1 0", tag="axis2"), axis("1 0 0", zero) + axis("0 1 0", tag="axis2")
    )
    places = []
    for text, cardan in ((CHAIN, (0.0, 0.4)), (locked, (0.4,))):
        found = imported(tmp_path, text)
        found.write(tmp_path / "out", force=True)
        robot = eurdf.load(tmp_path / "out", geometry=False)
        q = robot.configuration({"turn": (0.3,), "cardan": cardan, "screw": (0.2,)})
        pin.framesForwardKinematics(robot.model, robot.data, q)
        places.append(robot.data.oMf[robot.model.getFrameId("six", pin.FrameType.BODY)].homogeneous)
    np.testing.assert_allclose(places[0], places[1], atol=1e-12)
    types = {joint.name: joint.type for joint in robot.mechanism.joints}
    assert (types["slide"], types["cardan"]) == (JointType.FIXED, JointType.CONTINUOUS)
    assert [loss.name for loss in found.losses if loss.code == "import-locked-joint"] == ["slide", "cardan"]


def test_joints_keep_type_limits_and_springs(tmp_path: Path) -> None:
    found = imported(tmp_path, CHAIN)
    joints = {joint.name: joint for joint in found.mechanism.joints}
    types = [joints[name].type for name in ("turn", "slide", "ball", "cardan", "screw", "spin")]
    assert types == ["revolute", "prismatic", "spherical", "universal", "helical", "continuous"]
    turn = joints["turn"].properties
    assert (turn.lower, turn.upper, turn.effort, turn.velocity) == ((-1.0,), (2.0,), (7.0,), (math.inf,))
    assert (turn.damping, turn.friction, turn.stiffness, turn.rest) == ((0.3,), (0.2,), (9.0,), (0.1,))
    assert joints["slide"].properties.upper == (math.inf,)
    assert joints["screw"].pitch == 0.02
    assert found.mechanism.root == "floating"
    (tool,) = found.mechanism.frames
    assert (tool.name, tool.body, tool.pose.xyz) == ("tool", "six", (0.0, 0.0, 0.1))
    assert found.losses == ()


SQUARE = (
    link("base", "0 0 0 0 0 0"),
    link("left", "0 0 0 0 0 0"),
    link("top", "0 0 1 0 0 0"),
    link("right", "1 0 0 0 0 0"),
    joint("to_world", "fixed", "world", "base"),
    joint("a", "revolute", "base", "left", axis("0 1 0")),
    joint("b", "revolute", "left", "top", axis("0 1 0")),
    joint("c", "revolute", "base", "right", axis("0 1 0")),
)


@pytest.mark.parametrize(
    ("kind", "expected", "more"),
    [("ball", PointClosure, ""), ("fixed", FrameClosure, ""), ("revolute", HingeClosure, axis("0 1 0"))],
)
def test_second_parent_closes_a_loop(tmp_path: Path, kind: str, expected: type, more: str) -> None:
    found = imported(tmp_path, sdf(*SQUARE, joint("d", kind, "right", "top", f"<pose>1 0 0 0 0 0</pose>{more}")))
    (closure,) = found.mechanism.closures
    assert type(closure) is expected
    assert (closure.a.body, closure.a.pose.xyz) == ("right", (0.0, 0.0, 1.0))
    assert (closure.b.body, closure.b.pose.xyz) == ("top", (1.0, 0.0, 0.0))
    assert found.closes
    assert [body.name for body in found.mechanism.bodies] == ["base", "left", "top", "right"]
    assert found.mechanism.root == "fixed"


def test_older_version_has_axes_in_the_model(tmp_path: Path) -> None:
    use = "<use_parent_model_frame>1</use_parent_model_frame>"
    text = sdf(
        link("base", "0 0 0 0 0 0"),
        link("arm", f"0 0 1 0 0 {math.pi / 2}"),
        joint("a", "revolute", "base", "arm", axis("1 0 0", use)),
        version="1.6",
    )
    (found,) = imported(tmp_path, text).mechanism.joints
    np.testing.assert_allclose(found.axes[0], (0, -1, 0), atol=1e-12)


def test_mimic_has_its_reference(tmp_path: Path) -> None:
    mimic = '<mimic joint="a"><multiplier>2</multiplier><offset>0.5</offset><reference>0.1</reference></mimic>'
    text = sdf(*SQUARE[:-1], joint("c", "revolute", "base", "right", axis("0 1 0", mimic)))
    found = {joint.name: joint.mimic for joint in imported(tmp_path, text).mechanism.joints}
    assert found["c"] == Mimic("a", 2.0, 0.5 - 0.2)


def test_link_without_inertia_has_the_default(tmp_path: Path) -> None:
    found = imported(tmp_path, sdf(link("base", "0 0 0 0 0 0", "")))
    inertia = found.mechanism.bodies[0].inertia
    assert inertia is not None
    assert (inertia.mass, inertia.moments) == (1.0, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0))
    assert codes(found) == {"import-default-inertia"}


def test_shapes_have_sizes_poses_and_colors(tmp_path: Path) -> None:
    (tmp_path / "part.stl").write_bytes(b"solid")
    shapes = (
        "<visual name='v'><pose>0 0 1 0 0 0</pose><geometry><cylinder><radius>1</radius><length>2</length></cylinder>"
        "</geometry><material><diffuse>1 0 0 1</diffuse></material></visual>"
        "<collision name='c'><geometry><mesh><uri>part.stl</uri><scale>1 1 2</scale></mesh></geometry></collision>"
        "<collision name='p'><geometry><plane/></geometry></collision>"
        "<collision name='g'><geometry><mesh><uri>gone.stl</uri></mesh></geometry></collision>"
        "<collision name='s'><geometry><mesh><uri>/etc/passwd</uri></mesh></geometry></collision>"
    )
    found = imported(tmp_path, sdf(link("base", "0 0 0 0 0 0", INERTIAL + shapes)))
    (body,) = found.mechanism.bodies
    (visual,), (mesh,) = body.visuals, body.collisions
    assert (visual.kind, visual.size, visual.pose.xyz) == ("cylinder", (1.0, 2.0), (0, 0, 1))
    assert visual.color == (1, 0, 0, 1)
    assert (mesh.filename, mesh.size) == ("meshes/part.stl", (1.0, 1.0, 2.0))
    assert found.files["meshes/part.stl"] == b"solid"
    assert [loss.name for loss in found.losses if loss.code == "import-mesh"] == ["gone.stl", "/etc/passwd"]
    assert "import-shape" in codes(found)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<!DOCTYPE s [<!ENTITY e SYSTEM "file:///etc/passwd">]><sdf version="1.6">&e;</sdf>', "robot.sdf:1"),
        ('<sdf version="1.6"/>', "the file has 0 models: none; it must have one"),
        ('<sdf version="1.6"><model name="a"/><model name="b"/></sdf>', "the file has 2 models: 'a', 'b'"),
        (sdf(), "the model has no link"),
        (sdf(link("a", "0 0 0 0 0 0"), "<include><uri>model://b</uri></include>"), "<include> is another model"),
        (sdf(link("a", "0 0 zero 0 0 0")), "the pose of <pose> is '0 0 zero 0 0 0'; it must be 6 finite numbers"),
        (sdf(link("a", "0 0 inf 0 0 0")), "it must be 6 finite numbers"),
        (
            sdf(
                link("a", "0 0 0 0 0 0", relative=' relative_to="b"'),
                link("b", "0 0 0 0 0 0", relative=' relative_to="a"'),
            ),
            "poses refer to each other in a circle: a -> b -> a",
        ),
        (
            sdf(link("f999", "0 0 0 0 0 0"), *(f'<frame name="f{i}" attached_to="f{i + 1}"/>' for i in range(999))),
            "'f0' is attached to more than 200 others in turn",
        ),
        (sdf(link("a", "0 0 0 0 0 0"), joint("j", "revolute", "a", "z")), "there is no link, joint or frame 'z'"),
        (sdf(*SQUARE[:2], joint("j", "hinge", "base", "left")), "joint 'j' has the type 'hinge'"),
        (sdf(*SQUARE[:2], joint("j", "revolute", "base", "left")), "joint 'j' has no <axis>"),
        (sdf(*SQUARE[:2], joint("j", "revolute", "base", "left", axis("0 0 0"))), "an axis of joint 'j' is zero"),
        (sdf(*SQUARE[:2]), "no chain of joints leads from 'base' to the links 'left'"),
    ],
)
def test_bad_file_is_refused_with_one_error(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(eurdf.errors.CannotImport) as refused:
        imported(tmp_path, text)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.slow
@pytest.mark.skipif("EURDF_IMPORT_MODELS" not in os.environ, reason="EURDF_IMPORT_MODELS names no folder of models")
def test_cassies_are_imported(tmp_path: Path) -> None:
    found = sorted(Path(os.environ["EURDF_IMPORT_MODELS"]).rglob("cassie*.sdf"))
    if not found:
        pytest.skip("there is no cassie*.sdf in the folder")
    for path in found:
        robot = eurdf.import_robot(path)
        assert len(robot.mechanism.closures) == 4
        assert robot.closes
        assert max(each.position for each in robot.opened) < 1e-12
        robot.write(tmp_path / path.stem)
        assert eurdf.check(tmp_path / path.stem).ok
        if robot.mechanism.root == "floating":
            # The file has the pelvis at a height of 1.01 m; nothing says so in a description but its start.
            assert ROOT_JOINT not in robot.mechanism.configurations


def test_loop_joint_may_be_stated_first(tmp_path: Path) -> None:
    loop = "<physics><simbody><must_be_loop_joint>true</must_be_loop_joint></simbody></physics>"
    found = imported(tmp_path, sdf(*SQUARE[:5], joint("d", "ball", "right", "top", loop), *SQUARE[5:]))
    assert [closure.name for closure in found.mechanism.closures] == ["d"]
