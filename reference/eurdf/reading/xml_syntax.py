"""Why a text is not XML, in plain words."""

from __future__ import annotations

import re
from typing import Any
from xml.parsers import expat
from xml.parsers.expat import errors

from eurdf.diagnostics import FileError, Fix
from eurdf.reading.other_formats import NAMESPACES, of_text
from eurdf.reading.source import Source, short

#: Maximum depth of nested elements; the default of libxml2.
DEPTH_LIMIT = 256

#: libxml2's errors of a namespace whose name is no URI, or a relative one (xmlerror.h): any text is allowed.
HARMLESS_ERRORS = (99, 100)

#: libxml2's errors for a well-formed file beyond its limits; which one depends on its version.
_RESOURCE_ERRORS = (1, 110, 114)

_NAME = re.compile(r"[^\s<>/=&;\"'()]*")

#: An attribute: its name, and its value in double or single quotes.
ATTRIBUTE = re.compile(r"""\s*([^\s=/>]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")

_UNKNOWN_ENTITY = re.compile(r"&(?!#|(?:lt|gt|amp|quot|apos);)")

#: Between the namespace and the rest of a name, where expat gives both: a character that XML does not allow.
_SEPARATOR = "\f"


class _TooDeep(Exception):  # noqa: N818 - never seen outside
    """Ends the search for the error."""


def syntax_error(source: Source, error: Any = None) -> FileError | None:
    """EU-URD-001: the error of the text, or None if it has only `HARMLESS_ERRORS`.

    Args:
        source: The text.
        error: The `lxml.etree.XMLSyntaxError`. Its columns are in no fixed unit, so that expat is asked first. None
            if libxml2 has accepted the text.
    """
    parser = expat.ParserCreate("utf-8")
    opened: list[tuple[str, int]] = []  # name and byte of each start tag that is not closed yet

    def begin(name: str, _: Any) -> None:
        opened.append((name, parser.CurrentByteIndex))
        if len(opened) > DEPTH_LIMIT:
            raise _TooDeep

    def end(_: str) -> None:
        opened.pop()

    def index(byte: int) -> int:
        return len(source.data[: max(byte, 0)].decode("utf-8", "ignore"))

    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    try:
        parser.Parse(source.data, True)
    except _TooDeep:
        message = f"elements are nested more than {DEPTH_LIMIT} deep"
        return FileError("file-too-large", message, source.place(index(opened[-1][1])))
    except expat.ExpatError as found:
        problem = expat.ErrorString(found.code)
        at = index(parser.ErrorByteIndex)
        if opened and problem in (errors.XML_ERROR_TAG_MISMATCH, errors.XML_ERROR_NO_ELEMENTS):
            name, byte = opened[-1]
            return _not_closed(source, problem, at, name, index(byte))
        start, end_, message, hint = _explain(source.text, problem, at)
        return FileError("xml-syntax", message, source.place(start, end_), hint)
    if (wrong := _namespace_error(source)) is not None:
        return wrong
    if error is None or error.code in HARMLESS_ERRORS:
        return None
    return refused(source, error.code, error.msg, error.position[0])


def _namespace_error(source: Source) -> FileError | None:
    """What is wrong with the namespaces of a well-formed text."""
    parser = expat.ParserCreate("utf-8", _SEPARATOR)
    declared: dict[str | None, list[str]] = {"xml": [""]}  # the namespaces of each prefix, the innermost last

    parser.StartNamespaceDeclHandler = lambda prefix, uri: declared.setdefault(prefix, []).append(uri)
    parser.EndNamespaceDeclHandler = lambda prefix: declared[prefix].pop()
    try:
        parser.Parse(source.data, True)
    except expat.ExpatError as found:
        at = len(source.data[: max(parser.ErrorByteIndex, 0)].decode("utf-8", "ignore"))
        start, end, message, hint = _explain_namespaces(source.text, expat.ErrorString(found.code), at, declared)
        return FileError("xml-syntax", message, source.place(start, end), hint)
    return None


def _explain_namespaces(
    text: str, problem: str, at: int, declared: dict[str | None, list[str]]
) -> tuple[int, int, str, str | None]:
    """As `_explain`, for namespaces.

    Expat points at a character: of an element its first, or inside a name. The namespaces of each prefix are
    ``declared``, the innermost last.
    """
    if problem == errors.XML_ERROR_INVALID_TOKEN:
        while _NAME.fullmatch(text[at - 1]) and text[at - 1] != "?":
            at -= 1
        name = _name_at(text, at)
        hint = "a name has at most one ':', between a prefix and a name; that of an instruction and an entity has none"
        return *name.span(), f"the ':' in the name '{short(name[0])}' is not allowed there", hint
    names = [_name_at(text, at + 1)]
    values: list[re.Match[str]] = []
    while found := ATTRIBUTE.match(text, names[-1].end() if not values else values[-1].end()):
        names.append(_name_at(text, found.start(1)))
        values.append(found)
    for found in values:  # expat has taken back those of the element itself
        if found[1].startswith("xmlns:"):
            declared.setdefault(found[1].removeprefix("xmlns:"), []).append(found[2] or found[3])
    expanded: dict[tuple[str, str], str] = {}
    for name in names:
        prefix, _, local = name[0].rpartition(":")
        if problem == errors.XML_ERROR_UNBOUND_PREFIX and prefix not in ("", "xmlns") and not declared.get(prefix):
            namespace = NAMESPACES.get(prefix, f"urn:{short(prefix)}")
            hint = f'declare it, as in <robot xmlns:{short(prefix)}="{namespace}">, or remove the prefix'
            return *name.span(), f"the prefix '{short(prefix)}' of '{short(name[0])}' is not declared", hint
        if problem == errors.XML_ERROR_DUPLICATE_ATTRIBUTE and declared.get(prefix) and name is not names[0]:
            other = expanded.setdefault((declared[prefix][-1], local), name[0])
            if other != name[0]:
                message = f"the attributes '{short(other)}' and '{short(name[0])}' have one name in one namespace"
                return *name.span(), message, "remove one of them"
    if problem == errors.XML_ERROR_UNDECLARING_PREFIX:
        empty = next(found for found in values if found[1].startswith("xmlns:") and not (found[2] or found[3]))
        return *empty.span(1), f"the namespace '{short(empty[1])}' is empty", "give it a name, or remove it"
    reserved = "'xml', 'xmlns' and their namespaces are those of XML: use others" if "prefix" in problem else None
    return *names[0].span(), f"<{short(names[0][0])}>: {problem}", reserved


def refused(source: Source, code: int, message: str, line: int) -> FileError:
    """The error of a well-formed file that libxml2 refuses, from libxml2's error."""
    if code in _RESOURCE_ERRORS:
        message = "a name, a text or the value of an attribute is too long for the XML parser"
        return FileError("file-too-large", message, source.place_of_line(line))
    message = re.sub(r",? line \d+, column \d+.*", "", message.strip(), flags=re.DOTALL)
    return FileError("xml-syntax", short(message[:1].lower() + message[1:]), source.place_of_line(line))


def _not_closed(source: Source, problem: str, at: int, name: str, opened: int) -> FileError:
    """An element that the file, or another element, ends before it does."""
    if problem == errors.XML_ERROR_NO_ELEMENTS:
        place = source.place(opened, opened + 1 + len(name))
        return FileError("xml-syntax", f"<{short(name)}> is never closed", place, f"close it with </{short(name)}>")
    closing = _name_at(source.text, at)
    line, _ = source.position(opened)
    start = opened + 1
    fixes = (
        Fix(f"write <{closing[0]}> on line {line}", (source.edit(start, start + len(name), closing[0]),), rivals=True),
        Fix(f"write </{name}>", (source.edit(at, closing.end(), name),), rivals=True),
    )
    name = short(name)
    message = f"</{short(closing[0])}> does not match the open <{name}> of line {line}; </{name}> is expected"
    return FileError("xml-syntax", message, source.place(at - 2, closing.end()), None, fixes)


def _explain(text: str, problem: str, at: int) -> tuple[int, int, str, str | None]:
    """First character of what is wrong and the one after its last, message and hint, for what expat says of it."""
    end = min(at + 1, len(text))
    if problem == errors.XML_ERROR_INVALID_TOKEN:
        return _stray_character(text, at)
    if problem == errors.XML_ERROR_NO_ELEMENTS:
        return at, at, "the file has no element" if text.strip() else "the file is empty", None
    if problem == errors.XML_ERROR_SYNTAX:
        if found := of_text(text):
            return at, end, f"the file is {found.title}", found.hint
        return at, end, "the file does not begin with an element", 'a URDF begins with <robot name="...">'
    if problem == errors.XML_ERROR_UNCLOSED_CDATA_SECTION:
        at = text.rfind("<![CDATA[")
        return at, at + len("<![CDATA["), "'<![CDATA[' is never closed", "close it with ']]>'"
    if problem == errors.XML_ERROR_UNCLOSED_TOKEN:
        what = "'<!--'" if text.startswith("<!--", at) else "'<?'" if text.startswith("<?", at) else "this '<'"
        return at, end, f"{what} is never closed", None
    if problem == errors.XML_ERROR_DUPLICATE_ATTRIBUTE:
        end = _name_at(text, at).end()
        return at, end, f"the attribute '{short(text[at:end])}' occurs twice in one element", None
    if problem == errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT:
        return at, end, "there is content after the end of the root element", "an XML file has one root element"
    if problem == errors.XML_ERROR_UNDEFINED_ENTITY:
        entity = _UNKNOWN_ENTITY.search(text, at)  # expat points at the element, if it is in an attribute
        at = entity.start() if entity else at
        end = _name_at(text, at + 1).end()
        hint = "XML defines &lt; &gt; &amp; &quot; and &apos;; write &amp; for a single '&'"
        return at, end, f"the entity '{short(text[at:end])};' is unknown", hint
    if problem == errors.XML_ERROR_MISPLACED_XML_PI:
        return at, end, "the XML declaration is not at the very beginning of the file", None
    return at, end, problem, None


def _stray_character(text: str, at: int) -> tuple[int, int, str, str | None]:
    end = min(at + 1, len(text))
    character = text[at:end]
    single = text.rfind("&", 0, at)
    if single >= 0 and _NAME.fullmatch(text, single + 1, at) and not text.startswith("#", single + 1):
        return single, single + 1, "a '&' is not escaped", "write &amp; for it"
    if text[at - 2 : at] == "--" and text.rfind("<!--", 0, at) > text.rfind("-->", 0, at):
        return at - 2, at, "'--' is not allowed in a comment", None
    if text[:at].rstrip().endswith("="):
        return at, end, "the value of an attribute must be quoted", None
    if character == "<":
        return at, end, "a '<' is inside a tag", "close the tag before it with '>', or write &lt; in a value"
    if character in (" ", "\t", "\n", "\r"):
        return at, end, "white space is not allowed here", None
    if not character:
        return at, at, "the file ends too early", None
    shown = f"'{character}'" if character.isprintable() else f"the character U+{ord(character):04X}"
    return at, end, f"{shown} is not allowed here", None


def _name_at(text: str, at: int) -> re.Match[str]:
    """The name that begins there, empty if none does."""
    return next(_NAME.finditer(text, at))
