"""Readers that heed what other programs say in a URDF."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eurdf.format.urdf import UrdfJoint, _Reader
from eurdf.linking.description import Description
from eurdf.linking.urdf_tree import joint_of
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_transform import joint_transform
from eurdf.mechanism.mechanism import Mechanism
from eurdf_conformance.mutants.deviation import Deviation, around
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import described


def _at_any_depth(owner: str, *tags: str) -> Deviation:
    """Of an element the first one within it counts, at whatever depth, as with getElementsByTagName."""

    def children(original: Any, self: Any, parent: Any) -> Any:
        found = original(self, parent)
        if parent.tag == owner:
            found |= {tag: first for tag in tags if (first := next(parent.iter(tag), None)) is not None}
        return found

    return around(_Reader, "children", children)


@mutant("EU-CAN-001")
def parents_and_children_at_any_depth() -> Deviation:
    """The first parent and child within a joint count, at whatever depth."""
    return _at_any_depth("joint", "parent", "child")


@mutant("EU-URD-035")
def axes_at_any_depth() -> Deviation:
    """The first axis within a joint counts, at whatever depth."""
    return _at_any_depth("joint", "axis")


@mutant("EU-JNT-025")
def origins_at_any_depth() -> Deviation:
    """The first origin within a joint counts, at whatever depth."""
    return _at_any_depth("joint", "origin")


@mutant("EU-CAN-001")
def limits_at_any_depth() -> Deviation:
    """The first limit within a joint counts, at whatever depth."""
    return _at_any_depth("joint", "limit", "dynamics", "mimic")


@mutant("EU-INR-006")
def masses_at_any_depth() -> Deviation:
    """The first mass, inertia and origin within an inertial count, at whatever depth."""
    return _at_any_depth("inertial", "mass", "inertia", "origin")


@mutant("EU-INR-005")
def inertials_at_any_depth() -> Deviation:
    """A link without inertia has that of the first inertial within it, at whatever depth."""

    def link(original: Any, self: Any, element: Any) -> Any:
        found, inertial = original(self, element), next(element.iter("inertial"), None)
        if found is None or found.inertia is not None or inertial is None:
            return found
        return found._replace(inertia=self.inertial(inertial))

    return around(_Reader, "link", link)


@mutant("EU-JNT-025")
def calibration_shifts_the_zero() -> Deviation:
    """A joint is at zero where its calibration has its rising edge."""

    def joint(original: Any, self: Any, element: Any) -> UrdfJoint | None:
        found: UrdfJoint | None = original(self, element)
        calibration = element.find("calibration")
        if found is None or calibration is None or "rising" not in calibration.attrib:
            return found
        shift = joint_transform(joint_of(found), (float(calibration.get("rising")),))
        return found._replace(placement=found.placement * shift)

    return around(_Reader, "joint", joint)


@mutant("EU-CAN-001")
def safety_controllers_limit() -> Deviation:
    """The soft limits of a safety controller stand in place of those of the joint."""

    def limit(original: Any, self: Any, name: Any, kind: Any, joint: Any, element: Any) -> Any:
        found, soft = original(self, name, kind, joint, element), joint.find("safety_controller")
        if found is None or soft is None:
            return found
        lower, upper = soft.get("soft_lower_limit", found.lower), soft.get("soft_upper_limit", found.upper)
        return found._replace(lower=float(lower), upper=float(upper))

    return around(_Reader, "limit", limit)


def _by_urdf(change: Callable[[Mechanism, Any], Mechanism]) -> Deviation:
    """The mechanism is changed by what the root element of the URDF holds."""

    def changed(read: Description) -> Description:
        assert read.urdf is not None
        assert read.mechanism is not None
        return replace(read, mechanism=change(read.mechanism, read.urdf.document.root))

    return described(changed)


@mutant("EU-ACT-007")
def transmissions_are_motors() -> Deviation:
    """A joint that a transmission names is actuated."""

    def actuated(robot: Mechanism, root: Any) -> Mechanism:
        named = {joint.get("name") for joint in root.iterfind("transmission/joint")}
        more = (joint.name for joint in robot.joints if joint.name in named and joint.name not in robot.actuators)
        return replace(robot, actuators=(*robot.actuators, *more))

    return _by_urdf(actuated)


@mutant("EU-INR-006")
def rotors_of_drake() -> Deviation:
    """The rotor and the gear that Drake reads in a joint make its armature."""

    def geared(robot: Mechanism, root: Any) -> Mechanism:
        said: dict[str, dict[str, float]] = {}
        for element in root.iterfind("joint/*"):
            name = str(element.tag).rpartition("}")[2]
            if name in ("rotor_inertia", "gear_ratio"):
                said.setdefault(element.getparent().get("name"), {})[name] = float(element.get("value"))

        def with_rotor(joint: Joint) -> Joint:
            rotor = said.get(joint.name, {})
            armature = rotor.get("gear_ratio", 1.0) ** 2 * rotor.get("rotor_inertia", 0.0)
            return replace(joint, armature=(armature,)) if armature else joint

        return replace(robot, joints=tuple(map(with_rotor, robot.joints)))

    return _by_urdf(geared)
