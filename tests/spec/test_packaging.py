"""The two distributions of the repository agree."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

from support.places import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def project(folder: Path) -> dict[str, Any]:
    value: dict[str, Any] = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return value


READER, SUITE = project(ROOT), project(ROOT / "conformance")


def test_suite_requires_same_version_of_reference() -> None:
    assert SUITE["version"] == READER["version"]
    assert SUITE["optional-dependencies"]["reference"] == [f"eurdf=={READER['version']}"]


def test_editable_install_has_test_dependencies() -> None:
    assert set(SUITE["dependencies"]) <= {*READER["optional-dependencies"]["test"], *READER["dependencies"]}


def test_addresses_and_versions_agree() -> None:
    """The addresses are stated in the reference's metadata; what cannot read them there repeats them."""
    urls = READER["urls"]
    assert SUITE["urls"]["Source"] == urls["Source"]
    assert SUITE["urls"]["Documentation"].startswith(urls["Documentation"])
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert (citation["version"], citation["url"]) == (READER["version"], urls["Documentation"])
    assert citation["repository-code"] == urls["Source"]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"repo: {urls['Source']}\n    rev: v{READER['version']}\n" in readme
    assert f"uses: {urls['Source'].removeprefix('https://github.com/')}@v{READER['version']}\n" in readme
    package = ElementTree.parse(ROOT / "ros" / "package.xml").getroot()
    assert (package.findtext("name"), package.findtext("version")) == (READER["name"], READER["version"])
    recipe = yaml.safe_load((ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8"))
    assert recipe["context"]["version"] == READER["version"]
    assert recipe["about"]["repository"] == urls["Source"]
    corpus = ROOT / "conformance" / "eurdf_conformance" / "corpus" / "package"
    npm = json.loads((corpus / "package.json").read_text(encoding="utf-8"))
    assert (npm["homepage"], npm["repository"]) == (SUITE["urls"]["Documentation"], urls["Source"])
    js = json.loads((ROOT / "js" / "package.json").read_text(encoding="utf-8"))
    assert js["homepage"] == urls["Documentation"]
    assert js["repository"] == {"type": "git", "url": f"git+{urls['Source']}.git", "directory": "js"}
    vscode = json.loads((ROOT / "editors" / "vscode" / "package.json").read_text(encoding="utf-8"))
    assert (vscode["homepage"], vscode["bugs"]["url"]) == (urls["Documentation"], urls["Issues"])
    assert vscode["repository"] == {**js["repository"], "url": f"{urls['Source']}.git", "directory": "editors/vscode"}
    answers = (ROOT / "js" / "adapter" / "answers.js").read_text(encoding="utf-8")
    assert f'name: "{js["name"]}", version: "{js["version"]}"' in answers
    assert project(corpus)["urls"] == {"Documentation": npm["homepage"], "Source": npm["repository"]}


def test_recipe_for_conda_has_the_dependencies() -> None:
    """Pinocchio's package is called pin in one registry and pinocchio in the other."""
    recipe = yaml.safe_load((ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8"))
    _, *run = recipe["requirements"]["run"]
    names = {"pin": "pinocchio"}
    split = [each.lower().partition(">=") for each in READER["dependencies"]]
    wanted = {f"{names.get(name, name)}>={version}" for name, _, version in split}
    assert {each.replace(" ", "") for each in run} == wanted


def test_actions_are_pinned_by_commit() -> None:
    files = [ROOT / "action.yml", *(ROOT / ".github" / "workflows").glob("*.yml")]
    used = [
        line.split("uses:")[1].strip() for file in files for line in file.read_text().splitlines() if "uses:" in line
    ]
    elsewhere = [action for action in used if not action.startswith("./")]
    assert len(elsewhere) > 20
    assert not [action for action in elsewhere if not re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v[\d.]+", action)]
