"""The example of a page: its sliders move the robot with its loops closed, to where the reference has it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin

import eurdf
from support.browser import browser, errors_of
from support.javascript_package import served_package

_STATE = """() => {
  robot.updateMatrixWorld(true);
  const within = (link) => robot.matrixWorld.clone().invert().multiply(link.matrixWorld).toArray();
  return [robot.q, Object.entries(robot.links).map(([name, link]) => [name, within(link)])];
}"""


def test_sliders_move_the_robot_with_its_loops_closed(tmp_path: Path) -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    with browser() as chromium, served_package(tmp_path) as address:
        page = chromium.new_page()
        errors = errors_of(page)
        page.goto(f"{address}/examples/web/")
        page.wait_for_function("() => Boolean(window.robot)")
        sliders = page.get_by_role("slider")
        assert sliders.count() == len(robot.mechanism.actuators)
        for index in range(sliders.count()):
            sliders.nth(index).focus()
            page.keyboard.press("PageUp")  # a tenth of the range
        own, poses = page.evaluate(_STATE)
        assert [error for error in errors if "favicon" not in error and "404" not in error] == []
        assert len(set(page.locator("canvas").screenshot())) > 1
    q = robot.configuration(own)
    assert np.abs(eurdf.residual(robot, q)).max() < 1e-9
    assert np.abs(q - eurdf.assemble(robot).q).max() > 0.01
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    for name, matrix in poses:
        expected = data.oMf[robot.model.getFrameId(name, pin.BODY)].homogeneous
        np.testing.assert_allclose(np.reshape(matrix, (4, 4)).T, expected, atol=1e-9)
