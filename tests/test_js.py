"""The package in JavaScript as its users have it: what is published, its types, its README, its size."""

from __future__ import annotations

import gzip
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from support.browser import browser, errors_of, served
from support.javascript_package import build
from support.places import ROOT
from support.processes import JAVASCRIPT, MODULES, why_not_installed

MISSING = why_not_installed("closed-chain-ik", "saxes", "three", "typescript", "urdf-loader", "yaml")
pytestmark = pytest.mark.skipif(bool(MISSING), reason=MISSING)

PACKAGE = json.loads((JAVASCRIPT / "package.json").read_text(encoding="utf-8"))
EXAMPLES = re.findall(r"^```js\n(.*?)^```$", (JAVASCRIPT / "README.md").read_text(encoding="utf-8"), re.M | re.S)


def run(*command: str | Path, folder: Path = JAVASCRIPT) -> str:
    """What a command prints."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_bundles_for_browsers_are_small(tmp_path: Path) -> None:
    bundles = [file for file in build(tmp_path).glob("*.js") if file.name != "answers.js"]
    assert {"extended-urdf.js", "three.js"} <= {file.name for file in bundles}
    assert sum(len(gzip.compress(file.read_bytes())) for file in bundles) <= 80_000
    assert "yaml 2." in (tmp_path / "dist" / "licenses.txt").read_text(encoding="utf-8")


def test_types_fit_a_program_that_uses_every_export() -> None:
    run(MODULES / ".bin" / "tsc", "-p", "tests")
    program = (JAVASCRIPT / "tests" / "types.ts").read_text(encoding="utf-8")
    imported = re.findall(r'^import \{ (.*) \} from "(extended-urdf[\w/]*)";$', program, re.M)
    used = {entry: {name for name in names.split(", ") if not name.startswith("type ")} for names, entry in imported}
    entries = [f"extended-urdf{path[1:]}" for path in PACKAGE["exports"]]
    list_exports = "for (const each of process.argv.slice(1)) console.log(Object.keys(await import(each)).join())"
    exported = run("node", "--input-type=module", "--eval", list_exports, *entries).splitlines()
    assert used == {entry: set(names.split(",")) for entry, names in zip(entries, exported, strict=True)}


def test_npm_publishes_sources_bundles_and_types() -> None:
    if shutil.which("npm") is None:
        pytest.skip("npm is not on the PATH")
    (packed,) = json.loads(run("npm", "pack", "--dry-run", "--json", "--ignore-scripts"))
    files = {file["path"] for file in packed["files"]}
    stated = {path[2:] for entry in PACKAGE["exports"].values() for path in entry.values()}
    assert {*stated, "README.md", "package.json", *PACKAGE["bin"].values()} <= files
    assert {Path(file).parts[0] for file in files} <= {"LICENSE", "README.md", "adapter", "dist", "package.json", "src"}


def test_readme_examples_for_node_run(tmp_path: Path) -> None:
    with_robot(tmp_path)
    (tmp_path / "example.mjs").write_text("\n".join(EXAMPLES[:3]), encoding="utf-8")
    printed = run("node", "example.mjs", folder=tmp_path)
    assert "true 9\n" in printed  # whether the loops close, and the mobility


def test_readme_examples_for_pages_run_when_bundled(tmp_path: Path) -> None:
    with_robot(tmp_path)
    (tmp_path / "page.mjs").write_text("\n".join([*EXAMPLES[3:], "window.robot = robot;"]), encoding="utf-8")
    run(MODULES / ".bin" / "esbuild", "page.mjs", "--bundle", "--format=esm", "--outfile=page.js", folder=tmp_path)
    page_text = '<link rel="icon" href="data:,"><script type="module" src="page.js"></script>'
    (tmp_path / "index.html").write_text(page_text, encoding="utf-8")
    with browser() as chromium, served(tmp_path) as address:
        page = chromium.new_page()
        errors = errors_of(page)
        page.goto(address)
        page.wait_for_function("() => Boolean(window.robot)")
        assert page.evaluate("() => robot.closures.length") == 3
        assert errors == []


def with_robot(folder: Path) -> None:
    """A folder of a user: a robot, and installed packages."""
    for name in ("robot.yaml", "robot.urdf"):
        shutil.copy(ROOT / "robots" / "digit_leg" / name, folder)
    (folder / "node_modules").mkdir()
    (folder / "node_modules" / "extended-urdf").symlink_to(JAVASCRIPT)
    for package in MODULES.iterdir():
        (folder / "node_modules" / package.name).symlink_to(package)
