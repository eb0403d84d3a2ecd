"""A page as Markdown, for sites that have a style of their own."""

from __future__ import annotations

import re
from collections.abc import Iterable

from eurdf_conformance.certificate.page import Element

# What would be read as markup: of Markdown, of HTML, and of mathematics.
_MARKUP = re.compile(r"([\\`*_\[\]<>&$|{}~#])")
_LINE_END = re.compile(r"\s*\n\s*")


def markdown(content: Iterable[Element]) -> str:
    """The text of the file: headings, paragraphs, tables, lists, and lists that unfold."""
    return "\n\n".join(filter(None, map(_block, content))) + "\n"


def _block(part: Element) -> str:
    match part.tag:
        case "h1" | "h2" | "h3":
            return f"{'#' * int(part.tag[1])} {_inline(part)}"
        case "ul":
            return "\n".join(f"- {_inline(item)}" for item in part)
        case "details":
            return f"<details><summary>{_inline(part[0])}</summary>\n\n{markdown(list(part)[1:])}\n</details>"
        case "div":
            head, *rows = ([_inline(cell) for cell in row] for row in part.iter("tr"))
            return "\n".join(f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *rows))
        case _:
            return _inline(part)


def _inline(part: Element) -> str:
    return _plain(part.text) + "".join(f"{_marked(inner)}{_plain(inner.tail)}" for inner in part)


def _marked(part: Element) -> str:
    match part.tag:
        case "code":
            return f"`{_LINE_END.sub(' ', part.text or '')}`"
        case "div":  # on a line of its own
            return f" {_inline(part)}"
        case _:
            return _inline(part)


def _plain(text: str | None) -> str:
    return _MARKUP.sub(r"\\\1", _LINE_END.sub(" ", text or ""))
