"""The folder of published robots beside the checkout, where it is present, and what is known of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

WILD = Path(__file__).parents[3] / "shared" / "wild"
_FILE = WILD / "facts.json"

#: By robot, what its README describes; empty where the folder is not there.
FACTS: dict[str, dict[str, Any]] = json.loads(_FILE.read_text(encoding="utf-8")) if _FILE.is_file() else {}

needs_wild = pytest.mark.skipif(
    not FACTS, reason="no published robots: put their folder at ../shared/wild, beside the checkout"
)
