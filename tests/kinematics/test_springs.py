"""Forward kinematics of robots with springs: the springs are in equilibrium, or at rest where the loops allow it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

import eurdf
from benchmarks.dynamics import in_3d
from eurdf.kinematics.closing import close
from eurdf.kinematics.split import split_configuration
from eurdf.kinematics.springs import spring_equilibrium
from support.described import load
from support.linkage import described, n_bar

HEAD = 'extended_urdf: "2.1"\n'


def linkage(bars: int, springs: Mapping[str, str], **options: Any) -> Any:
    """A planar linkage of so many bars, its first joint actuated, with entries of joints."""
    urdf, yaml = described(n_bar(bars, "3d", **options))
    entries = "".join(f"  {name}: {{{entry}}}\n" for name, entry in springs.items())
    return load(urdf, HEAD + yaml + (f"joints:\n{entries}" if entries else ""))


def coordinate(robot: Any, q: Any, joint: str) -> float:
    return float(robot.joint_positions(q)[joint][0])


def least(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function of one minimum is least, by golden sections."""
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    while high - low > 1e-7:
        one, other = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, other) if function(one) < function(other) else (one, high)
    return 0.5 * (low + high)


def test_spring_on_the_free_motion_is_at_rest() -> None:
    robot = linkage(5, {"j2": "stiffness: 7, rest: 0.2"})
    assert eurdf.analyze(robot).mobility == 2
    q = eurdf.forward_kinematics(robot, [0.3])
    assert coordinate(robot, q, "j2") == pytest.approx(0.2, abs=1e-10)
    assert coordinate(robot, q, "j0") == 0.3
    assert np.abs(eurdf.residual(robot, q)).max() < 1e-10


def test_springs_that_cannot_all_rest_are_in_equilibrium() -> None:
    robot = linkage(5, {"j1": "stiffness: 3, rest: 0.4", "j2": "stiffness: 7, rest: 0.2"})
    q = eurdf.forward_kinematics(robot, [0.3])

    def energy(angle: float) -> float:
        at = eurdf.forward_kinematics(rigid, {"j0": 0.3, "j2": angle})
        one, other = coordinate(rigid, at, "j1") - 0.4, angle - 0.2
        return 1.5 * one * one + 3.5 * other * other

    rigid = linkage(5, {})
    angle = least(energy, -0.3, 0.4)
    assert coordinate(robot, q, "j2") == pytest.approx(angle, abs=1e-6)
    assert eurdf.springs.spring_energy(robot, q) == pytest.approx(energy(angle), rel=1e-9)
    assert eurdf.springs.spring_energy(robot, q) > 1e-3
    # No force of the springs is left along the free motion; the other forces are those of the loop and of the motor.
    actuated = np.array([1.0, 0.0, 0.0, 0.0])
    _, K = eurdf.residual_and_jacobian(robot, q)
    rows = np.vstack([K, actuated])
    left = np.linalg.lstsq(rows.T, eurdf.springs.spring_force(robot, q), rcond=None)[0]
    np.testing.assert_allclose(rows.T @ left, eurdf.springs.spring_force(robot, q), atol=1e-8)


def test_equilibrium_does_not_depend_on_the_start() -> None:
    robot = linkage(6, {"j1": "stiffness: 3", "j2": "stiffness: 7, rest: 0.2", "j3": "stiffness: 2, rest: -0.1"})
    first = eurdf.forward_kinematics(robot, [0.2])
    other = eurdf.forward_kinematics(robot, {"j0": -0.2, "j1": 0.15, "j2": -0.1})
    np.testing.assert_allclose(eurdf.forward_kinematics(robot, [0.2], other), first, atol=1e-9)


def test_spring_that_the_motor_decides_changes_nothing() -> None:
    sprung, rigid = linkage(4, {"j2": "stiffness: 7, rest: 2"}), linkage(4, {})
    for angle in (-0.3, 0.4):
        np.testing.assert_allclose(
            eurdf.forward_kinematics(sprung, [angle]), eurdf.forward_kinematics(rigid, [angle]), atol=1e-10
        )


def test_joint_with_a_spring_can_be_given() -> None:
    robot = linkage(5, {"j2": "stiffness: 7, rest: 0.2"})
    q = eurdf.forward_kinematics(robot, {"j0": 0.3, "j2": -0.1})
    assert coordinate(robot, q, "j2") == -0.1


def test_motion_without_spring_stays_minimal() -> None:
    sprung, rigid = linkage(6, {"j3": "stiffness: 7"}), linkage(6, {})
    q = eurdf.forward_kinematics(sprung, [0.3])
    assert coordinate(sprung, q, "j3") == pytest.approx(0.0, abs=1e-10)
    # Without springs, the third of the three freedoms would also be decided by the least motion.
    assert np.abs(eurdf.forward_kinematics(rigid, [0.3]) - q).max() > 1e-3


@pytest.mark.parametrize("name", ["cassie_leg", "digit_2legs"])
def test_springs_that_loops_let_rest_are_kept_at_rest(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = eurdf.load(name, geometry=False)
    q0 = eurdf.assemble(robot).q
    values = split_configuration(robot, q0)[0] + np.linspace(-0.05, 0.05, 4)[:, None]

    def refuse(*_: Any) -> None:
        raise AssertionError("springs were brought into equilibrium afterwards, which takes long")

    monkeypatch.setattr("eurdf.kinematics.forward.spring_equilibrium", refuse)
    found = eurdf.batch.forward_kinematics(robot, values, q0)
    assert found.converged.all()
    for value, q in zip(values, found.q, strict=True):
        assert eurdf.springs.spring_energy(robot, q) == 0.0
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-10
        np.testing.assert_allclose(eurdf.forward_kinematics(robot, value, q0), q, atol=1e-9)


def test_batch_agrees_where_loops_let_only_some_springs_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = eurdf.load("digit_2legs", geometry=False)
    q0 = eurdf.assemble(robot).q
    start = split_configuration(robot, q0)[0]
    values = start + np.random.default_rng(1).uniform(-0.65, 0.65, (5, len(start)))
    afterwards = []

    def counted(*given: Any) -> Any:
        afterwards.append(given)
        return spring_equilibrium(*given)

    monkeypatch.setattr("eurdf.kinematics.forward.spring_equilibrium", counted)
    found = eurdf.batch.forward_kinematics(robot, values, q0)
    assert found.converged.all()
    assert 0 < len(afterwards) < len(values)
    for value, q in zip(values, found.q, strict=True):
        np.testing.assert_allclose(eurdf.forward_kinematics(robot, value, q0), q, atol=1e-9)


def test_spring_of_a_mimic_joint_that_stands_still_acts_on_nothing() -> None:
    robot = load(
        """<robot name="pair"><link name="base"/><link name="one"/><link name="two"/>
        <joint name="leader" type="continuous"><parent link="base"/><child link="one"/></joint>
        <joint name="follower" type="continuous"><parent link="one"/><child link="two"/>
        <mimic joint="leader" multiplier="0"/></joint></robot>""",
        HEAD + "joints: {follower: {stiffness: 7, rest: 0.2}}\n",
    )
    q = eurdf.forward_kinematics(robot, {})
    assert coordinate(robot, q, "leader") == 0.0
    assert eurdf.springs.spring_energy(robot, q) == pytest.approx(0.14)


def test_spring_that_no_free_motion_deflects_takes_no_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    # With ball joints in place of its hinge and rod, two links spin freely; the motor alone decides on the spring.
    robot = in_3d(eurdf.load("double_wishbone", geometry=False))
    q0 = eurdf.assemble(robot).q

    def refuse(*_: Any) -> None:
        raise AssertionError("rounding of what the spring stores was minimised")

    monkeypatch.setattr("eurdf.kinematics.springs.close", refuse)
    q = eurdf.forward_kinematics(robot, split_configuration(robot, q0)[0] + 0.02, q0)
    assert eurdf.springs.spring_energy(robot, q) > 1.0


def test_rod_that_spins_does_not_delay_the_springs(monkeypatch: pytest.MonkeyPatch) -> None:
    robot, steps = eurdf.load("cassie_leg", geometry=False), []

    def counted(problem: Any, q: Any, tolerance: float) -> Any:
        steps.append(q)
        return close(problem, q, tolerance)

    for module in ("path", "springs"):
        monkeypatch.setattr(f"eurdf.kinematics.{module}.close", counted)
    q = eurdf.forward_kinematics(robot, [0.05] * 5)
    assert eurdf.springs.spring_energy(robot, q) == pytest.approx(0.0, abs=1e-12)
    assert len(steps) < 20
