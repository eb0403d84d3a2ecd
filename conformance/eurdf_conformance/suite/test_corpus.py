"""Every case, at every one of its levels that the reader claims."""

from __future__ import annotations

import pytest

from eurdf_conformance.suite.asking import Asking, all_cases
from eurdf_conformance.suite.item import CaseItem, case_items
from eurdf_conformance.suite.judge import judge
from eurdf_conformance.suite.options import options_of
from eurdf_conformance.suite.smoke import is_smoke


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test an item."""
    options = options_of(metafunc.config)
    items = [item for item in case_items(all_cases()) if options.wants(item.item)]
    if options.smoke:
        items = [item for item in items if is_smoke(item)]
    # The levels of one case are asked one after the other of one reader, which loads it once.
    marked = [
        pytest.param(
            item, id=f"{item.item.id}/{item.item.level}", marks=pytest.mark.xdist_group(_group(item, options.smoke))
        )
        for item in items
    ]
    metafunc.parametrize("case_item", marked)


def test_case(case_item: CaseItem, asking: Asking) -> None:
    """The answers of the reader on the case are the expected ones."""
    asking.settle(
        case_item.item, lambda: judge(case_item.case, case_item.item.level, asking.conversation), case_item.case
    )


def _group(item: CaseItem, smoke: bool) -> str:
    return "smoke" if smoke else item.case.id
