"""The tables of losses in the documentation: what an import from each format loses.

Run as ``python -m eurdf.importing.table docs/import.md`` to write them to a page.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from eurdf.convert.losses import LossKind
from eurdf.importing.formats import FORMATS
from eurdf.importing.import_robot import COMMON

_PLACE = re.compile(r"(<!-- tables: [^\n]*-->\n).*?(<!-- end of tables -->)", re.DOTALL)


def tables() -> str:
    """The tables in Markdown: one for each format, and one for what all share."""
    parts = [(each.title, each.losses) for each in FORMATS.values()]
    return "\n".join(_table(title, losses) for title, losses in (*parts, ("Every format", COMMON)))


def _table(title: str, losses: tuple[LossKind, ...]) -> str:
    lines = [f"### {title}", "", "| element | effect | what happens | code |", "| --- | --- | --- | --- |"]
    for kind in losses:
        error = f" ({kind.error})" if kind.error else ""
        lines.append(f"| {kind.concept} | {kind.effect} | {kind.title}{error} | `{kind.code}` |")
    return "\n".join(lines) + "\n"


def with_tables(page: str) -> str:
    """The page with the tables of today."""
    return _PLACE.sub(lambda found: found[1] + tables() + found[2], page)


def main(path: str) -> None:
    """Write the tables to a page."""
    page = Path(path)
    page.write_text(with_tables(page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
