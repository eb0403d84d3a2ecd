"""The names of the package: each is there, and looking at the package loads no simulator."""

from __future__ import annotations

import subprocess
import sys

import eurdf


def test_every_public_name_can_be_loaded() -> None:
    for name in eurdf.__all__:
        assert getattr(eurdf, name) is not None
    assert set(eurdf.__all__) <= set(dir(eurdf))


def test_a_name_that_is_not_there_is_an_attribute_error_that_says_so() -> None:
    assert not hasattr(eurdf, "lood")


def test_importing_the_package_loads_no_simulator() -> None:
    code = "import sys, eurdf; eurdf.Mechanism; assert 'pinocchio' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
