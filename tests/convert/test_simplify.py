"""`eurdf.simplify`: robots of the collection and their twins, files, losses, refusals."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.collection import collection_names
from eurdf.errors import CannotSimplify
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot
from eurdf.writing.rewriting import Rewriting
from eurdf.writing.simplification import simplified
from support.described import body, load, revolute, written
from support.plain_urdf import joint_element, link_element, robot

#: Three concurrent axes before a rod with mass; the last link is held by a 6d closure.
BALL = "\n".join(
    joint_element(name, "continuous", parent, child, f'<axis xyz="{axis}"/>', origin)
    for name, parent, child, axis, origin in (
        ("rx", "arm", "rx_link", "1 0 0", '<origin xyz="0 0 0.3"/>'),
        ("ry", "rx_link", "ry_link", "0 1 0", ""),
        ("rz", "ry_link", "rod", "0 0 1", ""),
    )
)
LINKS = "".join(map(body, ("base", "arm", "rod", "other"))) + "".join(map(link_element, ("rx_link", "ry_link")))
TREE = robot(LINKS + revolute("drive", "base", "arm", (0, 1, 0)) + BALL + revolute("turn", "base", "other", (0, 1, 0)))
HELD = """\
# A rod.
closures:
  - {name: end, type: 6d, frames: [{link: rod, xyz: [0.4, 0, 0]}, {link: other, xyz: [0.4, 0, 0.3]}]}
actuators: [drive]
configurations:
  assembled: {}
"""


def assert_same(found: eurdf.convert.Simplification) -> None:
    assert found.motion is not None
    assert found.motion.pose < 1e-10
    assert found.motion.acceleration is not None
    assert found.motion.acceleration < 1e-6


@pytest.mark.parametrize(
    ("name", "twin"), [("digit_leg", "digit_leg_3d"), ("five_bar_6d", "five_bar_3d"), ("stewart_platform", None)]
)
def test_robot_gets_the_size_of_its_twin(name: str, twin: str | None) -> None:
    found = eurdf.simplify(name)
    assert_same(found)
    small = build_robot(found.mechanism, geometry=False)
    before, after = eurdf.analyze(name), eurdf.analyze(small)
    assert (after.nv, after.nc) == (found.after.nv, found.after.nc)
    assert after.mobility == before.mobility
    assert after.uncontrolled == before.uncontrolled
    if twin is not None:
        assert (after.nv, after.nc) == (eurdf.analyze(twin).nv, eurdf.analyze(twin).nc)
    assert not eurdf.simplify(small).changes


@pytest.mark.parametrize("expand", [False, True])
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in ("delta", "screw_press", "talos_leg") else pytest.mark.slow)
        for name in collection_names()
    ],
)
def test_robots_are_rewritten_or_stay(name: str, expand: bool) -> None:
    found = eurdf.simplify(name, expand=expand)
    if found.changes:
        assert_same(found)
    else:
        assert found.before == found.after
        assert not found.files


def test_foot_is_where_it_was(tmp_path: Path) -> None:
    eurdf.simplify("digit_leg").write(tmp_path)
    robots = [eurdf.load(path, geometry=False) for path in ("digit_leg", tmp_path)]
    assert robots[0].actuation.joints == robots[1].actuation.joints
    values = np.random.default_rng(0).uniform(-0.2, 0.2, 6)
    feet = []
    for each in robots:
        data = each.model.createData()
        pin.framesForwardKinematics(each.model, data, eurdf.forward_kinematics(each, values))
        feet.append(data.oMf[each.model.getFrameId("foot")].homogeneous)
    np.testing.assert_allclose(*feet, atol=1e-8)


def test_three_axes_and_a_weld_become_a_point(tmp_path: Path) -> None:
    before = load(TREE, HELD)
    found = eurdf.simplify(before)
    assert_same(found)
    assert (found.before.nv - found.after.nv, found.before.nc - found.after.nc) == (3, 3)
    assert [joint.type for joint in found.mechanism.joints if joint.name in ("rx", "ry", "rz")] == ["fixed"] * 3
    only = eurdf.simplify(before, only="joints")
    assert_same(only)
    assert only.after == only.before
    assert only.mechanism.configurations["assembled"] == {}
    found.write(tmp_path / "small")
    back = eurdf.simplify(tmp_path / "small", expand=True)
    assert_same(back)
    assert back.after == found.before


def test_configurations_keep_their_poses() -> None:
    bent = "  bent: {rx: 0.4, ry: -0.5, rz: 1.2, drive: 0.1}\n"
    found = eurdf.simplify(load(TREE, HELD + bent), only="joints")
    quaternion = found.mechanism.configurations["bent"]["rz"]
    turns = [pin.AngleAxis(angle, axis).matrix() for angle, axis in zip((0.4, -0.5, 1.2), np.eye(3), strict=True)]
    np.testing.assert_allclose(
        pin.Quaternion(*np.roll(quaternion, 1)).matrix(), turns[0] @ turns[1] @ turns[2], atol=1e-12
    )
    lost = eurdf.simplify(load(TREE, HELD + bent)).lost
    assert any("open loops" in each and "'bent'" in each for each in lost)


def test_losses_are_reported(tmp_path: Path) -> None:
    path = written(tmp_path, TREE.replace("</robot>", "<!-- x --><gazebo/></robot>"), HELD)
    assert eurdf.simplify(path).lost == (
        "elements of the URDF that no description has are left out: 'gazebo'",
        "comments are left out",
    )


def test_motor_among_three_axes_keeps_them() -> None:
    found = eurdf.simplify(load(TREE, HELD.replace("[drive]", "[drive, ry]")))
    assert not found.changes
    assert found.kept == ("joints 'rx', 'ry', 'rz' stay, whose axes meet in one point: 'ry' is actuated",)


def test_loops_that_do_not_close_are_refused(tmp_path: Path) -> None:
    far = HELD.replace("xyz: [0.4, 0, 0.3]", "xyz: [0, 9, 0]").replace("  assembled: {}\n", "  other: {}\n")
    with pytest.raises(CannotSimplify, match="motion cannot be compared: no closed configuration"):
        eurdf.simplify(written(tmp_path, TREE, far))
    with pytest.raises(ValueError, match="only is 'all'"):
        eurdf.simplify("delta", only="all")  # type: ignore[arg-type]


def test_another_motion_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def with_a_slip(mechanism: eurdf.Mechanism, only: str | None) -> Rewriting:
        right = simplified(mechanism)
        (closure,) = right.mechanism.closures
        x, y, z = closure.a.pose.xyz
        slipped = replace(closure, a=replace(closure.a, pose=Pose((x, y, z + 1e-6)), frame=""))
        return replace(right, mechanism=replace(right.mechanism, closures=(slipped,)))

    monkeypatch.setattr("eurdf.convert.simplify.simplified", with_a_slip)
    with pytest.raises(CannotSimplify, match=r"'talos_leg', whose motion would change: poses differ by .*e-0. m"):
        eurdf.simplify("talos_leg")


def test_accelerations_without_inertia_are_not_compared() -> None:
    light = TREE.replace('<mass value="0.7"/>', '<mass value="0"/>')
    found = eurdf.simplify(load(re.sub(r'(i[xyz]{2})="[^"]*"', r'\1="0"', light), HELD), only="joints")
    assert found.motion is not None
    assert (found.motion.acceleration, found.motion.times) == (None, None)
    assert "accelerations are not compared" in str(found.motion)


def test_meshes_are_copied(tmp_path: Path) -> None:
    shape = '<visual><geometry><mesh filename="part.stl"/></geometry></visual>'
    (tmp_path / "part.stl").write_bytes(b"solid part\nendsolid part\n")
    path = written(tmp_path, TREE.replace("</link>", f"{shape}</link>", 1), HELD)
    found = eurdf.simplify(path)
    assert found.files["meshes/part.stl"] == (tmp_path / "part.stl").read_bytes()
    assert b'filename="meshes/part.stl"' in found.files["robot.urdf"]
    (tmp_path / "part.stl").unlink()
    assert any("keep their names: 'part.stl'" in each for each in eurdf.simplify(path).lost)
