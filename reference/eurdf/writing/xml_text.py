"""Numbers, names and files in XML."""

from __future__ import annotations

import re
from collections.abc import Sequence

from lxml import etree

_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def numbers(values: Sequence[float]) -> str:
    """Numbers that are read back to the last bit: the shortest text of at most 17 significant digits of each."""
    return " ".join(repr(float(value) + 0.0).removesuffix(".0") for value in values)


def representable(name: str) -> str:
    """The name, with ``_`` for each character that XML cannot contain."""
    return _NOT_IN_XML.sub("_", name)


def file_content(root: etree._Element) -> bytes:
    """The bytes of an XML file, indented."""
    etree.indent(root, "  ")
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8") + b"\n"
