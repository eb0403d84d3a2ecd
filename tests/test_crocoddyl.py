"""Closed loops in optimal control with Crocoddyl."""

from __future__ import annotations

import importlib
import re
import sys
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from support.differences import near, near_slope
from support.mechanisms import KINDS, closed_tree
from support.places import ROOT

crocoddyl = pytest.importorskip("crocoddyl", reason="Crocoddyl is not installed: pip install -e '.[crocoddyl]'")

import eurdf.crocoddyl as ours  # noqa: E402 - Crocoddyl may be missing


def costs_of(robot: eurdf.Robot, **residuals: Any) -> Any:
    """Costs of the state and the controls, and of residuals with what they take between state and nu."""
    state, nu = crocoddyl.StateMultibody(robot.model), len(robot.actuation.idx_v)
    costs = crocoddyl.CostModelSum(state, nu)
    for name, arguments in {"ResidualModelState": (), "ResidualModelControl": (), **residuals}.items():
        kind = getattr(ours if name == "ResidualModelFramePlacement" else crocoddyl, name)
        costs.addCost(name, crocoddyl.CostModelResidual(state, kind(state, *arguments, nu)), 0.7)
    return costs


def dynamics_of(robot: eurdf.Robot, costs: Any = None, gains: tuple[float, float] = (300.0, 30.0)) -> Any:
    return ours.DifferentialActionModelLoopFwdDynamics(robot, costs or costs_of(robot), gains)


def check_derivatives(robot: eurdf.Robot, q: Any, random: np.random.Generator) -> None:
    """Of acceleration and cost, along a random change of x and u, where another action was computed in between."""
    position, momentum = random.normal(size=3), random.normal(size=6)
    place = pin.SE3(pin.exp3(random.normal(size=3)), position)
    residuals: dict[str, Any] = {
        "ResidualModelFramePlacement": (robot.model.nframes - 1, place),
        "ResidualModelCoMPosition": (position,),
    }
    if not len(robot.model.mimicking_joints):
        residuals["ResidualModelCentroidalMomentum"] = (momentum,)
    model, nv = dynamics_of(robot, costs_of(robot, **residuals)), robot.model.nv
    v = eurdf.project_velocity(robot, q, random.uniform(-1.0, 1.0, nv))
    x, u = np.concatenate((q, v)), random.uniform(-1.0, 1.0, model.nu)
    dx, du = random.uniform(-1.0, 1.0, 2 * nv), random.uniform(-1.0, 1.0, model.nu)
    data, other = model.createData(), model.createData()

    def along(h: float) -> Any:
        model.calc(other, model.state.integrate(x, h * dx), u + h * du)
        return np.append(other.xout, other.cost)

    model.calc(data, x, u)
    near(data.xout, eurdf.forward_dynamics(robot, q, v, u, gains=model.gains).a)
    along(0.1)
    model.calcDiff(data, x, u)
    found = data.Fx @ dx + data.Fu.reshape(nv, -1) @ du, [data.Lx @ dx + data.Lu @ du]
    near_slope(found[0], lambda h: along(h)[:-1], (3e-3, 1e-3, 3e-4, 1e-4), 1e-6)
    near_slope(found[1], lambda h: along(h)[-1:], (3e-3, 1e-3, 3e-4), 1e-8)


@pytest.mark.parametrize("name", ["delta", "double_wishbone", "robotiq_2f85", "tello", "digit_2legs"])
def test_derivatives_are_those_of_robots(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    if name == "digit_2legs":
        robot = robot.with_contacts({"left_foot": "6d", "right_foot": "3d"})
    check_derivatives(robot, eurdf.assemble(robot).q, np.random.default_rng(0))


@given(seed=st.integers(0, 2**32 - 1), kinds=st.sets(st.sampled_from(KINDS), min_size=1))
@settings(max_examples=10, deadline=None)
def test_derivatives_are_those_of_every_kind_and_joint(seed: int, kinds: set[str]) -> None:
    random = np.random.default_rng(seed)
    check_derivatives(*closed_tree(random, tuple(sorted(kinds))), random)


def test_code_of_page_solves_in_few_iterations() -> None:
    """With Pinocchio's derivatives of 3d loops, Crocoddyl stops after 18 iterations, at a cost of 0.0599."""
    page, names = (ROOT / "docs" / "crocoddyl.md").read_text(encoding="utf-8"), dict[str, Any]()
    for block in re.findall(r"^```python\n(.*?)^```", page, re.M | re.S):
        exec(block, names)
    assert names["solved"]
    assert names["solver"].iter <= 6
    assert names["solver"].cost <= 0.0515
    assert names["opening"] < 1e-3


def test_redundant_loops_may_be_open() -> None:
    robot = eurdf.load("bennett", geometry=False)
    model, found, q = dynamics_of(robot), [], eurdf.assemble(robot).q
    along = np.linalg.svd(eurdf.residual_and_jacobian(robot, q)[1])[2][-1]
    opened = pin.integrate(robot.model, q, 1e-5 * np.array([1.0, -1.0, 2.0, 0.5]))
    for each in (q, opened):
        data, x = model.createData(), np.concatenate((each, np.zeros(4)))
        model.calc(data, x, np.ones(1))
        model.calcDiff(data, x, np.ones(1))
        found.append(data.Fx[:, :4] @ along)
    near(found[1], found[0], 1e-3)
    with pytest.raises(ValueError, match="contradict each other"):
        eurdf.dynamics_derivatives(robot, opened, np.zeros(4), np.ones(1), gains=model.gains)


def test_example_squats_with_its_feet_held() -> None:
    from examples import squat_with_crocoddyl

    squat = squat_with_crocoddyl.main()
    robot, half = squat.robot, squat_with_crocoddyl.NODES // 2
    assert squat.iterations <= 10
    assert squat.opening < 1e-3
    assert squat.height.argmin() == half
    np.testing.assert_allclose(squat.height[[half, -1]], [-squat_with_crocoddyl.DEPTH, 0.0], rtol=0.0, atol=1e-3)
    for frame in map(robot.model.getFrameId, squat_with_crocoddyl.FEET):
        at = [squat_with_crocoddyl.pose(robot, q, frame) for q in squat.q]
        assert max(np.abs(pin.log6(at[0].actInv(each)).vector).max() for each in at) < 1e-3
    # At rest before and after: on average the ground carries the weight.
    weight = 9.81 * sum(inertia.mass for inertia in robot.model.inertias)
    assert squat.ground.sum(axis=1).mean() == pytest.approx(weight, rel=1e-2)
    assert squat.ground.min() > 0.0
    assert squat.load < 1.0


def test_forces_and_bounds_are_those_of_the_robot() -> None:
    robot = eurdf.load("digit_leg", geometry=False).with_contacts({"foot": "3d"})
    model, still, u = dynamics_of(robot), np.zeros(robot.model.nv), np.ones(6)
    data, q = model.createData(), robot.configurations["assembled"]
    model.calc(data, np.concatenate((q, still)), u)
    near(data.forces["foot"], eurdf.forward_dynamics(robot, q, still, u).forces["foot"], 1e-6)
    limits = robot.model.upperEffortLimit[robot.actuation.idx_v]
    step = crocoddyl.IntegratedActionModelEuler(model, 1e-3)
    np.testing.assert_array_equal((step.u_lb, step.u_ub), (-limits, limits))


def test_overflow_is_not_a_number() -> None:
    model = dynamics_of(eurdf.load("delta", geometry=False))
    data, x = model.createData(), model.state.zero()
    x[-1] = 1e200
    model.calc(data, x, np.zeros(3))
    model.calcDiff(data, x, np.zeros(3))
    assert np.isnan(data.xout).all()
    assert np.isnan(data.Fx).all()


def test_wrong_arguments_are_errors() -> None:
    delta, leg = (eurdf.load(name, geometry=False) for name in ("delta", "digit_leg"))
    with pytest.raises(ValueError, match=r"another state or for 6 controls; make them .*, 3\) for 'delta'"):
        dynamics_of(delta, costs_of(leg))
    with pytest.raises(ValueError, match=r"id is 99; 'delta' has frames 0 to \d+$"):
        costs_of(delta, ResidualModelFramePlacement=(99, pin.SE3.Identity()))
    with pytest.raises(ValueError, match="gains"):
        dynamics_of(delta, gains=(np.nan, 0.0))
    urdf = (
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='continuous'>"
        "<parent link='a'/><child link='b'/></joint></robot>"
    )
    massless = eurdf.load({"extended_urdf": "2.1", "actuators": ["j"]}, urdf)
    with pytest.raises(eurdf.errors.UndeterminedMotion, match="add mass"):
        dynamics_of(massless)


def test_costs_that_would_be_wrong_are_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ours, "_FRAMES_MISREAD", True)
    robot = eurdf.load("delta", geometry=False)
    frames = costs_of(robot, ResidualModelFrameTranslation=(0, np.zeros(3)))
    with pytest.raises(ValueError, match=r"cost 'ResidualModelFrameTranslation': Crocoddyl .* reads wrong frames"):
        dynamics_of(robot, frames).createData()
    mimics, _ = closed_tree(np.random.default_rng(0))
    momentum = costs_of(mimics, ResidualModelCentroidalMomentum=(np.zeros(6),))
    with pytest.raises(ValueError, match=r"no derivatives of ResidualModelCentroidalMomentum with mimic joints"):
        dynamics_of(mimics, momentum).createData()


def test_missing_crocoddyl_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "crocoddyl", None)
    monkeypatch.delitem(sys.modules, "eurdf.crocoddyl")
    with pytest.raises(eurdf.errors.MissingExtra, match=r"eurdf\.crocoddyl needs Crocoddyl; install it") as caught:
        importlib.import_module("eurdf.crocoddyl")
    assert caught.value.extra == "crocoddyl"
