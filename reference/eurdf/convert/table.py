"""The tables of losses in the documentation and on the site: what each format can say of each concept.

Run as ``python -m eurdf.convert.table docs`` to write them to the pages of a folder: the overview to ``export.md``,
the losses of a format to export to to its page, those of imports to ``import.md``.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path

from eurdf.convert.export_format import export_format
from eurdf.convert.formats import EXPORTS
from eurdf.convert.import_format import import_format
from eurdf.convert.import_robot import COMMON
from eurdf.convert.losses import ELEMENTS, Effect, LossKind
from eurdf.reading.other_formats import IMPORTED

_PLACE = re.compile(r"(<!-- table: [^\n]*-->\n).*?(<!-- end of table -->)", re.DOTALL)


def overview() -> str:
    """A table in Markdown: a row for each concept, a column for each format; a cell says what is exact and what not."""
    names = [f"[{name}]({page_of(name)})" for name in EXPORTS]
    lines = [f"| concept | {' | '.join(names)} |", "| --- |" + " --- |" * len(EXPORTS)]
    for concept in ELEMENTS:
        cells = [_cell([kind for kind in export_format(name).rows if kind.concept == concept]) for name in EXPORTS]
        lines.append(f"| {concept} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _cell(kinds: Sequence[LossKind]) -> str:
    inexact = [kind for kind in kinds if kind.effect is not Effect.EXACT]
    words = dict.fromkeys(_effect(kind) + (f" ({kind.only})" if kind.only else "") for kind in inexact)
    return ", ".join(words if any(not kind.only for kind in inexact) else ["exact", *words])


def details(name: str) -> str:
    """A table in Markdown of the losses of a format, in the order of the concepts."""
    lines = ["| concept | effect | what happens | error | what you can do |", "| --- | --- | --- | --- | --- |"]
    for kind in sorted(export_format(name).rows, key=lambda kind: list(ELEMENTS).index(kind.concept)):
        about = f"{kind.concept} ({kind.only})" if kind.only else kind.concept
        happens = f"{kind.title} (`{kind.code}`)"
        lines.append(f"| {about} | {_effect(kind)} | {happens} | {kind.error or '-'} | {kind.hint} |")
    return "\n".join(lines) + "\n"


def imports() -> str:
    """Tables in Markdown of the losses of imports: one for each format, and one for what all share."""
    parts = [(each.title, import_format(name).losses) for name, each in IMPORTED.items()] + [("Every format", COMMON)]
    return "\n".join(_of_imports(title, losses) for title, losses in parts)


def _of_imports(title: str, losses: Sequence[LossKind]) -> str:
    lines = [f"### {title}", "", "| element | effect | what happens | code |", "| --- | --- | --- | --- |"]
    for kind in losses:
        error = f" ({kind.error})" if kind.error else ""
        lines.append(f"| {kind.concept} | {kind.effect} | {kind.title}{error} | `{kind.code}` |")
    return "\n".join(lines) + "\n"


def _effect(kind: LossKind) -> str:
    return "impossible" if kind.effect is Effect.DROPPED and not kind.sayable else str(kind.effect)


def page_of(name: str) -> str:
    """The file of the page of a format."""
    return f"export_{name.replace('-', '_')}.md"


def written(folder: Path) -> dict[Path, str]:
    """The pages in a folder with the tables of today, by file.

    Raises:
        FileNotFoundError: A format has no page.
        ValueError: A page has no place for its table.
    """
    tables = {"export.md": overview(), "import.md": imports()} | {page_of(name): details(name) for name in EXPORTS}
    return {folder / page: _with_table(folder / page, table) for page, table in tables.items()}


def _with_table(page: Path, table: str) -> str:
    text, places = _PLACE.subn(lambda found: f"{found[1]}\n{table}\n{found[2]}", page.read_text(encoding="utf-8"))
    if places != 1:
        raise ValueError(f"{page} has {places} places for a table, not one")
    return text


def main(folder: str) -> None:
    """Write the tables to the pages of a folder."""
    for page, text in written(Path(folder)).items():
        page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
