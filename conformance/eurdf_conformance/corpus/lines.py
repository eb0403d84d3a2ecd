"""The lines of a file, as diagnostics count them."""

from __future__ import annotations

import re
from pathlib import Path

_END = re.compile("\r\n|\n|\r")


def lines_of(path: Path) -> list[str]:
    """EU-DIA-011, EU-DIA-012: the lines without their ends and a byte order mark; [] if there is no file."""
    if not path.is_file():
        return []
    return _END.split(path.read_bytes().decode("utf-8", errors="replace").removeprefix("\ufeff"))
