"""The extension for VS Code, without the editor: its own tests by Node.js, and the page of a preview in a browser."""

from __future__ import annotations

import json
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import pytest

import eurdf
from eurdf.viewing.page_files import page_path
from support.browser import VIEW, browser, errors_of
from support.places import ROBOTS, ROOT
from support.processes import why_not_installed

EXTENSION = ROOT / "editors" / "vscode"
MISSING = why_not_installed("yaml", "saxes")

pytestmark = pytest.mark.skipif(bool(MISSING), reason=MISSING)

# Writes what a preview shows of a robot: its content, or the whole page.
_PREVIEW = """
import { readFile, readdir } from "node:fs/promises";
import { previewPage } from "./src/page.js";
import { contentOf, robotOf } from "./src/robot_files.js";
const [file, root, script, style] = process.argv.slice(1);
const files = { text: (path) => readFile(path, "utf8"), bytes: readFile, list: (folder) => readdir(folder) };
const content = await contentOf(await robotOf(file, files), root, files);
const text = (path) => readFile(path, "utf8");
const page = previewPage(content, { script: await text(script), style: await text(style), nonce: "a0" });
process.stdout.write(JSON.stringify({ content, page }));
"""


def node(*arguments: str) -> str:
    done = subprocess.run(["node", *arguments], cwd=EXTENSION, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def preview(file: Path) -> dict[str, Any]:
    bundles = map(str, (page_path("page.js"), page_path("page.css")))
    shown: dict[str, Any] = json.loads(node("--input-type=module", "-e", _PREVIEW, str(file), f"{ROBOTS}/", *bundles))
    return shown


def test_own_tests_of_the_extension_pass() -> None:
    files = sorted(map(str, (EXTENSION / "tests").glob("*.test.js")))
    assert files
    node("--test", *files)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["digit_leg", "delta"])
def test_preview_moves_the_robot_and_follows_its_texts(tmp_path: Path, name: str) -> None:
    shown = preview(ROBOTS / name / "robot.urdf")
    content = shown["content"]
    (tmp_path / "page.html").write_text(shown["page"], encoding="utf-8")
    robot = eurdf.load(name, geometry=False)
    with browser() as chromium:
        page = chromium.new_context(offline=True).new_page()
        errors, loads = errors_of(page), []
        page.on("request", lambda request: loads.append(request.url))
        page.goto((tmp_path / "page.html").as_uri())
        page.get_by_role("slider").first.wait_for()

        def ask(expression: str) -> Any:
            return page.evaluate(f"() => {{ {VIEW} return {expression}; }}")

        def told(**message: Any) -> None:
            page.evaluate(
                "async (data) => { postMessage(data); await new Promise((done) => setTimeout(done)); }", message
            )

        assert page.evaluate(f"async () => {{ {VIEW} return (await scene.loaded).length; }}") == 0
        before, drawn = (
            ask("session.q"),
            ask("[...scene.links.values()].map(({ matrixWorld }) => matrixWorld.elements)"),
        )
        slider = page.get_by_role("slider").first
        slider.fill(repr(0.9 * float(slider.input_value()) + 0.1 * ask("session.coordinates[0].upper")))
        moved = ask("session.q")
        assert moved != before
        assert ask("[...scene.links.values()].map(({ matrixWorld }) => matrixWorld.elements)") != drawn
        q = robot.configuration({joint: tuple(each) for joint, each in moved.items()})
        assert abs(eurdf.residual(robot, q)).max() < 1e-6

        # An error leaves the robot; the next text without one is shown at the same configuration.
        valid, camera = (
            content["description"]["text"],
            "document.querySelector('.eu-live').view.viewport.camera.position.x",
        )
        at = ask(camera)
        broken = {**content["description"], "text": valid.replace("closures:", "closurs:")}
        told(content={**content, "description": broken, "meshes": {}})
        assert "closurs" in page.locator(".eu-live-problem").inner_text()
        assert ask("session.q") == moved
        renamed = {**content["urdf"], "text": content["urdf"]["text"].replace('<robot name="', '<robot name="other_')}
        told(content={**content, "urdf": renamed, "meshes": {}})
        assert page.locator(".eu-live-problem").count() == 0
        assert ask("session.robot.name").startswith("other_")
        assert page.evaluate(f"async () => {{ {VIEW} return (await scene.loaded).length; }}") == 0
        for joint, values in moved.items():
            assert ask("session.q")[joint] == pytest.approx(values, abs=1e-6)
        assert ask(camera) == at
        told(problem="there is no file")
        assert page.locator(".eu-message").inner_text() == "there is no file"
        assert errors == []
        assert [url for url in loads if not url.startswith(("file:", "data:", "blob:"))] == []


@pytest.mark.slow
@pytest.mark.skipif(
    not (EXTENSION / "node_modules" / "@vscode" / "vsce").is_dir(), reason="run npm install --prefix editors/vscode"
)
def test_package_contains_the_extension_and_nothing_else() -> None:
    subprocess.run(["npm", "run", "package"], cwd=EXTENSION, check=True, capture_output=True)
    (file,) = EXTENSION.glob("*.vsix")
    with zipfile.ZipFile(file) as package:
        names = {name.removeprefix("extension/") for name in package.namelist() if name.startswith("extension/")}
        assert names == {
            "package.json", "readme.md", "LICENSE.txt", "icon.png",
            *(f"dist/{name}" for name in ("extension.cjs", "licenses.txt", "page.js", "page.css")),
        }  # fmt: skip
        code = package.read("extension/dist/extension.cjs").decode()
        assert package.read("extension/dist/page.js") == page_path("page.js").read_bytes()
    assert 'require("vscode")' in code
