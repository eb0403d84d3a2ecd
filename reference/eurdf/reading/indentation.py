"""Where a line of YAML that is indented wrongly was probably meant to begin."""

from __future__ import annotations

import re
from typing import NamedTuple

from eurdf.diagnostics.lines import Lines

#: Lines at the beginning of a file that a hint takes into account. The longest description of the collection has 200.
LOOKED_AT = 100_000

_ITEM = re.compile(r"-(?: +|$)")
_KEY = re.compile(r"""("[^"\n]*"|'[^'\n]*'|[^\s"'#&*!|>%@`{}\[\],:-][^#:]*?|-[^\s#:][^#:]*?)\s*:(?: +|$)""")


class _Level(NamedTuple):
    """A column at which the keys of a mapping, or the items of a list, begin.

    Attributes:
        column: Number of characters before it.
        key: The last key there as it is written; None for the items of a list.
        line: Of that key or item, from 1.
        has_value: Whether a value follows on the line.
    """

    column: int
    key: str | None
    line: int
    has_value: bool = False


def indentation_hint(text: Lines, line: int) -> str | None:
    """How to indent a line that does not continue what is before it.

    None if the line does not begin with a key or ``-``, its indentation is not wrong, or more than `LOOKED_AT` lines
    would have to be looked at.
    """
    if line > LOOKED_AT:
        return None
    lines = text.first(line)
    wrong = lines[line - 1] if line <= len(lines) else ""
    column, body = _indent(wrong)
    key = _KEY.match(body)
    is_item = _ITEM.match(body) is not None
    if not is_item and key is None:
        return None
    every_level = _levels(lines[: line - 1])
    levels = [level for level in every_level if (level.key is None) == is_item]
    distances = {abs(level.column - column) for level in levels}
    if not levels or 0 in distances:
        return None
    what = "the '-'" if is_item else _quoted(key[1] if key else "")
    nearest = [level for level in reversed(levels) if abs(level.column - column) == min(distances)]
    hint = f"indent {what} {', or '.join(map(_like, nearest))}"
    item = next((level for level in every_level if level.key is None and level.column == column), None)
    if item is not None:
        hint += f"; items of the list begin with '- ', like line {item.line}"
    over = nearest[0]
    if over.has_value and over.key is not None and column > over.column:
        hint += "; a key with a value on its line cannot have lines below it"
    return hint


def first_line_hint(text: Lines) -> str | None:
    """How to indent the first line of a file that is indented deeper than what follows; None where it is not."""
    for number, line in enumerate(text.first(LOOKED_AT), 1):
        column, body = _indent(line)
        if body and not body.startswith("#"):
            key = _KEY.match(body)
            return f"begin {_quoted(key[1])} on line {number} in the first column" if column and key else None
    return None


def _levels(lines: list[str]) -> list[_Level]:
    """The mappings and lists that are open after some lines, from the outside in."""
    levels: list[_Level] = []
    text_above = -1  # column of a key whose value is a block of text
    brackets = 0  # how many are open, quotes aside
    for number, line in enumerate(lines, 1):
        column, body = _indent(line)
        if not body or body.startswith(("#", "%", "---")):
            continue
        if brackets > 0 or 0 <= text_above < column:
            brackets += _opened(body) if brackets > 0 else 0
            continue
        text_above = -1
        levels = [level for level in levels if level.column <= column]
        while item := _ITEM.match(body):
            levels = [level for level in levels if level.column < column or (level.column == column and level.key)]
            levels.append(_Level(column, None, number))
            column, body = column + item.end(), body[item.end() :]
        if key := _KEY.match(body):
            value = body[key.end() :].partition(" #")[0].strip()
            levels = [level for level in levels if level.column < column]
            levels.append(_Level(column, key[1], number, bool(value) and not value.startswith(("#", "&", "!"))))
            if value.startswith(("|", ">")):
                text_above = column
        brackets = max(0, _opened(body))
    return levels


def _indent(line: str) -> tuple[int, str]:
    body = line.lstrip(" ")
    return len(line) - len(body), body.rstrip()


def _opened(body: str) -> int:
    bare = re.sub(r"""\"[^"]*\"|'[^']*'| #.*""", "", body)
    return sum(bare.count(sign) for sign in "[{") - sum(bare.count(sign) for sign in "]}")


def _like(level: _Level) -> str:
    where = f"the '-' on line {level.line}" if level.key is None else f"{_quoted(level.key)} on line {level.line}"
    return f"by {level.column} space{'' if level.column == 1 else 's'}, like {where}"


def _quoted(key: str) -> str:
    bare = key[1:-1] if key[:1] in ("'", '"') else key
    shown = bare if len(bare) <= 60 else f"{bare[:57]}…"
    return f"'{shown}'"
