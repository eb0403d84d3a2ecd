"""The tables of ``docs/toolbox.md``, made of the rows: ``python -m benchmarks.toolbox.page`` writes them there."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

from benchmarks.toolbox.checks import CHECKS, LEGS, PLANAR, SIX, THREE, Check
from benchmarks.toolbox.robots import PUBLISHED, Published
from benchmarks.toolbox.rows import TABLES, Row

_ROOT = Path(__file__).parents[2]
PAGE = _ROOT / "docs" / "toolbox.md"
_PLACE = re.compile(r"(<!-- table: (\w+)[^\n]*-->\n).*?(<!-- end of table -->)", re.DOTALL)
_KINDS = {SIX: "6d", THREE: "3d", PLANAR: "redundant rows", LEGS: "", SIX + PLANAR: "6d"}


def _seen(row: Row) -> str:
    return row.unrun or "; ".join(dict.fromkeys(map(_statement, CHECKS[row.theirs])))


def _statement(check: Check) -> str:
    about = ", ".join(filter(None, (check.what, _KINDS.get(check.robots, ""))))
    text = check.old.text
    if check.new is not None:
        text = f"3.4: {text}; 4.1: {check.new.text}"
    return f"{about}: {text}" if about else text


def table(rows: Sequence[Row]) -> str:
    """Rows in Markdown."""
    lines = ["| theirs | what it computes | ours | difference | seen |", "| --- | --- | --- | --- | --- |"]
    for row in rows:
        names = ", ".join(f"`{name}`" for name in row.theirs.split())
        lines.append(f"| {names} | {row.computes} | {row.ours} | {row.difference} | {_seen(row)} |")
    return "\n".join(lines) + "\n"


def robots() -> str:
    """The published robots in Markdown, with the dimensions of those here."""
    found = json.loads((_ROOT / "robots" / "collection.json").read_text(encoding="utf-8"))["robots"]
    sizes = {each["name"]: (each["nv"], each["nc"], each["actuated"]) for each in found}
    lines = ["| theirs | folder | theirs: nv, nc, motors | here | ours: nv, nc, motors | difference |"]
    lines += ["| --- | --- | --- | --- | --- | --- |"]
    for each in PUBLISHED:
        ours = f"[{each.ours}](../robots/{each.ours}/README.md)"
        lines.append(
            f"| `{each.name}` | {each.folder and f'`{each.folder}`'} | {_size(each)} | {ours} "
            f"| {_numbers(sizes[each.ours])} | {each.note} |"
        )
    return "\n".join(lines) + "\n"


def _size(robot: Published) -> str:
    return f"fails: `{robot.size}`" if isinstance(robot.size, str) else _numbers(robot.size)


def _numbers(size: Sequence[int]) -> str:
    return ", ".join(map(str, size))


def written(page: str) -> str:
    """A page with the tables of today.

    Raises:
        ValueError: It has not one place for each table.
    """
    tables = {name: table(rows) for name, rows in TABLES.items()} | {"robots": robots()}
    places = [found[2] for found in _PLACE.finditer(page)]
    if sorted(places) != sorted(tables):
        raise ValueError(f"{PAGE.name} has places for {sorted(places)}, not for {sorted(tables)}")
    return _PLACE.sub(lambda found: f"{found[1]}\n{tables[found[2]]}\n{found[3]}", page)


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
