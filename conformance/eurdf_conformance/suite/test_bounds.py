"""Every robot at a bound, and beyond it."""

from __future__ import annotations

import pytest

from eurdf_conformance.judging.judge import judge
from eurdf_conformance.suite.item import BoundItem, bound_items
from eurdf_conformance.suite.item_runner import ItemRunner
from eurdf_conformance.suite.options import options_of


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test an item; a smoke run has none."""
    options = options_of(metafunc.config)
    items = [] if options.smoke else [item for item in bound_items() if options.wants(item.item)]
    metafunc.parametrize("bound_item", [pytest.param(item, id=f"{item.item.id}/{item.item.level}") for item in items])


def test_bound(bound_item: BoundItem, item_runner: ItemRunner) -> None:
    """The parser accepts a robot at the bound and rejects one beyond it."""
    item, case = bound_item.item, bound_item.case
    item_runner.run(item, lambda: judge(case, item.level, item_runner.conversation), case)
