"""Damped steps: by eigenvalues, and by singular values where these are in doubt."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from eurdf.kinematics.damped_step import damped_step


@pytest.mark.parametrize("damping", [1e-2, 1e-10])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("smallest", "decomposed"), [(1e-2, 0), (1e-6, 1), (0.0, 0)])
def test_step_minimises_damped_error(
    smallest: float, decomposed: int, size: float, damping: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    random = np.random.default_rng(0)
    left, right = (np.linalg.qr(random.normal(size=(n, n)))[0] for n in (3, 5))
    values, e = size * np.array([1.0, 0.3, smallest]), random.normal(size=3)
    A, damping = (left * values) @ right[:3], damping * size**2
    # Where |A y + e|² + λ|y|² is least, its part along a singular value s is -s/(s² + λ).
    expected = -right[:3].T @ (values / (values**2 + damping) * (left.T @ e))
    counted: list[Any] = []
    svd = np.linalg.svd
    monkeypatch.setattr(np.linalg, "svd", lambda *given, **options: counted.append(given) or svd(*given, **options))
    found = damped_step(A, e, damping)
    assert len(counted) == decomposed
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())
    np.testing.assert_allclose(right[3:] @ found, 0.0, atol=1e-9 * np.abs(found).max())
