"""A description as YAML text, in the usual style or in a random spelling with the same meaning."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable
from typing import Any

from eurdf_conformance.properties.chance import Chance

#: What needs no quotes anywhere, if it is no null and no boolean: it begins with a letter.
_PLAIN = re.compile(r"[^\W\d_]\w*([ ./-]?\w+)*")
_WORDS = frozenset({"null", "true", "false"})

#: A string under the core schema, whatever YAML 1.1 made of it; in a flow collection not every library reads it.
_PLAIN_IN_BLOCK = re.compile(r"[0-9]+:[0-9]+|[0-9]+_[0-9]+")

_SPELLINGS: tuple[Callable[[float], str], ...] = (
    repr,
    lambda number: f"+{number!r}",
    lambda number: f"{number:.16e}",
    lambda number: f"{number:.16E}",
    lambda number: f"{number!r}000",
    lambda number: repr(number).replace("0.", ".", 1),
    lambda number: f"{number:.0f}",
    lambda number: f"0{number:.0f}",
    lambda number: hex(int(number)),
    lambda number: oct(int(number)),
    lambda number: f"!!float {number!r}",
)


def yaml_text(document: dict[str, Any], chance: Chance | None = None) -> bytes:
    """The text of a description.

    Args:
        document: Its value.
        chance: Chooses the spelling; without it, the top of the document is in block style and what is in a list or
            two levels deep in flow style.
    """
    text = _Writer(document, chance).block(document, 0).lstrip("\n")
    if chance is None:
        return text.encode()
    if chance.is_so(0.3):
        text = chance.one_of(["---\n", "%YAML 1.2\n---\n", "# a robot\n---\n"]) + text
        text += chance.one_of(["", "...\n", "# the end"])
    if chance.is_so(0.3):
        text = text.replace("\n", "\r\n")
    return (chance.one_of(["", "", "\ufeff"]) + text).encode()


class _Writer:
    """Writes one document from start to end, and remembers the anchors set so far."""

    def __init__(self, document: dict[str, Any], chance: Chance | None) -> None:
        self.chance = chance
        self.anchors: dict[str, str] = {}
        self.count: Counter[str] = Counter()
        if chance is not None:
            self._count(document)

    def block(self, value: Any, indent: int) -> str:
        """The text after a colon or a dash, to the end of its last line."""
        mark = self._mark(value)
        if mark.startswith("*"):
            return f" {mark}{self._comment()}\n"
        if not self._in_block(value, indent):
            return f" {mark}{self._flow(value)}{self._comment()}\n"
        inner = indent + (2 if self.chance is None else self.chance.one_of([2, 2, 1, 4]))
        pad = " " * indent
        lines = []
        if isinstance(value, dict):
            for key, item in value.items():
                name = self._string(key, flow=False)
                # A key that is asked for in so many words is on a line of its own.
                query = f"{pad}? {name}\n{pad}:" if self._is_so(0.05) else f"{pad}{name}:"
                lines.append(self._remark(pad) + query + self.block(item, inner))
        else:
            lines = [f"{self._remark(pad)}{pad}-{self.block(item, inner)}" for item in value]
        return (f" {mark.rstrip()}" if mark else "") + "\n" + "".join(lines)

    def _in_block(self, value: Any, indent: int) -> bool:
        if not isinstance(value, dict | list) or not value:
            return False
        if indent == 0:
            return True
        if self.chance is not None:
            return self.chance.is_so(0.5)
        return indent == 2 and any(isinstance(item, dict | list) for item in _items(value))

    def _flow(self, value: Any) -> str:
        if isinstance(value, dict):
            inside = [f"{self._string(key, flow=True)}: {self._marked(item)}" for key, item in value.items()]
            return "{" + ", ".join(inside) + "}"
        if isinstance(value, list):
            return "[" + ", ".join(map(self._marked, value)) + "]"
        return self._scalar(value)

    def _marked(self, value: Any) -> str:
        mark = self._mark(value)
        return mark if mark.startswith("*") else mark + self._flow(value)

    def _mark(self, value: Any) -> str:
        """The anchor to set before a repeated value, or the alias of it, each with a space."""
        if self.chance is None:
            return ""
        key = _key(value)
        if key in self.anchors and self._is_so(0.7):
            return f"*{self.anchors[key]} "
        if key not in self.anchors and self.count[key] > 1 and self._is_so(0.3):
            self.anchors[key] = f"a{len(self.anchors)}"
            return f"&{self.anchors[key]} "
        return ""

    def _scalar(self, value: Any) -> str:
        if isinstance(value, str):
            return self._string(value, flow=True)
        if isinstance(value, bool) or value is None:
            word = json.dumps(value)
            return self.chance.one_of([word, word.capitalize(), word.upper()]) if self.chance else word
        return self._number(value)

    def _string(self, value: str, *, flow: bool) -> str:
        spellings = [json.dumps(value, ensure_ascii=False)]
        if _PLAIN.fullmatch(value) and value.lower() not in _WORDS:
            spellings.insert(0, value)
        elif not flow and _PLAIN_IN_BLOCK.fullmatch(value):
            spellings.append(value)
        if self.chance is None:
            return spellings[0]
        return self.chance.one_of([*spellings, "'" + value.replace("'", "''") + "'", json.dumps(value)])

    def _number(self, value: float) -> str:
        if self.chance is None:
            return repr(value)
        spelling = self.chance.one_of(_SPELLINGS)(value)
        return spelling if _meaning(spelling) == value and str(_meaning(spelling)) == str(float(value)) else repr(value)

    def _comment(self) -> str:
        return "  # so it is: [1, 2}" if self._is_so(0.1) else ""

    def _remark(self, pad: str) -> str:
        return f"{pad}# what follows\n\n" if self._is_so(0.1) else ""

    def _is_so(self, probability: float) -> bool:
        return self.chance is not None and self.chance.is_so(probability)

    def _count(self, value: Any) -> None:
        self.count[_key(value)] += 1
        for item in _items(value):
            self._count(item)


def _meaning(spelling: str) -> float:
    """The number that a spelling means under the core schema."""
    word = spelling.removeprefix("!!float ")
    for prefix, base in (("0x", 16), ("0o", 8)):
        if word.startswith(prefix):
            return float(int(word[2:], base))
    if re.fullmatch(r"[-+]?[0-9]+", word):
        return float(int(word))
    return float(word) if re.fullmatch(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", word) else float("nan")


def _items(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return list(value.values())
    return list(value) if isinstance(value, list) else []


def _key(value: Any) -> str:
    return json.dumps(value)
