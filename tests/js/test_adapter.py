"""The suite certifies the bundle in a browser, as it certifies the package in Node.js."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from eurdf_conformance.certificate.certificate import read_certificate
from eurdf_conformance.level import Level
from support.browser import browser
from support.javascript_package import build
from support.places import ROOT
from support.session import SharedRun


@pytest.mark.slow
def test_bundle_in_a_browser_is_certified_at_every_level(shared_run: Callable[..., SharedRun], tmp_path: Path) -> None:
    with browser():  # without one, this is skipped
        dist = build(tmp_path)
    adapter = ["env", f"PYTHONPATH={ROOT / 'tests'}", sys.executable, "-m", "support.browser_adapter", str(dist)]
    # The newest version, as for Node.js; the workflow of the repository certifies it for all of them.
    done = shared_run("--parser", f"cmd:{shlex.join(adapter)}", "--seed", "0", "--format-version", "2.1")
    assert done.returncode == 0, done.stdout + done.stderr
    certificate = read_certificate(Path(done.certificate))
    assert certificate.failures == ()
    assert {(level.version, level.level) for level in certificate.levels if level.certified} == {
        ("2.1", level) for level in Level
    }
