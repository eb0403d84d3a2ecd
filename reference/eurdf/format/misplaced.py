"""Hints for keys that are in the wrong mapping because they are indented too little or too much."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from eurdf.format.version2 import JOINT_TYPES
from eurdf.format.version2_1 import KEYS
from eurdf.reading.yaml_node import Pointer

if TYPE_CHECKING:
    from eurdf.reading.yaml_reader import YamlDocument

_JOINT_KEYS = frozenset(KEYS["kept type"])

#: Keys that describe a joint or its motor: those of the format, and the words of a URDF and of other formats.
_OF_JOINTS = {
    *_JOINT_KEYS,
    *KEYS["limits"],
    *KEYS["geared actuator"],
    "limit",
    "dynamics",
    "actuated",
    "actuator",
    "motor",
}
_OF_JOINTS -= {"name", "type", "joint", "axes"}

#: Keys of the file whose values are mappings of names that the user chooses.
_NAMED = ("joints", "configurations")


class Indentation:
    """Finds what is probably indented wrongly in one file.

    Args:
        document: The file.
        faulty: Pointers to the errors in it.
    """

    def __init__(self, document: YamlDocument, faulty: Iterable[Pointer]) -> None:
        self._document = document
        self._faulty = {pointer[:end] for pointer in faulty for end in range(1, len(pointer) + 1)}

    def hint(self, pointer: Pointer, value: Any) -> str | None:
        """What to try where a value is of the wrong type; None where its indentation is not the likely reason."""
        if value is None:
            return self._below(pointer)
        return key_of_the_file_hint(pointer) or another_entry_hint(pointer, self._document)

    def _below(self, pointer: Pointer) -> str | None:
        """For a key without a value: whether the next key beside it was meant to be in it."""
        siblings = _mapping_at(self._document.data, pointer[:-1])
        if siblings is None or pointer[-1] not in siblings:
            return None
        keys = list(siblings)
        following = keys[keys.index(pointer[-1]) + 1 :]
        if not following:
            return None
        key = (*pointer[:-1], following[0])
        mine, next_one = self._document.place(pointer, True), self._document.place(key, True)
        in_a_joint = pointer[:-1] == ("joints",) and following[0] in _JOINT_KEYS
        if mine.column != next_one.column or not (key in self._faulty or in_a_joint):
            return None
        return (
            f"if '{following[0]}' on line {next_one.line} belongs to it, indent it deeper than '{pointer[-1]}'; "
            "remove the key if it has no value"
        )


def key_of_the_file_hint(pointer: Pointer) -> str | None:
    """For a key inside another entry that belongs at the top of the file."""
    if len(pointer) < 2 or pointer[-1] not in KEYS[""] or pointer[::2] == ("couplings", "joints"):
        return None
    return f"'{pointer[-1]}' is a key of the whole file: do not indent it"


def key_of_a_joint_hint(pointer: Pointer) -> str | None:
    """For a key in a closure or coupling that describes the joint of a tree."""
    if len(pointer) != 3 or pointer[-1] not in _OF_JOINTS or pointer[0] not in ("closures", "couplings"):
        return None
    if pointer[0] == "couplings":
        return "a coupling has no limit, friction or motor; the joints that it relates have them"
    return (
        "a closure has no coordinate, so no limit, friction, spring or motor: put this joint into the tree, and cut "
        "the loop at another one"
    )


def another_entry_hint(pointer: Pointer, document: YamlDocument) -> str | None:
    """For a key inside a joint or a configuration whose value looks like another joint or configuration."""
    if len(pointer) != 3 or pointer[0] not in _NAMED:
        return None
    name, key = pointer[1:]
    value = (_mapping_at(document.data, pointer[:-1]) or {}).get(str(key))
    if pointer[0] == "joints":
        is_entry = value in JOINT_TYPES if isinstance(value, str) else isinstance(value, dict) and key != "limits"
    else:
        is_entry = isinstance(value, dict)
    return f"if '{key}' is another {str(pointer[0])[:-1]}, indent it like '{name}'" if is_entry else None


def key_outside_hint(mapping: Pointer, key: str, document: YamlDocument) -> str | None:
    """For a key that an item of a list lacks: whether the list's own mapping has it, later in the file."""
    if len(mapping) < 2 or not isinstance(mapping[-1], int):
        return None
    around = _mapping_at(document.data, mapping[:-2])
    if around is None or key not in around:
        return None
    item, outside = document.place(mapping), document.place((*mapping[:-2], key), True)
    if item.line is None or item.column is None or outside.line is None or outside.line < item.line:
        return None
    if (document.source.lines.line(item.line) or "").startswith("{", item.column - 1):
        return None
    return f"if '{key}' on line {outside.line} belongs to it, indent it by {item.column - 1} spaces"


def _mapping_at(data: Any, pointer: Pointer) -> dict[str, Any] | None:
    for step in pointer:
        if not (step in data if isinstance(data, dict) else isinstance(data, list) and isinstance(step, int)):
            return None
        data = data[step]
    return data if isinstance(data, dict) else None
