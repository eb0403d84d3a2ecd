"""Gives the tests their options, fixtures and hooks."""

from __future__ import annotations

import pytest


def pytest_addoption(pluginmanager: pytest.PytestPluginManager) -> None:
    """The tests of the suite, in another folder, have the same plug-in."""
    pluginmanager.import_plugin("support.session")
