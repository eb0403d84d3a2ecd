"""Descriptions whose YAML is read as by a parser of another version, or with other bounds."""

from __future__ import annotations

from typing import Any

from eurdf.diagnostics import Fault
from eurdf.linking.description import Description
from eurdf.reading import source, yaml_reader
from eurdf_conformance.level import Level
from eurdf_conformance.mutants.accepting import accepting
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import refused

accepts_python_tags = accepting("yaml-unknown-tag", "EU-SEC-001", "accepts_python_tags")


def _begins(read: Description, mark: bytes) -> bool:
    assert read.document is not None
    assert read.urdf is not None
    files = read.document.source.file, read.urdf.document.source.file
    for file in files:
        with open(file, "rb") as opened:
            if opened.read(len(mark)) == mark:
                return True
    return False


@mutant("EU-FIL-003")
def byte_order_mark_refused() -> Deviation:
    """A file that begins with a byte order mark is refused."""
    return refused(lambda read: _begins(read, source.BOM))


@mutant("EU-FIL-002")
def bounds_of_a_hundredth() -> Deviation:
    """A description may have a hundredth of the keys and values."""
    return instead(yaml_reader, "NODE_LIMIT", 1000)


@mutant("EU-FIL-002")
def bounds_of_three_thousand() -> Deviation:
    """A description may have 3000 keys and values."""
    return instead(yaml_reader, "NODE_LIMIT", 3000)


@mutant("EU-FIL-002")
def keys_and_values_without_bound() -> Deviation:
    """A description may have any number of keys and values."""
    return instead(yaml_reader, "NODE_LIMIT", 10**9)


@mutant("EU-YML-002")
def first_of_a_list() -> Deviation:
    """Of a description that is a list, the first item counts."""

    def read(original: Any, self: Any) -> Any:
        try:
            return original(self)
        except Fault:
            (items,) = [node for node in self._file.nodes.values() if not isinstance(node, tuple)] or [None]
            if items is None or not items.nodes or not hasattr(items.nodes[0], "nodes"):
                raise
            return items.nodes[0]

    return around(yaml_reader._Reader, "read", read)


@mutant("EU-YML-003")
def marker_of_a_document_refused() -> Deviation:
    """A description that begins with --- or ends with ... is refused."""

    def marked(read: Description) -> bool:
        assert read.document is not None
        return any(line.rstrip() in ("---", "...") for line in read.document.source.text.splitlines())

    return refused(marked)


@mutant("EU-YML-005")
def tags_of_the_core_schema_refused() -> Deviation:
    """No tag is known, those of the core schema neither."""

    def tag(original: Any, self: Any, event: Any) -> None:
        if event.tag not in (None, "!"):
            raise self._tag_fault(event, "this")
        original(self, event)

    return around(yaml_reader._Reader, "_scalar", tag)


@mutant("EU-YML-005")
def tag_does_not_turn() -> Deviation:
    """A tag is known but has no effect: !!str 12 is the number 12."""

    def scalar(original: Any, self: Any, event: Any) -> None:
        if event.tag is not None:
            event.tag, event.implicit = None, (True, False)
        original(self, event)

    return around(yaml_reader._Reader, "_scalar", scalar)


@mutant("EU-YML-006")
def aliases_refused() -> Deviation:
    """An alias is refused."""

    def alias(original: Any, self: Any, event: Any) -> None:
        raise self._fault("yaml-alias", "no aliases here", event)

    return around(yaml_reader._Reader, "_alias", alias)


@mutant("EU-YML-006", level=Level.KINEMATICS)
def first_anchor_counts() -> Deviation:
    """Of two anchors of one name an alias means the first."""

    class First(dict[str, Any]):
        def __setitem__(self, name: str, value: Any) -> None:
            self.setdefault(name, value)

    def init(original: Any, self: Any, *arguments: Any) -> None:
        original(self, *arguments)
        self._anchors = First()

    return around(yaml_reader._Reader, "__init__", init)


@mutant("EU-YML-007")
def depth_of_63() -> Deviation:
    """Nodes may be nested 63 deep."""
    return instead(yaml_reader, "DEPTH_LIMIT", 63)


@mutant("EU-YML-007")
def depth_of_65() -> Deviation:
    """Nodes may be nested 65 deep."""
    return instead(yaml_reader, "DEPTH_LIMIT", 65)


@mutant("EU-YML-008")
def quoted_keys_are_resolved() -> Deviation:
    """A key that looks like a number is one, be it in quotes."""

    def scalar(original: Any, self: Any, event: Any) -> None:
        if event.tag is None and self._open[-1].awaits_key:
            event.implicit = (True, False)
        original(self, event)

    return around(yaml_reader._Reader, "_scalar", scalar)


@mutant("EU-YML-009")
def numbers_of_single_precision() -> Deviation:
    """A number must be within the range of single precision."""

    def resolve(original: Any, text: str) -> Any:
        value = original(text)
        return float("inf") if isinstance(value, float) and abs(value) > 3.4e38 else value

    return around(yaml_reader, "resolve", resolve)


@mutant("EU-YML-010")
def directive_refused() -> Deviation:
    """A %YAML directive is refused, whatever version it names."""

    def directed(read: Description) -> bool:
        assert read.document is not None
        return "%YAML" in read.document.source.text

    return refused(directed)


@mutant("EU-YML-001")
def tabs_refused() -> Deviation:
    """A tab is refused wherever it stands."""

    def tabbed(read: Description) -> bool:
        assert read.document is not None
        return "\t" in read.document.source.text

    return refused(tabbed)


@mutant("EU-EXT-001")
def merge_key_merges() -> Deviation:
    """The key << merges a mapping into the one that it stands in, as in YAML 1.1."""

    def end(original: Any, self: Any, event: Any) -> None:
        mapping = self._open[-1]
        if mapping.is_mapping and isinstance(mapping.data.get("<<"), dict):
            mapping.data.update({**mapping.data.pop("<<"), **mapping.data})
        original(self, event)

    return around(yaml_reader._Reader, "_end", end)
