"""Frames that are looked for elsewhere, or turned otherwise."""

from __future__ import annotations

from typing import Any

import numpy as np

from eurdf.linking.description import Description
from eurdf.linking.frame_names import FrameNames
from eurdf.mechanism.frame import Anchor
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose, Vector3
from eurdf.pinocchio.placement import placement_of
from eurdf_conformance.adapters import reference_values
from eurdf_conformance.adapters.reference_values import Quantities
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import canonical, refused

_from_xyz_rpy = Pose.from_xyz_rpy


@mutant("EU-FRM-004")
def fixed_links_vanish() -> Deviation:
    """A link behind a fixed joint has no frame, as in MuJoCo, which fuses it with the one before."""

    def poses(original: Any, self: Quantities) -> dict[str, Any]:
        fixed = {joint.child for joint in self.robot.mechanism.joints if joint.type is JointType.FIXED}
        return {name: pose for name, pose in original(self).items() if name not in fixed}

    return around(Quantities, "poses", poses)


@mutant("EU-FRM-004")
def fixed_links_are_where_the_body_is() -> Deviation:
    """A link behind a fixed joint has the frame of the body that it is part of."""

    def body(original: Any, self: Quantities, name: str) -> Any:
        joint = self.robot.model.frames[self._bodies[name]].parentJoint
        return self.robot.data.oMi[joint]

    return around(Quantities, "_body", body)


@mutant("EU-FRM-004")
def merged_links_are_at_the_parent() -> Deviation:
    """A link whose joint was merged, or locked, is where the body before it is."""

    def frame(original: Any, robot: Mechanism, name: str) -> Any:
        body, placement = original(robot, name)
        carrier = {joint.child: joint for joint in robot.joints}.get(body)
        if carrier is not None and carrier.type is JointType.FIXED:
            return carrier.parent, placement
        return body, placement

    return around(reference_values, "_frame", frame)


@mutant("EU-FRM-005")
def joint_frame_on_the_side_of_the_parent() -> Deviation:
    """The name of a joint stands for the frame in which it turns, on its parent's side."""

    def frame(original: Any, robot: Mechanism, name: str) -> Any:
        joint = next((joint for joint in robot.joints if joint.name == name), None)
        links = {body.name for body in robot.bodies}
        return (
            original(robot, name) if joint is None or name in links else (joint.parent, placement_of(joint.placement))
        )

    return around(reference_values, "_frame", frame)


@mutant("EU-FRM-005")
def closure_on_the_side_of_the_parent() -> Deviation:
    """A closure on a joint is on the frame in which it turns, on its parent's side."""

    def find(original: Any, self: FrameNames, reference: Any) -> Anchor | None:
        anchor: Anchor | None = original(self, reference)
        joint = self._joints.get(reference.joint or reference.name or "")
        if anchor is None or joint is None or reference.name in self._urdf.links:
            return anchor
        return Anchor(joint.parent, joint.placement * anchor.pose, anchor.frame)

    return around(FrameNames, "find", find)


def _about(axis: int, angle: float) -> Pose:
    turned = [0.0, 0.0, 0.0]
    turned[axis] = float(np.sin(angle / 2.0))
    return Pose((0.0, 0.0, 0.0), (turned[0], turned[1], turned[2], float(np.cos(angle / 2.0))))


def _rpy(turn: Any) -> Deviation:
    """Orientations are read otherwise."""
    return instead(Pose, "from_xyz_rpy", lambda xyz, rpy: Pose(xyz, turn(rpy)))


@mutant("EU-FRM-006")
def rpy_about_moving_axes() -> Deviation:
    """Roll, pitch and yaw are about x, y, z as each has been turned by those before."""
    return _rpy(lambda rpy: (_about(0, rpy[0]) * _about(1, rpy[1]) * _about(2, rpy[2])).quaternion)


@mutant("EU-FRM-006")
def rpy_is_yaw_pitch_roll() -> Deviation:
    """The three angles are yaw, pitch and roll."""
    return _rpy(lambda rpy: _from_xyz_rpy((0.0, 0.0, 0.0), (rpy[2], rpy[1], rpy[0])).quaternion)


@mutant("EU-FRM-006")
def rpy_in_degrees() -> Deviation:
    """Roll, pitch and yaw are in degrees."""

    def turned(rpy: Vector3) -> Any:
        x, y, z = np.radians(rpy).tolist()
        return _from_xyz_rpy((0.0, 0.0, 0.0), (x, y, z)).quaternion

    return _rpy(turned)


@mutant("EU-FRM-006")
def xyz_as_the_orientation_has_turned_it() -> Deviation:
    """The position of a pose is along the axes that its orientation has turned."""

    def pose(xyz: Vector3, rpy: Vector3) -> Pose:
        turned = _from_xyz_rpy((0.0, 0.0, 0.0), rpy)
        return Pose(turned.rotate(xyz), turned.quaternion)

    return instead(Pose, "from_xyz_rpy", pose)


@mutant("EU-FRM-006")
def poses_without_orientation() -> Deviation:
    """The orientation of a pose is passed over."""
    return _rpy(lambda rpy: (0.0, 0.0, 0.0, 1.0))


@mutant("EU-FRM-001")
def frames_of_joints_are_unknown() -> Deviation:
    """A closure's frame cannot be named by a joint."""
    return instead(FrameNames, "_joint_child", lambda self, name: None)


@mutant("EU-FRM-001", versions=("2",))  # version 1 adds no frames
def frames_of_the_description_only_once_listed() -> Deviation:
    """A frame that the description adds cannot be used by a closure."""

    def add(original: Any, self: FrameNames, entries: Any) -> Any:
        added = original(self, entries)
        self._frames.clear()
        return added

    return around(FrameNames, "add", add)


@mutant("EU-FRM-003")
def frame_in_place_of_a_link() -> Deviation:
    """A frame that the description adds may have the name of a link, which it hides."""
    return instead(FrameNames, "_known", lambda self, name: False)


@mutant("EU-FRM-002")
def name_used_nowhere_is_ambiguous() -> Deviation:
    """A name that stands for two frames is refused though the description does not use it."""

    def ambiguous(read: Description) -> bool:
        assert read.urdf is not None
        return any(name in read.urdf.links and joint.child != name for name, joint in read.urdf.joints.items())

    return refused(ambiguous)


@mutant("EU-CAN-001", versions=("2",))  # version 1 adds no frames
def frames_are_not_said() -> Deviation:
    """Frames that the description adds are not said."""
    return canonical(lambda robot: {"frames": []})


@mutant("EU-PRO-008")
def poses_of_six_decimals() -> Deviation:
    """Poses are rounded to six decimals."""
    return result(
        Quantities,
        "poses",
        lambda poses: {
            name: pose.model_copy(update={"translation": [round(x, 6) for x in pose.translation]})
            for name, pose in poses.items()
        },
    )


@mutant("EU-FRM-004", versions=("2",))  # version 1 has no poses
def poses_on_a_ball_at_its_centre() -> Deviation:
    """A pose on a ball whose axes meet away from its link's origin is placed from where they meet."""

    def find(original: Any, self: FrameNames, reference: Any) -> Anchor | None:
        anchor: Anchor | None = original(self, reference)
        joint = self._joints.get(reference.joint or "")
        if anchor is None or joint is None or joint.type is not JointType.SPHERICAL:
            return anchor
        return Anchor(anchor.body, joint.offset.inverse() * anchor.pose, anchor.frame)

    return around(FrameNames, "find", find)
