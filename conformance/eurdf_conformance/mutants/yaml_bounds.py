"""What has a tag, is nested, copied or large in a description, by other rules or bounds."""

from __future__ import annotations

from typing import Any

from eurdf.diagnostics import Fault
from eurdf.reading import core_schema, yaml_reader
from eurdf.reading.yaml_reader import _Reader
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant

#: Keys at the top that say something in one of the versions.
_KNOWN = frozenset(
    {
        *("closed_loop", "type", "name_mot", "joint_name", "joint_type"),
        *("closures", "joints", "actuators", "frames", "configurations"),
    }
)


def _tagged(change: Any) -> Deviation:
    """Of a scalar with a tag that it does not fit, something is made."""

    def resolved(original: Any, tag: str, text: str) -> Any:
        try:
            return original(tag, text)
        except ValueError:
            return change(tag, text)

    return around(yaml_reader, "resolve_tagged", resolved)


@mutant("EU-YML-005")
def tag_that_does_not_fit_is_passed_over() -> Deviation:
    """A tag of the core schema whose form a scalar lacks has no effect."""

    def plain(tag: str, text: str) -> Any:
        if tag.rpartition(":")[2] in ("null", "bool", "int", "float"):
            return core_schema.resolve(text)
        raise ValueError(text)

    return _tagged(plain)


@mutant("EU-YML-005", versions=("2",))
def tags_convert_numbers() -> Deviation:
    """A number is made an integer, or a float, by its tag."""

    def converted(tag: str, text: str) -> Any:
        value = core_schema.resolve(text)
        if isinstance(value, int | float) and tag.endswith((":int", ":float")):
            return int(value) if tag.endswith(":int") else float(value)
        raise ValueError(text)

    return _tagged(converted)


@mutant("EU-YML-005")
def tags_of_collections_have_no_effect() -> Deviation:
    """Whatever tag of the core schema a mapping or a list has, it is one."""

    def begin(original: Any, self: Any, event: Any, data: Any, tag: str) -> None:
        if event.tag and event.tag.startswith(core_schema.TAG_PREFIX):
            event.tag = core_schema.TAG_PREFIX + tag
        original(self, event, data, tag)

    return around(_Reader, "_begin", begin)


@mutant("EU-YML-005")
def tags_of_quoted_scalars_refused() -> Deviation:
    """What stands in quotes is a string, and has no other tag."""

    def scalar(original: Any, self: Any, event: Any) -> None:
        if event.style and event.tag not in (None, "!", core_schema.TAG_PREFIX + "str"):
            raise self._tag_fault(event, "a string")
        original(self, event)

    return around(_Reader, "_scalar", scalar)


@mutant("EU-YML-007")
def scalars_are_nested_too() -> Deviation:
    """A scalar in 64 mappings and lists is nested 65 deep."""

    def scalar(original: Any, self: Any, event: Any) -> None:
        if len(self._open) > yaml_reader.DEPTH_LIMIT and not self._open[-1].awaits_key:
            raise self._fault("yaml-too-deep", "it is nested more than 64 deep", event)
        original(self, event)

    return around(_Reader, "_scalar", scalar)


@mutant("EU-YML-007")
def keys_are_nested_too() -> Deviation:
    """A key of a mapping that is nested 64 deep is nested 65 deep."""

    def key(original: Any, self: Any, value: Any, event: Any) -> None:
        if len(self._open) > yaml_reader.DEPTH_LIMIT:
            raise self._fault("yaml-too-deep", "it is nested more than 64 deep", event)
        original(self, value, event)

    return around(_Reader, "_key", key)


@mutant("EU-YML-006", versions=("2",))  # what version 1 has of the user's own is a part of the answer
def nodes_of_the_file_count_with_copies() -> Deviation:
    """What aliases stand for, and all that the file has beside them, come to at most 100 000 nodes."""

    def alias(original: Any, self: Any, event: Any) -> None:
        original(self, event)
        if self._size() > yaml_reader.NODE_LIMIT:
            raise self._fault("yaml-alias", "there are too many nodes", event)

    return around(_Reader, "_alias", alias)


@mutant("EU-YML-006", versions=("2",))
def one_copy_too_many() -> Deviation:
    """Aliases of scalars are no copies."""

    def alias(original: Any, self: Any, event: Any) -> None:
        before = self._copies
        _, target = self._anchors.get(str(event.anchor), (None, None))
        if isinstance(target, tuple):
            self._copies -= 1
        original(self, event)
        if isinstance(target, tuple):
            self._copies = before

    return around(_Reader, "_alias", alias)


@mutant("EU-YML-009")
def own_numbers_are_not_looked_at() -> Deviation:
    """A number in the user's own data may be infinite."""

    def scalar(original: Any, self: Any, event: Any) -> None:
        try:
            original(self, event)
        except Fault as fault:
            if fault.diagnostic.code != "yaml-not-finite" or self._open[1].key in _KNOWN:
                raise
            self._open[-1].add(0.0, (event.start_mark.index, event.end_mark.index))

    return around(_Reader, "_scalar", scalar)


def _refuses(test: Any) -> Deviation:
    """Some numbers count as beyond the range of a double."""
    return around(yaml_reader, "resolve", lambda resolve, text: float("inf") if test(text, resolve) else resolve(text))


@mutant("EU-YML-009")
def numbers_too_small_refused() -> Deviation:
    """A number that is 0 only when it is rounded is refused."""
    return _refuses(lambda text, resolve: resolve(text) == 0.0 and text.lower().strip("+-").split("e")[0].strip("0."))


@mutant("EU-YML-009")
def integers_above_the_largest_double_refused() -> Deviation:
    """An integer that is more than the largest double is refused, be it the next one."""
    return _refuses(lambda text, resolve: type(value := resolve(text)) is int and value > int(1.7976931348623157e308))


@mutant("EU-YML-009", versions=("2",))
def integers_without_bound() -> Deviation:
    """An integer may be as large as it is."""
    return instead(core_schema, "_integer", lambda text: 0 if len(text) > 256 else int(text, 10))
