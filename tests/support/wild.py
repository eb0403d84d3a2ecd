"""Published robots that nobody here wrote."""

from __future__ import annotations

import json
import os
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import pytest

from support.places import WILD

_FILE = WILD / "facts.json"

#: By robot, what its README describes; empty where the folder is not there.
FACTS: dict[str, dict[str, Any]] = json.loads(_FILE.read_text(encoding="utf-8")) if _FILE.is_file() else {}

needs_wild = pytest.mark.skipif(
    not FACTS, reason="no published robots: put their folder at ../shared/wild, beside the checkout"
)


def _examples() -> Path | None:
    """The folder ``robots`` of example-robot-data: one that a variable names, or that of the package."""
    stated = os.environ.get("EURDF_EXAMPLE_ROBOT_DATA")
    if stated:
        return Path(stated)
    try:
        package = distribution("example-robot-data")
    except PackageNotFoundError:
        return None
    return Path(str(package.locate_file("cmeel.prefix/share/example-robot-data/robots")))


_EXAMPLES = _examples()

#: Where their meshes are: the package example-robot-data, or the folder that it is in.
PACKAGE_DIRS = () if _EXAMPLES is None else (_EXAMPLES.parent, _EXAMPLES.parent.parent)

#: By name, the folders of the robots beside the checkout whose loops can be closed, and the URDFs of the others.
ROBOTS: dict[str, Path] = {name: WILD / name for name, facts in FACTS.items() if facts["closes"]}
if _EXAMPLES is not None:
    ROBOTS |= {str(path.relative_to(_EXAMPLES)): path for path in sorted(_EXAMPLES.rglob("*.urdf"))}

#: Invalid ones of `ROBOTS`, and their errors.
INVALID = {
    "alex_description/urdf/alex_psyonic_hands.urdf": "urdf-mimic-unknown",
    "falcon_description/urdf/falcon.urdf": "urdf-unknown-link",
    "ur_description/urdf/ur3.urdf": "urdf-missing-attribute",
}
