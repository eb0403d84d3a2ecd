"""Calls of the public functions that take a robot, with arguments that are right, extreme or wrong."""

from __future__ import annotations

import dataclasses
import inspect
import math
import random
import warnings
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

import eurdf
from benchmarks.fuzz.mutators import NAMES

ROBOTS = ("four_bar", "digit_leg", "five_bar", "stewart_platform", "spherical_four_bar", "slider_crank")

#: Numbers far from those of a robot.
_EXTREME = (0.0, -0.0, 1e-320, 1e-200, 1e-9, 1e5, 1e20, 1e155, -1e155, 1e200, 1e308, -1e308, math.pi, 1e15)
_NOT_FINITE = (math.nan, math.inf, -math.inf)

#: In place of an argument.
_WRONG: tuple[Any, ...] = (None, "", "x", [], [[]], {}, True, -1, 10**400, [None], ["x"], [[1.0, 2.0], [3.0]], {"a": 1})

#: Of which space a parameter is a vector: its configurations, its velocities or its actuators.
_SPACES = {
    **dict.fromkeys(("q", "q0"), "nq"),
    **dict.fromkeys(("v", "a", "tau", "weights"), "nv"),
    **dict.fromkeys(("u", "actuated", "v_actuated", "q_actuated"), "nu"),
    **dict.fromkeys(("v_free", "q_free"), "free"),
}


def call_of(chance: random.Random) -> dict[str, Any]:
    """A call as plain data: the robot, the function and its arguments."""
    name = chance.choice(ROBOTS)
    function = chance.choice(sorted(functions()))
    arguments = {}
    for parameter in list(inspect.signature(functions()[function]).parameters.values())[1:]:
        if parameter.default is inspect.Parameter.empty or chance.random() < 0.3:
            arguments[parameter.name] = _argument(parameter.name, robot_of(name), chance)
    return {"robot": name, "function": function, "arguments": arguments}


@cache
def functions() -> dict[str, Callable[..., Any]]:
    """The public functions whose first parameter is a robot, by name."""
    modules = (eurdf, eurdf.kinematics, eurdf.springs, eurdf.transmissions)
    found = {name: getattr(module, name) for module in modules for name in dir(module)}
    found = {name: each for name, each in found.items() if inspect.isfunction(each) and not name.startswith("_")}
    return {name: each for name, each in found.items() if next(iter(inspect.signature(each).parameters), "") == "robot"}


@cache
def robot_of(name: str) -> eurdf.Robot:
    """A robot of the collection."""
    return eurdf.load(name, geometry=False)


def try_call(call: Mapping[str, Any]) -> str:
    """Make a call.

    Returns:
        What it came to: ``refused`` or ``answered``.

    Raises:
        AssertionError: The answer is not a number.
        Exception: One that should not have left the package.
    """
    arguments = {name: _array(value) for name, value in call["arguments"].items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            answer = functions()[call["function"]](robot_of(call["robot"]), **arguments)
        except np.linalg.LinAlgError:
            raise
        except (eurdf.EurdfError, ValueError, TypeError) as error:
            if not str(error):
                raise AssertionError(f"{type(error).__name__} without a message") from error
            return "refused"
    assert not _has_nan(answer), "the answer has NaN"
    return "answered"


def _argument(name: str, robot: eurdf.Robot, chance: random.Random) -> Any:
    if chance.random() < 0.1:
        return chance.choice(_WRONG)
    if name in _SPACES:
        return _vector(_size(_SPACES[name], robot), name, robot, chance)
    frames = [frame.name for frame in robot.model.frames]
    frame = chance.choice(frames if chance.random() < 0.8 else NAMES)
    joints = [*robot.model.names, *NAMES[:12]]
    match name:
        case "frame":
            return frame
        case "twist":
            return _numbers(6, chance)
        case "targets":
            return {frame: _numbers(chance.choice((3, 3, 7, 1)), chance)}
        case "external":
            return {frame: _numbers(6, chance)}
        case "actuator":
            return chance.choice((*robot.actuation.joints, *robot.actuation.joints, *joints))
        case "joints" | "hold":
            return chance.sample(joints, chance.randrange(4))
        case "gains":
            return _numbers(2, chance)
        case "duration" | "step":
            return chance.choice((1e-3, 5e-3, *_EXTREME[:5], *_NOT_FINITE, -1.0))
        case "steps" | "restarts":
            return chance.choice((-1, 0, 1, 2, 1.5, "2"))
        case "tolerance" | "singular":
            return chance.choice((*_EXTREME, *_NOT_FINITE, -1.0))
        case "dissipation":
            return chance.choice((True, False, "no"))
        case "limits":
            return chance.choice((True, False, "no", None))
        case _:
            return chance.choice(_WRONG)


def _size(space: str, robot: eurdf.Robot) -> int:
    nq, nv, nu = int(robot.model.nq), int(robot.model.nv), len(robot.actuation.idx_v)
    return {"nq": nq, "nv": nv, "nu": nu, "free": nv - nu}[space]


def _vector(size: int, name: str, robot: eurdf.Robot, chance: random.Random) -> Any:
    if chance.random() < 0.1:
        size = chance.choice((0, 1, max(0, size - 1), size + 1, 2 * size, 1000))
    if name in ("q", "q0") and chance.random() < 0.6 and robot.configurations:
        found = [float(x) for x in chance.choice(list(robot.configurations.values()))]
        if chance.random() < 0.5 and found:
            found[chance.randrange(len(found))] = chance.choice((*_EXTREME, chance.uniform(-3, 3)))
        return found
    return _numbers(size, chance)


def _numbers(size: int, chance: random.Random) -> list[float]:
    scale = chance.choice((1.0, 1.0, 1.0, 1e-6, 1e3))
    numbers = [chance.uniform(-scale, scale) for _ in range(size)]
    if numbers and chance.random() < 0.4:
        choices = _NOT_FINITE if chance.random() < 0.3 else _EXTREME
        numbers[chance.randrange(size)] = chance.choice(choices)
    return numbers


def _array(value: Any) -> Any:
    """Lists of numbers as the arrays that users have."""
    if isinstance(value, dict):
        return {key: _array(each) for key, each in value.items()}
    is_numbers = isinstance(value, list) and all(isinstance(each, float) for each in value)
    return np.array(value) if is_numbers else value


def _has_nan(value: Any) -> bool:
    if isinstance(value, float | np.ndarray):
        return bool(np.isnan(value).any()) if not isinstance(value, np.ndarray) or value.dtype.kind == "f" else False
    if isinstance(value, Mapping):
        return any(map(_has_nan, value.values()))
    if isinstance(value, tuple | list):
        return any(map(_has_nan, value))
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return any(_has_nan(getattr(value, each.name)) for each in dataclasses.fields(value))
    return False
