"""Solutions that depend on ranks: by singular values only where ranks are in doubt."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.kinematics.rank import damped_step, least_solution
from eurdf.kinematics.tolerances import CERTAIN


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
    (found,) = damped_step(A[None], e[None], np.array([damping]))
    assert len(counted) == decomposed
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())
    np.testing.assert_allclose(right[3:] @ found, 0.0, atol=1e-9 * np.abs(found).max())


def solution(A: Any, b: Any, norm: float | None = None) -> tuple[Any, bool]:
    """The least solution of A x = b, and whether there is one beyond doubt."""
    size = float(np.linalg.norm(A)) if norm is None else norm
    (x,), (sure,) = least_solution(A[None], b[None, :, None], np.array([size]))
    return x[:, 0], bool(sure)


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_rank_is_certain_above_the_stated_number_only(scale: float) -> None:
    random = np.random.default_rng(0)
    left, right = (np.linalg.qr(random.normal(size=(n, n)))[0] for n in (4, 6))
    values = np.array([1.0, 0.7, 0.3, scale * CERTAIN])
    A = left @ np.diag(values) @ right[:4]
    norm = float(np.linalg.norm(A))
    found, sure = solution(A, left[:, 0], norm)
    assert sure == (scale > norm)
    if sure:
        np.testing.assert_allclose(found, right[0], rtol=0.0, atol=1e-11)


@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 8), rank=st.integers(1, 8), columns=st.integers(1, 8))
@settings(max_examples=200, deadline=None)
def test_least_solution_equals_the_pseudoinverse(seed: int, rows: int, rank: int, columns: int) -> None:
    random, rank = np.random.default_rng(seed), min(rank, rows, columns)
    A = random.normal(size=(rows, rank)) @ random.normal(size=(rank, columns))
    b = A @ random.normal(size=columns)
    found, sure = solution(A, b)
    values = np.linalg.svd(A, compute_uv=False)[:rank]
    if values[-1] > 1e-3 * np.linalg.norm(A):
        assert sure
    if sure:
        np.testing.assert_allclose(
            found, np.linalg.pinv(A, rcond=1e-9) @ b, rtol=0.0, atol=1e-8 * np.abs(b).max() + 1e-12
        )


def test_what_redundant_rows_contradict_has_no_solution() -> None:
    A = np.array([[1.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    assert not solution(A, np.array([1.0, 2.1, 0.0]))[1]
    np.testing.assert_allclose(solution(A, np.array([1.0, 2.0, 3.0]))[0], [1.0, 3.0])


def test_numbers_that_overflow_have_no_solution() -> None:
    with np.errstate(all="ignore"):
        assert not solution(np.array([[np.inf, 1.0]]), np.ones(1))[1]
