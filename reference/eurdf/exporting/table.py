"""The table of losses in the documentation and on the site: what each format can say of each concept.

Run as ``python -m eurdf.exporting.table docs/export.md`` to write it to a page.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path

from eurdf.exporting.formats import FORMATS
from eurdf.loss import CONCEPTS, Effect, LossKind

_PLACE = re.compile(r"(<!-- table: [^\n]*-->\n).*?(<!-- end of table -->)", re.DOTALL)


def overview() -> str:
    """A table in Markdown: a row for each concept, a column for each format; a cell says what is exact and what not."""
    lines = [f"| concept | {' | '.join(FORMATS)} |", "| --- |" + " --- |" * len(FORMATS)]
    for concept in CONCEPTS:
        cells = [_cell([kind for kind in each.losses if kind.concept == concept]) for each in FORMATS.values()]
        lines.append(f"| {concept} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _cell(kinds: Sequence[LossKind]) -> str:
    inexact = [kind for kind in kinds if kind.effect is not Effect.EXACT]
    words = dict.fromkeys(_effect(kind) + (f" ({kind.only})" if kind.only else "") for kind in inexact)
    return ", ".join(words if any(not kind.only for kind in inexact) else ["exact", *words])


def details(name: str) -> str:
    """A table in Markdown of the losses of a format, in the order of the concepts."""
    lines = ["| concept | effect | what happens | error | what you can do |", "| --- | --- | --- | --- | --- |"]
    for kind in sorted(FORMATS[name].losses, key=lambda kind: CONCEPTS.index(kind.concept)):
        about = f"{kind.concept} ({kind.only})" if kind.only else kind.concept
        happens = f"{kind.title} (`{kind.code}`)"
        lines.append(f"| {about} | {_effect(kind)} | {happens} | {kind.error or '-'} | {kind.hint} |")
    return "\n".join(lines) + "\n"


def table() -> str:
    """The overview, then the losses of each format."""
    sections = [f"### Losses in {name}\n\n{details(name)}" for name in FORMATS]
    return "\n".join(["", overview(), *sections, ""])


def _effect(kind: LossKind) -> str:
    return "impossible" if kind.effect is Effect.DROPPED and not kind.sayable else str(kind.effect)


def with_table(page: str) -> str:
    """The page with the table of today."""
    return _PLACE.sub(lambda found: found[1] + table() + found[2], page)


def main(path: str) -> None:
    """Write the table to a page."""
    page = Path(path)
    page.write_text(with_table(page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
