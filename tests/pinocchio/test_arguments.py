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

#: Annotations of parameters that are arrays, or mappings to arrays.
ARRAY = re.compile(r"\b(Vector|Matrix|ArrayLike|External|Mapping\[str, Any\]|tuple\[float)")

#: A valid call of each public function, and of each method of a robot, that takes an array.
CALLS: dict[str, dict[str, Any]] = {
    "Robot.coordinates": {"q": "q"},
    "Robot.joint_coordinates": {"q": "q"},
    "achievable_acceleration": {"q": "q", "v": "v", "a": "v", "tau": "v", "external": {"coupler": 6}},
    "actuated_jacobian": {"q": "q", "frame": "coupler", "weights": "v"},
    "analyze": {"q": "q"},
    "assemble": {"q0": "q"},
    "closure_openings": {"q": "q"},
    "differential_inverse_kinematics": {"q": "q", "frame": "coupler", "twist": 6},
    "dq_dq_actuated": {"q": "q", "weights": "v"},
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
    },
    "inverse_kinematics": {"targets": {"coupler": 3}, "q0": "q"},
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
        if parameter in ("frame", "actuator", "joints", "duration", "grid", "port"):
            arguments[parameter] = given
        elif isinstance(given, Mapping):
            arguments[parameter] = {key: np.ones(size) for key, size in given.items()}
        else:
            arguments[parameter] = array(parameter, given)
    if name.startswith("batch."):  # of two elements
        for parameter in arguments.keys() & {"q", "q0", "values"}:
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
    found = {name: getattr(eurdf, name) for name in eurdf.__all__ if inspect.isfunction(getattr(eurdf, name))}
    methods = inspect.getmembers(eurdf.Robot, inspect.isfunction)
    found |= {f"batch.{name}": each for name, each in inspect.getmembers(eurdf.batch, inspect.isfunction)}
    return found | {f"Robot.{name}": method for name, method in methods if not name.startswith("_")}


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
        if isinstance(answer, eurdf.Viewer):
            answer.close()
    except (eurdf.UnderactuatedMotion, eurdf.InconsistentMotion):
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


#: A mapping gives coordinates by name; a column of one number is also a matrix.
RIGHT = {("actuated", "mapping"), ("stiffness", "column"), ("damping", "column")}


@pytest.mark.parametrize(("name", "parameter"), list(array_parameters()))
def test_wrong_array_is_a_value_error(name: str, parameter: str) -> None:
    given = valid(name)[parameter]
    [(key, good)] = given.items() if isinstance(given, Mapping) else [(None, np.asarray(given))]
    named = parameter if key is None else rf"{parameter}\['{key}'\]"
    of_one = not name.startswith("batch.")
    expected = rf"^{named}[ \[].*expected .*\({good.shape[-1]},\)" if of_one else rf"^{parameter}\b"
    for what, bad in wrong(good).items():
        if (parameter, what) not in RIGHT:
            with pytest.raises(ValueError, match=expected):
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
    (eurdf.achievable_acceleration, none, none, none), (eurdf.actuated_jacobian, none, {link!r}), (eurdf.analyze, none),
    (eurdf.assemble, none), (eurdf.closure_openings, none),
    (eurdf.differential_inverse_kinematics, none, {link!r}, np.ones(6)), (eurdf.dq_dq_actuated, none),
    (eurdf.forward_dynamics, none, none, none), (eurdf.forward_kinematics, none), (eurdf.forward_kinematics, {{}}),
    (eurdf.inverse_dynamics, none, none, none), (eurdf.lock, []), (eurdf.mass_matrix, none),
    (eurdf.merge_configuration, none, none), (eurdf.merge_velocity, none, none),
    (eurdf.project_acceleration, none, none, none), (eurdf.project_configuration, none),
    (eurdf.project_velocity, none, none), (eurdf.residual, none),
    (eurdf.residual_and_jacobian, none),
    (eurdf.split_configuration, none), (eurdf.split_velocity, none),
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
