"""The serial robot that stands for a parallel one."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import mujoco
import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.commands.output import output_schemas
from support.transmissions import with_properties

ANKLE = ("free_pitch", "free_roll")
ROTORS = {"motor_a": 0.0036, "motor_b": 0.0036}


@pytest.fixture(scope="module")
def ankle() -> eurdf.Robot:
    return eurdf.load("unitree_g1_ankle", geometry=False)


@pytest.fixture(scope="module")
def twin(ankle: eurdf.Robot) -> eurdf.transmissions.SerialTwin:
    return eurdf.transmissions.serial_twin(ankle, ANKLE, armature=ROTORS, grid=11)


def test_twin_is_serial_and_driven_at_its_joints(twin: eurdf.transmissions.SerialTwin) -> None:
    assert twin.robot.constraints == ()
    assert twin.robot.actuation.joints == ANKLE
    assert twin.robot.model.nv == 2
    assert {"crank_a", "crank_b", "rod_a", "rod_b"} < set(twin.bodies)


def test_lumped_masses_are_those_of_the_locked_linkage(
    ankle: eurdf.Robot, twin: eurdf.transmissions.SerialTwin
) -> None:
    # Pinocchio lumps the masses of locked joints on its own.
    others = [name for name in ankle.slots if name not in ANKLE]
    ids = [joint for joint, name in enumerate(ankle.model.names) if name.removesuffix("/1") in others]
    locked = pin.buildReducedModel(ankle.model, ids, twin.q)
    q = twin.robot.tree.neutral()
    data, own = locked.createData(), twin.robot.model.createData()
    assert pin.computeTotalMass(twin.robot.model) == pytest.approx(pin.computeTotalMass(locked), rel=1e-12)
    for at in ([0.0, 0.0], [0.2, -0.1]):
        q = np.array(at)
        com = pin.centerOfMass(twin.robot.model, own, q)
        assert com == pytest.approx(pin.centerOfMass(locked, data, q), abs=1e-12)
        mass = eurdf.mass_matrix(twin.robot, q) - np.diag(twin.armature)
        assert mass == pytest.approx(pin.crba(locked, data, q), abs=1e-12)


def test_conservative_numbers_hold_in_the_whole_box(ankle: eurdf.Robot, twin: eurdf.transmissions.SerialTwin) -> None:
    points = twin.workspace.positions
    inside = ((points >= twin.position[:, 0] - 1e-12) & (points <= twin.position[:, 1] + 1e-12)).all(axis=1)
    assert np.count_nonzero(inside) == round(twin.neglected.covered * len(points)) > 20
    for q, position in zip(twin.workspace.q[inside][::5], points[inside][::5], strict=True):
        limits = eurdf.transmissions.serial_limits(ankle, ANKLE, q)
        corners = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
        assert limits.torque.contains(corners * twin.torque).all()
        assert limits.velocity.contains(corners * twin.velocity).all()
        exact = eurdf.transmissions.reflected_inertia(ankle, ANKLE, q, armature=ROTORS).total
        own = eurdf.mass_matrix(twin.robot, position)
        assert (np.diag(own) >= np.diag(exact) - 1e-12).all()
        error = np.linalg.norm(own - exact, 2) / np.linalg.norm(exact, 2)
        assert error <= twin.neglected.inertia + 1e-12
        assert np.abs(own - exact)[0, 1] <= twin.neglected.coupling[0, 1] + 1e-12


def test_map_is_as_near_as_it_states(ankle: eurdf.Robot, twin: eurdf.transmissions.SerialTwin) -> None:
    for pitch, roll in ((0.0, 0.0), (-0.3, 0.1), (0.2, -0.05)):
        at = eurdf.transmissions.prepare_transmission(ankle, ANKLE).at_joints([pitch, roll])
        # Four times what was seen at the points tested.
        assert np.abs(twin.map.motor_positions([pitch, roll]) - at.positions) == pytest.approx(0, abs=4e-3)
        assert np.abs(twin.map.G([pitch, roll]) - at.G) == pytest.approx(0, abs=0.1)
        h = 1e-6
        ahead, behind = twin.map.motor_positions([[pitch + h, roll], [pitch - h, roll]])
        assert twin.map.G([pitch, roll])[:, 0] == pytest.approx((ahead - behind) / (2 * h), abs=1e-7)


def test_gravity_error_is_that_of_the_closed_mechanism(
    ankle: eurdf.Robot, twin: eurdf.transmissions.SerialTwin
) -> None:
    differences = []
    for q, position in zip(twin.workspace.q, twin.workspace.positions, strict=True):
        held = eurdf.inverse_dynamics(ankle, q, np.zeros(8), np.zeros(8)).u
        G = eurdf.transmission(ankle, ANKLE, q).G
        own = pin.computeGeneralizedGravity(twin.robot.model, twin.robot.model.createData(), position)
        differences.append(np.abs(G.T @ held - own))
    assert np.max(differences, axis=0) == pytest.approx(twin.neglected.gravity, abs=1e-9)
    assert (twin.neglected.gravity > 1e-3).all()


def test_files_are_read_by_simulators(twin: eurdf.transmissions.SerialTwin, tmp_path: Path) -> None:
    twin.write(tmp_path)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "mjcf" / "robot.xml"))
    assert (model.nq, model.neq, model.nu) == (2, 0, 2)
    assert model.dof_armature == pytest.approx(twin.armature, rel=1e-12)
    assert model.jnt_range == pytest.approx(twin.position, abs=1e-12)
    urdf = pin.buildModelFromUrdf(str(tmp_path / "urdf" / "robot.urdf"))
    assert urdf.effortLimit == pytest.approx(twin.torque, rel=1e-12)
    assert urdf.velocityLimit == pytest.approx(twin.velocity, rel=1e-12)
    stated = json.loads((tmp_path / "transmission.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(output_schemas()["serial.schema.json"]).validate(stated)
    assert stated["armature"] == twin.armature.tolist()
    assert set(stated["neglected"]) == set(twin.neglected.__slots__)


def test_fitted_numbers_are_means(ankle: eurdf.Robot) -> None:
    fitted = eurdf.transmissions.serial_twin(ankle, ANKLE, armature=ROTORS, limits="fitted", grid=5)
    each = [eurdf.transmissions.serial_limits(ankle, ANKLE, q).torque_box for q in fitted.workspace.q]
    assert fitted.torque == pytest.approx(np.mean(each, axis=0), rel=1e-9)
    assert fitted.neglected.covered == 1.0


def test_springs_of_joints_are_kept_and_those_of_the_linkage_noted() -> None:
    springs = {
        "free_rocker": {"stiffness": (20.0,), "rest": (0.1,)},
        "motor_crank": {"stiffness": (5.0,), "rest": (0.0,)},
    }
    robot = with_properties(eurdf.load("four_bar", geometry=False), springs)
    found = eurdf.transmissions.serial_twin(robot, "free_rocker", grid=5, ranges={"free_rocker": (-0.1, 0.1)})
    (kept,) = (joint.properties for joint in found.robot.mechanism.joints if joint.name == "free_rocker")
    assert (kept.stiffness, kept.rest) == ((20.0,), (0.1,))
    q = found.robot.configuration({"free_rocker": (0.3,)})
    assert eurdf.springs.spring_force(found.robot, q) == pytest.approx([-20.0 * 0.2])
    note = found.notes[-1]
    assert note == "springs of the linkage are left out, those of 'motor_crank': add their torque to the drives"


def test_wrong_arguments_are_errors(ankle: eurdf.Robot) -> None:
    with pytest.raises(ValueError, match="limits is 'best'; it must be 'conservative' or 'fitted'"):
        eurdf.transmissions.serial_twin(ankle, ANKLE, limits="best")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="degree is 0"):
        eurdf.transmissions.serial_twin(ankle, ANKLE, degree=0)


def test_linkage_with_motors_of_other_joints_is_refused() -> None:
    robot = eurdf.load("kangaroo_leg", geometry=False)
    with pytest.raises(
        eurdf.errors.NoTransmission, match="'motor_ankle_outer' and 'motor_ankle_inner'; add the joints"
    ):
        eurdf.transmissions.serial_twin(robot, ["free_knee"])
