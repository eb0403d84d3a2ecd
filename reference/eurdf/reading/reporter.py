"""Reporting what is wrong with a file at a place in it."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from lxml import etree

from eurdf.diagnostics import Diagnostics, Hint
from eurdf.reading.xml_reader import XmlDocument
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

Element = etree._Element


class YamlReporter(NamedTuple):
    """Adds diagnostics on a YAML file.

    Attributes:
        document: The file.
        diagnostics: What is found in it, and in other files.
    """

    document: YamlDocument
    diagnostics: Diagnostics

    def report(self, code: str, message: str, pointer: Pointer, hint: Hint = None, *, key: bool = False) -> None:
        """Report at a value, or at its key: see `Diagnostics.report` and `YamlDocument.place`."""
        self.diagnostics.report(code, message, partial(self.document.place, pointer, key), hint)


class XmlReporter(NamedTuple):
    """Adds diagnostics on an XML file.

    Attributes:
        document: The file.
        diagnostics: What is found in it, and in other files.
    """

    document: XmlDocument
    diagnostics: Diagnostics

    def report(
        self, code: str, message: str, element: Element, attribute: str | None = None, hint: Hint = None
    ) -> None:
        """Report at an element, or at one of its attributes: see `Diagnostics.report` and `XmlDocument.place`."""
        self.diagnostics.report(code, message, partial(self.document.place, element, attribute), hint)
