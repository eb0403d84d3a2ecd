"""Where the reference can be broken: what it reads, what it makes of that, what it says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.diagnostics.registry import REGISTRY
from eurdf.format import read_extension
from eurdf.format.extension import Extension
from eurdf.format.urdf import Urdf
from eurdf.format.version1 import Version1
from eurdf.format.version2 import Version2
from eurdf.linking.description import Description
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import COORDINATES, JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio import configuration
from eurdf_conformance.adapters import reference
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result
from eurdf_conformance.protocol.message import CanonicalJoint, CanonicalRobot, Issue, Values


def clause_of(code: str) -> str:
    """The clause that a code of this specification enforces: advice of the reference alone is never broken."""
    clause = REGISTRY[code].clause
    assert clause is not None, code
    return clause


class _Changed:
    """A model of a version, before which what it is to read is changed."""

    def __init__(self, model: Any, change: Callable[[Any], Any]) -> None:
        self._model = model
        self._change = change

    def model_validate(self, data: Any) -> Any:
        return self._model.model_validate(self._change(data))


def data_of_version1(change: Callable[[Any], Any]) -> Deviation:
    """What is read of a description of version 1, as plain data, is changed."""
    return instead(read_extension, "Version1", _Changed(Version1, change))


def data_of_version2(change: Callable[[Any], Any]) -> Deviation:
    """What is read of a description of version 2, as plain data, is changed."""
    return instead(read_extension, "Version2", _Changed(Version2, change))


def said_in_version1(change: Callable[[Extension], Extension]) -> Deviation:
    """What a description of version 1 says is changed."""
    return result(read_extension, "from_version1", change)


def said_in_version2(change: Callable[[Extension], Extension]) -> Deviation:
    """What a description of version 2 says is changed."""
    return result(read_extension, "from_version2", change)


def described(change: Callable[[Description], Description]) -> Deviation:
    """What was read of the two files is changed, where there is a mechanism."""
    return result(Reference, "describe", lambda read: read if read.mechanism is None else change(read))


def refused(where: Callable[[Description], bool]) -> Deviation:
    """A robot that is right is rejected."""
    return described(lambda read: replace(read, mechanism=None) if where(read) else read)


def refused_by_urdf(where: Callable[[Urdf], bool]) -> Deviation:
    """A robot that is right is rejected for its URDF."""
    return refused(lambda read: read.urdf is not None and where(read.urdf))


def refused_by_mechanism(where: Callable[[Mechanism], bool]) -> Deviation:
    """A robot that is right is rejected for its mechanism."""
    return refused(lambda read: read.mechanism is not None and where(read.mechanism))


def has(kind: Callable[[Joint], bool]) -> Callable[[Description], bool]:
    """Whether a robot has such a joint."""
    return lambda read: read.mechanism is not None and any(map(kind, read.mechanism.joints))


def mechanism(change: Callable[[Mechanism], Mechanism]) -> Deviation:
    """The mechanism is changed."""

    def changed(read: Description) -> Description:
        assert read.mechanism is not None
        return replace(read, mechanism=change(read.mechanism))

    return described(changed)


def joints(change: Callable[[Joint], Joint]) -> Deviation:
    """Each joint of the mechanism is changed."""
    return mechanism(lambda robot: replace(robot, joints=tuple(map(change, robot.joints))))


def coordinates(kind: JointType, change: Callable[[list[float]], list[float]]) -> Deviation:
    """The coordinates of joints of one type are taken for others."""

    def checked(original: Any, name: str, values: list[float], of: Any) -> Any:
        there = of is COORDINATES[kind] and len(values) == len(of.names)
        return original(name, change(values) if there else values, of)

    return around(configuration, "_checked", checked)


def canonical(change: Callable[[CanonicalRobot], dict[str, Any]]) -> Deviation:
    """Members of the canonical description are others."""
    return result(reference, "canonical_robot", lambda robot: robot.model_copy(update=change(robot)))


def canonical_joints(change: Callable[[CanonicalJoint], dict[str, Any]]) -> Deviation:
    """Members of each joint of the canonical description are others."""
    return canonical(lambda robot: {"joints": [joint.model_copy(update=change(joint)) for joint in robot.joints]})


def issues(change: Callable[[list[Issue]], list[Issue]]) -> Deviation:
    """What is told that is wrong is changed."""
    return result(Reference, "issues", change)


def each_issue(change: Callable[[Issue], dict[str, Any]]) -> Deviation:
    """Members of each issue are others."""
    return issues(lambda found: [issue.model_copy(update=change(issue)) for issue in found])


def values(change: Callable[[Values], dict[str, Any]]) -> Deviation:
    """Quantities are others, where they are asked for."""

    def changed(said: Values) -> Values:
        asked = {name: new for name, new in change(said).items() if getattr(said, name) is not None}
        return said.model_copy(update=asked)

    return result(Reference, "values", changed)


def while_evaluating(deviation: Callable[[], Deviation]) -> Deviation:
    """What is broken only where values are asked for, so that whether loops close is still seen."""

    def evaluated(original: Any, *arguments: Any) -> Any:
        with deviation():
            return original(*arguments)

    return around(Reference, "values", evaluated)
