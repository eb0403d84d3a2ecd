"""The package in JavaScript as pages without a bundler load it."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from support.browser import served
from support.places import ROOT
from support.processes import JAVASCRIPT, MODULES, why_not_installed

#: Where pages at the top of a checkout, or of `served_package`, find what they import.
IMPORTS = """<script type="importmap">{"imports": {
  "three": "/js/node_modules/three/build/three.module.js",
  "three/addons/": "/js/node_modules/three/examples/jsm/",
  "three/examples/jsm/": "/js/node_modules/three/examples/jsm/",
  "urdf-loader": "/js/node_modules/urdf-loader/src/URDFLoader.js",
  "extended-urdf/three": "/js/dist/three.js"
}}</script>"""


def build(folder: Path) -> Path:
    """Bundle the package and the page into a folder; the test is skipped where Node or a package is missing."""
    if reason := why_not_installed("esbuild", "saxes", "three", "yaml"):
        pytest.skip(reason)
    done = subprocess.run(
        ["node", str(JAVASCRIPT / "build.js"), str(folder)], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    return folder / "dist"


@contextmanager
def served_package(folder: Path) -> Iterator[str]:
    """The address of a folder like a checkout in which the package is built."""
    js = folder / "js"
    build(js)
    (js / "node_modules").symlink_to(MODULES)
    for name in ("examples", "robots"):
        (folder / name).symlink_to(ROOT / name)
    with served(folder) as address:
        yield address
