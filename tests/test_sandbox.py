"""What runs where the operating system lacks what Linux has: tried on Linux without it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import eurdf
from support.places import ROOT
from support.stl import TETRAHEDRON

OTHER_SYSTEM = ROOT / "tests" / "support" / "other_system"

IMPORT_EVERYTHING = """
import importlib, pkgutil, sys
import eurdf
from sitecustomize import MODULES
for module in pkgutil.walk_packages(eurdf.__path__, "eurdf."):
    try:
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    except eurdf.errors.MissingExtra as missing:
        print(missing)
    except ModuleNotFoundError as error:
        root = error.name.split(".")[0]
        if root in ("eurdf", *MODULES):
            raise
        print(root, "is not installed")
"""

XACRO = """\
<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="file" default="none"/>
<link name="a"><visual><geometry><mesh filename="$(arg file)"/></geometry></visual></link></robot>
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folders = map(str, (OTHER_SYSTEM, Path(eurdf.__file__).parents[1]))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(folders))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*arguments: str) -> str:
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def test_every_module_is_imported_without_posix(here: Path) -> None:
    run("-c", IMPORT_EVERYTHING)


def test_robots_are_read_and_written_without_posix(here: Path) -> None:
    Path("a.stl").write_bytes(TETRAHEDRON)
    Path("r.urdf.xacro").write_text(XACRO)
    arguments = ("r.urdf.xacro", "--xacro-arg", "file:=a.stl")
    assert ": valid" in run("-m", "eurdf", "check", *arguments)
    assert "a.stl" in run("-m", "eurdf", "export", *arguments, "--to", "mjcf", "-o", "mjcf")
    for force in ((), ("--force",)):
        run("-m", "eurdf", "export", "four_bar", "--to", "mjcf", "-o", "out", *force)
        run("-m", "eurdf", "import", "out/robot.xml", "-o", "imported", *force)
    assert ": valid" in run("-m", "eurdf", "check", "imported")
    assert not list(here.rglob(".eurdf*"))


def test_version_says_what_the_system_does_not_bound(here: Path) -> None:
    assert "does not bound the memory" in run("-m", "eurdf", "--version")
