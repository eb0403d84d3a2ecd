"""Reading XML, with the place of each element and attribute."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import partial
from typing import NamedTuple

from lxml import etree

from eurdf.diagnostics import Diagnostics, Edit, FileError, Hint, Place, Proposals, misspelt
from eurdf.reading.source import FILE_LIMIT, Source, short, too_large
from eurdf.reading.xml_syntax import ATTRIBUTE, DEPTH_LIMIT, HARMLESS_ERRORS, refused, syntax_error

Element = etree._Element

#: Tags and attributes that a file may have: what takes memory is their number.
TAG_LIMIT = 1_000_000

#: Bytes of the value of an attribute, in UTF-8.
ATTRIBUTE_LIMIT = 10_000_000

_TOO_DEEP = etree.XPath(f"boolean({'/*' * (DEPTH_LIMIT + 1)})")

_DECLARED_VERSION = re.compile(r"""<\?xml\s+version\s*=\s*(["'])(.*?)\1""")
_DECLARED_ENCODING = re.compile(r"""<\?xml\s[^>]*?\sencoding\s*=\s*(["'])(.*?)\1""")

#: Some of what may precede a DOCTYPE: a match keeps memory for each repetition, so it has a limited number of them.
_BEFORE_DOCTYPE = re.compile(r"(?:[ \t\r\n]+|<\?.*?\?>|<!--.*?-->){1,1000}", re.DOTALL)

_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", '"': "&quot;", "'": "&apos;"})

#: In a well-formed file without DOCTYPE: ``<`` and a name begin an element, the rest is skipped.
_MARKUP = re.compile(r"<(?:!--.*?-->|!\[CDATA\[.*?\]\]>|\?.*?\?>|/|([^\s/>]+))", re.DOTALL)


class XmlDocument:
    """An XML file.

    Attributes:
        source: The text.
        root: Its root element, without comments and processing instructions. Names are as they are written, in no
            default namespace, since no URDF parser respects one.
    """

    __slots__ = ("_ordinals", "_tags", "_totals", "root", "source")

    def __init__(self, source: Source, root: etree._Element) -> None:
        self.source = source
        self.root = root
        self._tags: dict[etree._Element, tuple[int, int]] = {}  # from "<" to the end of the name
        self._ordinals: dict[etree._Element, int] = {}
        self._totals: dict[tuple[etree._Element | None, str], int] = {}

    def place(self, element: etree._Element, attribute: str | None = None) -> Place:
        """Place of the start of an element, or of the value of one of its attributes.

        Args:
            element: An element of this file.
            attribute: Name of an attribute as lxml gives it. If the element lacks it, the place is the element's.
        """
        pointer, _ = self._of_root() if element is self.root else self._of(element)
        named = "" if attribute is None else "/@" + written_name(element, attribute)
        return self.source.place(*self.span(element, attribute), pointer + named)

    def span(self, element: etree._Element, attribute: str | None = None) -> tuple[int, int]:
        """Indices in the text of the first character of what `place` is the place of, and of the one after its last."""
        _, (start, end) = self._of_root() if element is self.root else self._of(element)
        after_name = end
        name = None if attribute is None else written_name(element, attribute)
        while name is not None and (found := ATTRIBUTE.match(self.source.text, end)):
            if found[1] == name:
                return found.span(2 if found[2] is not None else 3)
            end = found.end()
        return start, after_name

    def restated(self, element: etree._Element, attribute: str, value: str) -> tuple[Edit]:
        """The edit that gives an attribute another value."""
        return (self.source.edit(*self.span(element, attribute), escaped(value)),)

    def renamed(self, element: etree._Element, attribute: str, name: str) -> tuple[Edit]:
        """The edit that gives an attribute another name."""
        value, _ = self.span(element, attribute)
        start = self.source.text.rindex(attribute, 0, value)
        return (self.source.edit(start, start + len(attribute), name),)

    def retagged(self, element: etree._Element, tag: str) -> tuple[Edit, ...]:
        """The edits that give an element, which contains none like it, another tag."""
        start, end = self.span(element)
        old = self.source.text[start + 1 : end]
        edits = [self.source.edit(start + 1, end, tag)]
        close = self.source.text.find(f"</{old}", end)
        if close >= 0 and not self._is_empty(end):
            edits.append(self.source.edit(close + 2, close + 2 + len(old), tag))
        return tuple(edits)

    def _is_empty(self, end: int) -> bool:
        """Whether an element whose name ends there has only one tag."""
        while found := ATTRIBUTE.match(self.source.text, end):
            end = found.end()
        return self.source.text[end:].lstrip().startswith("/>")

    def _of_root(self) -> tuple[str, tuple[int, int]]:
        """Its pointer and its tag, without those of all others: of a file that is too large, only this is wanted."""
        first = next(found.span() for found in _MARKUP.finditer(self.source.text) if found[1])
        return f"/{written_name(self.root, self.root.tag)}", first

    def _of(self, element: etree._Element) -> tuple[str, tuple[int, int]]:
        if not self._tags:
            self._find_elements()
        return self._path(element), self._tags[element]

    def _find_elements(self) -> None:
        # Only once something is to be reported. libxml2 keeps no columns, and the line where a start tag ends.
        tags = (found.span() for found in _MARKUP.finditer(self.source.text) if found[1])
        for tag, element in zip(tags, self.root.iter("*"), strict=True):
            self._tags[element] = tag
            siblings = (element.getparent(), element.tag)
            self._totals[siblings] = self._ordinals[element] = self._totals.get(siblings, 0) + 1

    def _path(self, element: etree._Element) -> str:
        steps: list[str] = []
        step: etree._Element | None = element
        while step is not None:
            parent = step.getparent()
            index = f"[{self._ordinals[step]}]" if self._totals[parent, step.tag] > 1 else ""
            steps.append(f"/{written_name(step, step.tag)}{index}")
            step = parent
        return "".join(reversed(steps))


def escaped(value: str) -> str:
    """The value of an attribute as a file has it, in quotes of either kind."""
    return value.translate(_ESCAPES)


def written_name(element: etree._Element, name: str) -> str:
    """Name of an element or of one of its attributes as the file has it, with its prefix."""
    if not name.startswith("{"):
        return name
    uri, _, local = name[1:].rpartition("}")
    if name == element.tag:
        return f"{element.prefix}:{local}" if element.prefix else local
    prefixes = [prefix for prefix, bound in element.nsmap.items() if prefix and bound == uri]
    return f"{(prefixes or ['xml'])[0]}:{local}"


class XmlReporter(NamedTuple):
    """Adds diagnostics on an XML file."""

    document: XmlDocument
    diagnostics: Diagnostics

    def report(
        self,
        code: str,
        message: str,
        element: Element,
        attribute: str | None = None,
        hint: Hint = None,
        proposals: Proposals = (),
    ) -> None:
        """Report at an element, or at one of its attributes: see `Diagnostics.report` and `XmlDocument.place`."""
        self.diagnostics.report(code, message, partial(self.document.place, element, attribute), hint, proposals)

    def report_name(
        self, code: str, message: str, element: Element, attribute: str, known: Iterable[str], beside: str = ""
    ) -> None:
        """Report that an attribute has a name that is none of those known; for ``beside`` see `similar`."""
        write = partial(self.document.restated, element, attribute)
        self.report(code, message, element, attribute, *misspelt(element.get(attribute, ""), known, write, beside))


def read_xml(source: Source) -> XmlDocument:
    """Read an XML file, in UTF-8 and without DOCTYPE.

    Raises:
        FileError: ``file-too-large``, ``file-not-utf8``, ``xml-doctype`` or ``xml-syntax``.
    """
    if len(source.data) > FILE_LIMIT:
        raise too_large(source.file, f"{FILE_LIMIT:,} bytes")
    if len(source.text) > TAG_LIMIT and source.text.count("<") + source.text.count("=") > TAG_LIMIT:
        raise too_large(source.file, f"{TAG_LIMIT:,} tags and attributes")
    _refuse_other_version(source)
    _refuse_other_encoding(source)
    _refuse_doctype(source)
    try:
        root = etree.fromstring(source.data, _BOUNDED)
    except etree.XMLSyntaxError:
        root = _read_unbounded(source)
    if source.text.rfind("xmlns") >= 0:  # from the end, which takes a third of the time of `in`
        for element in root.iter("{*}*"):
            if element.prefix is None:
                element.tag = element.tag.rpartition("}")[2]
    return XmlDocument(source, root)


def _read_unbounded(source: Source) -> etree._Element:
    """Read a file that has an error, or that is beyond one of libxml2's own limits.

    Its limit of depth is that of the format; without it, deeper files are taken. Its others are below those of the
    format.
    """
    try:
        root = etree.fromstring(source.data, _parser())
    except etree.XMLSyntaxError as error:
        wrong = syntax_error(source, error)
        if wrong is not None:
            raise wrong from None
        root = _read_with_harmless_errors(source)
    if len(source.data) > ATTRIBUTE_LIMIT:
        _refuse_long_attribute(source, root)
    if _TOO_DEEP(root) and (wrong := syntax_error(source)) is not None:
        raise wrong
    return root


def _parser(recover: bool = False, bounded: bool = False) -> etree.XMLParser:
    """EU-SEC-002, EU-SEC-003: nothing is resolved, included or fetched."""
    return etree.XMLParser(
        encoding="utf-8",
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=not bounded,
        remove_blank_text=True,  # no text of a URDF has a meaning
        remove_comments=True,
        remove_pis=True,
        collect_ids=False,
        recover=recover,
    )


_BOUNDED = _parser(bounded=True)


def _read_with_harmless_errors(source: Source) -> etree._Element:
    """Read a file in which libxml2 finds names of namespaces that are no URIs."""
    parser = _parser(recover=True)
    root = etree.fromstring(source.data, parser)
    for entry in parser.error_log:
        if entry.type not in HARMLESS_ERRORS:
            raise refused(source, entry.type, entry.message, entry.line)
    return root


def _refuse_long_attribute(source: Source, root: etree._Element) -> None:
    for element in root.iter("*"):
        if any(len(str(value).encode()) > ATTRIBUTE_LIMIT for value in element.attrib.values()):
            raise too_large(source.file, f"{ATTRIBUTE_LIMIT:,} bytes in an attribute")


def _refuse_other_version(source: Source) -> None:
    """XML 1.0, fifth edition, productions 24 to 26."""
    declared = _DECLARED_VERSION.match(source.text, 0, 1024)
    if declared is None or re.fullmatch(r"1\.[0-9]+", declared[2]):
        return
    message = f"the file declares version '{short(declared[2])}' of XML; it must be 1.0"
    raise FileError("xml-syntax", message, source.place(*declared.span(2)), 'write version="1.0"')


def _refuse_other_encoding(source: Source) -> None:
    declared = _DECLARED_ENCODING.match(source.text, 0, 1024)
    if declared is None or declared[2].lower() == "utf-8":
        return
    message = f"the file declares the encoding '{short(declared[2])}'; it must be UTF-8"
    hint = "save it as UTF-8, and declare that or no encoding"
    raise FileError("file-not-utf8", message, source.place(*declared.span(2)), hint)


def _refuse_doctype(source: Source) -> None:
    """Check what precedes it, so that no parser ever sees an entity being declared."""
    at = 0
    while before := _BEFORE_DOCTYPE.match(source.text, at):
        at = before.end()
    if source.text.startswith("<!DOCTYPE", at):
        place = source.place(at, at + len("<!DOCTYPE"))
        raise FileError("xml-doctype", "the file has a document type declaration", place, "remove it")
