"""A headless browser: chromium of the system, driven by playwright."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

_MISSING = "playwright is not installed: pip install -e '.[browser]'"

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")

#: What draws without a graphics card.
_WITHOUT_GPU = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


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
