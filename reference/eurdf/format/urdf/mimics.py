"""The mimic joints of a URDF and their leaders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import dropwhile

from eurdf.format.urdf.data import UrdfJoint
from eurdf.format.urdf.elements import UrdfReader
from eurdf.mechanism.joint import Mimic
from eurdf.reading.xml_reader import Element

_Joints = Mapping[str, UrdfJoint]


def check_mimics(reader: UrdfReader, joints: _Joints) -> None:
    """Check what each mimic joint names as its leader; the joints are in file order."""
    done: set[str] = set()
    for joint in joints.values():
        if joint.mimic is None:
            continue
        element = next(joint.element.iterchildren("mimic"))
        leader = _leader(reader, joint, joint.mimic, joints, element)
        if leader is not None and _can_mimic(reader, joint, leader, element):
            _check_chain(reader, joint, leader, joints, element, done)


def _leader(reader: UrdfReader, joint: UrdfJoint, mimic: Mimic, joints: _Joints, element: Element) -> UrdfJoint | None:
    """EU-URD-021: the leader of a mimic joint exists."""
    leader = joints.get(mimic.joint)
    if leader is None:
        reader.mimic_reporter.report_name(
            "urdf-mimic-unknown",
            f"joint '{joint.name}' mimics '{mimic.joint}', which does not exist",
            element,
            "joint",
            joints.keys() - {joint.name},
            joint.name,
        )
    return leader


def _can_mimic(reader: UrdfReader, joint: UrdfJoint, leader: UrdfJoint, element: Element) -> bool:
    """EU-URD-023: a mimic joint and its leader have one coordinate."""
    for role, each in (("mimics another joint", joint), ("is the leader of a mimic joint", leader)):
        if not each.type.is_axial:
            reader.mimic_reporter.report(
                "urdf-mimic-kind",
                f"joint '{each.name}' {role}, but is {each.type}; it must be revolute, continuous or prismatic",
                element,
                "joint",
            )
            return False
    return True


def _check_chain(
    reader: UrdfReader, joint: UrdfJoint, leader: UrdfJoint, joints: _Joints, element: Element, done: set[str]
) -> None:
    """EU-URD-022: no joint mimics itself through others; each joint is followed once."""
    trail = dict.fromkeys([joint.name])
    at: UrdfJoint | None = leader
    while at is not None and at.name not in trail and at.name not in done:
        trail[at.name] = None
        at = None if at.mimic is None else joints.get(at.mimic.joint)
    if at is not None and at.name in trail:
        reader.mimic_reporter.report(
            "urdf-mimic-cycle",
            "joints mimic one another in a cycle: " + cycle_of([*dropwhile(at.name.__ne__, trail)]),
            element,
            "joint",
        )
    done.update(trail)


def cycle_of(names: Sequence[str]) -> str:
    """How a message names the members of a cycle, a few at most."""
    shown = names if len(names) <= 6 else [*names[:5], "..."]
    return " -> ".join(f"'{name}'" for name in [*shown, names[0]])
