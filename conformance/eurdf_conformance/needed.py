"""What the suite needs beside the dependencies of eurdf, and what installs it where it is missing.

Nothing but the standard library is imported here, so that a missing package is reported before an import fails.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec

#: Modules without which there is no run.
REQUIRED = ("pytest", "hypothesis", "ruamel.yaml")

# Where a module is not called as the distribution that has it.
_DISTRIBUTIONS = {"xdist": "pytest-xdist"}


def missing(names: Iterable[str] = REQUIRED) -> list[str]:
    """Those of some modules that cannot be imported."""
    return [name for name in names if not is_installed(name)]


def is_installed(name: str) -> bool:
    """Whether a module can be imported; a folder that an uninstalled package has left behind is none."""
    try:
        found = find_spec(name)
    except ModuleNotFoundError:  # the package that it is in
        return False
    return found is not None and found.origin is not None


def needs(names: Iterable[str]) -> str:
    """The message that packages are missing, and how to install them."""
    missing = " ".join(_DISTRIBUTIONS.get(name, name) for name in names)
    return f"the conformance suite needs packages that are not installed; install them with: pip install {missing}"
