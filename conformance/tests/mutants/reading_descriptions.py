"""Parsers that take the data of a description for something else, among them the published loader of version 1."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any
from urllib.parse import quote

import numpy as np

from eurdf_conformance.oracle import canonical, configuration, joint_property, tree, version1
from eurdf_conformance.oracle.version2 import KEYS
from eurdf_conformance.protocol.message import CanonicalRobot
from mutants.answering import each
from mutants.mutant import Members, accepting, instead, text_of

VERSION = "extended_urdf"

Change = Callable[[Members], None]


def _values(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every mapping or list, with each of its keys or indices."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in list(items):
        yield value, key
        yield from _values(item)


def _entries(data: Members, *keys: str) -> Iterator[Members]:
    """The mappings in some lists or mappings of a description."""
    for key in keys:
        listed = data.get(key) or ()
        entries = listed.values() if isinstance(listed, dict) else listed if isinstance(listed, list) else ()
        yield from (entry for entry in entries if isinstance(entry, dict))


def _is_version_1(data: Members) -> bool:
    return VERSION not in data


# -- Version 2 ------------------------------------------------------------------------------------------------------


def _each(change: Callable[[Any], Any]) -> Change:
    """Every value of version 2 is another."""

    def changed(data: Members) -> None:
        for holder, key in () if _is_version_1(data) else _values(data):
            if key != VERSION:
                holder[key] = change(holder[key])

    return changed


def _number(value: Any) -> Any:
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


def _drop_null(data: Members) -> None:
    for holder, key in () if _is_version_1(data) else _values(data):
        if isinstance(holder, dict) and holder[key] is None and not str(key).startswith("x-"):
            del holder[key]


def _drop_unknown_keys(data: Members) -> None:
    for key in [] if _is_version_1(data) else [key for key in data if key not in KEYS and not key.startswith("x-")]:
        del data[key]


def _read_own_keys(data: Members) -> None:
    for holder, key in () if _is_version_1(data) else _values(data):
        if isinstance(holder, dict) and str(key).startswith("x-") and key[2:] not in holder:
            holder[key[2:]] = holder[key]
            if key[2:] not in KEYS:
                del holder[key[2:]]


def _root_floats(data: Members) -> None:
    if not _is_version_1(data):
        data.setdefault("root", "floating")


def _own_types_are_6d(data: Members) -> None:
    for closure in () if _is_version_1(data) else _entries(data, "closures"):
        if str(closure.get("type")).startswith("x-"):
            closure["type"] = "6d"


def _normalise(data: Members) -> None:
    for stated in () if _is_version_1(data) else _entries(data, "configurations"):
        for q in stated.values():
            if isinstance(q, list) and len(q) == 4 and all(isinstance(number, int | float) for number in q):
                length = sum(number * number for number in q) ** 0.5
                q[:] = [number / (length or 1) for number in q]


def _rename_actuators(data: Members) -> None:
    taken: set[str] = set()
    for actuator in data.get("actuators") or ():
        if isinstance(actuator, dict) and actuator.get("name") in taken:
            actuator["name"] = "another"
        elif isinstance(actuator, str) or (isinstance(actuator, dict) and "name" not in actuator):
            taken.add(actuator if isinstance(actuator, str) else actuator.get("joint", ""))


def _merge_three(data: Members) -> None:
    for entry in _entries(data, "joints"):
        if isinstance(entry.get("merges"), list):
            del entry["merges"][3:]


def _drop_the_middle(data: Members) -> None:
    for actuator in _entries(data, "actuators"):
        if len(actuator.get("control", ())) == 3:
            del actuator["control"][1]


def _without_signs(data: Members) -> None:
    for closure in _entries(data, "closures"):
        if isinstance(stated := closure.get("compliance"), dict):
            stated |= {key: abs(value) for key, value in stated.items() if isinstance(value, float)}


# -- Version 1 ------------------------------------------------------------------------------------------------------


def _of_version_1(key: str, kind: type, change: Callable[[Any, Members], Any]) -> Change:
    """A value of version 1 is another, if it has a type: change(value, data)."""

    def changed(data: Members) -> None:
        if _is_version_1(data) and isinstance(data.get(key), kind):
            data[key] = change(data[key], data)

    return changed


def _null_is_empty(data: Members) -> None:
    if _is_version_1(data):
        data.update({key: [] for key in version1.KEYS if key in data and data[key] is None})


def _cut(data: Members) -> None:
    for pair in (("closed_loop", "type"), ("joint_name", "joint_type")) if _is_version_1(data) else ():
        if all(isinstance(data.get(key), list) for key in pair):
            length = min(len(data[key]) for key in pair)
            data.update({key: data[key][:length] for key in pair})


def _types_are_3d(data: Members) -> None:
    if _is_version_1(data) and isinstance(data.get("closed_loop"), list):
        data.setdefault("type", ["3d"] * len(data["closed_loop"]))


def _drop_universal_joints(data: Members) -> None:
    names, types = data.get("joint_name"), data.get("joint_type")
    if _is_version_1(data) and isinstance(names, list) and isinstance(types, list):
        kept = [(name, kind) for name, kind in zip(names, types, strict=False) if not str(kind).startswith("UJOINT_")]
        data["joint_name"], data["joint_type"] = [name for name, _ in kept], [kind for _, kind in kept]


def _drop_other_keys(data: Members) -> None:
    if data.keys() & set(version1.KEYS) and _is_version_1(data):
        for key in set(data) - set(version1.KEYS):
            del data[key]


def _drop_empty_names(data: Members) -> None:
    if _is_version_1(data) and data.get("joint_name") == [] and "joint_type" not in data:
        del data["joint_name"]


READS_DESCRIPTION = {
    ("EU-SCH-002", "2"): {
        "A text that looks like a number is one.": _each(_number),
        "A boolean is the number 0 or 1, as in Python and C.": _each(
            lambda value: int(value) if isinstance(value, bool) else value
        ),
        "A key whose value is null is left out.": _drop_null,
        "The version may be the number 2.0.": lambda data: (
            data.update({VERSION: "2.0"}) if data.get(VERSION) == 2 else None
        ),
    },
    ("EU-SCH-003", "2"): {"Of four joints to merge the first three count.": _merge_three},
    ("EU-SCH-003", "2.1"): {"Of three numbers of a control range the first and the last count.": _drop_the_middle},
    ("EU-SCH-004", "2"): {
        "A closure's type, and a joint's, may be in upper case, as in version 1.": _each(
            lambda value: (
                value.lower()
                if value in ("3D", "6D", "Spherical", "SPHERICAL", "FIXED", "Fixed", "XY", "Floating")
                else value
            )
        ),
    },
    ("EU-SCH-005", "2.1"): {"The sign of a compliance has no effect.": _without_signs},
    "EU-EXT-001": {"A key at the top that the format does not have is ignored.": _drop_unknown_keys},
    "EU-EXT-004": {"A key that begins with x- is read as if it did not, where the other is left out.": _read_own_keys},
    "EU-VER-004": {
        "The root is fixed, whatever the description says.": lambda data: (
            data.update(root="fixed") if data.get("root") == "floating" else None
        ),
        "The root floats where the description does not say that it is fixed.": _root_floats,
    },
    "EU-CLO-012": {"A closure of a user-defined type is 6d.": _own_types_are_6d},
    "EU-CFG-003": {"A quaternion may have any length but 0.": _normalise},
    "EU-ACT-008": {"An actuator may have the name of the joint of an actuator before it.": _rename_actuators},
    "EU-ONE-001": {
        "Any type of closure other than 3d is 6d, as in the published loader.": _of_version_1(
            "type", list, lambda types, data: [kind if str(kind).lower() == "3d" else "6d" for kind in types]
        ),
        "One motor may be given without the list around it.": _of_version_1("name_mot", str, lambda name, data: [name]),
        "A key without a value is an empty list.": _null_is_empty,
        "An empty list of joint names needs no list of types.": _drop_empty_names,
    },
    "EU-ONE-003": {"Of lists that belong together the longer one is cut, as by the published loader.": _cut},
    "EU-ONE-004": {"Where the types are left out, closures are 3d.": _types_are_3d},
    "EU-ONE-006": {"UJOINT_AB leaves the joint as the URDF has it.": _drop_universal_joints},
    "EU-ONE-008": {"Keys other than the five are dropped.": _drop_other_keys},
}

ANSWERS = {
    ("EU-FRM-001", "2"): {  # in version 1 no root floats
        "The joint of a floating root is the name of a frame.": accepting(
            "unknown-frame", lambda issue, description, urdf: "root_joint" in text_of(description)
        ),
    },
    "EU-VER-003": {
        "A description of version 2 may leave its version out.": accepting(
            "missing-key", lambda issue, description, urdf: f"{VERSION}:" not in text_of(description)
        ),
    },
}

REFUSES = {
    "EU-EXT-001": {
        "A key that begins with x- is refused.": lambda data, robot: (
            not _is_version_1(data) and any(str(key).startswith("x-") for _, key in _values(data))
        ),
    },
    ("EU-FIL-004", "2"): {  # version 1 names no URDF
        "The URDF must be in the folder of the description.": lambda data, robot: "/" in data.get("urdf", ""),
    },
    ("EU-SCH-002", "2"): {
        "Where a number is expected, an integer is refused.": lambda data, robot: any(
            type(holder[key]) is int for holder, key in _values(data.get("configurations", {}))
        ),
    },
    "EU-JNT-008": {
        "A pitch must be positive.": lambda data, robot: (
            not _is_version_1(data) and any(joint.get("pitch", 0) < 0 for joint in _entries(data, "joints"))
        ),
    },
    "EU-CNF-002": {
        "A key whose list or mapping is empty is refused.": lambda data, robot: any(
            value in ([], {}) for value in data.values()
        ),
    },
    "EU-ONE-001": {
        "A closure's type must be in lower case.": lambda data, robot: (
            _is_version_1(data) and any(kind != kind.lower() for kind in data.get("type", []))
        ),
    },
}


# -- What is described ------------------------------------------------------------------------------------------------


def _own(key: Callable[[str], str], version: str = "", value: Callable[[Any], Any] = lambda value: value) -> Any:
    """Own data is kept under other pointers, or is another."""
    return lambda robot: (
        {"own": {key(pointer): value(each) for pointer, each in robot.own.items()}}
        if robot.version.startswith(version)
        else {}
    )


def _rest_of_the_first(joint: Any) -> Members:
    once = joint.rest and len(joint.rest) == 2 and joint.rest[0] == joint.rest[1]
    return {"rest": [joint.rest[0], 0.0]} if once else {}


def _counted_from_0(robot: CanonicalRobot) -> Members:
    return {"closures": [each.model_copy(update={"name": f"closure_{i}"}) for i, each in enumerate(robot.closures)]}


DESCRIBES = {
    "EU-VER-002": {"A description of version 1 is said to have version 2.": lambda robot: {"version": "2"}},
    "EU-ONE-005": {"The first closure is `closure_0`.": _counted_from_0},
    "EU-CAN-002": {
        "A slash in a key is not escaped in its JSON pointer.": _own(lambda pointer: pointer.replace("~1", "/")),
        "JSON pointers are those of a URI, with percent signs.": _own(lambda pointer: quote(pointer, safe="/~")),
        "Own data is kept under its key without the x-.": _own(lambda pointer: pointer.replace("/x-", "/")),
    },
    "EU-CAN-003": {
        "Own data is kept under the key itself, which is not a JSON pointer.": _own(
            lambda pointer: pointer.removeprefix("/")
        ),
    },
    "EU-EXT-002": {
        "What is under a key x- is dropped.": lambda robot: {"own": {}} if robot.version == "2" else {},
        "What is under a key x- is kept at the top of the description only.": lambda robot: {
            "own": {pointer: value for pointer, value in robot.own.items() if pointer.count("/") == 1}
        },
        "What is under a key x- is kept as text.": _own(lambda pointer: pointer, version="2", value=str),
    },
    "EU-JNT-031": {
        "A rest position that is given once is that of the first spring.": each("joints", _rest_of_the_first),
    },
}


# -- What is meant ----------------------------------------------------------------------------------------------------


def _second_half_without_limits(right: Any, joint: Any) -> Any:
    second = joint.change.letters and joint.name.endswith(joint.change.letters[1])
    return ([None], [None]) if second else right(joint)


def _link_on_the_first_half(right: Any, found: Any, of: Any, change: Any) -> None:
    right(found, of, change)
    if change.type == "pair":
        found.links[of.child] = found.joint_frames[of.name] = found.joint_frames[f"{of.name}_{change.letters[0]}"]


def _left_out_in_the_middle(right: Any, of: Any, q: Any) -> Any:
    middle = {
        joint.name: [(joint.source[0].lower + joint.source[0].upper) / 2]
        for joint in of.joints
        if joint.type in ("revolute", "prismatic") and joint.source and not joint.mimic
    }
    return right(of, middle | dict(q))


MEANS = {
    "EU-ONE-006": {
        "The second of the two joints that UJOINT_AB makes has no position limits, as in the published loader.": (
            instead(joint_property, "position_limits", _second_half_without_limits)
        ),
        "UJOINT_AB leaves the link on the first of the two joints, as in the published loader.": instead(
            tree, "add_joint", _link_on_the_first_half
        ),
    },
    "EU-CFG-005": {
        "A joint that a configuration leaves out is in the middle of its range.": instead(
            canonical, "stated", _left_out_in_the_middle
        ),
    },
    "EU-CFG-006": {
        "A quaternion is kept as it is written.": instead(
            configuration, "normalised", lambda right, joint, q: np.array(q, dtype=float)
        ),
    },
}
