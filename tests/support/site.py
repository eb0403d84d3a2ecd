"""The site of the specification, built as it is published."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from spec.site.clause import ROOT, SPEC

#: Marks of the tests that build a site.
BUILDS_SITE = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.version_info < (3, 11), reason="Sphinx 8.2, which the site needs, needs Python 3.11"),
    pytest.mark.skipif(
        any(importlib.util.find_spec(name) is None for name in ("sphinx", "myst_parser", "furo", "latex2mathml")),
        reason="the packages of the site are not installed: pip install -e '.[docs]'",
    ),
]


def build_site(
    output: Path, source: Path = SPEC, robots: Sequence[str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Build a site in a process of its own; robots are those with a page, by default all."""
    program = (
        "import json, sys; from pathlib import Path; from spec.site.__main__ import build;"
        "sys.exit(build(Path(sys.argv[1]), source=Path(sys.argv[2]), robots=json.loads(sys.argv[3])))"
    )
    given = "null" if robots is None else json.dumps(list(robots))
    command = [sys.executable, "-c", program, str(output), str(source), given]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
