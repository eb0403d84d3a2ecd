"""The measurements run on the robots that they name; that of dynamics first compares accelerations with its peer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import pytest

from benchmarks import derivatives, dynamics, forward_kinematics, inverse_kinematics, simulation


def _once(functions: Sequence[Callable[[], Any]], repeats: int = 1, seconds: float = 0.0) -> list[float]:
    for function in functions:
        function()
    return [1.0] * len(functions)


@pytest.mark.parametrize("name", ["digit_leg", "stewart_platform", "tello", "double_wishbone"])
@pytest.mark.parametrize("measurement", [derivatives, dynamics, forward_kinematics, inverse_kinematics, simulation])
def test_measurement_runs(measurement: ModuleType, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measurement, "least_times", _once)
    row = measurement._rows if measurement is dynamics else measurement._row
    assert row(name)
