"""The message where an optional dependency is not installed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import pytest

from eurdf.diagnostics import extras
from support.places import ROOT

WITHOUT = "import sys; sys.modules.update(dict.fromkeys({names})); import pytest; sys.exit(pytest.main(sys.argv[1:]))"


def installed_from(monkeypatch: pytest.MonkeyPatch, origin: dict[str, Any] | None) -> None:
    """Let the package be one that was installed from somewhere; None for an index."""

    class Package:
        def read_text(self, name: str) -> str | None:
            assert name == "direct_url.json"
            return None if origin is None else json.dumps(origin)

    monkeypatch.setattr(extras, "distribution", lambda name: Package())
    monkeypatch.setattr(extras, "_pip_is_ours", lambda: True)


def checkout(folder: Path) -> Path:
    """A folder that has the suite, as a checkout has."""
    (folder / "conformance").mkdir(parents=True)
    return folder


def not_installed(name: str) -> None:
    raise PackageNotFoundError(name)


@pytest.mark.parametrize(
    ("origin", "command"),
    [
        ({"url": "HERE", "dir_info": {}}, 'pip install ".[xacro]"'),
        ({"url": "HERE", "dir_info": {"editable": True}}, 'pip install -e ".[xacro]"'),
        ({"url": "file:///elsewhere", "dir_info": {}}, 'pip install "eurdf[xacro]"'),
        ({"url": "file:///a/eurdf.whl", "archive_info": {}}, 'pip install "eurdf[xacro]"'),
        (None, 'pip install "eurdf[xacro]"'),
    ],
    ids=["clone", "editable", "another folder", "wheel", "index"],
)
def test_install_command_matches_package_origin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, origin: dict[str, Any] | None, command: str
) -> None:
    clone = tmp_path / "a clone"
    clone.mkdir()
    if origin is not None:
        origin = {**origin, "url": origin["url"].replace("HERE", clone.as_uri())}
    installed_from(monkeypatch, origin)
    monkeypatch.chdir(clone)
    assert extras.install_command("xacro") == command


def test_uninstalled_checkout_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(extras, "distribution", not_installed)
    monkeypatch.setattr(extras, "_pip_is_ours", lambda: True)
    monkeypatch.chdir(tmp_path)
    assert extras.install_command("xacro") == f'pip install "{ROOT}[xacro]"'
    monkeypatch.chdir(ROOT)
    assert extras.install_command("xacro") == 'pip install ".[xacro]"'


def test_pip_of_other_python_is_not_suggested(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    assert extras.install_command("xacro").startswith(f"{sys.executable} -m pip install ")


@pytest.mark.parametrize(
    ("origin", "command"),
    [
        ({"url": "CHECKOUT", "dir_info": {}}, 'pip install "CHECKOUT/conformance"'),
        ({"url": "CHECKOUT", "dir_info": {"editable": True}}, 'pip install -e "CHECKOUT"'),
        ({"url": "file:///elsewhere", "dir_info": {}}, "pip install eurdf-conformance"),
        (None, "pip install eurdf-conformance"),
    ],
    ids=["checkout", "editable", "a folder that is gone", "index"],
)
def test_suite_is_installed_from_package_origin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, origin: dict[str, Any] | None, command: str
) -> None:
    folder = checkout(tmp_path / "a checkout")
    if origin is not None:
        origin = {**origin, "url": origin["url"].replace("CHECKOUT", folder.as_uri())}
    installed_from(monkeypatch, origin)
    assert extras.install_suite_command() == command.replace("CHECKOUT", str(folder))


def test_page_is_built_in_a_checkout_and_by_installation_elsewhere(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(ROOT)
    assert extras.build_page_command() == "npm install --prefix js && npm run build --prefix js"
    monkeypatch.chdir(tmp_path)
    assert extras.build_page_command().endswith(f'npm run build --prefix "{ROOT / "js"}"')
    monkeypatch.setattr(extras, "_CHECKOUT", tmp_path)
    for origin, name in (({"url": tmp_path.as_uri(), "dir_info": {}}, f'"{tmp_path}"'), (None, "eurdf")):
        installed_from(monkeypatch, origin)
        assert extras.build_page_command() == f"pip install --force-reinstall --no-deps {name}"


@pytest.mark.parametrize(
    ("names", "packages"),
    [(["hypothesis", "ruamel.yaml", "xdist"], "hypothesis ruamel.yaml pytest-xdist"), (["eurdf"], str(ROOT))],
    ids=["of the suite", "eurdf"],
)
def test_suite_says_how_to_install_missing_packages(names: list[str], packages: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT.format(names=names), "conformance/", "--collect-only"],
        cwd=ROOT,
        env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    said = done.stdout + done.stderr
    assert f"not installed; install them with: pip install {packages}\n" in said
    assert "Traceback" not in said
