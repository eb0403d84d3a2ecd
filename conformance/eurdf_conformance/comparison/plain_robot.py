"""A canonical description in a common form: steps 1 to 4, and 6, of EU-CAN-005."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.comparison.universal import (
    universal_pairs,
    velocities,
    with_defaults,
    with_limits,
    with_springs,
)
from eurdf_conformance.json_pointer import step
from eurdf_conformance.protocol.message import (
    CanonicalActuator,
    CanonicalClosure,
    CanonicalCompliance,
    CanonicalCoupling,
    CanonicalJoint,
    CanonicalRobot,
    CanonicalShape,
)

#: The joint of a floating root.
ROOT_JOINT = "root_joint"

Part = TypeVar("Part", CanonicalJoint, CanonicalClosure, CanonicalCoupling, CanonicalActuator, CanonicalShape)


@dataclass(frozen=True, slots=True)
class Placed(Generic[Part]):
    """A joint, closure, actuator or shape, and its place in the answer.

    Attributes:
        part: Without style.
        pointer: Where it is in the answer; of two joints that became one, where the first is.
    """

    part: Part
    pointer: str


@dataclass(frozen=True, slots=True)
class PlainRobot:
    """A canonical description in the common form.

    Attributes:
        links: Names of its links.
        frames: Names of the frames that the description adds.
        joints: By name.
        closures: By name.
        couplings: By name.
        actuators: By joint.
        configurations: By name; for each joint its coordinates.
        repeated: What occurs twice in a list that is a set.
    """

    links: frozenset[str]
    frames: frozenset[str]
    joints: Mapping[str, Placed[CanonicalJoint]]
    closures: Mapping[str, Placed[CanonicalClosure]]
    couplings: Mapping[str, Placed[CanonicalCoupling]]
    actuators: Mapping[str, Placed[CanonicalActuator]]
    configurations: Mapping[str, Mapping[str, Sequence[float]]]
    repeated: Sequence[Difference]

    def type_of(self, joint: str, root: str) -> str | None:
        """Type of a joint, the one by which a floating root moves too; None where there is none of that name."""
        if joint in self.joints:
            return self.joints[joint].part.type
        return "floating" if joint == ROOT_JOINT and root == "floating" else None


def plain_robot(robot: CanonicalRobot, bodies: Iterable[Iterable[str]], links: Iterable[str]) -> PlainRobot:
    """EU-CAN-005, steps 1 to 4, and 6.

    Args:
        robot: As a parser gave it.
        bodies: For each body of the robot its links.
        links: The links of the URDF.
    """
    first_link: dict[str, str] = {}
    for body in map(list, bodies):
        first_link |= dict.fromkeys(body, min(body, key=str.encode))
    repeated: list[Difference] = []
    joints = _by_name([with_springs(joint) for joint in robot.joints], "/joints", lambda joint: joint.name, repeated)
    actuators = _by_name(robot.actuators, "/actuators", lambda actuator: actuator.joint, repeated)
    closures = _by_name(robot.closures, "/closures", lambda closure: closure.name, repeated)
    couplings = _by_name(robot.couplings, "/couplings", lambda coupling: coupling.name, repeated)
    configurations: dict[str, dict[str, Sequence[float]]] = {
        name: dict(coordinates) for name, coordinates in robot.configurations.items()
    }

    motors = {name: placed.part for name, placed in actuators.items()}
    for pair in universal_pairs([placed.part for placed in joints.values()], frozenset(links)):
        where = joints.pop(pair.first.name).pointer
        del joints[pair.second.name]
        if pair.name in joints:
            repeated.append(
                Difference(where, ABSENT, pair.first, f"joint '{pair.name}' occurs beside its two revolute joints")
            )
        joints[pair.name] = Placed(pair.joint(), where)
        if (motor := pair.actuator(motors)) is not None:
            where = actuators.pop(pair.first.name).pointer
            del actuators[pair.second.name]
            actuators[pair.name] = Placed(motor, where)
        for configuration in configurations.values():
            if (angles := pair.coordinates(configuration)) is not None:
                configuration.pop(pair.first.name, None)
                configuration.pop(pair.second.name, None)
                configuration[pair.name] = angles

    return PlainRobot(
        frozenset(robot.links),
        frozenset(robot.frames),
        {name: Placed(_joint(placed.part, first_link), placed.pointer) for name, placed in joints.items()},
        {name: Placed(_closure(placed.part, first_link), placed.pointer) for name, placed in closures.items()},
        couplings,
        {
            name: Placed(with_defaults(placed.part, _velocities(name, joints)), placed.pointer)
            for name, placed in actuators.items()
        },
        configurations,
        repeated,
    )


def _joint(joint: CanonicalJoint, first_link: Mapping[str, str]) -> CanonicalJoint:
    parent, child = first_link.get(joint.parent, joint.parent), first_link.get(joint.child, joint.child)
    if (parent, child) != (joint.parent, joint.child):
        joint = joint.model_copy(update={"parent": parent, "child": child})
    return with_limits(joint)


def _closure(closure: CanonicalClosure, first_link: Mapping[str, str]) -> CanonicalClosure:
    if closure.compliance == CanonicalCompliance():
        closure = closure.model_copy(update={"compliance": None})
    a, b = first_link.get(closure.a, closure.a), first_link.get(closure.b, closure.b)
    return closure if (a, b) == (closure.a, closure.b) else closure.model_copy(update={"a": a, "b": b})


def _velocities(joint: str, joints: Mapping[str, Placed[CanonicalJoint]]) -> int:
    return velocities(joints[joint].part if joint in joints else None)


def _by_name(
    parts: Sequence[Part], pointer: str, name_of: Callable[[Part], str], repeated: list[Difference]
) -> dict[str, Placed[Part]]:
    found: dict[str, Placed[Part]] = {}
    for index, part in enumerate(parts):
        name, where = name_of(part), pointer + step(index)
        if name in found:
            repeated.append(Difference(where, ABSENT, part, f"'{name}' occurs twice, first at {found[name].pointer}"))
        else:
            found[name] = Placed(part, where)
    return found
