"""Lets ``pytest conformance/ --parser=…`` have the options and the fixtures of the suite."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eurdf_conformance.needed import REQUIRED, missing, needs

_ROOT = Path(__file__).parents[1]

# The reference parser is eurdf, and the suite uses its dependencies; the options in pyproject.toml are those of xdist.
_NEEDED = ("eurdf", *REQUIRED, "xdist")

# All tests are in `suite`: to look for some in every folder of the corpus takes longer than to read it.
collect_ignore = [str(path) for path in (Path(__file__).parent / "eurdf_conformance").iterdir() if path.name != "suite"]


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    """Load the plug-in, if the command line has not done so.

    Raises:
        pytest.UsageError: A package that it imports is not installed.
    """
    if lacking := missing(_NEEDED):
        raise pytest.UsageError(needs([os.fspath(_ROOT) if name == "eurdf" else name for name in lacking]))
    pluginmanager.import_plugin("eurdf_conformance.suite.plugin")
