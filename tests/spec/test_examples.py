"""The examples run and are right, and so are code and signs on the page about the published toolbox."""

from __future__ import annotations

import importlib.util
import re
import runpy
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from examples import (
    export_digit_2legs,
    follow_foot_trajectory,
    mujoco_and_pinocchio,
    simulate_digit_leg,
    squat_torques,
    stand,
)
from support.places import ROOT

pytestmark = pytest.mark.slow

EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
#: The rows of the README.
LISTED = dict(re.findall(r"^\| `(\w+\.py)`(.*)", (ROOT / "examples" / "README.md").read_text(encoding="utf-8"), re.M))
NEEDED = {
    "squat_torques": ("matplotlib",),
    "reach_with_pink": ("pink", "daqp"),
    "squat_with_crocoddyl": ("crocoddyl",),
}
PAGE = (ROOT / "docs" / "toolbox.md").read_text(encoding="utf-8")

needs_matplotlib = pytest.mark.skipif(
    importlib.util.find_spec("matplotlib") is None, reason="matplotlib is not installed: pip install -e '.[examples]'"
)


@pytest.fixture(autouse=True)
def silent(request: pytest.FixtureRequest, capsys: pytest.CaptureFixture[str]) -> Iterator[None]:
    """Nothing is printed, except by what is run as a script."""
    yield
    if "script" not in request.node.name:
        printed = capsys.readouterr()
        assert (printed.out, printed.err) == ("", "")


@pytest.fixture(scope="module")
def held() -> simulate_digit_leg.Held:
    return simulate_digit_leg.main()


@pytest.fixture(scope="module")
def squat() -> squat_torques.Squat:
    return squat_torques.squat()


def bent_leg() -> tuple[Any, Any]:
    """A leg and a closed configuration that is not one of its named ones."""
    robot = eurdf.load("digit_leg", geometry=False)
    return robot, eurdf.forward_kinematics(robot, np.array([0.1, -0.1, 0.2, -0.3, 0.1, 0.05]))


def test_simulated_leg_stays_closed_and_is_held(held: simulate_digit_leg.Held) -> None:
    assert held.motion.t[-1] == pytest.approx(1.0)
    assert held.opening < 1e-10
    assert 0.0 < np.degrees(held.sag).max() < 1.0


def test_simulated_leg_falls_until_carried(held: simulate_digit_leg.Held) -> None:
    assert held.energy[-1] < held.energy[0]
    assert np.abs(held.motion.v[-1]).max() < 1e-2


def test_foot_follows_ellipse_within_limits(tmp_path: Path) -> None:
    followed = follow_foot_trajectory.main(tmp_path)
    robot, model = followed.robot, followed.robot.model
    for q, wanted in zip(followed.q, followed.wanted, strict=True):
        pin.forwardKinematics(model, robot.data, q)
        foot = pin.updateFramePlacement(model, robot.data, model.getFrameId("foot"))
        np.testing.assert_allclose(foot.translation, wanted, rtol=0.0, atol=1e-6)
        np.testing.assert_allclose(foot.rotation, np.eye(3), rtol=0.0, atol=1e-6)
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-9
    assert (followed.q >= model.lowerPositionLimit - 1e-9).all()
    assert (followed.q <= model.upperPositionLimit + 1e-9).all()
    steps = [pin.difference(model, *pair) for pair in zip(followed.q, followed.q[1:], strict=False)]
    assert np.abs(steps).max() < np.radians(3.0)
    np.testing.assert_allclose(np.ptp(followed.wanted, axis=0), [0.3, 0.0, 0.16], atol=1e-3)

    path = tmp_path / "foot_trajectory.csv"
    assert path.read_text().splitlines()[0] == ",".join(["t", *robot.actuation.joints])
    np.testing.assert_allclose(
        np.loadtxt(path, delimiter=",", skiprows=1)[:, 1:], followed.q[:, robot.actuation.idx_q], rtol=0.0, atol=1e-8
    )


@pytest.mark.parametrize("k", [0, 37, 100])
def test_ground_balances_leg_and_half_torso(squat: squat_torques.Squat, k: int) -> None:
    """By the momentum of the leg about its centre of mass, and the weights."""
    model = squat.robot.model
    data = model.createData()
    pin.computeCentroidalMomentumTimeVariation(model, data, squat.q[k], squat.v[k], squat.a[k])
    foot = pin.updateFramePlacement(model, data, model.getFrameId("foot")).translation
    torso, *leg = model.inertias
    heavy = np.array([0.0, 0.0, 9.81 + squat.upwards[k]])
    for_leg = data.dhg.linear + sum(inertia.mass for inertia in leg) * heavy
    for_torso = torso.mass / 2.0 * heavy
    moment = data.dhg.angular + np.cross(data.com[0] - foot, for_leg) + np.cross(torso.lever - foot, for_torso)
    expected = [*(for_leg + for_torso)[[0, 2]], moment[1]]
    np.testing.assert_allclose(squat.ground[k, [0, 2, 4]], expected, rtol=0.0, atol=1e-3)


@pytest.mark.parametrize("k", [0, 37, 100])
def test_squat_torques_do_virtual_work(squat: squat_torques.Squat, k: int) -> None:
    """No closure does any: for each motor, u = Dᵀ (M a + h) less what the ground does as the foot moves with it."""
    robot, q = squat.robot, squat.q[k]
    robot.model.gravity.linear = np.array([0.0, 0.0, -9.81 - squat.upwards[k]])
    tau = pin.rnea(robot.model, robot.model.createData(), q, squat.v[k], squat.a[k])
    J = eurdf.actuated_jacobian(robot, "foot", q, reference=pin.LOCAL_WORLD_ALIGNED)
    expected = eurdf.kinematics.dq_dq_actuated(robot, q).T @ tau - J.T @ squat.ground[k]
    np.testing.assert_allclose(squat.u[k], expected, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("name", stand.ROBOTS)
def test_robots_squat_on_both_feet(name: str) -> None:
    robot, moments, compared = stand.main(name)
    assert compared.momentum < 1e-5
    assert compared.pinocchio < 1e-5
    assert compared.mujoco < 1e-5
    grounds = [ground for moment in moments for ground in moment.ground.values()]
    assert min(ground.friction for ground in grounds) > 0.0
    assert min(ground.pressure for ground in grounds) > 0.0
    # The torso ends as it starts, so on average the ground carries the weight.
    weight = 9.81 * sum(inertia.mass for inertia in robot.model.inertias)
    assert sum(ground.wrench[2] for ground in grounds) / len(moments) == pytest.approx(weight, rel=2e-3)


def test_examples_readme_lists_all() -> None:
    assert sorted(LISTED) == [path.name for path in EXAMPLES]


def test_code_on_page_gives_the_twist() -> None:
    robot, q = bent_leg()
    twist = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.1])
    found = re.search(r"^```python\n(.*?)^```", PAGE, re.M | re.S)
    assert found
    names = {"eurdf": eurdf, "np": np, "robot": robot, "q": q, "twist": twist}
    exec(found[1], names)
    J = pin.computeFrameJacobian(robot.model, robot.data, q, robot.model.getFrameId("foot"), pin.LOCAL)
    np.testing.assert_allclose(J @ names["v"], twist, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(eurdf.residual_and_jacobian(robot, q)[1] @ names["v"], 0.0, atol=1e-9)


def their_jacobian(robot: Any, q: Any) -> Any:
    model, data = robot.model, robot.data
    pin.computeJointJacobians(model, data, q)
    rows = []
    for constraint in robot.constraint_models:
        constraint_data = constraint.createData()
        constraint.calc(model, data, constraint_data)
        rows.append(pin.getConstraintJacobian(model, data, constraint, constraint_data))
    return np.vstack(rows)


def test_signs_on_page_are_right() -> None:
    robot, q = bent_leg()
    model, S, J = robot.model, robot.actuation.selection, their_jacobian(robot, q)
    np.testing.assert_allclose(eurdf.residual_and_jacobian(robot, q)[1], -J, rtol=0.0, atol=1e-9)
    v = eurdf.project_velocity(robot, q, np.linspace(-1.0, 1.0, model.nv))
    a = eurdf.kinematics.achievable_acceleration(
        robot, q, v, eurdf.project_acceleration(robot, q, v, np.ones(model.nv))
    )
    x = np.linalg.lstsq(np.hstack([S, J.T]), pin.rnea(model, robot.data, q, v, a), rcond=None)[0]
    ours = eurdf.inverse_dynamics(robot, q, v, a)
    np.testing.assert_allclose(ours.u, x[:6], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(np.concatenate(ours.forces), -x[6:], rtol=0.0, atol=1e-6)


def test_exported_legs_land_with_their_loops_closed(tmp_path: Path) -> None:
    found = export_digit_2legs.main(tmp_path)
    assert found.actuators == 12
    assert found.opening < 1e-3
    assert found.height > 0.9


def test_mujoco_and_pinocchio_see_the_same_robot() -> None:
    assert max(mujoco_and_pinocchio.main()) < 1e-9


@needs_matplotlib
def test_picture_of_squat_is_written(tmp_path: Path, squat: squat_torques.Squat) -> None:
    figure = squat_torques.new_figure()
    squat_torques.draw(squat, figure)
    path = tmp_path / "squat_torques.png"
    figure.savefig(path, dpi=100)
    header = path.read_bytes()[:24]
    assert header[:8] == b"\x89PNG\r\n\x1a\n"
    assert (int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")) == (800, 900)
    _, angles, torques = figure.axes[:3]
    assert len(angles.lines) == len(torques.lines) == len(squat.robot.actuation.joints) + 1
    assert "[°]" in angles.get_ylabel()
    assert "[N·m]" in torques.get_ylabel()
    assert "[s]" in torques.get_xlabel()


def test_examples_have_their_commands_on_the_page() -> None:
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^python examples/(\w+\.py) ", page, re.M)) == [path.name for path in EXAMPLES]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_script_prints_its_result(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for module in NEEDED.get(path.stem, ()):
        pytest.importorskip(module, reason=f"{module} is not installed: pip install -e '.[examples,pink]'")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [path.name])
    runpy.run_path(str(path), run_name="__main__")
    assert re.search(r"\d", capsys.readouterr().out)
    written = re.findall(r"writes `([\w.]+)`", LISTED[path.name])
    assert sorted(each.name for each in tmp_path.iterdir()) == written


def test_derivative_claim_on_page_is_right() -> None:
    robot, q = bent_leg()
    motors = robot.actuation.idx_v
    free = np.setdiff1d(np.arange(robot.model.nv), motors)
    J = their_jacobian(robot, q)
    theirs = np.zeros((robot.model.nv, len(motors)))
    theirs[motors] = np.eye(len(motors))
    theirs[free] = -np.linalg.pinv(J[:, free]) @ J[:, motors]
    np.testing.assert_allclose(eurdf.kinematics.dq_dq_actuated(robot, q), theirs, rtol=0.0, atol=1e-9)
