"""Options of the tests."""

from __future__ import annotations

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("damaged robots")
    group.addoption("--mutations", type=int, default=2600, metavar="N", help="damaged robots to try (default: 2600)")
    group.addoption(
        "--mutation-seed", type=int, default=0, metavar="SEED", help="from which they are drawn (default: 0)"
    )
