"""Every case, at every one of its levels that the parser claims."""

from __future__ import annotations

import pytest

from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.level import Level
from eurdf_conformance.suite.item import CaseItem, case_items
from eurdf_conformance.suite.item_runner import ItemRunner
from eurdf_conformance.suite.options import Options, options_of
from eurdf_conformance.suite.smoke import smoke_levels


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test an item."""
    options = options_of(metafunc.config)
    items = [item for item in case_items(all_cases()) if options.wants(item.item)]
    if options.smoke:
        items = [item for item in items if item.item.level in smoke_levels(item)]
    metafunc.parametrize("case_item", [pytest.param(item, id=f"{item.item.id}/{item.item.level}") for item in items])


def test_case(case_item: CaseItem, item_runner: ItemRunner) -> None:
    """The parser gives the expected answers on the case."""
    item, case = case_item.item, case_item.case
    item_runner.run(
        item, lambda: judge(case, item.level, item_runner.conversation), case, _rather(case_item, item_runner.options)
    )


def _rather(item: CaseItem, options: Options) -> tuple[Level, ...]:
    """The levels that replace the level of the item in a smoke run."""
    levels = smoke_levels(item) if options.smoke else ()
    earlier = levels[: levels.index(item.item.level)] if levels else ()
    return tuple(level for level in earlier if level in options.levels)
