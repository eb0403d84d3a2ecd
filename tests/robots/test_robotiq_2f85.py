"""The gripper against an import of the joints of its source."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import eurdf


def finger(side: str, turn: str) -> str:
    """The joints of a finger, as robotiq_2f85/2f85.xml of MuJoCo Menagerie ec98278 has them."""
    y = 0.0306011 if side == "right" else -0.0306011
    z = 0.0132 if side == "right" else -0.0132
    mass = '<inertial mass="0.01" pos="0 0 0" diaginertia="1e-6 1e-6 1e-6"/>'
    return f"""
      <body name="{side}_driver" pos="0 {y} 0.054904" {turn}>{mass}
        <joint name="{side}_driver_joint" axis="1 0 0" range="0 0.8"/>
        <body name="{side}_coupler" pos="0 0.0315 -0.0041">{mass}
          <joint name="{side}_coupler_joint" axis="1 0 0" range="-1.57 0"/>
        </body>
      </body>
      <body name="{side}_spring_link" pos="0 {z} 0.0609" {turn}>{mass}
        <joint name="{side}_spring_link_joint" axis="1 0 0" range="-0.297 0.8"/>
        <body name="{side}_follower" pos="0 0.055 0.0375">{mass}
          <joint name="{side}_follower_joint" axis="1 0 0" pos="0 -0.018 0.0065" range="-0.872664 0.872664"/>
          <body name="{side}_pad" pos="0 -0.0189 0.01352">{mass}</body>
        </body>
      </body>"""


SOURCE = f"""
<mujoco model="source">
  <compiler angle="radian" autolimits="true"/>
  <worldbody>
    <body name="base">{finger("right", "")}{finger("left", 'quat="0 0 0 1"')}</body>
  </worldbody>
  <equality>
    <connect anchor="0 0 0" body1="right_follower" body2="right_coupler"/>
    <connect anchor="0 0 0" body1="left_follower" body2="left_coupler"/>
    <joint joint1="right_driver_joint" joint2="left_driver_joint" polycoef="0 1 0 0 0"/>
  </equality>
  <actuator><motor joint="left_driver_joint"/></actuator>
</mujoco>"""


@pytest.mark.slow
def test_pads_move_as_in_the_source(tmp_path: Path) -> None:
    (tmp_path / "source.xml").write_text(SOURCE)
    theirs = eurdf.import_robot(tmp_path / "source.xml").write(tmp_path / "there")
    source, ours = eurdf.load(Path(theirs[0]).parent), eurdf.load("robotiq_2f85")
    assert eurdf.analyze(source).mobility == eurdf.analyze(ours).mobility == 3
    half_turn = pin.SE3(pin.utils.rotate("z", np.pi), np.zeros(3))  # the drawing sees the base from the other side
    for name in ("assembled", "closed", "enveloping"):
        q = ours.configurations[name]
        values = {joint: angle for joint, angle in ours.joint_positions(q).items() if joint != "motor"}
        there = source.configuration(values)
        assert np.abs(eurdf.residual(source, there)).max() < 1e-9
        pin.framesForwardKinematics(source.model, source.data, there)
        pin.framesForwardKinematics(ours.model, ours.data, q)
        for side in ("left", "right"):
            pad = half_turn * source.data.oMf[source.model.getFrameId(f"{side}_pad")]
            expected = pad.act(np.array([0.0, -0.0066, 0.01875]))
            found = ours.data.oMf[ours.model.getFrameId(f"{side}_pad")].translation
            np.testing.assert_allclose(found, expected, atol=1e-9)
