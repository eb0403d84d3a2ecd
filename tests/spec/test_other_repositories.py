"""What other repositories use of this one: the pre-commit hook, the GitHub action, the entry in a catalogue."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import pytest
import yaml

from eurdf.format.schema import FILES
from support.places import ROOT

HOOKS = ROOT / ".pre-commit-hooks.yaml"
ACTION = ROOT / "action.yml"


def repository(folder: Path, *, broken: bool) -> Path:
    """A repository with two robots, one of them deep inside, sound or with a frame that does not exist."""
    for place in ("robots/a", "deep/er/b"):
        shutil.copytree(ROOT / "robots" / "four_bar", folder / place)
    if broken:
        path = folder / "deep/er/b/robot.yaml"
        path.write_text(path.read_text().replace("rocker_pin_a", "rocker_pin_x"))
    return folder


def environment(**more: str) -> dict[str, str]:
    """With the eurdf of this Python first on the PATH."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT / "reference"), **more}


def test_hook_is_valid_for_pre_commit() -> None:
    pre_commit = [sys.executable, "-m", "pre_commit", "validate-manifest", str(HOOKS)]
    subprocess.run(pre_commit, check=True)


def test_hook_runs_on_the_files_of_robots() -> None:
    (hook,) = yaml.safe_load(HOOKS.read_text())
    for name, is_run in (("robot.yaml", True), ("a/leg.urdf", True), ("leg.urdf.xacro", True), ("xacro.md", False)):
        assert (re.search(hook["files"], name) is not None) == is_run


def run_the_hook(folder: Path) -> subprocess.CompletedProcess[str]:
    (hook,) = yaml.safe_load(HOOKS.read_text())
    command = [*hook["entry"].split(), *hook["args"]]
    return subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, check=False)


@pytest.mark.parametrize("broken", [False, True], ids=["sound", "broken"])
def test_hook_passes_valid_repository(tmp_path: Path, broken: bool) -> None:
    found = run_the_hook(repository(tmp_path, broken=broken))
    assert found.returncode == (1 if broken else 0), found.stdout + found.stderr
    assert ("unknown-frame" in found.stdout) == broken


#: Files of repositories without robots.
OTHERS = {
    "no file": [],
    "one YAML file": ["mkdocs.yml"],
    "several YAML files": [".github/workflows/ci.yml", "mkdocs.yml", "config.yaml", "deep/er/settings.yaml"],
}


def other_repository(folder: Path, files: list[str]) -> Path:
    folder.mkdir(exist_ok=True)
    for name in files:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("site_name: A site\n")
    return folder


@pytest.mark.parametrize("files", OTHERS.values(), ids=OTHERS)
def test_hook_passes_repository_without_robots(tmp_path: Path, files: list[str]) -> None:
    found = run_the_hook(other_repository(tmp_path, files))
    assert (found.returncode, found.stdout, found.stderr) == (0, ".: no robot\n", "")


def test_action_is_valid_for_github() -> None:
    check = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.github-actions", str(ACTION)]
    subprocess.run(check, check=True)


def run_the_action(folder: Path, paths: str, sarif: Path, output: Path) -> subprocess.CompletedProcess[str]:
    (step,) = (step for step in yaml.safe_load(ACTION.read_text())["runs"]["steps"] if step.get("id") == "check")
    return subprocess.run(
        ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
        cwd=folder,
        env=environment(PATHS=paths, SARIF=str(sarif), GITHUB_OUTPUT=str(output)),
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("broken", [False, True], ids=["sound", "broken"])
def test_action_writes_sarif_and_fails_with_check(tmp_path: Path, broken: bool) -> None:
    sarif, output = tmp_path / "found.sarif", tmp_path / "output"
    found = run_the_action(repository(tmp_path / "repository", broken=broken), "robots deep", sarif, output)
    assert found.returncode == (1 if broken else 0), found.stdout + found.stderr
    assert output.read_text() == f"sarif={sarif}\n"
    results: list[dict[str, Any]] = json.loads(sarif.read_text())["runs"][0]["results"]
    assert [result["ruleId"] for result in results] == (["unknown-frame"] if broken else [])
    assert ("unknown-frame" in found.stdout) == broken


@pytest.mark.parametrize("files", OTHERS.values(), ids=OTHERS)
def test_action_passes_repository_without_robots(tmp_path: Path, files: list[str]) -> None:
    sarif, output = tmp_path / "found.sarif", tmp_path / "output"
    found = run_the_action(other_repository(tmp_path / "repository", files), ".", sarif, output)
    assert (found.returncode, found.stdout) == (0, ".: no robot\n"), found.stderr
    assert json.loads(sarif.read_text())["runs"][0]["results"] == []


def test_catalogue_entry_matches_only_our_files() -> None:
    entry = json.loads((ROOT / "schema" / "catalog.json").read_text())
    assert set(entry) == {"name", "description", "fileMatch", "url", "versions"}
    assert entry["url"] == entry["versions"]["2.0"]
    names = {version: url.rpartition("/")[2] for version, url in entry["versions"].items()}
    assert names == {"1": FILES["1"], "2.0": FILES["2"], "2.1": FILES["2.1"]}
    assert any(fnmatch("leg.eurdf.yaml", pattern) for pattern in entry["fileMatch"])
    assert not any(fnmatch(name, pattern) for name in ("robot.yaml", "config.yml") for pattern in entry["fileMatch"])


def test_action_uploads_nothing_for_missing_path(tmp_path: Path) -> None:
    output = tmp_path / "output"
    found = run_the_action(other_repository(tmp_path / "repository", []), "robtos", tmp_path / "found.sarif", output)
    assert found.returncode == 2
    assert "there is no 'robtos'" in found.stderr
    assert not output.exists()
