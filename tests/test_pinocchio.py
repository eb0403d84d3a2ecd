"""Pinocchio's own derivatives are right for the model of every robot."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.pinocchio.model import build_model
from support import by_hand
from support.actuated import robot_called

STEP = 2e-3


def slopes(f: Callable[[float], np.ndarray]) -> np.ndarray:
    return (8.0 * (f(STEP) - f(-STEP)) - (f(2.0 * STEP) - f(-2.0 * STEP))) / (12.0 * STEP)


def model_called(name: str) -> pin.Model:
    if name != "every joint type":
        return robot_called(name).model
    model = build_model(by_hand.tree_of_all_types(np.random.default_rng(0)))
    for joint in range(1, model.njoints):
        model.inertias[joint] += pin.Inertia.Random()
    return model


@pytest.mark.parametrize("name", ["every joint type", *eurdf.collection_names()])
def test_derivatives_of_inverse_dynamics_equal_differences(name: str) -> None:
    model = model_called(name)
    data, random = model.createData(), np.random.default_rng(0)
    q = pin.integrate(model, pin.neutral(model), random.uniform(-1.0, 1.0, model.nv))
    v, a = random.uniform(-1.0, 1.0, (2, model.nv))
    found = [np.array(each) for each in pin.computeRNEADerivatives(model, data, q, v, a)[:2]]
    for each in np.eye(model.nv):
        k = int(each.argmax())
        by_q = slopes(lambda h: pin.rnea(model, data, pin.integrate(model, q, h * each), v, a).copy())  # noqa: B023
        by_v = slopes(lambda h: pin.rnea(model, data, q, v + h * each, a).copy())  # noqa: B023
        for derivative, expected in zip(found, (by_q, by_v), strict=True):
            np.testing.assert_allclose(derivative[:, k], expected, atol=1e-8 * max(1.0, np.abs(derivative).max()))
