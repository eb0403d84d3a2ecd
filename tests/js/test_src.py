"""The tests of the package in JavaScript that need no browser: Node.js runs them."""

from __future__ import annotations

import subprocess

import pytest

from support.processes import JAVASCRIPT, why_not_installed

MISSING = why_not_installed("yaml", "saxes")


@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_own_tests_of_the_package_pass() -> None:
    files = sorted((JAVASCRIPT / "tests").glob("*.test.js"))
    assert files
    done = subprocess.run(["node", "--test", *files], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
