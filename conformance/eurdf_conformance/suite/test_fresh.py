"""Every fresh case, at each of its levels that the parser claims."""

from __future__ import annotations

import pytest

from eurdf_conformance.fresh.case import fresh_cases
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.suite.item import FreshItem, fresh_items
from eurdf_conformance.suite.item_runner import ItemRunner
from eurdf_conformance.suite.options import options_of


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test an item; a smoke run has none."""
    options = options_of(metafunc.config)
    items = [] if options.smoke else [item for item in fresh_items() if options.wants(item.item)]
    metafunc.parametrize("fresh_item", [pytest.param(item, id=f"{item.item.id}/{item.item.level}") for item in items])


def test_fresh(fresh_item: FreshItem, item_runner: ItemRunner) -> None:
    """The answers of the parser on the case are the expected ones."""
    item = fresh_item.item
    case = fresh_cases(item_runner.options.seed)[item.id]
    item_runner.run(item, lambda: judge(case, item.level, item_runner.conversation), case)
