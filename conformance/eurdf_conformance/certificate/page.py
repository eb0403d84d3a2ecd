"""The common parts of pages: each is one HTML file without dependencies, in a light and a dark style."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from importlib.resources import files

from lxml import html
from lxml.etree import _Element

from eurdf_conformance.visible import visible

Element = _Element
Content = str | Element

# Roles in the text of the specification, {code}`x`; only the argument is shown.
_ROLE = re.compile(r"\{[a-z:]+\}(?=`)")
_LINK = re.compile(r"\[([^]]+)\]\([^)]*\)")

# The page loads and runs nothing, whatever texts of a parser it contains.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'"


def page(title: str, content: Iterable[Element], kind: str = "report") -> str:
    """A page as the text of its file; its kind is the class of what is in it."""
    style = files("eurdf_conformance.certificate").joinpath("page.css").read_text(encoding="utf-8")
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=_POLICY),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name="color-scheme", content="light dark"),
        element("title", title),
        element("style", style),
    )
    document = element("html", head, element("body", element("main", *content, class_=kind)), lang="en")
    return str(html.tostring(document, doctype="<!DOCTYPE html>", encoding="unicode")) + "\n"


def element(tag: str, *content: Content, **attributes: str) -> Element:
    """An element.

    Args:
        tag: Its name.
        content: Texts and elements; a character that no page can hold is escaped.
        attributes: An underscore becomes a hyphen; at the end, as in ``class_``, it is dropped.
    """
    names = {name.rstrip("_").replace("_", "-"): visible(value) for name, value in attributes.items()}
    made: Element = html.Element(tag, names)
    for part in content:
        if not isinstance(part, str):
            made.append(part)
        elif len(made):
            made[-1].tail = (made[-1].tail or "") + visible(part)
        else:
            made.text = (made.text or "") + visible(part)
    return made


def table(caption: str, head: Iterable[Content], rows: Iterable[Iterable[Element]]) -> Element:
    """A table in a box that scrolls by itself where the window is narrower."""
    top = element("thead", element("tr", *(element("th", cell, scope="col") for cell in head)))
    body = element("tbody", *(element("tr", *row) for row in rows))
    whole = element("table", element("caption", caption), top, body)
    return element("div", whole, class_="wide", tabindex="0", role="region", aria_label=caption)


def facts(values: Iterable[tuple[str, str]]) -> Element:
    """A list of names and their values."""
    parts = (part for name, value in values for part in (element("dt", name), element("dd", element("code", value))))
    return element("dl", *parts)


def marked_up(text: str) -> Iterator[Content]:
    """A sentence of the specification: text between backticks is code, and links are their texts."""
    for index, part in enumerate(_LINK.sub(r"\1", _ROLE.sub("", text)).split("`")):
        yield element("code", part) if index % 2 else part
