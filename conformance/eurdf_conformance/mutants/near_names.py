"""Names that are near known ones: too many of them, or too few."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

from eurdf.format import read_extension, urdf, violation
from eurdf.format.urdf import _OPTIONAL_ATTRIBUTES, _OPTIONAL_CHILDREN, _Reader
from eurdf_conformance.mutants.deviation import Deviation, around, instead, together
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import each_issue

#: Whether one name is near a known one.
_Rule = Callable[[str, str], bool]


def _near(rule: _Rule) -> Callable[[str, Iterable[str]], str | None]:
    return lambda name, known: next((one for one in known if rule(name, one)), None)


def _keys(rule: _Rule) -> Deviation:
    """Which keys of version 1 are near one is another matter."""
    return instead(read_extension, "near", _near(rule))


def _elements(rule: _Rule) -> Deviation:
    """Which elements and attributes are near one is another matter."""
    return instead(urdf, "near", _near(rule))


def _rule(replaced: int = 2, exchanged: int = 1, most: int = 2, short: int = 1, fold: bool = True) -> _Rule:
    """The rule, with other weights and bounds."""

    def rule(name: str, known: str) -> bool:
        a, b = (name.lower(), known) if fold else (name, known)

        @cache
        def d(i: int, j: int) -> int:
            if not i or not j:
                return i + j
            ways = [d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + (replaced if a[i - 1] != b[j - 1] else 0)]
            if i > 1 and j > 1 and a[i - 2 : i] == b[j - 1] + b[j - 2]:
                ways.append(d(i - 2, j - 2) + exchanged)
            return min(ways)

        return d(len(a), len(b)) <= (short if len(known) < 5 else most)

    return rule


def _an_edit_in_an_edit(name: str, known: str) -> bool:
    """What was exchanged may be taken apart again: a step each, and no matter where."""
    name = name.lower()
    apart = {known[:i] + known[i + 1] + known[i] + known[i + 2 :] for i in range(len(known) - 1)}
    return _rule()(name, known) or any(name[:i] + name[i + 1 :] in apart for i in range(len(name)))


@mutant("EU-ONE-002")
def near_keys_by_case() -> Deviation:
    """A key in capitals is near none of the five."""
    return _keys(_rule(fold=False))


@mutant("EU-ONE-002")
def near_keys_with_one_replaced() -> Deviation:
    """To replace a character of a key is one edit."""
    return _keys(_rule(replaced=1))


@mutant("EU-ONE-002")
def near_keys_by_one_edit() -> Deviation:
    """A key is near where one edit is enough."""
    return _keys(_rule(most=1))


@mutant("EU-ONE-002")
def near_keys_by_three_edits() -> Deviation:
    """A key is near where three edits are enough."""
    return _keys(_rule(most=3))


@mutant("EU-ONE-002")
def near_keys_exchange_is_two() -> Deviation:
    """To exchange two neighbours in a key is two edits."""
    return _keys(_rule(exchanged=2))


@mutant("EU-ONE-002")
def near_keys_exchange_and_put_in_between() -> Deviation:
    """Two characters of a key may be exchanged and a third put in between."""
    return _keys(_an_edit_in_an_edit)


@mutant("EU-ONE-002")
def near_keys_short_as_long() -> Deviation:
    """Two edits are enough whatever the length of a key."""
    return _keys(_rule(short=2))


@mutant("EU-ONE-002")
def near_keys_by_difflib() -> Deviation:
    """A key is near where difflib of Python says a ratio of 0.8."""
    return _keys(lambda name, known: bool(difflib.get_close_matches(name.lower(), [known], cutoff=0.8)))


@mutant("EU-ONE-002")
def own_key_with_x_is_near() -> Deviation:
    """A key that begins with x- may be near one of the five."""
    return instead(read_extension, "is_own_key", lambda key: False)


@mutant("EU-VER-003")
def misspelt_version_is_data() -> Deviation:
    """A key that is near `extended_urdf` is the user's own, if it stands alone."""
    return _keys(lambda name, known: False)


@mutant("EU-VER-003", versions=("1",))  # what is accepted is of that version
def far_version_is_misspelt() -> Deviation:
    """A key that begins as `extended_urdf` does is taken for it."""
    return _keys(lambda name, known: known.startswith(name.lower()[:8]) and known != "type")


@mutant("EU-URD-026")
def near_elements_by_case() -> Deviation:
    """An element in capitals is near none."""
    return _elements(_rule(fold=False))


@mutant("EU-URD-026")
def near_elements_with_one_replaced() -> Deviation:
    """To replace a character of an element or attribute is one edit."""
    return _elements(_rule(replaced=1))


@mutant("EU-URD-026")
def near_elements_by_one_edit() -> Deviation:
    """An element or attribute is near where one edit is enough."""
    return _elements(_rule(most=1))


@mutant("EU-URD-026")
def near_elements_short_as_long() -> Deviation:
    """Two edits are enough whatever the length of an element or attribute."""
    return _elements(_rule(short=2))


@mutant("EU-URD-026")
def near_elements_by_difflib() -> Deviation:
    """An element or attribute is near where difflib of Python says a ratio of 0.6."""
    return _elements(lambda name, known: bool(difflib.get_close_matches(name, [known])))


@mutant("EU-URD-026")
def attributes_are_not_near() -> Deviation:
    """An attribute that is misspelt is passed over."""
    return instead(_Reader, "attributes", lambda self, element: None)


@mutant("EU-URD-026")
def near_what_must_be_there() -> Deviation:
    """An element or attribute that is near one that must be there is told of too."""
    children = {**_OPTIONAL_CHILDREN, "joint": (*_OPTIONAL_CHILDREN["joint"], "parent", "child")}
    attributes = {**_OPTIONAL_ATTRIBUTES, "limit": ("effort", "velocity", *_OPTIONAL_ATTRIBUTES["limit"])}
    return together(instead(urdf, "_OPTIONAL_CHILDREN", children), instead(urdf, "_OPTIONAL_ATTRIBUTES", attributes))


@mutant("EU-URD-026")
def near_a_limit_that_must_be_there() -> Deviation:
    """An element that is near `limit` is told of where a joint must have that too."""
    return instead(urdf, "_RANGED", frozenset())


@mutant("EU-URD-026")
def near_with_a_prefix() -> Deviation:
    """The prefix of an element is no part of its name."""

    def near_miss(original: Any, self: Any, name: str, optional: tuple[str, ...]) -> str | None:
        local = name.rpartition(":")[2]
        return None if local in optional and ":" not in name else original(self, local, optional)

    def local(name: str, known: Iterable[str]) -> str | None:
        return next((one for one in known if one == name or _rule()(name, one)), None)

    return together(around(_Reader, "near_miss", near_miss), instead(urdf, "near", local))


@mutant("EU-URD-027")
def loop_of_a_link_is_a_closure() -> Deviation:
    """An element `loop` states a closure wherever it stands."""

    def unknown(original: Any, self: Any, parent: Any, child: Any) -> None:
        if not isinstance(child.tag, str) or not self.other_dialect(child):
            original(self, parent, child)

    return around(_Reader, "unknown", unknown)


@mutant("EU-DIA-002", versions=("2",))  # version 1 has no mappings but one
def misspelt_key_is_lacking_too() -> Deviation:
    """A key that is misspelt is told of as unknown, and as lacking where it must be there."""
    return instead(violation, "near", lambda name, known: None)


@mutant("EU-DIA-009")
def lacking_version_at_the_first_key() -> Deviation:
    """Where the version is lacking, the place is the first key of the file."""
    return each_issue(
        lambda issue: (
            {"line": 2, "column": 1} if issue.code == "missing-key" and "lacks 'extended_urdf'" in issue.message else {}
        )
    )
