"""Lets ``pytest conformance/ --parser=…`` have the options and the fixtures of the suite."""

from __future__ import annotations

from pathlib import Path

import pytest

# All tests are in `suite`: to look for some in every folder of the corpus takes longer than to read it.
collect_ignore = [str(path) for path in (Path(__file__).parent / "eurdf_conformance").iterdir() if path.name != "suite"]


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    """Load the plug-in, if the command line has not done so."""
    pluginmanager.import_plugin("eurdf_conformance.suite.plugin")
