"""The energy balance of a simulation, and the warning of a step that is too long."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.errors import StepTooLongWarning
from eurdf.kinematics.equation_of_motion import EquationOfMotion
from eurdf.kinematics.project import project_velocity
from eurdf.kinematics.simulation import simulate


def four_bar() -> tuple[Any, Any]:
    robot = eurdf.load("four_bar", geometry=False)
    return robot, eurdf.assemble(robot).q


def quiet(*given: Any, **options: Any) -> Any:
    """Simulate; a warning is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return simulate(*given, **options)


def test_long_step_of_ankle_is_warned_of_and_suggested_step_is_not() -> None:
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    q = eurdf.assemble(robot).q
    with pytest.warns(
        StepTooLongWarning, match=r"% of the .* J exchanged: the time step of 0.001 s is too long"
    ) as all_:
        simulate(robot, q, duration=1.0)
    (warning,) = [found.message for found in all_ if isinstance(found.message, StepTooLongWarning)]
    assert warning.error / warning.exchanged == pytest.approx(0.2, abs=0.02)
    assert warning.step == 1e-3
    assert 2e-4 < warning.suggested < 5e-4


def test_energies_are_those_of_pinocchio() -> None:
    robot, q = four_bar()
    motion = quiet(robot, q, duration=0.05, step=1e-3)
    data = robot.model.createData()
    for q, v, kinetic, potential in zip(motion.q, motion.v, motion.kinetic, motion.potential, strict=True):
        assert pin.computeKineticEnergy(robot.model, data, q, v) == pytest.approx(kinetic, rel=1e-9)
        assert pin.computePotentialEnergy(robot.model, data, q) == pytest.approx(potential, rel=1e-9)


def test_constant_torque_does_work_along_joint() -> None:
    robot, q = four_bar()
    motion = quiet(robot, q, duration=0.1, step=1e-3, control=lambda t, q, v: np.array([0.3]))
    index = robot.actuation.idx_v[0]
    turned = [pin.difference(robot.model, q, at)[index] for at in motion.q]
    np.testing.assert_allclose(motion.work, 0.3 * np.array(turned), atol=1e-10)
    assert motion.energy_error < 1e-6 * motion.energy_exchanged


def test_damping_takes_energy() -> None:
    robot, q = four_bar()
    robot.model.damping = np.full(3, 0.05)
    v = project_velocity(robot, q, 2.0 * np.ones(3))
    motion = quiet(robot, q, v, duration=0.1, step=1e-3, dissipation=True)
    assert (np.diff(motion.work) < 0.0).all()
    assert motion.energy_error < 1e-5 * motion.energy_exchanged


def test_external_force_does_work_along_frame() -> None:
    robot, q = four_bar()
    force = np.array([0.5, -0.2, 0.0])
    frame = robot.model.getFrameId("coupler")
    motion = quiet(robot, q, duration=0.1, step=1e-3, external={"coupler": np.concatenate((force, np.zeros(3)))})
    data = robot.model.createData()
    places = []
    for at in motion.q:
        pin.forwardKinematics(robot.model, data, at)
        places.append(pin.updateFramePlacement(robot.model, data, frame).translation.copy())
    along = (np.array(places) - places[0]) @ force
    np.testing.assert_allclose(motion.work, along, atol=1e-9)
    assert np.ptp(along) > 1e-4


@pytest.mark.parametrize("duration", [0.0, 0.02])
def test_robot_at_rest_is_not_warned_of(duration: float) -> None:
    robot, q = four_bar()
    robot.model.gravity.linear = np.zeros(3)
    motion = quiet(robot, q, duration=duration)
    assert motion.energy_error == pytest.approx(0.0, abs=1e-12)
    assert motion.energy_exchanged == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["bennett", "excavator", "spherical_four_bar"])
def test_steps_of_redundant_rows_equal_elimination(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Between steps, redundant rows contradict each other, and no row may lock the mechanism."""
    eliminated: list[int] = []
    found, eliminate = [], EquationOfMotion.eliminate
    monkeypatch.setattr(EquationOfMotion, "eliminate", lambda *given: (eliminated.append(0), eliminate(*given))[1])
    for by_rows in (True, False):
        robot = eurdf.load(name, geometry=False)
        q = eurdf.assemble(robot).q
        v = project_velocity(robot, q, np.random.default_rng(0).uniform(-1.0, 1.0, robot.model.nv))
        if not by_rows:
            monkeypatch.setattr("eurdf.kinematics.independence.Independence.combinations", lambda _: None)
        found.append(quiet(robot, q, v, duration=0.05, step=1e-3))
        assert bool(eliminated) != by_rows
    np.testing.assert_allclose(found[0].q, found[1].q, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found[0].v, found[1].v, rtol=0.0, atol=1e-8)
    assert found[0].energy_error < 1e-6 * found[0].energy_exchanged
