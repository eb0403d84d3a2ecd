"""Lets ``pytest conformance/ --parser=…`` have the options and the fixtures of the suite."""

from __future__ import annotations

import pytest


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    """Load the plug-in, if the command line has not done so."""
    pluginmanager.import_plugin("eurdf_conformance.suite.plugin")
