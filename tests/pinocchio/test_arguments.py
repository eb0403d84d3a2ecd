"""Wrong arguments of public functions: each gives a ValueError that names the argument and the expected shape."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from support.public import public_functions

#: Annotations of parameters that are arrays, or mappings to arrays.
ARRAY = re.compile(r"\b(Named|Vector|Matrix|ArrayLike|External|Mapping\[str, Any\]|tuple\[float)")

#: A valid call of each public function, and of each method of a robot, that takes an array.
CALLS: dict[str, dict[str, Any]] = {
    "Robot.joint_positions": {"q": "q"},
    "Robot.with_contacts": {"contacts": {"coupler": "3d"}, "at": "q"},
    "achievable_acceleration": {"q": "q", "v": "v", "a": "v", "tau": "v", "external": {"coupler": 6}},
    "actuated_jacobian": {"q": "q", "frame": "coupler", "weights": "v"},
    "analyze": {"q": "q"},
    "calibrate": {"samples": {"motor_crank": 2}, "unknown": "motor_crank", "q0": "q"},
    "assemble": {"q0": "q", "hold": "motor_crank", "hold_at": "q"},
    "closure_openings": {"q": "q"},
    "constraint_acceleration": {"q": "q", "v": "v"},
    "differential_inverse_kinematics": {"q": "q", "frame": "coupler", "twist": 6},
    "dq_dq_actuated": {"q": "q", "weights": "v"},
    "dq_dq_actuated_derivative": {"q": "q"},
    "dynamics_derivatives": {"q": "q", "v": "v", "u": "u", "tau": "v", "gains": 2},
    "forward_dynamics": {
        "q": "q",
        "v": "v",
        "u": "u",
        "tau": "v",
        "external": {"coupler": 6},
        "gains": 2,
    },
    "forward_kinematics": {"actuated": {"motor_crank": 1}, "q0": "q"},
    "impedance_map": {"joints": "free_rocker", "q": "q", "stiffness": 1, "damping": 1, "tau": 1},
    "inverse_dynamics": {
        "q": "q",
        "v": "v",
        "a": "v",
        "tau": "v",
        "external": {"coupler": 6},
        "weights": "u",
        "u0": "u",
    },
    "inverse_kinematics": {"targets": {"coupler": 3}, "q0": "q", "hold": "motor_crank", "hold_at": "q"},
    "inertial_regressor": {"q": "q", "v": "v", "a": "v", "tau": "v", "weights": "u"},
    "inverse_dynamics_derivatives": {"q": "q", "v": "v", "a": "v", "tau": "v", "weights": "u"},
    "lock": {"joints": (), "q": "q"},
    "mass_matrix": {"q": "q"},
    "merge_configuration": {"q_actuated": "qa", "q_free": "qf"},
    "merge_velocity": {"v_actuated": "u", "v_free": "vf"},
    "project_acceleration": {"q": "q", "v": "v", "a": "v", "weights": "v"},
    "project_configuration": {"q": "q", "weights": "v"},
    "project_velocity": {"q": "q", "v": "v", "weights": "v"},
    "reflected_inertia": {"joints": "free_rocker", "q": "q"},
    "residual": {"q": "q"},
    "residual_and_jacobian": {"q": "q"},
    "serial_limits": {"joints": "free_rocker", "q": "q", "torque_ratio": 1, "velocity_ratio": 1},
    "simulate": {"q": "q", "v": "v", "external": {"coupler": 6}, "duration": 0.002},
    "spring_energy": {"q": "q"},
    "spring_force": {"q": "q"},
    "split_configuration": {"q": "q"},
    "split_velocity": {"v": "v"},
    "actuator_values": {"joints": {"free_rocker": -0.1}, "q0": "q"},
    "joint_values": {"motors": {"motor_crank": 1}, "q0": "q"},
    "workspace": {"joints": "free_rocker", "q": "q", "grid": 3},
    "serial_twin": {"joints": "free_rocker", "q": "q", "grid": 9},
    "prepare_transmission": {"joints": "free_rocker", "q": "q"},
    "transmission": {"joints": "free_rocker", "q": "q"},
    "sweep": {"actuator": "motor_crank", "q0": "q"},
    "view": {"q": "q", "port": 0},
    "batch.actuated_jacobian": {"q": "q", "frame": "coupler", "weights": "v"},
    "batch.constraint_acceleration": {"q": "q", "v": "v"},
    "batch.dynamics_derivatives": {"q": "q", "v": "v", "u": "u", "tau": "v", "gains": 2},
    "batch.forward_kinematics": {"values": "qa", "q0": "q"},
    "batch.inverse_kinematics": {"targets": {"coupler": 3}, "q0": "q"},
    "batch.project_configuration": {"q": "q", "weights": "v"},
    "batch.residual": {"q": "q"},
    "batch.residual_and_jacobian": {"q": "q"},
}


@cache
def robot() -> eurdf.Robot:
    return eurdf.load("four_bar", geometry=False)


def sizes() -> dict[str, int]:
    nq, nv, actuation = robot().model.nq, robot().model.nv, robot().actuation
    nu, of_actuators = len(actuation.idx_v), len(actuation.idx_q)
    return {"q": nq, "v": nv, "u": nu, "qa": of_actuators, "qf": nq - of_actuators, "vf": nv - nu}


def valid(name: str) -> dict[str, Any]:
    """The arguments of a valid call."""
    arguments = {}
    for parameter, given in CALLS[name].items():
        if parameter in ("contacts", "frame", "actuator", "joints", "hold", "duration", "grid", "port", "unknown"):
            arguments[parameter] = given
        elif isinstance(given, Mapping):
            arguments[parameter] = {key: np.ones(size) for key, size in given.items()}
        else:
            arguments[parameter] = array(parameter, given)
    if name.startswith("batch."):  # of two elements
        for parameter in arguments.keys() & {"q", "q0", "values", "v", "u", "tau"}:
            arguments[parameter] = np.tile(arguments[parameter], (2, 1))
        if "targets" in arguments:
            arguments["targets"] = {"coupler": np.zeros((2, 3))}
    return arguments


def array(parameter: str, given: Any) -> Any:
    q = np.array(robot().configurations["assembled"])
    if parameter == "values":
        return q[robot().actuation.idx_q]
    if given == "q":
        return q
    size = sizes()[given] if isinstance(given, str) else given
    ones = ("weights", "gains", "twist", "torque_ratio", "velocity_ratio")
    return np.ones(size) if parameter in ones else np.zeros(size)


def functions() -> dict[str, Callable[..., Any]]:
    """The public functions, those for batches, and the methods of a robot."""
    methods = inspect.getmembers(eurdf.Robot, inspect.isfunction)
    return public_functions() | {f"Robot.{name}": method for name, method in methods if not name.startswith("_")}


def call(name: str, arguments: Mapping[str, Any]) -> Any:
    return functions()[name](robot(), **arguments)


def array_parameters() -> Iterator[tuple[str, str]]:
    for name, function in functions().items():
        for parameter in inspect.signature(function).parameters.values():
            if parameter.name != "options" and ARRAY.search(str(parameter.annotation)):
                yield name, parameter.name


def parameters_called(*names: str) -> list[tuple[str, str]]:
    return [(name, own) for name, function in functions().items() for own in names if takes(function, own)]


def takes(function: Callable[..., Any], name: str) -> bool:
    return name in inspect.signature(function).parameters


def test_every_function_that_takes_an_array_is_tested() -> None:
    stated = {(name, parameter) for name, given in CALLS.items() for parameter in given}
    assert set(array_parameters()) <= stated
    assert len(list(array_parameters())) > 40


@pytest.mark.parametrize("name", CALLS)
def test_valid_call_succeeds(name: str) -> None:
    try:
        answer = call(name, valid(name))
        if isinstance(answer, eurdf.viewing.Viewer):
            answer.close()
    except (eurdf.errors.UnderactuatedMotion, eurdf.errors.InconsistentMotion):
        assert name in ("inverse_dynamics", "achievable_acceleration")


def wrong(good: Any) -> dict[str, Any]:
    *lead, size = good.shape
    of_one = {
        "empty": [],
        "far too long": np.zeros(10_000),
        "column": np.zeros((size, 1)),
        "row": np.zeros((1, size + 1)),
    }
    return ({} if lead else of_one) | {
        "short": np.zeros((*lead, size - 1)),
        "long": np.zeros((*lead, size + 1)),
        "deep": np.zeros((1, 1, *good.shape)),
        "nan": np.full(good.shape, np.nan),
        "inf": np.full(good.shape, np.inf),
        "text": "abc",
        "complex": np.zeros(good.shape, dtype=complex),
        "mapping": {0: 1.0},
        "ragged": [[0.0], [0.0, 1.0]],
    }


#: A column of one number is also a matrix.
RIGHT = {("stiffness", "column"), ("damping", "column")}


@pytest.mark.parametrize(("name", "parameter"), list(array_parameters()))
def test_wrong_array_is_a_value_error(name: str, parameter: str) -> None:
    given = valid(name)[parameter]
    [(key, good)] = given.items() if isinstance(given, Mapping) else [(None, np.asarray(given))]
    named = parameter if key is None else rf"{parameter}\['{key}'\]"
    of_one = not name.startswith("batch.")
    expected = rf"^{named}[ \[].*expected .*\({good.shape[-1]},\)" if of_one else rf"^{parameter}\b"
    for what, bad in wrong(good).items():
        if (parameter, what) not in RIGHT:
            with pytest.raises(
                ValueError, match=rf"^{named}|joint '0'|'0' is not a joint" if what == "mapping" else expected
            ):
                pytest.fail(
                    f"{name} accepts {what}: {call(name, {**valid(name), parameter: {key: bad} if key else bad})}"
                )


@pytest.mark.parametrize("name", ["actuated_jacobian", "dq_dq_actuated", "project_velocity"])
def test_metric_of_wrong_shape_is_a_value_error(name: str) -> None:
    nv = robot().model.nv
    for weights in (np.eye(nv + 1), np.eye(nv)[:-1], np.full((nv, nv), np.nan)):
        with pytest.raises(ValueError, match=rf"^weights.*expected .*\({nv},\) or \({nv}, {nv}\)"):
            call(name, valid(name) | {"weights": weights})


@pytest.mark.parametrize(("name", "parameter"), parameters_called("data"))
def test_data_of_another_model_is_a_value_error(name: str, parameter: str) -> None:
    for data in (pin.Model().createData(), eurdf.load("delta", geometry=False).data, "data", 3):
        with pytest.raises(ValueError, match=r"^data is not a pin.Data of the robot's model"):
            call(name, valid(name) | {parameter: data})
    call(name, {**valid(name), **{p: np.zeros(robot().model.nv) for p in ("a", "v") if p in CALLS[name]}})


@pytest.mark.parametrize(("name", "parameter"), parameters_called("tolerance", "restarts", "steps", "threads"))
@pytest.mark.parametrize("bad", [-1, np.nan, np.inf, "1", None])
def test_number_out_of_range_is_a_value_error(name: str, parameter: str, bad: Any) -> None:
    with pytest.raises(ValueError, match=rf"^{parameter} is .*expected"):
        call(name, valid(name) | {parameter: bad})


def test_sweep_of_no_steps_is_a_value_error() -> None:
    with pytest.raises(ValueError, match="steps is 0; expected an integer of at least 1"):
        eurdf.sweep(robot(), "motor_crank", steps=0)


#: Expressions that give a robot without moving joints, and a link of it.
STILL = {
    "one link": ("""eurdf.load('<robot name="r"><link name="only"/></robot>', geometry=False)""", "only"),
    "locked": (
        "eurdf.lock(eurdf.load('four_bar', geometry=False), ['motor_crank', 'free_coupler', 'free_rocker'])",
        "coupler",
    ),
}


@pytest.mark.parametrize("which", STILL)
def test_robot_without_moving_joints_is_accepted(which: str) -> None:
    """In a process of its own: Pinocchio ends the process where it does not check sizes."""
    robot, link = STILL[which]
    code = f"""
import eurdf, numpy as np, pinocchio as pin
robot = {robot}
none = np.empty(0)
for target in (np.ones(3), pin.SE3.Random()):
    found = eurdf.inverse_kinematics(robot, {{{link!r}: target}}, none)
    assert not found.converged
for function, *arguments in [
    (eurdf.kinematics.achievable_acceleration, none, none, none), (eurdf.actuated_jacobian, {link!r}, none),
    (eurdf.analyze, none), (eurdf.dynamics_derivatives, none, none),
    (eurdf.assemble, none), (eurdf.kinematics.closure_openings, none),
    (eurdf.differential_inverse_kinematics, {link!r}, none, np.ones(6)), (eurdf.kinematics.dq_dq_actuated, none),
    (eurdf.forward_dynamics, none, none, none), (eurdf.forward_kinematics, none), (eurdf.forward_kinematics, {{}}),
    (eurdf.inverse_dynamics, none, none, none), (eurdf.lock, []), (eurdf.mass_matrix, none),
    (eurdf.merge_configuration, none, none), (eurdf.kinematics.merge_velocity, none, none),
    (eurdf.project_acceleration, none, none, none), (eurdf.project_configuration, none),
    (eurdf.project_velocity, none, none), (eurdf.residual, none),
    (eurdf.residual_and_jacobian, none), (eurdf.kinematics.constraint_acceleration, none, none),
    (eurdf.split_configuration, none), (eurdf.kinematics.split_velocity, none),
]:
    function(robot, *arguments)
eurdf.simulate(robot, none, duration=0.01)
print("done")
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.stdout == "done\n", ended.stderr


@pytest.mark.parametrize("wrong", [[], ["coupler"], np.zeros(6), "coupler", 1.0], ids=repr)
@pytest.mark.parametrize(("name", "parameter"), [("inverse_kinematics", "targets"), ("forward_dynamics", "external")])
def test_what_maps_no_names_is_refused(name: str, parameter: str, wrong: Any) -> None:
    with pytest.raises(ValueError, match=f"{parameter} must map names of frames to .*, not {type(wrong).__name__}"):
        call(name, {**valid(name), parameter: wrong})


@pytest.mark.parametrize(
    ("duration", "step"), [(0.0, np.inf), (np.inf, 1.0), (1e-320, np.inf), (0.0, np.nan), (-1.0, 1.0)]
)
def test_simulation_has_finite_times(duration: float, step: float) -> None:
    q = np.array(robot().configurations["assembled"])
    with pytest.raises(ValueError, match="duration must be finite and at least 0 s, and step finite and above 0 s"):
        eurdf.simulate(robot(), q, duration=duration, step=step)


def test_named_values_make_the_vectors() -> None:
    loaded = eurdf.load("four_bar", root="floating", geometry=False)
    q = loaded.configurations["assembled"]
    named = loaded.joint_positions(q)
    rate = {"motor_crank": 0.3, "root_joint": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]}
    v = np.zeros(loaded.model.nv)
    v[:6], v[loaded.slots["motor_crank"].idx_v] = rate["root_joint"], 0.3
    np.testing.assert_allclose(eurdf.residual(loaded, named), eurdf.residual(loaded, q), atol=1e-12)
    np.testing.assert_allclose(eurdf.kinematics.split_velocity(loaded, rate)[0], [0.3])
    for u in ({"motor_crank": 2.0}, {}):
        found = eurdf.forward_dynamics(loaded, named, rate, u, tau={"motor_crank": 1.0}).a
        tau = np.zeros(loaded.model.nv)
        tau[loaded.slots["motor_crank"].idx_v] = 1.0
        np.testing.assert_allclose(found, eurdf.forward_dynamics(loaded, q, v, [2.0] if u else [0.0], tau=tau).a)
    moved = eurdf.simulate(loaded, named, rate, duration=2e-3, control=lambda t, q, v: {"motor_crank": 2.0})
    same = eurdf.simulate(loaded, q, v, duration=2e-3, control=lambda t, q, v: np.array([2.0]))
    np.testing.assert_allclose(moved.q, same.q, atol=1e-12)
    ankle = eurdf.transmission("unitree_g1_ankle", ["free_pitch", "free_roll"])
    np.testing.assert_allclose(ankle.motor_torque({"free_roll": 5.0}), ankle.motor_torque([0.0, 5.0]))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"motor_cranc": 1.0}, r"'motor_cranc'.*did you mean 'motor_crank'\?"),
        ({"motor_crank": [1.0, 2.0]}, r"u\['motor_crank'\] has the shape \(2,\)"),
        ({"motor_crank": np.nan}, r"u\['motor_crank'\] is nan"),
    ],
)
def test_wrong_named_value_is_named(given: Any, message: str) -> None:
    q, v = robot().configurations["assembled"], np.zeros(robot().model.nv)
    with pytest.raises(ValueError, match=message):
        eurdf.forward_dynamics(robot(), q, v, given)
    with pytest.raises(ValueError, match=r"'motor_cranc'.*did you mean"):
        eurdf.forward_dynamics(robot(), q, {"motor_cranc": 1.0})
    with pytest.raises(ValueError, match=r"'motor_cranc'.*did you mean"):
        eurdf.assemble(robot(), {"motor_cranc": 1.0})


@pytest.mark.parametrize("name", [name for name in CALLS if not name.startswith(("Robot.", "plot"))])
def test_robot_is_also_given_by_its_name(name: str) -> None:
    function = functions()[name]
    assert "RobotSource" in str(inspect.signature(function).parameters["robot"].annotation)
    if name in ("residual", "batch.residual", "analyze", "spring_energy", "closure_openings", "lock", "transmission"):
        of_robot, of_name = (repr(function(each, **valid(name))) for each in (robot(), "four_bar"))
        assert of_name == of_robot
    with pytest.raises(eurdf.errors.RobotNotFound):
        function("four_baar", **valid(name))
