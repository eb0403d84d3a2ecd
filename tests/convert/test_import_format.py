"""Dialects of URDF with loops that are imported: Isaac Sim's, Drake's, and URDF+."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

import eurdf
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.convert.losses import Effect
from eurdf.mechanism.constraint import Coupling
from eurdf.mechanism.joint_types import JointType
from eurdf.pinocchio.robot import build_robot
from support.open_four_bar import TURN, robot
from support.plain_urdf import inertial, joint_element, link_element

ENDS = '<link1 link="top"/><link2 link="right"/>'


def loop_joint(content: str, attributes: str = 'type="spherical"') -> str:
    return f'<loop_joint name="l" {attributes}>{content}</loop_joint>'


def imported(folder: Path, text: str, format_: str | None = None) -> eurdf.convert.Import:
    path = folder / "robot.urdf"
    path.write_text(text)
    return eurdf.import_robot(path, format=format_)


def codes(found: eurdf.convert.Import) -> set[str]:
    return {loss.code for loss in found.losses}


@pytest.mark.parametrize("second", ["link1", "link2"])  # the documentation of Isaac has link1 twice
@pytest.mark.parametrize(
    ("kind", "expected"), [("spherical", PointClosure), ("fixed", FrameClosure), ("revolute", HingeClosure)]
)
def test_loop_joint_of_isaac_is_a_closure(tmp_path: Path, kind: str, second: str, expected: type) -> None:
    loop = (
        f'<loop_joint name="loop" type="{kind}"><link1 link="top" rpy="0 0 0" xyz="1 0 0"/>'
        f'<{second} link="right" rpy="0 0 0" xyz="0 0 1"/></loop_joint>'
    )
    frame = '<fixed_frame name="tool"><parent link="top"/><origin xyz="0 0 2" rpy="0 0 0"/></fixed_frame>'
    found = imported(tmp_path, robot(loop + frame))
    assert found.format == "loop-joint"
    (closure,) = found.mechanism.closures
    assert type(closure) is expected
    assert (closure.a.body, closure.a.pose.xyz) == ("top", (1, 0, 0))
    assert (closure.b.body, closure.b.pose.xyz) == ("right", (0, 0, 1))
    if isinstance(closure, HingeClosure):
        assert closure.axes == ((0, 1, 0), (0, 1, 0))  # that of the other joints
    assert found.mechanism.frames[0].pose.xyz == (0, 0, 2)
    assert found.closes
    found.write(tmp_path / "out")
    assert eurdf.check(tmp_path / "out").ok


def turned_loops(text: bytes, axis: int) -> bytes:
    """A URDF of ours as Isaac Sim writes it: loop joints in single precision, without axis, about x, y or z."""
    root = etree.fromstring(text)
    turn = np.roll(np.eye(3), -axis, axis=1)  # its column of the axis is x, the axis in the file
    for loop in root.iter("loop_joint"):
        for stated in loop.findall("axis"):
            loop.remove(stated)
        for end in loop:
            R = pin.rpy.rpyToMatrix(np.array([float(word) for word in end.get("rpy").split()])) @ turn.T
            end.set("rpy", " ".join(map(str, pin.rpy.matrixToRpy(R).astype(np.float32).tolist())))
            end.set("xyz", " ".join(str(float(np.float32(word))) for word in end.get("xyz").split()))
    return etree.tostring(root)


def mobility(found: eurdf.convert.Import) -> int | None:
    return eurdf.analyze(build_robot(found.mechanism, geometry=False)).mobility


@pytest.mark.parametrize(
    ("name", "axis"), [("four_bar", 0), ("doggo_leg", 1), ("screw_press", 2), ("toddlerbot_2legs", 2)]
)
def test_loop_joint_without_axis_has_the_one_that_moves(name: str, axis: int, tmp_path: Path) -> None:
    text = eurdf.export(name, "loop-joint", closures="hinge").main
    found = imported(tmp_path, turned_loops(text, axis).decode())
    hinges = [closure for closure in found.mechanism.closures if isinstance(closure, HingeClosure)]
    assert hinges
    assert {closure.axes for closure in hinges} == {(tuple(np.eye(3)[axis]),) * 2}
    losses = {loss.name: loss.effect for loss in found.losses if loss.code == "import-loop-axis"}
    assert losses == dict.fromkeys((closure.name for closure in hinges), Effect.APPROXIMATE)
    assert mobility(found) == mobility(imported(tmp_path, text.decode()))


def test_loop_joint_with_several_possible_axes_is_refused(tmp_path: Path) -> None:
    text = eurdf.export("double_wishbone", "loop-joint").main
    with pytest.raises(
        eurdf.errors.CannotImport, match=r"robot\.urdf:\d+: the loop joint 'upper_bush' .* add the axis"
    ):
        imported(tmp_path, turned_loops(text, 0).decode())


@pytest.mark.parametrize(
    ("place", "slides", "why"), [("0 0 1", True, "exactly one axis"), ("9 0 0", False, "no configuration was found")]
)
def test_loop_joint_that_shows_no_axis_is_refused(place: str, slides: bool, why: str, tmp_path: Path) -> None:
    ends = f'<link1 link="top" xyz="1 0 0"/><link2 link="right" xyz="{place}"/>'
    text = robot(loop_joint(ends, 'type="revolute"'))
    if slides:
        text = text.replace("continuous", "prismatic")
        text = text.replace(TURN, f'{TURN}<limit lower="-1" upper="1" effort="1" velocity="1"/>')
    with pytest.raises(eurdf.errors.CannotImport, match=why):
        imported(tmp_path, text)


def test_other_elements_and_loops_are_losses(tmp_path: Path) -> None:
    loop = loop_joint(ENDS, 'type="prismatic"')
    found = imported(tmp_path, robot(loop + "<gazebo/><sensor name='s'/>"))
    assert found.mechanism.closures == ()
    assert [(loss.code, loss.name) for loss in found.losses] == [
        ("import-element", "gazebo"),
        ("import-element", "sensor"),
        ("import-loop", "l"),
    ]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (loop_joint('<link1 link="top"/>'), "has 1 elements <link1> and <link2>; it must have two"),
        (loop_joint(ENDS.replace("top", "tpo")), "the link 'tpo', which does not exist; did you mean 'top'?"),
        (loop_joint(ENDS.replace("/>", ' xyz="1 2"/>', 1)), "'xyz' of <link1> is '1 2'; it must be 3 finite numbers"),
        (loop_joint(ENDS.replace("/>", ' quat_xyzw="0 0 0 1"/>', 1)), "<link1> has 'quat_xyzw'; only links and joints"),
        (loop_joint(ENDS, ""), "<loop_joint> 'l' has no type; state spherical, fixed or revolute"),
        ('<loop name="l"><predecessor link="top"/></loop>', "<loop> 'l' has no <successor>"),
        ('<coupling name="g"><predecessor link="top"/><successor link="right"/></coupling>', "'g' has no <ratio>"),
        (
            '<coupling name="g"><predecessor link="top"/><successor link="top"/><ratio value="2"/></coupling>',
            "<coupling> 'g' relates fewer than two joints",
        ),
        ('<drake:joint name="d" type="cone"/>', "has the type 'cone'; Drake has ball, universal, screw, planar"),
        ("", "it is a URDF without loops of another dialect"),
    ],
)
def test_bad_element_is_refused_with_file_and_line(tmp_path: Path, content: str, message: str) -> None:
    text = robot(content, ' xmlns:drake="http://drake.mit.edu"')
    with pytest.raises(eurdf.errors.CannotImport) as refused:
        imported(tmp_path, text)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_attribute_of_a_later_version_is_a_loss(tmp_path: Path) -> None:
    turned = robot(loop_joint(ENDS)).replace('<origin xyz="0 0 1"/>', '<origin xyz="0 0 1" quat_xyzw="0 0 1 1"/>')
    (loss,) = imported(tmp_path, turned).losses
    assert (loss.code, loss.name) == ("import-later-version", "quat_xyzw")
    stated = imported(tmp_path, turned.replace('name="r"', 'name="r" version="1.1"'))
    assert not stated.losses
    assert stated.mechanism.joints[1].placement.quaternion[2] == pytest.approx(0.5**0.5)


def test_loop_of_urdf_plus_is_a_closure(tmp_path: Path) -> None:
    loop = (
        '<loop name="pin" type="revolute"><predecessor link="top"><origin xyz="1 0 0"/></predecessor>'
        '<successor link="right"><origin xyz="0 0 1"/></successor><axis xyz="0 1 0"/></loop>'
    )
    found = imported(tmp_path, robot(loop))
    assert found.format == "urdf-plus"
    (closure,) = found.mechanism.closures
    assert isinstance(closure, HingeClosure)
    assert (closure.a.pose.xyz, closure.b.pose.xyz, closure.axes[0]) == ((1, 0, 0), (0, 0, 1), (0, 1, 0))
    assert found.closes


def test_older_loop_of_urdf_plus_is_a_closure(tmp_path: Path) -> None:
    loop = (
        '<loop_constraint name="pin"><parent link="top"/><parent_origin xyz="1 0 0"/><child link="right"/>'
        '<child_origin xyz="0 0 1"/></loop_constraint>'
    )
    (closure,) = imported(tmp_path, robot(loop)).mechanism.closures
    assert isinstance(closure, PointClosure)
    assert (closure.a.pose.xyz, closure.b.pose.xyz) == ((1, 0, 0), (0, 0, 1))


def test_coupling_of_urdf_plus_sums_the_joints_of_both_chains(tmp_path: Path) -> None:
    coupling = '<coupling name="belt"><predecessor link="top"/><successor link="right"/><ratio value="6"/></coupling>'
    (found,) = imported(tmp_path, robot(coupling)).mechanism.couplings
    assert found == Coupling("belt", (("a", 6.0), ("b", 6.0), ("c", -1.0)))


DRAKE = ' xmlns:drake="http://drake.mit.edu"'


def ball(p: str, q: str) -> str:
    return (
        '<drake:ball_constraint><drake:ball_constraint_body_A name="top"/><drake:ball_constraint_body_B name="right"/>'
        f'<drake:ball_constraint_p_AP value="{p}"/><drake:ball_constraint_p_BQ value="{q}"/></drake:ball_constraint>'
    )


@pytest.mark.parametrize(
    ("balls", "expected"),
    [
        (ball("1 0 0", "0 0 1"), [PointClosure]),
        (ball("1 0 0", "0 0 1") + ball("1 0.5 0", "0 0.5 1"), [HingeClosure]),
        (ball("1 0 0", "0 0 1") + ball("1 0.5 0", "0 0.4 1"), [PointClosure, PointClosure]),
        (ball("1 0 0", "0 0 1") + ball("2 0 0", "1 0 1") + ball("1 2 0", "0 2 1"), [FrameClosure]),
        (ball("1 0 0", "0 0 1") + ball("2 0 0", "1 0 1") + ball("3 0 0", "2 0 1"), [HingeClosure]),
    ],
)
def test_ball_constraints_of_drake_are_one_closure(tmp_path: Path, balls: str, expected: list[type]) -> None:
    found = imported(tmp_path, robot(balls, DRAKE))
    assert found.format == "drake"
    assert [type(closure) for closure in found.mechanism.closures] == expected
    if len(expected) == 1:
        assert found.closes
        assert max(max(each.position, each.angle) for each in found.opened) < 1e-12
    assert found.mechanism.root == "floating"


def test_joints_of_drake_get_their_type(tmp_path: Path) -> None:
    names = ("one", "two", "three", "four")
    parts = "".join(link_element(name, inertial(1.0)) for name in names)
    content = {
        "ball": '<dynamics damping="0.3"/>',
        "universal": "",
        "screw": '<axis xyz="0 0 1"/><drake:screw_thread_pitch value="0.02"/>',
        "planar": '<axis xyz="0 0 1"/><dynamics damping="1 2 3"/>',
    }
    for name, (kind, more) in zip(names, content.items(), strict=True):
        ends = f'<parent link="base"/><child link="{name}"/>'
        parts += f'<drake:joint name="j_{name}" type="{kind}">{ends}{more}</drake:joint>'
    parts += link_element("five", inertial(1.0)) + link_element("six", inertial(1.0))
    limit = '<axis xyz="0 0 1"/><limit effort="5" drake:acceleration="7"/>'
    parts += joint_element("free", "revolute", "base", "five", limit)
    parts += joint_element("stuck", "revolute", "base", "six", '<axis xyz="0 0 1"/><limit lower="0" upper="0"/>')
    motor = (
        '<transmission><type>t</type><joint name="a"/><actuator name="m"><drake:gear_ratio value="10"/>'
        '<drake:rotor_inertia value="0.02"/></actuator></transmission>'
    )
    found = imported(tmp_path, robot(parts + motor, DRAKE))
    joints = {joint.name: joint for joint in found.mechanism.joints}
    assert [joints[f"j_{name}"].type for name in names] == ["spherical", "universal", "helical", "planar"]
    assert joints["j_one"].properties.damping == (0.3, 0.3, 0.3)
    assert joints["j_two"].axes == ((1, 0, 0), (0, 1, 0))
    assert joints["j_three"].pitch == 0.02
    assert joints["j_four"].properties.damping == (1.0, 2.0, 3.0)
    assert joints["free"].type is JointType.CONTINUOUS
    assert joints["free"].properties.effort == (5.0,)
    assert joints["stuck"].type is JointType.FIXED
    assert [loss.name for loss in found.losses if loss.code == "import-locked-joint"] == ["stuck"]
    assert joints["free"].properties.acceleration == joints["free"].properties.deceleration == (7.0,)
    np.testing.assert_allclose(joints["a"].properties.armature, (2.0,))
    assert found.mechanism.actuators == ("a",)
    assert found.mechanism.motors["a"].name == "m"


def test_tendon_of_drake_is_a_coupling(tmp_path: Path) -> None:
    def tendon(lower: float, upper: float) -> str:
        limits = (("lower_limit", lower), ("upper_limit", upper))
        bounds = "".join(f'<drake:tendon_constraint_{what} value="{value}"/>' for what, value in limits)
        return (
            '<drake:tendon_constraint><drake:tendon_constraint_joint name="a" a="2"/><drake:tendon_constraint_joint '
            f'name="c" a="-1"/><drake:tendon_constraint_offset value="0.3"/>{bounds}</drake:tendon_constraint>'
        )

    (coupling,) = imported(tmp_path, robot(tendon(0.5, 0.5), DRAKE)).mechanism.couplings
    assert coupling.coefficients == (("a", 2.0), ("c", -1.0))
    np.testing.assert_allclose(coupling.offset, 0.2)
    found = imported(tmp_path, robot(tendon(-1.0, 1.0), DRAKE))
    assert found.mechanism.couplings == ()
    assert codes(found) == {"import-tendon"}


def test_robot_on_the_world_of_drake_is_fixed(tmp_path: Path) -> None:
    world = '<link name="world"/>' + joint_element("to_world", "fixed", "world", "base", "")
    found = imported(tmp_path, robot(world + ball("1 0 0", "0 0 1"), DRAKE))
    assert (found.mechanism.root, found.mechanism.bodies[0].name) == ("fixed", "base")


def test_assembled_has_joints_outside_loops_within_their_limits(tmp_path: Path) -> None:
    loop = '<loop_joint name="loop" type="spherical"><link1 link="top" xyz="1 0 0"/><link2 link="right" xyz="0 0 1"/>'
    limit = '<limit lower="0.5" upper="1" effort="1" velocity="1"/>'
    lid = link_element("lid", inertial(1.0)) + joint_element("hinge", "revolute", "base", "lid", TURN + limit)
    found = imported(tmp_path, robot(f"{loop}</loop_joint>{lid}"))
    assert found.mechanism.configurations["assembled"]["hinge"] == (0.5,)
    found.write(tmp_path / "out")
    assert eurdf.check(tmp_path / "out").ok
