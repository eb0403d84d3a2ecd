"""What other repositories use of this one: the pre-commit hook, the GitHub action, the entry in a catalogue."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import pytest
import yaml

from eurdf.format.schema import FILES

ROOT = Path(__file__).parent.parent
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


def test_the_hook_is_one_that_pre_commit_takes() -> None:
    pre_commit = [sys.executable, "-m", "pre_commit", "validate-manifest", str(HOOKS)]
    subprocess.run(pre_commit, check=True)


@pytest.mark.parametrize("broken", [False, True], ids=["sound", "broken"])
def test_the_hook_passes_where_every_robot_of_the_repository_is_sound(tmp_path: Path, broken: bool) -> None:
    (hook,) = yaml.safe_load(HOOKS.read_text())
    command = [*hook["entry"].split(), *hook["args"]]
    found = subprocess.run(
        command, cwd=repository(tmp_path, broken=broken), env=environment(), capture_output=True, text=True, check=False
    )
    assert found.returncode == (1 if broken else 0), found.stdout + found.stderr
    assert ("unknown-frame" in found.stdout) == broken


def test_the_action_is_one_that_github_takes() -> None:
    check = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.github-actions", str(ACTION)]
    subprocess.run(check, check=True)


@pytest.mark.parametrize("broken", [False, True], ids=["sound", "broken"])
def test_the_action_writes_its_findings_as_sarif_and_fails_where_the_check_does(tmp_path: Path, broken: bool) -> None:
    (step,) = (step for step in yaml.safe_load(ACTION.read_text())["runs"]["steps"] if step.get("id") == "check")
    sarif, output = tmp_path / "found.sarif", tmp_path / "output"
    found = subprocess.run(
        ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
        cwd=repository(tmp_path / "repository", broken=broken),
        env=environment(PATHS="robots deep", SARIF=str(sarif), GITHUB_OUTPUT=str(output)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == (1 if broken else 0), found.stdout + found.stderr
    assert output.read_text() == f"sarif={sarif}\n"
    results: list[dict[str, Any]] = json.loads(sarif.read_text())["runs"][0]["results"]
    assert [result["ruleId"] for result in results] == (["unknown-frame"] if broken else [])
    assert ("unknown-frame" in found.stdout) == broken


def test_the_catalogue_entry_names_each_version_of_the_schema_and_claims_no_file_of_others() -> None:
    entry = json.loads((ROOT / "schema" / "catalog.json").read_text())
    assert set(entry) == {"name", "description", "fileMatch", "url", "versions"}
    assert entry["url"] == entry["versions"]["2.0"]
    names = {version: url.rpartition("/")[2] for version, url in entry["versions"].items()}
    assert names == {"1": FILES["1"], "2.0": FILES["2"]}
    assert any(fnmatch("leg.eurdf.yaml", pattern) for pattern in entry["fileMatch"])
    assert not any(fnmatch(name, pattern) for name in ("robot.yaml", "config.yml") for pattern in entry["fileMatch"])
