"""Readers that have a rule too many, or one that is stricter than the specification: they reject what is right."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from eurdf.linking import link
from eurdf.linking.description import Description
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import has, refused, refused_by_mechanism, refused_by_urdf


def _refused_by_names(where: Callable[[str], bool]) -> Deviation:
    return refused_by_urdf(lambda urdf: any(where(name) for name in (*urdf.links, *urdf.joints)))


def _said(read: Description, key: str) -> Any:
    return None if read.document is None else read.document.data.get(key)


def _repeated(items: Iterable[Any]) -> bool:
    items = list(items)
    return len(set(items)) < len(items)


@mutant("EU-CLO-011")
def redundant_rows_refused() -> Deviation:
    """More rows of closures than velocities are refused."""
    return refused_by_mechanism(
        lambda robot: bool(robot.closures) and robot.nc > sum(j.coordinates.nv for j in robot.joints if not j.mimic)
    )


@mutant("EU-FIL-002")
def two_dozen_closures_at_most() -> Deviation:
    """A robot of more than 24 closures is refused."""
    return refused_by_mechanism(lambda robot: len(robot.closures) > 24)


@mutant("EU-CLO-004", versions=("2",))  # in version 1 a link has one frame
def second_closure_of_two_links_refused() -> Deviation:
    """Two closures may not join the same two links."""
    return refused_by_mechanism(
        lambda robot: _repeated(frozenset((closure.a.body, closure.b.body)) for closure in robot.closures)
    )


@mutant("EU-CLO-001")
def closure_with_the_name_of_a_joint_refused() -> Deviation:
    """A closure may not have the name of a link, a joint or a frame."""

    def taken(robot: Mechanism) -> bool:
        names = {body.name for body in robot.bodies} | {joint.name for joint in robot.joints}
        names |= {frame.name for frame in robot.frames}
        return any(closure.name in names for closure in robot.closures)

    return refused_by_mechanism(taken)


@mutant("EU-FRM-002")
def link_and_joint_of_one_name_refused() -> Deviation:
    """A link and the joint that carries it may not share their name."""
    return refused_by_urdf(lambda urdf: not urdf.links.keys().isdisjoint(urdf.joints))


@mutant("EU-CNF-002")
def spaces_in_names_refused() -> Deviation:
    """A name may not have spaces."""
    return _refused_by_names(lambda name: " " in name)


@mutant("EU-CNF-002")
def slashes_in_names_refused() -> Deviation:
    """A name may not have slashes."""
    return _refused_by_names(lambda name: "/" in name)


@mutant("EU-CNF-002")
def long_names_refused() -> Deviation:
    """A name may have 64 characters."""
    return _refused_by_names(lambda name: len(name) > 64)


@mutant("EU-CNF-002")
def names_beyond_ascii_refused() -> Deviation:
    """A name must be of ASCII."""
    return _refused_by_names(lambda name: not name.isascii())


@mutant("EU-EXT-001")
def own_keys_refused() -> Deviation:
    """A key that begins with x- is refused."""
    return refused_by_mechanism(lambda robot: robot.version == "2.0" and bool(robot.own_data))


@mutant("EU-FIL-004", versions=("2",))  # version 1 names no URDF
def urdf_in_another_folder_refused() -> Deviation:
    """The URDF must be in the folder of the description."""
    return refused(lambda read: "/" in str(_said(read, "urdf")))


@mutant("EU-JNT-005", versions=("2",))  # version 1 has neither
def prismatic_stays_prismatic() -> Deviation:
    """A prismatic joint may become neither cylindrical nor helical."""

    def turned(read: Description) -> bool:
        changed = _said(read, "joints") or {}
        return read.urdf is not None and any(
            name in read.urdf.joints and read.urdf.joints[name].type is JointType.PRISMATIC for name in changed
        )

    return refused(turned)


@mutant("EU-JNT-008")
def left_handed_screws_refused() -> Deviation:
    """A pitch must be more than 0."""
    return refused(has(lambda joint: joint.pitch < 0.0))


@mutant("EU-SCH-002", versions=("2",))  # version 1 has no numbers
def integers_are_no_numbers() -> Deviation:
    """Where a number is asked for, an integer is refused."""
    return refused(lambda read: any(type(value) is int for value in _numbers(_said(read, "configurations"))))


def _numbers(value: Any) -> Iterator[float]:
    """All numbers in a value."""
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    for each in inside:
        yield from _numbers(each)
    if isinstance(value, int | float) and not isinstance(value, bool):
        yield value


def _empty(read: Description) -> bool:
    return read.document is not None and any(value in ([], {}) for value in read.document.data.values())


@mutant("EU-CNF-002")
def empty_lists_refused() -> Deviation:
    """A key whose list or mapping is empty is refused: it should be left out."""
    return refused(_empty)


@mutant("EU-JNT-005")
def joints_of_several_coordinates_are_not_locked() -> Deviation:
    """A planar or a floating joint may not be locked."""

    def locked(read: Description) -> bool:
        assert read.urdf is not None
        assert read.mechanism is not None
        several = (JointType.PLANAR, JointType.FLOATING)
        kinds = {joint.name: joint.type for joint in read.urdf.joints.values()}
        return any(joint.type == "fixed" and kinds.get(joint.name) in several for joint in read.mechanism.joints)

    return refused(locked)


#: Names that every object of JavaScript has.
_OF_OBJECTS = frozenset({"__proto__", "constructor", "hasOwnProperty", "toString", "valueOf"})


@mutant("EU-CNF-002")
def names_of_objects_refused() -> Deviation:
    """A link or joint may not have a name that every object of JavaScript has, which seems to be taken."""
    return _refused_by_names(lambda name: name in _OF_OBJECTS)


@mutant("EU-ACT-001")
def names_of_objects_are_known() -> Deviation:
    """A motor may be on what every object of JavaScript has, which seems to be there."""

    def linked(original: Any, entries: Iterable[Any], *arguments: Any) -> Any:
        return original([each for each in entries if each.joint != "valueOf"], *arguments)

    return around(link, "link_actuators", linked)
