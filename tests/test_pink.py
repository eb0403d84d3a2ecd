"""Loops as constraints and tasks of Pink."""

from __future__ import annotations

import importlib
import re
import sys
import warnings
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from support.mechanisms import one_loop
from support.places import ROOT

pink = pytest.importorskip("pink", reason="Pink is not installed: pip install -e '.[pink]'")

from eurdf.pink import ClosureTask  # noqa: E402 - Pink may be missing


def opened(robot: eurdf.Robot, by: float, seed: int = 0) -> Any:
    """A Pink configuration whose loops are open: each velocity turns or slides by up to so many rad or m."""
    q = eurdf.assemble(robot).q
    q = pin.integrate(robot.model, q, by * np.random.default_rng(seed).uniform(-1.0, 1.0, robot.model.nv))
    return pink.Configuration(robot.model, robot.data, q)


def opening_after(steps: int, robot: eurdf.Robot, configuration: Any, solver: str = "daqp", **program: Any) -> float:
    program = {"tasks": [], "damping": 1e-6, "limits": [], "safety_break": False, **program}
    for _ in range(steps):
        configuration.integrate_inplace(pink.solve_ik(configuration, dt=1.0, solver=solver, **program), 1.0)
    return float(np.abs(eurdf.residual(robot, configuration.q)).max())


@pytest.mark.parametrize("solver", ["daqp", "quadprog", "clarabel"])
def test_example_reaches_with_closed_loops(solver: str) -> None:
    pytest.importorskip(solver, reason=f"{solver} is not installed: pip install {solver}")
    from examples import reach_with_pink

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Converted matrix")
        reached = reach_with_pink.main(solver)
    assert reached.error < 1e-12
    assert reached.opening < 1e-12
    assert 1e-9 < reached.opening_on_the_way < 1e-4


@given(
    seed=st.integers(0, 2**32 - 1),
    kind=st.sampled_from(["3d", "6d", "hinge", "distance"]),
    types=st.permutations(["spherical", "universal", "cylindrical", "planar", "continuous"]),
    follower=st.booleans(),
    coupled=st.booleans(),
    soft=st.booleans(),
)
@settings(max_examples=30, deadline=None)
def test_steps_close_loops_of_each_kind(
    seed: int, kind: str, types: list[str], follower: bool, coupled: bool, soft: bool
) -> None:
    robot = one_loop(["revolute", "prismatic", *types], kind, seed, follower=follower, coupled=coupled)
    loops, configuration = ClosureTask(robot), opened(robot, 0.01, seed)
    program = {"tasks": [loops], "damping": 1e-9} if soft else {"constraints": [loops]}
    assert opening_after(5, robot, configuration, **program) < 1e-9


@pytest.mark.parametrize("name", ["bennett", "four_bar", "toddlerbot_2legs", "digit_leg"])
def test_rows_are_independent_and_span_those_of_the_jacobian(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    configuration = opened(robot, 0.0)
    J, (_, K) = ClosureTask(robot).compute_jacobian(configuration), eurdf.residual_and_jacobian(robot, configuration.q)
    np.testing.assert_allclose(J @ J.T, np.eye(len(J)), rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(K @ J.T @ J, K, rtol=0.0, atol=1e-6)
    assert len(J) == np.linalg.matrix_rank(K, tol=1e-6)


def test_redundant_closures_suit_a_solver_that_needs_independent_rows() -> None:
    pytest.importorskip("quadprog", reason="quadprog is not installed: pip install quadprog")
    robot = eurdf.load("bennett", geometry=False)
    assert opening_after(6, robot, opened(robot, 1e-3), "quadprog", constraints=[ClosureTask(robot)]) < 1e-10


def test_step_removes_the_stated_part_of_the_opening() -> None:
    robot = eurdf.load("digit_leg", geometry=False).with_contacts({"foot": "3d"})
    configuration, loops = opened(robot, 0.01), ClosureTask(robot, gain=0.25)
    r, K = eurdf.residual_and_jacobian(robot, configuration.q)
    v = pink.solve_ik(configuration, [], 1.0, "daqp", 1e-6, [], constraints=[loops], safety_break=False)
    assert len(K) == 18 + 3
    np.testing.assert_allclose(K @ v, -0.25 * r, rtol=0.0, atol=1e-9)


def test_wrong_arguments_are_errors() -> None:
    robot = eurdf.load("four_bar", geometry=False)
    with pytest.raises(ValueError, match=r"one of the model 'five_bar', not of that of the task's robot 'four_bar'"):
        ClosureTask(robot).compute_error(opened(eurdf.load("five_bar", geometry=False), 0.0))
    for wrong in ({"gain": 0.0}, {"gain": np.nan}, {"cost": -1.0}, {"lm_damping": np.inf}):
        with pytest.raises(ValueError, match=r"must be finite and at least 0, and gain in \(0, 1\]"):
            ClosureTask(robot, **wrong)


def test_missing_pink_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pink.tasks", None)
    monkeypatch.delitem(sys.modules, "eurdf.pink")
    with pytest.raises(eurdf.errors.MissingExtra, match=r"eurdf\.pink needs Pink; install it with: .*pink") as caught:
        importlib.import_module("eurdf.pink")
    assert caught.value.extra == "pink"


def test_code_of_page_reaches() -> None:
    pytest.importorskip("mink", reason="mink is not installed: pip install mink")
    names: dict[str, Any] = {}
    page = (ROOT / "docs" / "pink.md").read_text(encoding="utf-8")
    for block in re.findall(r"^```python\n(.*?)^```", page, re.M | re.S):
        exec(block, names)
        assert names["error"] < 1e-9
        assert names["opening"] < 1e-9
