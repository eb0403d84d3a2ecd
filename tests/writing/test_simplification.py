"""Balls in place of three revolutes, 3d closures in place of a ball and a 6d closure, and back; poses by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

import eurdf
from eurdf.closures.frame import FrameClosure
from eurdf.convert.same_motion import compare_motion
from eurdf.mechanism.body import Anchor, Body, Frame, Inertia, Shape
from eurdf.mechanism.constraint import Compliance, Coupling
from eurdf.mechanism.joint import Joint, JointProperties, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot
from eurdf.writing.rewriting import Positions, Rewriting, size_of
from eurdf.writing.simplification import expanded, saving, simplified
from support import by_hand
from support.linkage import pose_of

SEEDS = st.integers(0, 10_000)
MOVING = sorted(kind for kind in JointType if not kind.is_fixed)


def held(seed: int, floating: bool = False) -> tuple[Mechanism, dict[str, tuple[float, ...]]]:
    """A link on a ball, held to a floating body by a 6d closure; a joint of any type hangs from the link, or none.

    And positions that close the loop.
    """
    random = np.random.default_rng(seed)
    kinds = (MOVING[seed % len(MOVING)], JointType.SPHERICAL, JointType.FIXED)
    arm, ball, weld = (
        by_hand.some_joint(JointType(kind), random, *ends)
        for kind, ends in zip(kinds, (("base", "arm"), ("arm", "link"), ("link", "marker")), strict=True)
    )
    ball = replace(ball, offset=by_hand.some_pose(random), properties=JointProperties.unlimited(ball.type))
    joints = [arm, ball, weld]
    if seed % 3 == 0:
        joints.append(by_hand.some_joint(JointType.REVOLUTE, random, "link", "tail"))
    joints.append(by_hand.some_joint(JointType.FLOATING, random, "base", "other"))
    bodies = tuple(Body(name, by_hand.some_inertia(random)) for name in ("base", *(joint.child for joint in joints)))
    positions = {joint.name: by_hand.some_coordinates(joint.type, random) for joint in joints}
    mechanism = Mechanism("held", "", "floating" if floating else "fixed", bodies, tuple(joints))
    poses = by_hand.poses(mechanism, positions)
    at = by_hand.some_pose(random)
    there = np.linalg.inv(poses["other"]) @ poses["marker"] @ by_hand.pose_matrix(at)
    ends = Anchor("marker", at), Anchor("other", pose_of(pin.SE3(there)))
    closure = FrameClosure("weld", *(ends if seed % 2 else ends[::-1]))
    configurations = {"assembled": {name: values for name, values in positions.items() if values}}
    return replace(mechanism, closures=(closure,), configurations=configurations), positions


def three(seed: int, **changes: Any) -> Mechanism:
    """Three joints whose axes meet in one point, revolute or continuous, each with its origin on its axis."""
    random = np.random.default_rng(seed)
    point, names = random.uniform(-1.0, 1.0, 3), ("a", "b", "c")
    frame = np.eye(4)
    joints = []
    for index, (name, parent, child) in enumerate(zip(names, ("base", *names), (*names,), strict=False)):
        axis = np.eye(3)[index] + random.uniform(-0.3, 0.3, 3)
        target = by_hand.transform(
            by_hand.quaternion_rotation(by_hand.some_coordinates(JointType.SPHERICAL, random)), point
        )
        target[:3, 3] += random.uniform(-1.0, 1.0) * target[:3, :3] @ axis
        placement = pose_of(pin.SE3(np.linalg.inv(frame) @ target))
        frame = frame @ by_hand.pose_matrix(placement)
        kind = JointType.CONTINUOUS if random.random() < 0.5 else JointType.REVOLUTE
        properties = JointProperties.unlimited(kind)
        joints.append(Joint(name, kind, parent, child, placement, axes=(tuple(axis.tolist()),), properties=properties))
    bodies = (Body("base"), Body("a"), Body("b"), Body("c", by_hand.some_inertia(random)))
    return replace(Mechanism("three", "", "fixed", bodies, tuple(joints)), **changes)


def differing(before: Mechanism, positions: Positions, after: Rewriting, without: tuple[str, ...] = ()) -> float:
    """Largest difference of the poses of links that both mechanisms have, by hand."""
    one = by_hand.poses(before, positions)
    other = by_hand.poses(after.mechanism, after.converted(positions))
    return max(float(np.abs(one[link] - other[link]).max()) for link in one if link not in without)


def assert_same_motion(before: eurdf.Robot, after: eurdf.Robot, rewriting: Rewriting) -> None:
    motion = compare_motion(before, after, rewriting.converted)
    assert motion.pose < 1e-10
    assert motion.acceleration is not None
    assert motion.acceleration < 1e-6


@given(seed=SEEDS, floating=st.booleans())
def test_held_ball_becomes_a_point_and_back(seed: int, floating: bool) -> None:
    mechanism, positions = held(seed, floating)
    smaller = simplified(mechanism)
    assert [closure.type for closure in smaller.mechanism.closures] == ["3d"]
    assert not any(joint.type.is_ball and joint.child == "link" for joint in smaller.mechanism.joints)
    assert differing(mechanism, positions, smaller) < 1e-12
    back = expanded(smaller.mechanism, "closures")
    assert [closure.type for closure in back.mechanism.closures] == ["6d"]
    assert differing(smaller.mechanism, smaller.converted(positions), back) < 1e-12
    robots = [build_robot(each, geometry=False) for each in (mechanism, smaller.mechanism, back.mechanism)]
    assert [robot.model.nv - robots[1].model.nv for robot in robots] == [3, 0, 3]
    assert_same_motion(robots[0], robots[1], smaller)
    assert_same_motion(robots[1], robots[2], back)


@given(seed=SEEDS, angles=st.tuples(*[st.floats(-3.0, 3.0)] * 3))
def test_concurrent_axes_become_a_ball(seed: int, angles: tuple[float, float, float]) -> None:
    mechanism = three(seed)
    found = simplified(mechanism)
    assert [joint.type for joint in found.mechanism.joints] == ["fixed", "fixed", "spherical"]
    assert found.between == ("a", "b")
    positions = {name: (angle,) for name, angle in zip("abc", angles, strict=True)}
    assert differing(mechanism, positions, found, found.between) < 1e-12


@given(seed=SEEDS)
def test_ball_becomes_three_continuous_joints(seed: int) -> None:
    mechanism, positions = held(seed)
    found = expanded(mechanism, "joints")
    kinds = {joint.name: joint.type for joint in found.mechanism.joints}
    assert [kinds[f"spherical_link{end}"] for end in ("_x", "_y", "")] == ["continuous"] * 3
    assert differing(mechanism, positions, found) < 1e-12
    again = simplified(found.mechanism, "joints").mechanism
    assert size_of(again) == size_of(mechanism)


def changed(index: int, **changes: Any) -> Callable[[Mechanism], Mechanism]:
    """With other properties of one of three joints."""

    def change(mechanism: Mechanism) -> Mechanism:
        joints = list(mechanism.joints)
        joints[index] = joints[index].with_properties(replace(joints[index].properties, **changes))
        return replace(mechanism, joints=tuple(joints))

    return change


def with_link(**changes: Any) -> Callable[[Mechanism], Mechanism]:
    """With another link between the joints."""
    return lambda mechanism: replace(
        mechanism, bodies=tuple(replace(body, **changes) if body.name == "b" else body for body in mechanism.bodies)
    )


def shifted(mechanism: Mechanism) -> Mechanism:
    """With the axis of the last joint a micrometre beside the point."""
    last = mechanism.joints[2]
    x, y, z = last.placement.xyz
    moved = replace(last, placement=replace(last.placement, xyz=(x + 1e-6, y + 1e-6, z)))
    return replace(mechanism, joints=(*mechanism.joints[:2], moved))


#: By what is changed: the change, and why the joints then stay.
STAYS: dict[str, tuple[Callable[[Mechanism], Mechanism], str]] = {
    "actuator": (lambda each: replace(each, actuators=("b",)), "'b' is actuated"),
    "coupling": (lambda each: replace(each, couplings=(Coupling("k", (("a", 1.0), ("c", 1.0))),)), "'a' is coupled"),
    "mimic": (
        lambda each: replace(each, joints=(*each.joints[:2], replace(each.joints[2], mimic=Mimic("a")))),
        "'a' is coupled",
    ),
    "damping": (changed(2, damping=(0.1,)), "'c' has damping"),
    "armature": (changed(0, armature=(0.1,)), "'a' has armature"),
    "spring": (changed(0, stiffness=(0.1,)), "'a' has stiffness"),
    "limits": (changed(1, lower=(-1.0,), upper=(1.0,)), "'b' has position limits"),
    "inertia": (with_link(inertia=Inertia(1e-9, Pose(), (0.0,) * 6)), "link 'b' between them has inertia"),
    "shape": (with_link(visuals=(Shape("sphere", (0.1,)),)), "link 'b' between them has a shape"),
    "frame": (lambda each: replace(each, frames=(Frame("tip", "b"),)), "link 'b' between them has a frame"),
    "gap": (shifted, "they miss it by"),
}


@pytest.mark.parametrize("case", STAYS)
def test_joints_stay_that_would_move_otherwise(case: str) -> None:
    change, reason = STAYS[case]
    mechanism = three(7)
    joints = tuple(replace(joint, type=JointType.REVOLUTE) for joint in mechanism.joints)
    assert saving(replace(mechanism, joints=joints))
    mechanism = change(replace(mechanism, joints=joints))
    found = simplified(mechanism)
    assert found.mechanism is mechanism
    (kept,) = found.kept
    assert reason in kept
    assert not saving(mechanism)


def test_weld_of_a_ball_that_must_stay_stays_6d() -> None:
    mechanism, _ = held(1)
    driven = replace(mechanism, actuators=("spherical_link",))
    soft = replace(mechanism, closures=(replace(mechanism.closures[0], compliance=Compliance(1e-6)),))
    bare = replace(mechanism, bodies=tuple(replace(body, inertia=None) for body in mechanism.bodies))
    for each, reason in ((driven, "is actuated"), (soft, "has compliance"), (bare, "link 'arm' would move no mass")):
        found = simplified(each)
        assert found.mechanism is each
        assert reason in found.kept[0]


def test_lone_ball_of_a_loop_stays() -> None:
    mechanism, _ = held(1)
    locked = replace(
        mechanism, joints=tuple(joint if joint.type.is_ball else joint.fixed() for joint in mechanism.joints)
    )
    assert simplified(locked).mechanism is locked


def test_point_between_bodies_without_inertia_stays() -> None:
    smaller = simplified(held(1)[0]).mechanism
    bare = replace(smaller, bodies=tuple(replace(body, inertia=None) for body in smaller.bodies))
    found = expanded(bare, "closures")
    assert found.mechanism is bare
    assert "neither of its bodies has inertia" in found.kept[0]


def test_new_link_halves_the_inertia_of_its_body() -> None:
    mechanism, positions = held(2)
    smaller = simplified(mechanism)
    (point,) = smaller.mechanism.closures
    # Both frames on bodies that move: no fixed link is there to hang on the ball.
    (end,) = (anchor for anchor in point.anchors if anchor.body == "link")
    poses = by_hand.poses(smaller.mechanism, smaller.converted(positions))
    at = pose_of(pin.SE3(np.linalg.inv(poses["other"]) @ poses["link"] @ by_hand.pose_matrix(end.pose)))
    sides = {"a" if end is point.a else "b": Anchor("other", at)}
    given = replace(smaller.mechanism, closures=(replace(point, **sides),))
    found = expanded(given, "closures")
    masses, whole = (
        {body.name: body.inertia.mass for body in each.bodies if body.inertia} for each in (found.mechanism, given)
    )
    (halved,) = (name for name in whole if masses[name] != whole[name])
    assert masses["weld_ball"] == masses[halved] == whole[halved] / 2
    assert_same_motion(build_robot(given, geometry=False), build_robot(found.mechanism, geometry=False), found)


def test_wrong_rewriting_is_seen() -> None:
    mechanism, _ = held(1)
    right = simplified(mechanism)
    before = build_robot(mechanism, geometry=False)
    point = right.mechanism.closures[0]
    x, y, z = point.a.pose.xyz
    moved = replace(right.mechanism, closures=(replace(point, a=replace(point.a, pose=Pose((x + 1e-6, y, z)))),))
    heavy = right.mechanism.bodies[-1]
    assert heavy.inertia is not None
    heavier = replace(
        right.mechanism,
        bodies=(
            *right.mechanism.bodies[:-1],
            replace(heavy, inertia=replace(heavy.inertia, mass=1.01 * heavy.inertia.mass)),
        ),
    )
    assert compare_motion(before, build_robot(moved, geometry=False), right.converted).pose > 1e-7
    assert (compare_motion(before, build_robot(heavier, geometry=False), right.converted).acceleration or 0.0) > 1e-6
