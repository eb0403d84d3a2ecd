"""The table of losses in the documentation: what each format can say of each concept.

Run as ``python -m eurdf.exporting.table docs/export.md`` to write it to a page.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from eurdf.exporting.formats import FORMATS
from eurdf.loss import CONCEPTS, Effect, LossKind

_PLACE = re.compile(r"(<!-- table: [^\n]*-->\n).*?(<!-- end of table -->)", re.DOTALL)


def table() -> str:
    """The table in Markdown: a row for each concept, a column for each format."""
    lines = [f"| concept | {' | '.join(FORMATS)} |", "| --- |" + " --- |" * len(FORMATS)]
    for concept in CONCEPTS:
        cells = [
            "<br>".join(_cell(kind) for kind in each.losses if kind.concept == concept) or "exact"
            for each in FORMATS.values()
        ]
        lines.append(f"| {concept} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _cell(kind: LossKind) -> str:
    effect = "impossible" if kind.effect is Effect.DROPPED and not kind.sayable else str(kind.effect)
    error = f"; error: {kind.error}" if kind.error else ""
    return f"**{effect}**: {kind.title}{error} (`{kind.code}`)"


def with_table(page: str) -> str:
    """The page with the table of today."""
    return _PLACE.sub(lambda found: found[1] + table() + found[2], page)


def main(path: str) -> None:
    """Write the table to a page."""
    page = Path(path)
    page.write_text(with_table(page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
