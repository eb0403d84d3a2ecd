"""Reading YAML 1.2 into plain values, with the place of each.

libyaml finds the nodes; their values are decided here, by the core schema, since the constructors that come with
libyaml's Python binding follow YAML 1.1.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial
from math import copysign, isfinite, isnan
from typing import Any, NamedTuple

from yaml import CSafeLoader
from yaml.error import MarkedYAMLError, YAMLError
from yaml.events import AliasEvent, Event, MappingStartEvent, ScalarEvent, SequenceStartEvent, StreamEndEvent

from eurdf.diagnostics import Diagnostics, Edit, FileError, Fix, Hint, Place, Proposals
from eurdf.reading import yaml_syntax
from eurdf.reading.core_schema import TAG_PREFIX, resolve, resolve_tagged
from eurdf.reading.other_formats import of_text, other_format
from eurdf.reading.source import FILE_LIMIT, Source, short, too_large
from eurdf.reading.yaml_node import Alias, Node, Pointer, Span, YamlCollection, json_pointer, start_of

#: Maximum depth of nested mappings and lists, aliases expanded.
DEPTH_LIMIT = 64

#: Maximum number of nodes (mappings, lists, keys and values) in a file, and of nodes that all of its aliases repeat.
NODE_LIMIT = 100_000

#: %TAG directives that a file may have; the time libyaml takes grows with the square of their number.
DIRECTIVE_LIMIT = 64

#: What libyaml from 0.2.6 on says at 1,000 levels, which its scanner may reach before its parser reaches `DEPTH_LIMIT`.
_TOO_DEEP_TO_SCAN = "exceeded maximum nesting depth"

_CORE_TAGS = ("!!str", "!!int", "!!float", "!!bool", "!!null", "!!map", "!!seq")
#: After the end of a document: white space, comments and further ends.
_BETWEEN_DOCUMENTS = re.compile(r"(?:\s|#[^\r\n]*|\.\.\.(?=\s))*")
#: After a key: a colon, and a value that begins on the same line.
_VALUE_BESIDE = re.compile(r"[ \t]*:[ \t]+[^\s#|>&!*]")
#: A tag, behind an anchor if there is one, and the blanks behind it.
_TAG = re.compile(r"(?:&[^\s,\[\]{}]+[ \t]+)?(![^\s,\[\]{}]*[ \t]*)")
_KINDS = {dict: "a mapping", list: "a list", str: "a string", bool: "a boolean", type(None): "empty"}


class YamlDocument:
    """A YAML file as plain values.

    Attributes:
        source: The text.
        root: The top level, with the place of everything in it.
        data: The same as ``dict`` with string keys, ``list``, ``str``, ``int``, ``float``, ``bool`` and ``None``. A
            value with several aliases is one object in several places.
    """

    def __init__(self, source: Source, root: YamlCollection) -> None:
        self.source, self.root = source, root
        self.data: dict[str, Any] = root.data

    def span(self, pointer: Sequence[str | int] = (), key: bool = False) -> Span:
        """Indices in the text of the first character of a value, or of its key, and of the one after the last.

        A value that is an alias has the place of the alias; what is in it, that of where it is written.

        Args:
            pointer: Keys and indices that lead to the value. If there is no such value, the place is that of the
                innermost one on the path that exists.
            key: Whether the key is meant rather than the value. An item of a list has no key.
        """
        node: Node = self.root
        key_span: Span | None = None
        for step in pointer:
            collection = node.target if isinstance(node, Alias) else node
            if not isinstance(collection, YamlCollection) or step not in collection.nodes:
                break
            node, key_span = collection.nodes[step], collection.keys.get(step)
        if key and key_span is not None:
            node = key_span
        return node if isinstance(node, tuple) else node.span

    def place(self, pointer: Sequence[str | int] = (), key: bool = False) -> Place:
        """Place of a value, or of its key; for the arguments see `span`."""
        return self.source.place(*self.span(pointer, key), json_pointer(pointer))

    def edit(self, pointer: Sequence[str | int], text: str, key: bool = False) -> Edit:
        """An edit that writes a text in the place of a value on one line, or of its key."""
        start, end = self.span(pointer, key)
        return self.source.edit(start, start if end is None else end, text)


class YamlReporter(NamedTuple):
    """Adds diagnostics on a YAML file."""

    document: YamlDocument
    diagnostics: Diagnostics

    def report(
        self,
        code: str,
        message: str,
        pointer: Pointer,
        hint: Hint = None,
        proposals: Proposals = (),
        *,
        key: bool = False,
    ) -> None:
        """Report at a value, or at its key: see `Diagnostics.report` and `YamlDocument.place`."""
        self.diagnostics.report(code, message, partial(self.document.place, pointer, key), hint, proposals)


def read_yaml(source: Source) -> YamlDocument:
    """Read a file that holds one YAML 1.2 mapping.

    Raises:
        FileError: ``file-too-large`` or one of the ``yaml-`` codes, at the first error.
    """
    try:
        return YamlDocument(source, _read_nodes(source))
    except FileError as error:
        if found := of_text(source.text):
            raise other_format(error.diagnostic.code, found, source.place(0)) from None
        raise


def plain_data(text: str) -> dict[str, Any] | None:
    """The plain values of a text; None if it is not one YAML mapping."""
    try:
        return read_yaml(Source("", text, text.encode())).data
    except FileError:
        return None


def _read_nodes(source: Source) -> YamlCollection:
    """The top level of a file, or its first error."""
    if len(source.data) > FILE_LIMIT:
        raise too_large(source.file, f"{FILE_LIMIT:,} bytes")
    text, original = yaml_syntax.without_other_breaks(source)
    data = text.encode() if original else source.data
    text = source.text.rstrip(" ")
    if text != source.text and text[-1:] in "\r\n":
        data += b"\n"  # of a last line of blanks, without which libyaml would not see that it is one
    if data.count(b"\n%TAG") + data.count(b"\r%TAG") + data.startswith(b"%TAG") > DIRECTIVE_LIMIT:
        raise too_large(
            source.file, f"{DIRECTIVE_LIMIT} %TAG directives", yaml_syntax.tags_fix(source, 4 * DIRECTIVE_LIMIT)
        )
    try:
        root = _NodeReader(source, CSafeLoader(data).get_event, original).read()
    except (YAMLError, UnicodeDecodeError) as error:
        if isinstance(error, MarkedYAMLError) and error.problem == _TOO_DEEP_TO_SCAN and error.problem_mark:
            start = data.decode()[: error.problem_mark.index].encode()
            _NodeReader(source, CSafeLoader(start).get_event, original).read()  # which refuses less depth
        raise yaml_syntax.syntax_error(source, error) from None
    if "\ufeff" in source.text and (mark := yaml_syntax.stray_mark(source, data)) is not None:
        raise mark
    return root


class _NodeReader:
    """Builds the nodes of one document from libyaml's events, without recursion."""

    def __init__(self, source: Source, next_event: Any, original: dict[int, str]) -> None:
        self._source, self._text = source, source.text
        self._next_event = next_event
        self._original = original
        self._anchors: dict[str, tuple[Any, Span | YamlCollection]] = {}
        self._count = 0  # of nodes, of which an alias is one
        self._copies = 0  # of nodes that aliases refer to
        self._expansion = 0  # by how many nodes that is more than the aliases themselves
        self._file = YamlCollection([], _span(next_event()), 0)  # whose one item is the top level
        self._open = [self._file]  # from the outermost to the innermost

    def read(self) -> YamlCollection:
        """The top level, a mapping."""
        document = self._next_event()
        if type(document) is StreamEndEvent:
            what = "contains only comments" if self._source.text.strip("\ufeff \t\r\n") else "is empty"
            raise FileError("yaml-empty", f"the file {what}; it must contain a mapping", Place(self._source.file))
        if document.version is not None and document.version != (1, 2):
            version = ".".join(map(str, document.version))
            message = f"the %YAML directive states version {version}; it must be 1.2"
            raise self._error(
                "yaml-version", message, document, "remove the directive", yaml_syntax.version_fix(self._source)
            )
        top_level, next_event = self._file.data, self._next_event
        while not top_level:
            event = next_event()
            kind = type(event)
            if kind is ScalarEvent:
                self._scalar(event)
            elif kind is MappingStartEvent:
                self._begin(event, {}, "map")
            elif kind is SequenceStartEvent:
                self._begin(event, [], "seq")
            elif kind is AliasEvent:
                self._alias(event)
            else:
                self._end(event)
        self._expect_end()
        top = self._file.nodes[0]
        if isinstance(top, YamlCollection) and top.is_mapping:
            return top
        value = top_level[0]
        message = "the document is empty" if value is None else f"the top level is {_kind(value)}"
        span = top if isinstance(top, tuple) else top.span
        # Of a value that is left out, there is no place to point at.
        place = Place(self._source.file) if span[0] == span[1] else self._source.place(*span)
        fixes = yaml_syntax.mapping_fix(self._source, start_of(top), value)
        raise FileError("yaml-empty", f"{message}; it must be a mapping", place, None, fixes)

    def _next_node(self) -> None:
        """EU-FIL-002: one more node."""
        self._count += 1
        if self._count > NODE_LIMIT:
            raise too_large(self._source.file, f"{NODE_LIMIT:,} keys and values")

    def _scalar(self, event: Any) -> None:
        self._next_node()
        text = event.value.translate(self._original) if self._original else event.value
        value: Any = text
        tag = event.tag
        if tag is None:
            if event.implicit[0]:  # plain
                value = resolve(text)
        elif tag != "!":
            try:
                value = resolve_tagged(tag, text)
            except ValueError:
                raise self._tag_error(event, _quote(text)) from None
        span = event.start_mark.index, event.end_mark.index
        if event.anchor is not None:
            self._check_name(event, "&")
            self._anchors[event.anchor] = value, span
        around = self._open[-1]
        if around.awaits_key:
            self._key(value, event, span)
            return
        if type(value) is float and not isfinite(value):
            what = "is not a finite number" if "n" in text.lower() else "is too large for a number"
            unlimited = self._source.edit(*span, f"{copysign(1e308, value):.1e}")
            fix = Fix(f"write {unlimited.text} for no limit", (unlimited,))
            fixes = () if isnan(value) or not self._is_limit() else (fix,)
            raise self._error("yaml-not-finite", f"{_quote(text)} {what}", event, None, fixes)
        around.add(value, span)

    def _is_limit(self) -> bool:
        """Whether the next value is a limit of a joint, which limits nothing if it is large enough (EU-FIL-006)."""
        return any(each.key == "limits" for each in self._open[1:-1] if each.is_mapping)

    def _begin(self, event: Any, data: dict[str, Any] | list[Any], tag: str) -> None:
        start, end = _span(event)
        if self._open[-1].awaits_key:
            self._key(data, event, (start, end))
        if len(self._open) > DEPTH_LIMIT:
            message = f"mappings and lists are nested more than {DEPTH_LIMIT} deep"
            raise self._error("yaml-too-deep", message, event)
        if event.tag not in (None, "!", TAG_PREFIX + tag):
            raise self._tag_error(event, _kind(data))
        collection = YamlCollection(data, (start, end if event.flow_style else None), self._count + self._expansion)
        self._next_node()
        if event.anchor is not None:
            self._check_name(event, "&")
            self._anchors[event.anchor] = data, collection
        self._open.append(collection)

    def _end(self, event: Event) -> None:
        collection = self._open.pop()
        collection.is_open = False
        start, end = collection.span
        if end is not None:
            collection.span = start, _span(event)[1]
        collection.size = self._count + self._expansion - collection.size
        around = self._open[-1]
        if around.height <= collection.height:
            around.height = collection.height + 1
        around.add(collection.data, collection)

    def _alias(self, event: AliasEvent) -> None:
        self._check_name(event, "*")
        name = str(event.anchor)
        shown = short(name)
        if name not in self._anchors:
            message = f"the alias '*{shown}' has no anchor '&{shown}' before it"
            fixes = yaml_syntax.anchor_fix(self._source, *_span(event), name)
            raise self._error("yaml-alias", message, event, None, fixes)
        value, target = self._anchors[name]
        collection = target if isinstance(target, YamlCollection) else None
        if collection is not None and collection.is_open:
            raise self._error("yaml-alias", f"the alias '*{shown}' refers to a node that contains it", event)
        self._next_node()
        size = 1 if collection is None else collection.size
        self._copies += size
        self._expansion += size - 1
        if self._copies > NODE_LIMIT:
            message = f"the aliases of the file expand to more than {NODE_LIMIT:,} keys and values"
            raise self._error("yaml-alias", message, event)
        around = self._open[-1]
        if around.awaits_key:
            self._key(value, event, _span(event))
        elif collection is None:
            around.add(value, _span(event))
        else:
            if len(self._open) - 1 + collection.height > DEPTH_LIMIT:
                message = f"with the alias '*{shown}', mappings and lists are nested more than {DEPTH_LIMIT} deep"
                raise self._error("yaml-too-deep", message, event)
            around.height = max(around.height, collection.height + 1)
            around.add(value, Alias(_span(event), collection))

    def _check_name(self, event: Any, sign: str) -> None:
        """EU-YML-012: where libyaml ends the name of an anchor, YAML 1.2 may go on."""
        text, name = self._source.text, f"{sign}{event.anchor}"
        begin = text.find(name, event.start_mark.index)
        if text[begin + len(name) : begin + len(name) + 1].strip(" \t\r\n,[]{}"):
            raise yaml_syntax.unusual_name(self._source.place(begin, begin + len(name)))

    def _key(self, value: Any, event: Event, span: tuple[int, int]) -> None:
        """Take a value as the next key of the innermost mapping."""
        mapping = self._open[-1]
        if self._text.startswith("?", span[0] - 1) and span[0]:
            # EU-YML-012: within braces, to libyaml it marks a key whatever follows.
            message = "a '?' is not allowed directly before a key inside braces or brackets"
            raise self._error("yaml-syntax", message, event, "quote the key, and its '?' if it is a part of it")
        if type(value) is not str:
            text = event.value if isinstance(event, ScalarEvent) else ""
            what = ("a key is null" if text else "a key is empty") if value is None else f"a key is {_kind(value)}"
            hint = f'quote it: "{text}"' if text == short(text) != "" else None
            fixes = () if hint is None else (Fix(hint, (self._source.edit(*span, f'"{text}"'),)),)
            raise self._error("yaml-key-not-string", f"{what}; it must be a string", event, hint, fixes)
        if value in mapping.keys:
            line, _ = self._source.position(mapping.keys[value][0])
            mapping.key, mapping.awaits_key = value, False  # for the pointer
            message = f"the key {_quote(value)} occurs twice in one mapping"
            hint = f"it first occurs on line {line}"
            error = self._error("yaml-duplicate-key", message, event, hint, self._repeated(span, line))
            error.diagnostic.related = self._source.place(*mapping.keys[value])
            raise error
        mapping.key, mapping.awaits_key = value, False
        mapping.keys[value] = span

    def _expect_end(self) -> None:
        end = self._next_event()
        message = "a second document begins here; the file must contain only one"
        try:
            after = self._next_event()
        except MarkedYAMLError as error:
            # libyaml wants '---' before a second document; YAML 1.2 takes one that merely follows '...'.
            if end.explicit and error.problem == "did not find expected <document start>" and error.problem_mark:
                between = _BETWEEN_DOCUMENTS.match(self._source.text, end.end_mark.index)
                assert between is not None  # it matches the empty string too
                raise FileError("yaml-several-documents", message, self._source.place(between.end())) from None
            raise
        if type(after) is not StreamEndEvent:
            start, end = _span(after)
            fixes = (Fix("remove '---'", (self._source.edit(start, end, ""),)),)
            raise self._error("yaml-several-documents", message, after, None, fixes if end - start == 3 else ())

    def _repeated(self, key: Span, first: int) -> tuple[Fix, ...]:
        """The removal of a line that begins with a key, and is the same as the first one that does."""
        lines, text = self._source.lines, self._source.text
        line, _ = lines.position(key[0])
        span = lines.span(line)
        has_value = _VALUE_BESIDE.match(text, key[1] or key[0]) is not None
        if span is None or lines.line(line) != lines.line(first) or text[span[0] : key[0]].strip() or not has_value:
            return ()
        return (Fix(f"remove line {line}", (self._source.edit(span[0] - 1, span[1], ""),)),)

    def _tag_error(self, event: Any, what: str) -> FileError:
        shown = event.tag.replace(TAG_PREFIX, "!!", 1)
        found = _TAG.match(self._source.text, event.start_mark.index)
        fixes = () if found is None else (Fix("remove the tag", (self._source.edit(*found.span(1), ""),)),)
        if shown in _CORE_TAGS:
            return self._error("yaml-unknown-tag", f"{what} does not match the tag '{shown}'", event, None, fixes)
        return self._error("yaml-unknown-tag", f"the tag {_quote(shown)} is unknown", event, "remove it", fixes)

    def _error(
        self, code: str, message: str, event: Event, hint: str | None = None, fixes: tuple[Fix, ...] = ()
    ) -> FileError:
        steps: list[str | int] = []
        for collection in self._open[1:]:
            if not collection.is_mapping:
                steps.append(len(collection.data))
            elif not collection.awaits_key:
                steps.append(collection.key)
        return FileError(code, message, self._source.place(*_span(event), json_pointer(steps)), hint, fixes)


def _span(event: Any) -> tuple[int, int]:
    return event.start_mark.index, event.end_mark.index


def _kind(value: Any) -> str:
    return _KINDS.get(type(value), "a number")


def _quote(text: str) -> str:
    return repr(short(text))
