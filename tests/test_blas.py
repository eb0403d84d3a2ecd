"""How many threads BLAS has while the library computes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from eurdf.blas import MANY_VELOCITIES, ONE_THREAD
from eurdf.loading import of_any_robot


@pytest.fixture
def count() -> Iterator[Callable[[], int]]:
    """Tells the number of threads, which is two unless something changes it."""
    if ONE_THREAD._functions is None:
        pytest.skip("NumPy has another BLAS than OpenBLAS")
    number, set_number = ONE_THREAD._functions
    before = number()
    set_number(2)
    yield number
    set_number(before)


def test_the_last_to_leave_restores_the_threads(count: Callable[[], int]) -> None:
    with ONE_THREAD:
        with ONE_THREAD:
            assert count() == 1
        assert count() == 1
    assert count() == 2


@pytest.mark.parametrize(("velocities", "threads"), [(MANY_VELOCITIES, 1), (MANY_VELOCITIES - 1, 2)])
def test_large_robots_are_computed_on_one_thread(count: Callable[[], int], velocities: int, threads: int) -> None:
    robot: Any = SimpleNamespace(tree=SimpleNamespace(nv=velocities))
    assert of_any_robot(lambda robot: count())(robot) == threads
    assert count() == 2
