"""Wrong arguments of the functions of `eurdf.batch`: each gives a ValueError that names the argument."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

import eurdf

#: Annotations of parameters that are arrays, or mappings to arrays.
ARRAY = re.compile(r"\b(Vector|Matrix|Mapping\[str, Any\])")

ROWS = 2


@cache
def robot() -> eurdf.Robot:
    return eurdf.load("four_bar", geometry=False)


def valid() -> dict[str, dict[str, Any]]:
    """The arguments of a valid call of each function."""
    q = np.tile(robot().configurations["assembled"], (ROWS, 1))
    weights = np.ones(robot().model.nv)
    return {
        "actuated_jacobian": {"q": q, "frame": "coupler", "weights": weights},
        "forward_kinematics": {"values": q[:, robot().actuation.idx_q], "q0": q},
        "inverse_kinematics": {"targets": {"coupler": np.zeros((ROWS, 3))}, "q0": q},
        "project_configuration": {"q": q, "weights": weights},
        "residual": {"q": q},
        "residual_and_jacobian": {"q": q},
    }


def functions() -> dict[str, Callable[..., Any]]:
    return dict(inspect.getmembers(eurdf.batch, inspect.isfunction))


def parameters(pattern: re.Pattern[str]) -> Iterator[tuple[str, str]]:
    for name, function in functions().items():
        for parameter in inspect.signature(function).parameters.values():
            if pattern.search(f"{parameter.name}: {parameter.annotation}"):
                yield name, parameter.name


def test_every_function_and_array_is_tested() -> None:
    stated = {(name, parameter) for name, given in valid().items() for parameter in given}
    assert functions().keys() == valid().keys()
    assert set(parameters(ARRAY)) <= stated


@pytest.mark.parametrize("name", valid())
def test_valid_call_succeeds(name: str) -> None:
    functions()[name](robot(), **valid()[name])


@pytest.mark.parametrize(("name", "parameter"), list(parameters(ARRAY)))
@pytest.mark.parametrize("what", ["narrow", "wide", "deep", "nan", "inf", "text", "complex", "mapping", "ragged"])
def test_wrong_array_is_a_value_error(name: str, parameter: str, what: str) -> None:
    given = valid()[name][parameter]
    key, array = next(iter(given.items())) if isinstance(given, Mapping) else (None, given)
    bad: Any = {
        "narrow": np.zeros((*array.shape[:-1], array.shape[-1] - 1)),
        "wide": np.zeros((*array.shape[:-1], array.shape[-1] + 1)),
        "deep": np.zeros((1, 1, *array.shape)),
        "nan": np.full(array.shape, np.nan),
        "inf": np.full(array.shape, np.inf),
        "text": "abc",
        "complex": np.zeros(array.shape, dtype=complex),
        "mapping": {0: 1.0},
        "ragged": [[0.0], [0.0, 1.0]],
    }[what]
    with pytest.raises(ValueError, match=rf"^{parameter}\b"):
        functions()[name](robot(), **valid()[name] | {parameter: bad if key is None else {key: bad}})


@pytest.mark.parametrize(("name", "parameter"), list(parameters(re.compile("^(tolerance|block|threads|restarts):"))))
@pytest.mark.parametrize("bad", [-1, np.nan, np.inf, "1"])
def test_number_out_of_range_is_a_value_error(name: str, parameter: str, bad: Any) -> None:
    with pytest.raises(ValueError, match=rf"^{parameter} is .*expected"):
        functions()[name](robot(), **valid()[name] | {parameter: bad})
