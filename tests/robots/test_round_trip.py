"""A robot that is exported and imported again is the same robot, but for the losses that are listed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.constraint import HingeClosure
from eurdf.mechanism.frame import Anchor, Frame
from eurdf.mechanism.joint import JointProperties
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose, direction
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.robot import Robot
from support.exported import random_robot
from support.same_mechanism import unlike


def round_trip(robot: Robot | str, to: str, folder: Path) -> tuple[eurdf.Export, eurdf.Import]:
    export = eurdf.export(robot, to)
    main, *_ = export.write(folder)
    return export, eurdf.import_robot(main, format=to)


def in_normal_form(mechanism: Mechanism) -> Mechanism:
    """The mechanism in the one of several equal forms that all formats can say.

    Axes are unit vectors; the first coefficient of a coupling is 1; a revolute joint without limits is continuous; a
    fixed joint is named after its child; frames in closures are poses; a fixed link without mass and shapes, which some
    formats have as a site, is a frame.
    """
    bodies = {body.name: body for body in mechanism.bodies}
    carrying = {joint.parent for joint in mechanism.joints}
    frames: dict[str, tuple[str, Pose]] = {}
    joints = []
    for joint in mechanism.joints:
        body = bodies[joint.child]
        if joint.type is JointType.FIXED:
            if not (body.inertia or body.visuals or body.collisions or joint.child in carrying):
                frames[joint.child] = joint.parent, joint.placement * joint.offset
                continue
            joint = replace(
                joint, name=f"{joint.child}_fixed", placement=joint.placement * joint.offset, offset=IDENTITY
            )
        elif (
            joint.type is JointType.REVOLUTE
            and not np.isfinite([*joint.properties.lower, *joint.properties.upper]).any()
        ):
            joint = replace(joint, type=JointType.CONTINUOUS)
        joints.append(replace(joint, axes=tuple(map(direction, joint.axes))))

    def anchor(given: Anchor) -> Anchor:
        if given.body in frames:
            body, pose = frames[given.body]
            return Anchor(body, pose * given.pose)
        return Anchor(given.body, given.pose)

    closures = []
    for closure in mechanism.closures:
        closure = replace(closure, a=anchor(closure.a), b=anchor(closure.b))
        if isinstance(closure, HingeClosure):
            one, other = closure.axes
            closure = replace(closure, axes=(direction(one), direction(other)))
        closures.append(closure)
    couplings = []
    for coupling in mechanism.couplings:
        c = coupling.coefficients[0][1]
        terms = tuple((name, value / c) for name, value in coupling.coefficients)
        couplings.append(replace(coupling, coefficients=terms, offset=coupling.offset / c))
    neutral = {joint.name: joint.coordinates.neutral for joint in mechanism.joints}
    configurations = {
        name: {joint: values for joint, values in stated.items() if values != neutral.get(joint)}
        for name, stated in mechanism.configurations.items()
    }
    own = [(frame.name, anchor(Anchor(frame.body, frame.pose))) for frame in mechanism.frames]
    all_frames = [Frame(name, at.body, at.pose) for name, at in own]
    all_frames += [Frame(name, body, pose) for name, (body, pose) in frames.items()]
    kept = [body for body in mechanism.bodies if body.name not in frames]
    return replace(
        mechanism,
        version="",
        bodies=tuple(sorted(kept, key=lambda body: body.name)),
        joints=tuple(sorted(joints, key=lambda joint: joint.name)),
        frames=tuple(sorted(all_frames, key=lambda frame: frame.name)),
        configurations=configurations,
        closures=tuple(closures),
        couplings=tuple(couplings),
        metadata={},
        own_data={},
    )


def without(mechanism: Mechanism, *properties: str) -> Mechanism:
    """The mechanism without some properties of its joints."""
    free = JointProperties.unlimited
    joints = tuple(
        replace(
            joint,
            properties=replace(joint.properties, **{name: getattr(free(joint.type), name) for name in properties}),
        )
        if joint.type is not JointType.FIXED
        else joint
        for joint in mechanism.joints
    )
    return replace(mechanism, joints=joints)


def some_robot(seed: int, root: Any) -> Robot:
    robot = random_robot(seed, root)[0]
    mechanism = robot.mechanism
    rigid = rigid_roots(mechanism.bodies[0].name, mechanism.joints)
    assume(all(rigid[closure.a.body] != rigid[closure.b.body] for closure in mechanism.closures))
    return robot


@pytest.mark.parametrize("to", ["mjcf"])
@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=3)
def test_random_mechanism_of_all_joint_types_comes_back(
    to: str, seed: int, root: Any, tmp_path_factory: pytest.TempPathFactory
) -> None:
    robot = some_robot(seed, root)
    _, found = round_trip(robot, to, tmp_path_factory.mktemp(to))
    assert unlike(in_normal_form(robot.mechanism), in_normal_form(found.mechanism), 1e-9) == []


@pytest.mark.parametrize("name", ["four_bar", "digit_leg", "kangaroo_leg"])
def test_robot_of_the_collection_comes_back_from_mjcf(name: str, tmp_path: Path) -> None:
    """But for what the losses name: velocity limits and metadata; and effort limits of 0."""
    robot = eurdf.load(name)
    export, found = round_trip(name, "mjcf", tmp_path)
    assert {"export-velocity-limit", "export-metadata"} <= {loss.code for loss in export.losses}
    one, other = (in_normal_form(without(each, "velocity", "effort")) for each in (robot.mechanism, found.mechanism))
    assert unlike(one, other, 1e-9) == []
    for joint in found.mechanism.joints:
        (mine,) = (each for each in robot.mechanism.joints if each.name == joint.name)
        if any(mine.properties.effort):
            assert joint.properties.effort == mine.properties.effort
