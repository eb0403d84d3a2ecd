"""Options of the tests."""

from __future__ import annotations

import pytest


def pytest_configure(config: pytest.Config) -> None:
    # Here, and not where pytest is configured: the conformance suite runs with whatever plug-ins its users have.
    config.addinivalue_line("filterwarnings", "error")


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("damaged robots")
    group.addoption("--mutations", type=int, default=2600, metavar="N", help="damaged robots to try (default: 2600)")
    group.addoption(
        "--mutation-seed", type=int, default=0, metavar="SEED", help="from which they are drawn (default: 0)"
    )
