"""Saving a pose to the files of a robot that is shown."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eurdf
from eurdf.viewing.files import RobotOnDisk
from eurdf.writing.saved_configuration import CannotSave, ConfigurationExists
from support.places import ROBOTS


def test_pose_is_saved_to_the_description_and_comments_stay(tmp_path: Path) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        (tmp_path / name).write_text((ROBOTS / "four_bar" / name).read_text())
    files = RobotOnDisk(tmp_path, {"root": "floating"})
    shown = files.load()
    assert files.can_save
    bent = eurdf.forward_kinematics(shown, {"motor_crank": 0.4})
    assert files.save("bent knee", shown, bent) == f"saved configuration 'bent knee' to '{tmp_path / 'robot.yaml'}'"
    text_ = (tmp_path / "robot.yaml").read_text()
    assert "# Written by build.py" in text_
    robot = eurdf.load(tmp_path, strict=True)
    assert robot.joint_positions(robot.configurations["bent knee"])["motor_crank"] == pytest.approx((0.4,))
    assert np.abs(eurdf.residual(robot, robot.configurations["bent knee"])).max() < 1e-12
    assert not files.has_changed
    assert files.save("bent knee", shown, bent).endswith("already has this configuration")
    assert (tmp_path / "robot.yaml").read_text() == text_
    first = shown.configurations["assembled"]
    with pytest.raises(ConfigurationExists, match="already has a different configuration 'bent knee'"):
        files.save("bent knee", shown, first)
    (tmp_path / "robot.yaml").write_text(text_ + "# by hand\n")
    files.save("another", shown, first)
    assert files.has_changed  # by hand, which is still to be shown
    with pytest.raises(CannotSave, match="the loops are open"):
        files.save("open", shown, shown.tree.integrate(first, np.full(shown.tree.nv, 0.3)))


def test_pose_beyond_limits_is_saved_only_after_assembling(tmp_path: Path) -> None:
    lid = (
        '<link name="lid"/><joint name="hinge" type="revolute"><parent link="ground"/><child link="lid"/>'
        '<axis xyz="0 0 1"/><limit lower="0.5" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    urdf, yaml = ((ROBOTS / "four_bar" / name).read_text() for name in ("robot.urdf", "robot.yaml"))
    (tmp_path / "robot.urdf").write_text(urdf.replace("</robot>", lid))
    (tmp_path / "robot.yaml").write_text(yaml.replace("assembled: {}", "assembled: {hinge: 0.5}"))
    files = RobotOnDisk(tmp_path, {})
    shown = files.load()
    with pytest.raises(CannotSave, match=r"leaves out joints.*'hinge' \(limits 0.5 to 1 rad\)"):
        files.save("low", shown, shown.tree.neutral())
    files.save("low", shown, eurdf.assemble(shown, {"hinge": 0.5}).q)
    assert dict(eurdf.load(tmp_path).mechanism.configurations["low"]) == {"hinge": (0.5,)}


NOT_SAVED = ["four_bar", ROBOTS / "four_bar/robot.v1.yaml", ROBOTS / "four_bar/robot.urdf"]


@pytest.mark.parametrize("robot", [*NOT_SAVED, (ROBOTS / "four_bar/robot.urdf").read_text()], ids=range(4))
def test_pose_is_not_saved_where_it_cannot_be(robot: str | Path) -> None:
    files = RobotOnDisk(robot, {})
    files.load()
    assert not files.can_save
    assert not files.has_changed
