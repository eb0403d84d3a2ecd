"""EU-CAN-005, step 3: two revolutes without a link of the URDF between them are one universal joint."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from eurdf_conformance.comparison.coordinates import VELOCITIES, neutral
from eurdf_conformance.protocol.message import CanonicalActuator, CanonicalJoint

_TURNING = frozenset({"revolute", "continuous"})
_LISTS = ("lower", "upper", "velocity", "effort", "damping", "friction", "armature")
_SPRINGS = ("stiffness", "rest")


@dataclass(frozen=True, slots=True)
class Pair:
    """Two joints that are one universal joint."""

    name: str
    first: CanonicalJoint
    second: CanonicalJoint

    def joint(self) -> CanonicalJoint:
        """The one joint between the outer bodies; its lists are those of the two joints, one after the other."""
        lists = {key: [*getattr(self.first, key), *getattr(self.second, key)] for key in _LISTS}
        if self.first.stiffness or self.second.stiffness:
            for key in _SPRINGS:
                lists[key] = [*(getattr(self.first, key) or [0.0]), *(getattr(self.second, key) or [0.0])]
        return self.first.model_copy(
            update={"name": self.name, "type": "universal", "child": self.second.child, **lists}
        )

    def actuator(self, actuators: Mapping[str, CanonicalActuator]) -> CanonicalActuator | None:
        """The one actuator if both joints have one; a motor on one axis only stays at that joint."""
        if self.first.name not in actuators or self.second.name not in actuators:
            return None
        one, two = with_defaults(actuators[self.first.name], 1), with_defaults(actuators[self.second.name], 1)
        return CanonicalActuator(
            joint=self.name,
            gear_ratio=[*(one.gear_ratio or ()), *(two.gear_ratio or ())],
            rotor_inertia=[*(one.rotor_inertia or ()), *(two.rotor_inertia or ())],
            name=one.name if one.name == two.name else None,
            control=one.control if one.control == two.control else None,
        )

    def coordinates(self, configuration: Mapping[str, Sequence[float]]) -> list[float] | None:
        """The two angles in a configuration that names at least one of the joints; None if it names neither."""
        if self.first.name not in configuration and self.second.name not in configuration:
            return None
        return [
            angle for joint in (self.first, self.second) for angle in configuration.get(joint.name, neutral("revolute"))
        ]


def universal_pairs(joints: Sequence[CanonicalJoint], links: Collection[str]) -> list[Pair]:
    """The pairs of joints that are one universal joint.

    Args:
        joints: Joints of a canonical description.
        links: Links of the URDF: a body that is named by no link of them is none of its bodies.
    """
    pairs: list[Pair] = []
    for first in joints:
        carried = [joint for joint in joints if joint.parent == first.child]
        if first.child in links or len(carried) != 1:
            continue
        second = carried[0]
        paired = {joint.name for pair in pairs for joint in (pair.first, pair.second)}
        if first is second or {first.name, second.name} & paired or first.mimic or second.mimic:
            continue
        if first.type in _TURNING and _kind(first) == _kind(second):
            pairs.append(Pair(_name(first.name, second.name), first, second))
    return pairs


def with_defaults(actuator: CanonicalActuator, velocities: int) -> CanonicalActuator:
    """EU-CAN-005, step 6: `gear_ratio` and `rotor_inertia` left out are 1 and 0, `name` is that of the joint."""
    return CanonicalActuator(
        joint=actuator.joint,
        gear_ratio=[1.0] * velocities if actuator.gear_ratio is None else actuator.gear_ratio,
        rotor_inertia=[0.0] * velocities if actuator.rotor_inertia is None else actuator.rotor_inertia,
        name=actuator.joint if actuator.name is None else actuator.name,
        control=actuator.control,
    )


def with_springs(joint: CanonicalJoint) -> CanonicalJoint:
    """EU-CAN-005, step 6: no springs are springs with the stiffness 0, and the rest position of such a spring is 0."""
    if joint.stiffness is None and joint.rest is None:
        return joint
    if not any(joint.stiffness or ()):
        return joint.model_copy(update={"stiffness": None, "rest": None})
    stiffness = joint.stiffness or []
    rest = [0.0] * len(stiffness) if joint.rest is None else joint.rest
    if len(rest) != len(stiffness):
        return joint
    return joint.model_copy(update={"rest": [at if k else 0.0 for at, k in zip(rest, stiffness, strict=True)]})


def with_limits(joint: CanonicalJoint) -> CanonicalJoint:
    """EU-CAN-005, step 4: a revolute joint without limits is continuous, a continuous one has the limits null."""
    if joint.type == "continuous" and (joint.lower, joint.upper) == ([None], [None]):
        return joint
    unlimited = all(limit is None for limit in (*joint.lower, *joint.upper))
    if joint.type == "continuous" or (joint.type == "revolute" and unlimited):
        return joint.model_copy(update={"type": "continuous", "lower": [None], "upper": [None]})
    return joint


def velocities(joint: CanonicalJoint | None) -> int:
    """Number of velocities of a joint; 1 if its type is unknown."""
    return 1 if joint is None else VELOCITIES[joint.type]


def _kind(joint: CanonicalJoint) -> str:
    return with_limits(joint).type


def _name(first: str, second: str) -> str:
    head, mark, _ = first.rpartition("_")
    other, other_mark, _ = second.rpartition("_")
    return head if mark and other_mark and head == other and head else first
