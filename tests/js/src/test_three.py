"""Robots of urdf-loader with closed loops, in a browser: their objects are where the reference has their links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from support.browser import browser, errors_of
from support.every_joint import CONFIGURATION, write_every_joint
from support.javascript_package import IMPORTS, served_package
from support.places import ROOT
from support.plain_urdf import joint_element, link_element
from support.plain_urdf import robot as robot_text
from support.stl import TETRAHEDRON

PAGE = (
    f'<!doctype html><link rel="icon" href="data:,">{IMPORTS}'
    """<script type="module">
  import URDFLoader from "urdf-loader";
  import * as three from "extended-urdf/three";
  window.load = async (url, options = {}) => {
    window.robot = await three.loadExtendedURDF(url, { loader: new URDFLoader(), ...options });
    return state();
  };
  window.state = () => {
    robot.updateMatrixWorld(true);
    const poses = Object.entries(robot.links).map(([name, link]) => [name, link.matrixWorld.toArray()]);
    const ends = robot.closures.map(({ frames }) => frames.map((each) => each.matrixWorld.toArray().slice(12, 15)));
    return { q: robot.q, poses: Object.fromEntries(poses), ends, stop: robot.stop };
  };
</script>"""
)


WITH_MESH = robot_text(
    link_element("base"),
    link_element("part", '<visual><geometry><mesh filename="part.stl"/></geometry></visual>'),
    joint_element("turn", "revolute", "base", "part", '<limit lower="-1" upper="2" effort="3" velocity="4"/>', ""),
)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    folder = tmp_path_factory.mktemp("checkout")
    with browser() as chromium, served_package(folder) as address:
        write_every_joint(folder)
        (folder / "meshes").mkdir()
        (folder / "meshes" / "part.stl").write_bytes(TETRAHEDRON)
        (folder / "meshes" / "robot.urdf").write_text(WITH_MESH, encoding="utf-8")
        (folder / "index.html").write_text(PAGE, encoding="utf-8")
        opened = chromium.new_page()
        errors = errors_of(opened)
        opened.goto(address)
        opened.wait_for_function("() => Boolean(window.load)")
        yield opened
        assert errors == []


def act(page: Any, action: str, *arguments: Any) -> Any:
    """What a function of JavaScript gives for some arguments."""
    return page.evaluate(f"given => ({action})(...given)", list(arguments))


def assert_placed(robot: eurdf.Robot, state: Mapping[str, Any]) -> None:
    """The objects are where the reference has the links, relative to the root link, and loops are closed."""
    q = robot.configuration({name: own for name, own in state["q"].items() if own})
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    of = {frame.name: data.oMf[index] for index, frame in enumerate(robot.model.frames) if frame.type == pin.BODY}
    base = of[robot.mechanism.bodies[0].name]
    assert of.keys() - {"universe"} <= state["poses"].keys()
    for name in of.keys() - {"universe"}:
        found = np.reshape(state["poses"][name], (4, 4)).T
        np.testing.assert_allclose(found, (base.inverse() * of[name]).homogeneous, atol=1e-9, err_msg=name)
    if np.abs(eurdf.residual(robot, q)).max(initial=0.0) > 1e-9:
        return
    kinds = [closure.type for closure in robot.mechanism.closures]
    for kind, (a, b) in zip(kinds, state["ends"], strict=True):
        assert kind == "distance" or np.linalg.norm(np.subtract(a, b)) < 1e-9


@pytest.mark.parametrize("name", ["digit_leg", "delta", "screw_press"])
def test_loops_stay_closed_while_motors_move(page: Any, name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    assert_placed(robot, act(page, "load", f"/robots/{name}/robot.yaml"))
    for joint in list(robot.mechanism.actuators)[:4]:
        more = "name => [robot.setJointValue(name, robot.joints[name].jointValue[0] + 0.05), state()]"
        moved, state = act(page, more, joint)
        assert moved
        assert_placed(robot, state)
        assert np.abs(eurdf.residual(robot, robot.configuration(state["q"]))).max() < 1e-9


def test_joints_of_each_type_take_their_coordinates(page: Any, tmp_path: Path) -> None:
    robot = eurdf.load(write_every_joint(tmp_path)[0], geometry=False)
    act(page, "load", "/robot.yaml")
    act(page, "q => { robot.q = q; }", {})  # the loops are open here: joints move alone
    for joint, values in CONFIGURATION.items():
        if joint != "root_joint":
            assert act(page, "(joint, values) => robot.setJointValue(joint, ...values)", joint, values), joint
    state = act(page, "state")
    assert_placed(robot, state)
    for joint, values in CONFIGURATION.items():
        if joint != "root_joint":
            found = np.array(state["q"][joint])
            assert min(np.abs(found - values).max(), np.abs(found + values).max()) < 1e-9, joint
    assert not act(page, "() => robot.setJointValue('follower', 1) || robot.setJointValue('m1', 1)")
    assert act(page, "() => robot.joints.follower.jointValue") == [pytest.approx(-0.5 * 0.4 + 0.2)]
    act(page, "() => robot.setJointValue('plane', null, 0.5, null)")
    assert act(page, "() => robot.q.plane") == [0.2, 0.5, pytest.approx(0.7)]
    with pytest.raises(Exception, match="joint 'cardan', which is universal, has 2 coordinates; it is given 1"):
        act(page, "() => robot.setJointValue('cardan', 0.1)")


def test_meshes_beside_the_urdf_are_loaded(page: Any) -> None:
    act(page, "load", "/meshes/robot.urdf")
    mesh = """async () => {
      while (!robot.links.part.getObjectByProperty("isMesh", true)) await new Promise(requestAnimationFrame);
      return robot.links.part.getObjectByProperty("isMesh", true).geometry.attributes.position.count;
    }"""
    assert act(page, mesh) == 12  # corners of the faces of a tetrahedron
    assert act(page, "() => Object.values(robot.joints.turn.limit)") == [-1, 2, 3, 4]


def test_crank_turns_more_than_once(page: Any) -> None:
    act(page, "load", "/robots/four_bar/robot.yaml")
    robot = eurdf.load("four_bar", geometry=False)
    (crank,) = robot.mechanism.actuators
    for angle in np.linspace(0.0, 8.0, 20)[1:]:
        state = act(
            page, "(joint, angle) => { robot.setJointValue(joint, angle); return state(); }", crank, float(angle)
        )
        assert (state["q"][crank], state["stop"]) == ([pytest.approx(angle)], None)
    assert_placed(robot, state)


def test_limit_stops_a_motor(page: Any) -> None:
    act(page, "load", "/robots/digit_leg/robot.yaml")
    state = act(page, "() => { robot.setJointValue('motor_knee', 9); return state(); }")
    assert state["stop"]["reason"] in ("limit", "passive limit", "dead point")
    assert_placed(eurdf.load("digit_leg", geometry=False), state)


def test_robot_of_version_1_has_the_halves_of_its_joints(page: Any) -> None:
    url = "/robots/delta/robot.v1.yaml"
    state = act(page, "load", url)
    robot = eurdf.load(ROOT / url[1:], geometry=False)
    halves = {name for name in robot.slots if name.endswith("_X")}
    assert halves
    assert halves <= set(act(page, "() => Object.keys(robot.joints)"))
    assert_placed(robot, state)


def test_invalid_robot_rejects_with_its_diagnostics(page: Any) -> None:
    reject = "(...given) => load(...given).catch(({ name, message, diagnostics }) => ({ name, message, diagnostics }))"
    found = act(page, reject, "/robots/digit_leg/robot.urdf", {"description": "/robots/four_bar/robot.yaml"})
    assert found["name"] == "InvalidRobot"
    assert {"unknown-frame", "unknown-joint"} & {each["code"] for each in found["diagnostics"]}
    first = found["diagnostics"][0]
    assert f"robot.yaml:{first['line']}:{first['column']}: {first['message']}" in found["message"]
    assert act(page, reject, "/robots/digit_leg/robot.urdf", {})["q"]  # without a description, it has no loops
