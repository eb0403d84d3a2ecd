"""Tello's rods and differentials against the constraints that its makers derived."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

import numpy as np

import eurdf

#: Angles of Tello's own in the pose that is drawn, where they are not 0 (rad).
HIP_CRANK, ANKLE_CRANK = 0.15685349478899657, -4.583900721089e-05


def hip(y: complex, roll: complex, pitch: complex, side: float) -> complex:
    """Constraint of a hip motor as ``derive_tello_hip_differential.m`` of generalized_rbda 45fa7c4 has it, m²."""
    s, c = cmath.sin, cmath.cos
    return (
        57 / 2500 * s(y)
        - 49 / 5000 * c(roll)
        - side * 399 / 20000 * s(roll)
        - 8 / 625 * c(y) * c(pitch)
        - 57 / 2500 * c(roll) * s(pitch)
        - side * 7 / 625 * s(y) * s(roll)
        + side * 7 / 625 * s(roll) * s(pitch)
        - 8 / 625 * c(roll) * s(y) * s(pitch)
        + 3021 / 160000
    )


def ankle(crank: complex, ankle: complex) -> complex:
    """That of the ankle as ``derive_tello_knee_ankle_differential.m`` has it, m²; half the difference is -crank."""
    s, c, pi = cmath.sin, cmath.cos, math.pi
    return (
        21 / 6250 * c(-crank + 1979 * pi / 4500)
        - 13 / 625 * c(-crank + 493 * pi / 1500)
        - 273 / 12500 * c(pi / 9)
        - 7 / 2500 * s(-crank + ankle + 231 * pi / 500)
        + 91 / 5000 * s(ankle + 2 * pi / 15)
        - 147 / 50000 * s(ankle + pi / 45)
        + 163349 / 6250000
    )


def derivative(function: Callable[..., complex], *at: float) -> list[float]:
    """The partial derivatives, by complex steps: exact to the last bits."""
    step = 1e-30
    return [function(*(x + 1j * step * (n == k) for n, x in enumerate(at))).imag / step for k in range(len(at))]


def test_constraints_are_those_of_the_derivation_at_any_pose() -> None:
    robot = eurdf.load("tello", root="fixed", geometry=False)
    at = robot.slots
    rows = {constraint.name: row for row, constraint in enumerate(robot.constraints)}
    random = np.random.default_rng(11)
    for _ in range(5):
        values = {name: [random.uniform(-0.8, 0.8)] for name in at}
        q = robot.configuration(values)
        r, K = eurdf.residual_and_jacobian(robot, q)
        angle = {name: value for name, (value,) in values.items()}
        expected = {
            f"left_hip_rod_{number}": (
                lambda y, roll, pitch, side=side: hip(y + HIP_CRANK, roll, pitch, side),
                (f"left_motor_hip_{number}", "left_free_hip_x", "left_free_hip_y"),
                0.155,
            )
            for number, side in ((1, 1.0), (2, -1.0))
        } | {
            "left_ankle_rod": (
                lambda crank, foot: ankle(crank + ANKLE_CRANK, foot),
                ("left_free_crank", "left_free_ankle"),
                0.2146,
            )
        }
        for name, (function, joints, length) in expected.items():
            row, coordinates = rows[name], [angle[joint] for joint in joints]
            distance = r[row] + length
            np.testing.assert_allclose(distance**2 - length**2, function(*coordinates).real, atol=1e-14)
            gradient = np.zeros(robot.model.nv)
            gradient[[at[joint].idx_v for joint in joints]] = derivative(function, *coordinates)
            np.testing.assert_allclose(2.0 * distance * K[row], gradient, atol=1e-14)


def test_knee_is_the_mean_of_its_motors() -> None:
    robot = eurdf.load("tello", geometry=False)
    for name in ("bent", "wide"):
        q = robot.configurations[name]
        angle = {joint: q[slot.idx_q] for joint, slot in robot.slots.items()}
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        for side in ("left", "right"):
            one, two = (angle[f"{side}_motor_knee_{number}"] for number in (1, 2))
            np.testing.assert_allclose(angle[f"{side}_free_knee"], (one + two) / 2, atol=1e-14)
            np.testing.assert_allclose(angle[f"{side}_free_crank"], (two - one) / 2, atol=1e-14)
