"""Pages in a browser, and the robots on them."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from support.processes import MODULES, why_not_installed

_MISSING = "playwright is not installed: pip install -e '.[browser]'"

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")

#: What draws without a graphics card.
_WITHOUT_GPU = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


#: What a script starts with that knows the only robot on a page of it: its session and its scene.
VIEW = "const view = document.querySelector('.eu-live').view; const { session, scene } = view;"

#: The transform to the world of each link that is drawn, by rows.
POSES = f"""() => {{
  {VIEW}
  const rows = ({{ elements: e }}) => [0, 1, 2, 3].map((i) => [e[i], e[4 + i], e[8 + i], e[12 + i]]);
  return Object.fromEntries([...scene.links].map(([name, link]) => [name, rows(link.matrixWorld)]));
}}"""


@contextmanager
def browser() -> Iterator[Any]:
    """A browser; the test is skipped where there is none."""
    executable = next(filter(None, map(shutil.which, _NAMES)), None)
    if executable is None:
        pytest.skip("no browser: install chromium")
    playwright = pytest.importorskip("playwright.sync_api", reason=_MISSING)
    with playwright.sync_playwright() as driver:
        # Of a container's root, chromium asks for no sandbox.
        started = driver.chromium.launch(executable_path=executable, args=["--no-sandbox", *_WITHOUT_GPU])
        try:
            yield started
        finally:
            started.close()


# What is drawn or measured by a script is complete two frames after a page is loaded or changed.
_SETTLED = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"

_BARRIERS = """async () => {
  const { violations } = await axe.run({ preload: false, resultTypes: ["violations"] });
  return violations
    .filter(({ impact }) => ["critical", "serious"].includes(impact))
    .flatMap(({ id, nodes }) => nodes.map(({ target }) => `${id}: ${target}`));
}"""


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a server of the files of a folder, on this machine alone."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *args: Any) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(folder))) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


def errors_of(page: Any) -> list[str]:
    """A list to which each later error in a page is added: of a script, in the console, of a request."""
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.on("requestfailed", lambda request: errors.append(f"{request.url}: {request.failure}"))
    page.on(
        "response",
        lambda response: errors.append(f"{response.url}: status {response.status}") if response.status >= 400 else None,
    )
    return errors


def scrolls_sideways(page: Any) -> bool:
    """Whether a page is wider than its window."""
    page.evaluate(_SETTLED)
    wider: bool = page.evaluate("document.documentElement.scrollWidth > document.documentElement.clientWidth")
    return wider


def axe() -> str:
    """The script of axe-core; the test is skipped where it is not installed."""
    if reason := why_not_installed("axe-core"):
        pytest.skip(reason)
    return (MODULES / "axe-core" / "axe.min.js").read_text(encoding="utf-8")


def barriers(page: Any) -> list[str]:
    """The critical and serious barriers that axe-core finds in a page, as ``rule: element``."""
    page.evaluate(_SETTLED)
    if not page.evaluate("'axe' in window"):
        page.evaluate(axe())
    found: list[str] = page.evaluate(_BARRIERS)
    return found
