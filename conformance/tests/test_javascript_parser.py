"""The parser in JavaScript, which was written from the specification alone."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from eurdf_conformance import adapters
from eurdf_conformance.certificate.certificate import read_certificate
from support.node_packages import MODULES, why_not_installed
from support.session import SharedRun

PARSER = Path(adapters.__file__).with_name("javascript")
MISSING = why_not_installed("yaml", "saxes")
LEVELS = ("accept", "structure", "kinematics", "dynamics")


def test_the_tests_install_what_the_parser_declares() -> None:
    declared = json.loads((PARSER / "package.json").read_text(encoding="utf-8"))["dependencies"]
    installed = json.loads((MODULES.parent / "package.json").read_text(encoding="utf-8"))["dependencies"]
    assert declared.items() <= installed.items()


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_the_javascript_parser_is_certified_at_the_levels_it_claims(
    tmp_path: Path, shared_run: Callable[..., SharedRun]
) -> None:
    folder = tmp_path / "extended-urdf"
    shutil.copytree(PARSER, folder, ignore=shutil.ignore_patterns("node_modules"))
    (folder / "node_modules").symlink_to(MODULES)
    # The newest version, which has few cases; the workflow of the repository certifies it for all of them.
    done = shared_run("--parser", f"cmd:node {folder / 'main.mjs'}", "--seed", "0", "--format-version", "2.1")
    assert done.returncode == 0, done.stdout + done.stderr
    certificate = read_certificate(Path(done.certificate))
    assert certificate.failures == ()
    certified = {(level.version, level.level) for level in certificate.levels if level.certified}
    assert certified == {("2.1", level) for level in LEVELS}
