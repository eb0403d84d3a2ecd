"""The npm packages that tests use: those that the adapters in JavaScript import, and axe-core."""

from __future__ import annotations

import shutil
from pathlib import Path

#: Where ``npm install --prefix tests/support/javascript`` installs them.
MODULES = Path(__file__).parent / "javascript" / "node_modules"


def why_not_installed(*packages: str) -> str:
    """Why a program for Node.js that imports some packages cannot be run; empty if it can."""
    if shutil.which("node") is None:
        return "Node.js is not on the PATH: install it, then npm install --prefix tests/support/javascript"
    missing = [package for package in packages if not (MODULES / package).is_dir()]
    if missing:
        return f"{', '.join(missing)} is not installed: npm install --prefix tests/support/javascript"
    return ""
