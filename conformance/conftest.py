"""Lets ``pytest conformance/ --parser=…`` have the options and the fixtures of the suite.

The suite's own tests are in ``conformance/tests``: only a run that names this folder, or none, collects them, and it
has the hooks of the project's tests in place of the suite.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eurdf_conformance.needed import REQUIRED, missing, needs

_HERE = Path(__file__).parent
_ROOT = _HERE.parent
_TESTS = _HERE / "tests"

# The reference parser is eurdf, and the suite uses its dependencies; the options in pyproject.toml are those of xdist.
_NEEDED = ("eurdf", *REQUIRED, "xdist")

# All items are in `suite`: to look for some in every folder of the corpus takes longer than to read it.
collect_ignore = [str(path) for path in (_HERE / "eurdf_conformance").iterdir() if path.name != "suite"] + [str(_TESTS)]


def _named(config: pytest.Config) -> list[Path]:
    """The files and folders that the command line names; the working folder if there are none."""
    names = config.known_args_namespace.file_or_dir or [""]
    return [Path(config.invocation_params.dir, name.partition("::")[0]).resolve() for name in names]


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    """Load the plug-in, if the command line has not done so.

    Raises:
        pytest.UsageError: A package that it imports is not installed.
    """
    config = pluginmanager.getplugin("pytestconfig")
    assert isinstance(config, pytest.Config)
    if not any(path.is_relative_to(_HERE) and not path.is_relative_to(_TESTS) for path in _named(config)):
        pluginmanager.import_plugin("support.session")
        return
    if lacking := missing(_NEEDED):
        raise pytest.UsageError(needs([os.fspath(_ROOT) if name == "eurdf" else name for name in lacking]))
    pluginmanager.import_plugin("eurdf_conformance.suite.plugin")
