"""Rotations and rigid motions: exponentials and logarithms are inverses, and derivatives are those of differences."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.closures import se3

seeds = st.integers(0, 2**32 - 1)
#: Angles in rad: of closed loops, on both sides of where series end, and nearly half a turn.
angles = st.sampled_from([0.0, 1e-9, 1e-5, 0.01, 0.49, 0.51, 1.0, 2.5, 3.1])


def twists(seed: int, angle: float) -> Any:
    """Twists (4, 2, 6) that turn by an angle."""
    random = np.random.default_rng(seed)
    turn = random.normal(size=(4, 2, 3))
    turn *= angle / se3.norm(turn)[..., None]
    return np.concatenate((random.uniform(-1.0, 1.0, (4, 2, 3)), turn), axis=-1)


def derivative(f: Callable[[float], Any], step: float = 1e-3) -> Any:
    return (8.0 * (f(step) - f(-step)) - f(2.0 * step) + f(-2.0 * step)) / (12.0 * step)


def near(found: Any, expected: Any, tolerance: float = 1e-9) -> None:
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance)


@settings(deadline=None, max_examples=50)
@given(seeds, angles)
def test_logarithm_is_inverse_of_exponential_and_equals_pinocchio(seed: int, angle: float) -> None:
    v = twists(seed, angle)
    R, p = se3.exp6(v)
    near(se3.log6(R, p), v)
    near(se3.rotation_of(se3.quaternion_of(R)), R, 1e-12)
    for twist, rotation, position in zip(v.reshape(-1, 6), R.reshape(-1, 3, 3), p.reshape(-1, 3), strict=True):
        near(pin.exp6(twist).homogeneous[:3], np.column_stack((rotation, position)), 1e-12)
        near(pin.Jlog6(pin.exp6(twist)), se3.log6_derivative(twist))
        near(pin.Jlog3(rotation), se3.log3_derivative(twist[3:]))


@settings(deadline=None, max_examples=50)
@given(seeds, angles)
def test_derivatives_of_logarithm(seed: int, angle: float) -> None:
    v, rate, acceleration = twists(seed, min(angle, 3.0)), twists(seed + 1, 0.7), twists(seed + 2, 0.5)
    near(se3.exp6_derivative(v) @ se3.log6_derivative(v), np.broadcast_to(np.eye(6), (4, 2, 6, 6)))
    # With ξ(t) = J(r)⁻¹ ṙ, r̈ of a curve r + t ṙ + t² a / 2 is a.
    curve = lambda t: v + t * rate + 0.5 * t * t * acceleration  # noqa: E731
    twist = lambda t: se3.turned(se3.exp6_derivative(curve(t)), rate + t * acceleration)  # noqa: E731
    near(se3.log6_second(v, twist(0.0), derivative(twist)), acceleration, 1e-7)


@settings(deadline=None, max_examples=20)
@given(seeds)
def test_quaternions_multiply_as_rotations(seed: int) -> None:
    a, b = (se3.quaternion_exp(twists(seed + k, 2.0)[..., 3:]) for k in range(2))
    near(se3.rotation_of(se3.quaternion_product(a, b)), se3.rotation_of(a) @ se3.rotation_of(b), 1e-12)
    near(se3.turned(se3.skew(a[..., :3]), b[..., :3]), np.cross(a[..., :3], b[..., :3]), 1e-12)
