"""The user's own data, kept as another language would have it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from urllib.parse import quote

from eurdf.linking import link
from eurdf_conformance.mutants.deviation import Deviation, instead
from eurdf_conformance.mutants.mutant import Mutant, mutant
from eurdf_conformance.mutants.of_the_reference import canonical
from eurdf_conformance.oracle.own import own_data

#: The clause that asks for own data, by version.
_KEPT = {"1": "EU-ONE-008", "2": "EU-EXT-002"}


def _within(value: Any, change: Callable[[Any], Any]) -> Any:
    """A value with all that is in it changed, from the outside inwards."""
    value = change(value)
    if isinstance(value, dict):
        return {key: _within(item, change) for key, item in value.items()}
    return [_within(item, change) for item in value] if isinstance(value, list) else value


def _kept(name: str, breaks: str, change: Callable[[Any], Any]) -> list[Mutant]:
    """Two mutants, one a version, by which own data, and what is in it, is changed."""

    def deviation() -> Deviation:
        return canonical(lambda robot: {"own": _within(robot.own, change)})

    return [Mutant(f"{name}_{version}", clause, breaks, deviation) for version, clause in _KEPT.items()]


def _empty_list(value: Any) -> Any:
    return [] if value == {} else value


def _without_nulls(value: Any) -> Any:
    return {key: item for key, item in value.items() if item is not None} if isinstance(value, dict) else value


def _without_nothing(value: Any) -> Any:
    return {key: item for key, item in value.items() if item or item == 0.0} if isinstance(value, dict) else value


def _without_empty_keys(value: Any) -> Any:
    gone = ("", "/")
    return {key: item for key, item in value.items() if key not in gone} if isinstance(value, dict) else value


def _without_prototypes(value: Any) -> Any:
    gone = ("__proto__", "/__proto__", "/x-__proto__")
    return {key: item for key, item in value.items() if key not in gone} if isinstance(value, dict) else value


def _numbers(value: Any) -> Any:
    return int(value) if isinstance(value, bool) else value


OWN = (
    *_kept("empty_mapping_is_a_list", "An empty mapping of the user's own is an empty list, as in Lua.", _empty_list),
    *_kept("null_is_dropped", "A key of the user's own whose value is null is dropped.", _without_nulls),
    *_kept("nothing_is_dropped", "A key of the user's own is dropped whose value is false or empty.", _without_nothing),
    *_kept("empty_key_is_dropped", "In the user's own data, a key of no characters is dropped.", _without_empty_keys),
    *_kept("key_of_every_object_is_dropped", "A key __proto__ is lost, as in JavaScript.", _without_prototypes),
    *_kept("true_is_kept_as_one", "In the user's own data, a boolean is 0 or 1.", _numbers),
)


@mutant("EU-CAN-002")
def pointers_escaped_twice() -> Deviation:
    """In a JSON pointer the slash is escaped before the tilde, so that its own is escaped as well."""
    return _escaped_twice()


@mutant("EU-CAN-003")
def pointers_of_version_1_escaped_twice() -> Deviation:
    """In a JSON pointer the slash is escaped before the tilde, so that its own is escaped as well."""
    return _escaped_twice()


@mutant("EU-CAN-002")
def pointers_of_a_uri() -> Deviation:
    """JSON pointers are those of a URI, with percent signs."""
    return _of_a_uri()


@mutant("EU-CAN-003")
def pointers_of_version_1_of_a_uri() -> Deviation:
    """JSON pointers are those of a URI, with percent signs."""
    return _of_a_uri()


@mutant("EU-CAN-003")
def own_data_within_that_of_version_1() -> Deviation:
    """In version 1 a key that begins with x- within the user's own data is listed once more, by itself."""

    def listed(own: dict[str, Any]) -> dict[str, Any]:
        return own | {inner: value for where, item in own.items() for inner, value in own_data(item, where).items()}

    return canonical(lambda robot: {"own": listed(robot.own)})


def _escaped_twice() -> Deviation:
    return instead(
        link,
        "json_pointer",
        lambda steps: "".join("/" + str(step).replace("/", "~1").replace("~", "~0") for step in steps),
    )


def _of_a_uri() -> Deviation:
    return instead(
        link,
        "json_pointer",
        lambda steps: "".join("/" + quote(str(step).replace("~", "~0").replace("/", "~1"), "~") for step in steps),
    )
