"""What a description of version 1 says, misread: by the published loader, among others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.format import read_extension
from eurdf.format.extension import Extension
from eurdf.format.version1 import Version1
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import canonical, data_of_version1, said_in_version1

_JOINT_TYPES = ("SPHERICAL", "FIXED", "UJOINT_XY", "UJOINT_XZ", "UJOINT_YX", "UJOINT_YZ", "UJOINT_ZX", "UJOINT_ZY")


def _list(key: str, change: Callable[[Any], Any]) -> Deviation:
    """One of the five keys is read otherwise, where it stands."""
    return data_of_version1(lambda data: {**data, key: change(data[key])} if key in data else data)


def _each(key: str, change: Callable[[Any], Any]) -> Deviation:
    """Each item of one of the five lists is read otherwise."""
    return _list(key, lambda items: [change(item) for item in items] if isinstance(items, list) else items)


@mutant("EU-ONE-001")
def any_other_type_is_6d() -> Deviation:
    """Any type of a closure other than 3d is 6d, as in the published loader."""
    return _each("type", lambda kind: kind if kind in ("3d", "3D") else "6d")


@mutant("EU-ONE-001")
def unknown_joint_type_is_that_before() -> Deviation:
    """A joint of an unknown type is of that of the joint before, as in the published loader."""

    def known(kinds: Any) -> Any:
        last = "SPHERICAL"
        found = []
        for kind in kinds if isinstance(kinds, list) else ():
            last = kind if kind in _JOINT_TYPES else last
            found.append(last)
        return found

    return _list("joint_type", known)


@mutant("EU-ONE-001")
def universal_joint_of_one_axis() -> Deviation:
    """UJOINT_XX is accepted, as by the published loader."""
    return _each("joint_type", lambda kind: "UJOINT_XY" if kind == "UJOINT_XX" else kind)


@mutant("EU-ONE-001")
def null_is_an_empty_list() -> Deviation:
    """A key without a value is an empty list."""
    return data_of_version1(lambda data: {key: [] if value is None else value for key, value in data.items()})


@mutant("EU-ONE-001")
def one_name_without_a_list() -> Deviation:
    """One motor may stand without the list around it."""
    return _list("name_mot", lambda names: [names] if isinstance(names, str) else names)


@mutant("EU-ONE-001")
def capital_d_refused() -> Deviation:
    """A closure's type must be in lower case."""
    return _each("type", lambda kind: "unknown" if kind in ("3D", "6D") else kind)


@mutant("EU-ONE-003")
def longer_list_is_cut() -> Deviation:
    """Of lists that go together the longer one is cut, as by the published loader."""

    def cut(data: Any) -> Any:
        found = dict(data)
        for one, other in (("closed_loop", "type"), ("joint_name", "joint_type")):
            if isinstance(data.get(one), list) and isinstance(data.get(other), list):
                length = min(len(data[one]), len(data[other]))
                found |= {one: data[one][:length], other: data[other][:length]}
        return found

    return data_of_version1(cut)


@mutant("EU-ONE-004")
def type_left_out_is_3d() -> Deviation:
    """Where the types are left out, closures are 3d."""

    def read(original: Any, model: Version1) -> Extension:
        said: Extension = original(model)
        if "type" in model.model_fields_set:
            return said
        return replace(said, closures=tuple(replace(each, type="3d") for each in said.closures))

    return around(read_extension, "from_version1", read)


@mutant("EU-ONE-005")
def closures_from_0() -> Deviation:
    """Closures are numbered from 0."""
    return said_in_version1(
        lambda said: replace(
            said, closures=tuple(replace(each, name=f"closure_{i}") for i, each in enumerate(said.closures))
        )
    )


@mutant("EU-ONE-005")
def closures_in_the_order_of_their_frames() -> Deviation:
    """Closures are numbered in the order of the names of their frames."""

    def sorted_by_name(said: Extension) -> Extension:
        ordered = sorted(said.closures, key=lambda each: (each.a.name or "", each.b.name or ""))
        return replace(said, closures=tuple(replace(each, name=f"closure_{i}") for i, each in enumerate(ordered, 1)))

    return said_in_version1(sorted_by_name)


@mutant("EU-ONE-008")
def own_keys_of_version_1_are_dropped() -> Deviation:
    """Keys other than the five are dropped."""
    return said_in_version1(lambda said: replace(said, own_data={}))


@mutant("EU-ONE-008")
def own_keys_of_version_1_begin_with_x() -> Deviation:
    """Only keys that begin with x- are kept."""
    return said_in_version1(
        lambda said: replace(
            said, own_data={where: value for where, value in said.own_data.items() if str(where[0]).startswith("x-")}
        )
    )


@mutant("EU-CAN-003")
def own_keys_without_pointer() -> Deviation:
    """Own data is kept under the key itself, which is no JSON pointer."""
    return canonical(lambda robot: {"own": {where[1:]: value for where, value in robot.own.items()}})


@mutant("EU-CAN-003")
def own_keys_begin_with_x() -> Deviation:
    """Own data of version 1 is kept under the key that version 2 has for it."""
    return said_in_version1(
        lambda said: replace(said, own_data={(f"x-{where[0]}",): value for where, value in said.own_data.items()})
    )
