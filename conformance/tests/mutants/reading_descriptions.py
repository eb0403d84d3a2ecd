"""Parsers that take the data of a description for something else, among them the published loader of version 1."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from eurdf_conformance.oracle import canonical, configuration, joint_property, tree, version1
from eurdf_conformance.oracle.version2 import KEYS
from eurdf_conformance.protocol.message import CanonicalRobot
from eurdf_conformance.protocol.reply import accepted
from mutants.mutant import (
    Answer,
    Deviation,
    Members,
    answers,
    describes,
    instead,
    means,
    reads_description,
    refuses,
)

VERSION = "extended_urdf"


def _values(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every mapping or list, with each of its keys or indices."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in list(items):
        yield value, key
        yield from _values(item)


def _each(data: Members, change: Callable[[Any], Any]) -> None:
    if VERSION in data:
        for holder, key in _values(data):
            if key != VERSION:
                holder[key] = change(holder[key])


# -- Version 2 ------------------------------------------------------------------------------------------------------


@reads_description("EU-SCH-002", versions=("2",))
def texts_are_numbers(data: Members) -> None:
    """A text that looks like a number is one."""

    def number(value: Any) -> Any:
        try:
            return float(value) if isinstance(value, str) else value
        except ValueError:
            return value

    _each(data, number)


@reads_description("EU-SCH-002", versions=("2",))
def booleans_are_numbers(data: Members) -> None:
    """A boolean is the number 0 or 1, as in Python and C."""
    _each(data, lambda value: int(value) if isinstance(value, bool) else value)


@reads_description("EU-SCH-002", versions=("2",))
def null_is_left_out(data: Members) -> None:
    """A key whose value is null is left out."""
    if VERSION in data:
        for holder, key in _values(data):
            if isinstance(holder, dict) and holder[key] is None and not str(key).startswith("x-"):
                del holder[key]


@reads_description("EU-SCH-002", versions=("2",))
def version_may_be_a_number(data: Members) -> None:
    """The version may be the number 2.0."""
    if data.get(VERSION) == 2:
        data[VERSION] = "2.0"


@reads_description("EU-SCH-004", versions=("2",))
def types_in_any_case(data: Members) -> None:
    """A closure's type, and a joint's, may be in upper case, as in version 1."""
    words = ("3D", "6D", "Spherical", "SPHERICAL", "FIXED", "Fixed", "XY", "Floating")
    _each(data, lambda value: value.lower() if value in words else value)


@reads_description("EU-EXT-001")
def unknown_keys_are_ignored(data: Members) -> None:
    """A key at the top that the format does not have is ignored."""
    if VERSION in data:
        for key in [key for key in data if key not in KEYS and not key.startswith("x-")]:
            del data[key]


@reads_description("EU-EXT-004")
def own_keys_are_read(data: Members) -> None:
    """A key that begins with x- is read as if it did not, where the other is left out."""
    if VERSION in data:
        for holder, key in _values(data):
            if isinstance(holder, dict) and str(key).startswith("x-") and key[2:] not in holder:
                holder[key[2:]] = holder[key]
                if key[2:] not in KEYS:
                    del holder[key[2:]]


@reads_description("EU-VER-004")
def root_is_always_fixed(data: Members) -> None:
    """The root is fixed, whatever the description says."""
    if data.get("root") == "floating":
        data["root"] = "fixed"


@reads_description("EU-VER-004")
def root_floats_by_default(data: Members) -> None:
    """The root floats where the description does not say that it is fixed."""
    if VERSION in data:
        data.setdefault("root", "floating")


wrong = describes("EU-VER-002")
wrong("A description of version 1 is said to have version 2.", lambda robot: {"version": "2"})


@answers("EU-FRM-001", versions=("2",))  # in version 1 no root floats
def root_joint_is_a_frame(right: Answer, description: Path, urdf: Path) -> Answer:
    """The joint of a floating root is the name of a frame."""
    unknown = {issue.code for issue in right.issues} == {"unknown-frame"}
    return accepted() if unknown and re.search(r"\broot_joint\b", description.read_text("utf-8-sig")) else right


@answers("EU-VER-003")
def version_may_be_left_out(right: Answer, description: Path, urdf: Path) -> Answer:
    """A description of version 2 may leave its version out."""
    missing = {issue.code for issue in right.issues} == {"missing-key"}
    return accepted() if missing and f"{VERSION}:" not in description.read_text("utf-8-sig") else right


wrong = refuses("EU-EXT-001")
wrong(
    "A key that begins with x- is refused.",
    lambda data, robot: VERSION in data and any(str(key).startswith("x-") for _, key in _values(data)),
)

wrong = refuses("EU-FIL-004", versions=("2",))
# version 1 names no URDF
wrong("The URDF must be in the folder of the description.", lambda data, robot: "/" in data.get("urdf", ""))

wrong = refuses("EU-SCH-002", versions=("2",))
wrong(
    "Where a number is expected, an integer is refused.",
    lambda data, robot: any(type(holder[key]) is int for holder, key in _values(data.get("configurations", {}))),
)


@refuses("EU-JNT-008")
def left_handed_screws_are_refused(data: Members, robot: Any) -> bool:
    """A pitch must be positive."""
    joints = data.get("joints", {}).values() if VERSION in data else ()
    return any(isinstance(joint, dict) and joint.get("pitch", 0) < 0 for joint in joints)


wrong = refuses("EU-CNF-002")
wrong(
    "A key whose list or mapping is empty is refused.",
    lambda data, robot: any(value in ([], {}) for value in data.values()),
)


@reads_description("EU-CLO-012")
def own_closure_types_are_6d(data: Members) -> None:
    """A closure of a user-defined type is 6d."""
    for closure in data.get("closures", []) if VERSION in data else ():
        if isinstance(closure, dict) and str(closure.get("type")).startswith("x-"):
            closure["type"] = "6d"


@reads_description("EU-CFG-003")
def quaternions_are_normalised(data: Members) -> None:
    """A quaternion may have any length but 0."""
    for stated in (data.get("configurations") or {}).values() if VERSION in data else ():
        for q in stated.values() if isinstance(stated, dict) else ():
            if isinstance(q, list) and len(q) == 4 and all(isinstance(each, int | float) for each in q):
                length = sum(each * each for each in q) ** 0.5
                q[:] = [each / (length or 1) for each in q]


# -- Version 1 ------------------------------------------------------------------------------------------------------


def _is_version_1(data: Members) -> bool:
    return VERSION not in data


@reads_description("EU-ONE-001")
def unknown_closure_types_are_6d(data: Members) -> None:
    """Any type of closure other than 3d is 6d, as in the published loader."""
    if _is_version_1(data) and isinstance(data.get("type"), list):
        data["type"] = [kind if str(kind).lower() == "3d" else "6d" for kind in data["type"]]


@reads_description("EU-ONE-001")
def one_name_without_a_list(data: Members) -> None:
    """One motor may be given without the list around it."""
    if _is_version_1(data) and isinstance(data.get("name_mot"), str):
        data["name_mot"] = [data["name_mot"]]


@reads_description("EU-ONE-001")
def null_is_an_empty_list(data: Members) -> None:
    """A key without a value is an empty list."""
    if _is_version_1(data):
        data.update({key: [] for key in version1.KEYS if key in data and data[key] is None})


wrong = refuses("EU-ONE-001")
wrong(
    "A closure's type must be in lower case.",
    lambda data, robot: _is_version_1(data) and any(kind != kind.lower() for kind in data.get("type", [])),
)


@reads_description("EU-ONE-003")
def longer_lists_are_cut(data: Members) -> None:
    """Of lists that belong together the longer one is cut, as by the published loader."""
    for pair in (("closed_loop", "type"), ("joint_name", "joint_type")) if _is_version_1(data) else ():
        if all(isinstance(data.get(key), list) for key in pair):
            length = min(len(data[key]) for key in pair)
            data.update({key: data[key][:length] for key in pair})


@reads_description("EU-ONE-004")
def types_left_out_are_3d(data: Members) -> None:
    """Where the types are left out, closures are 3d."""
    if _is_version_1(data) and isinstance(data.get("closed_loop"), list):
        data.setdefault("type", ["3d"] * len(data["closed_loop"]))


wrong = describes("EU-ONE-005")
wrong(
    "The first closure is `closure_0`.",
    lambda robot: {
        "closures": [each.model_copy(update={"name": f"closure_{i}"}) for i, each in enumerate(robot.closures)]
    },
)


@reads_description("EU-ONE-006")
def universal_joints_stay_as_they_are(data: Members) -> None:
    """UJOINT_AB leaves the joint as the URDF has it."""
    names, types = data.get("joint_name"), data.get("joint_type")
    if _is_version_1(data) and isinstance(names, list) and isinstance(types, list):
        kept = [(name, kind) for name, kind in zip(names, types, strict=False) if not str(kind).startswith("UJOINT_")]
        data["joint_name"], data["joint_type"] = [name for name, _ in kept], [kind for _, kind in kept]


@means("EU-ONE-006")
def second_half_has_no_limits() -> Deviation:
    """The second of the two joints that UJOINT_AB makes has no position limits, as in the published loader."""

    def limits(right: Any, joint: Any) -> Any:
        second = joint.change.letters and joint.name.endswith(joint.change.letters[1])
        return ([None], [None]) if second else right(joint)

    return instead(joint_property, "position_limits", limits)


@means("EU-ONE-006")
def link_is_on_the_first_half() -> Deviation:
    """UJOINT_AB leaves the link on the first of the two joints, as in the published loader."""

    def joint(right: Any, found: Any, of: Any, change: Any) -> None:
        right(found, of, change)
        if change.type == "pair":
            found.links[of.child] = found.joint_frames[of.name] = found.joint_frames[f"{of.name}_{change.letters[0]}"]

    return instead(tree, "add_joint", joint)


@reads_description("EU-ONE-008")
def own_keys_of_version_1_are_dropped(data: Members) -> None:
    """Keys other than the five are dropped."""
    if data.keys() & set(version1.KEYS) and _is_version_1(data):
        for key in set(data) - set(version1.KEYS):
            del data[key]


wrong = describes("EU-CAN-003")
wrong(
    "Own data is kept under the key itself, which is not a JSON pointer.",
    lambda robot: {"own": {pointer.removeprefix("/"): value for pointer, value in robot.own.items()}},
)


# -- Own data of version 2 ------------------------------------------------------------------------------------------


wrong = describes("EU-EXT-002")
wrong("What is under a key x- is dropped.", lambda robot: {"own": {}} if robot.version == "2" else {})
wrong(
    "What is under a key x- is kept at the top of the description only.",
    lambda robot: {"own": {pointer: value for pointer, value in robot.own.items() if pointer.count("/") == 1}},
)
wrong(
    "What is under a key x- is kept as text.",
    lambda robot: (
        {"own": {pointer: str(value) for pointer, value in robot.own.items()}} if robot.version == "2" else {}
    ),
)

wrong = describes("EU-CAN-002")
wrong(
    "A slash in a key is not escaped in its JSON pointer.",
    lambda robot: {"own": {pointer.replace("~1", "/"): value for pointer, value in robot.own.items()}},
)
wrong(
    "JSON pointers are those of a URI, with percent signs.",
    lambda robot: {"own": {quote(pointer, safe="/~"): value for pointer, value in robot.own.items()}},
)
wrong(
    "Own data is kept under its key without the x-.",
    lambda robot: {"own": {pointer.replace("/x-", "/"): value for pointer, value in robot.own.items()}},
)


# -- Configurations ---------------------------------------------------------------------------------------------------


wrong = means("EU-CFG-006")
wrong(
    "A quaternion is kept as it is written.",
    lambda: instead(configuration, "normalised", lambda right, joint, q: np.array(q, dtype=float)),
)


@means("EU-CFG-005")
def left_out_joints_are_in_the_middle() -> Deviation:
    """A joint that a configuration leaves out is in the middle of its range."""

    def stated(right: Any, of: Any, q: Any) -> Any:
        middle = {
            joint.name: [(joint.source[0].lower + joint.source[0].upper) / 2]
            for joint in of.joints
            if joint.type in ("revolute", "prismatic") and joint.source and not joint.mimic
        }
        return right(of, middle | dict(q))

    return instead(canonical, "stated", stated)


@reads_description("EU-ONE-001")
def empty_names_need_no_types(data: Members) -> None:
    """An empty list of joint names needs no list of types."""
    if _is_version_1(data) and data.get("joint_name") == [] and "joint_type" not in data:
        del data["joint_name"]


@reads_description("EU-ACT-008")
def names_of_joints_are_free_afterwards(data: Members) -> None:
    """An actuator may have the name of the joint of an actuator before it."""
    taken: set[str] = set()
    for actuator in data.get("actuators") or ():
        if isinstance(actuator, dict) and actuator.get("name") in taken:
            actuator["name"] = "another"
        elif isinstance(actuator, str) or (isinstance(actuator, dict) and "name" not in actuator):
            taken.add(actuator if isinstance(actuator, str) else actuator.get("joint", ""))


@reads_description("EU-SCH-003", versions=("2",))
def fourth_joint_to_merge_is_ignored(data: Members) -> None:
    """Of four joints to merge the first three count."""
    for entry in data.get("joints", {}).values() if isinstance(data.get("joints"), dict) else ():
        if isinstance(entry, dict) and isinstance(entry.get("merges"), list):
            del entry["merges"][3:]


@reads_description("EU-SCH-003", versions=("2.1",))
def control_ranges_have_a_middle(data: Members) -> None:
    """Of three numbers of a control range the first and the last count."""
    for actuator in data.get("actuators") or ():
        if isinstance(actuator, dict) and len(actuator.get("control", ())) == 3:
            del actuator["control"][1]


@reads_description("EU-SCH-005", versions=("2.1",))
def compliances_may_be_negative(data: Members) -> None:
    """The sign of a compliance has no effect."""
    for closure in data.get("closures") or ():
        if isinstance(closure, dict) and isinstance(stated := closure.get("compliance"), dict):
            stated |= {key: abs(value) for key, value in stated.items() if isinstance(value, float)}


@describes("EU-JNT-031")
def one_rest_is_of_the_first_spring(robot: CanonicalRobot) -> Members:
    """A rest position that is given once is that of the first spring."""
    return {
        "joints": [
            joint.model_copy(update={"rest": [joint.rest[0], 0.0]})
            if joint.rest and len(joint.rest) == 2 and joint.rest[0] == joint.rest[1]
            else joint
            for joint in robot.joints
        ]
    }
