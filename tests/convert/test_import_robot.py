"""A robot that is exported and imported again is the same robot, but for the losses that are listed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.closures.hinge import HingeClosure
from eurdf.convert.losses import Effect
from eurdf.convert.parts import Part
from eurdf.convert.verification.read_model import without_armature
from eurdf.mechanism.body import Anchor, Frame
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose, direction
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.robot import Robot, build_robot
from support.described import mass_matrix
from support.exported import random_robot, values_of_parts
from support.same_mechanism import unlike


def round_trip(robot: Robot | str, to: str, folder: Path) -> tuple[eurdf.convert.Export, eurdf.convert.Import]:
    export = eurdf.export(robot, to)
    export.write(folder)
    return export, eurdf.import_robot(folder, format=to)


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
    neutral = {joint.name: joint.type.neutral for joint in mechanism.joints}
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


def there(export: eurdf.convert.Export, found: Robot, q: Any) -> Any:
    """The configuration of the imported robot that is q of the exported one: by the names of the joints of the file."""
    coordinates: dict[str, list[float]] = {}
    for part, mine in zip(export.coordinates.parts, values_of_parts(export.coordinates, q), strict=True):
        if part.mimics:
            continue
        names = list(part.names) if part.joint != ROOT_JOINT else [ROOT_JOINT]
        while len(names) > 1 and len(mine) > 1:
            coordinates[names.pop(0)] = [mine.pop(0)]
        if part.type in (JointType.SPHERICAL, JointType.FLOATING) and len(mine) > 1:
            mine = in_files(mine, part, export.coordinates.quaternion)
        coordinates[names[0]] = mine
    return found.configuration(
        {name: each for name, each in coordinates.items() if name == ROOT_JOINT or name in found.slots}
    )


def in_files(values: list[float], part: Part, quaternion: str) -> list[float]:
    """Coordinates of a ball or free joint as files have them: x y z, then a quaternion x y z w."""
    if part.rotation == "rpy" and part.joint != ROOT_JOINT:
        roll, pitch, yaw = values
        return list(Pose.from_xyz_rpy((0.0, 0.0, 0.0), (roll, pitch, yaw)).quaternion)
    if part.orientation_first:
        values = [*values[4:], *values[:4]]
    at = len(values) - 4
    if quaternion == "wxyz":
        values = [*values[:at], *values[at + 1 :], values[at]]
    return values


@pytest.mark.parametrize("to", ["loop-joint", "drake", "sdf"])
@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=6)
def test_random_mechanism_is_the_same_in_poses_and_closures(
    to: str, seed: int, root: Any, tmp_path_factory: pytest.TempPathFactory
) -> None:
    robot = with_limits(some_robot(seed, root), np.random.default_rng(seed))
    pairs = [frozenset(end.body for end in each.anchors) for each in robot.mechanism.closures]
    assume(len(set(pairs)) == len(pairs))  # points of the same two bodies are joined to one closure
    export, imported = round_trip(robot, to, tmp_path_factory.mktemp("files"))
    # URDF alone does not say whether the root floats: a listed loss.
    mechanism = replace(imported.mechanism, root=root)
    found = build_robot(mechanism, geometry=False)
    assert_same_robot(robot, found, export, seed)
    assert_same_properties(robot, found, export)


@pytest.mark.slow
@pytest.mark.parametrize("to", ["mjcf", "loop-joint", "drake", "sdf"])
@pytest.mark.parametrize("name", eurdf.collection_names())
def test_robot_of_the_collection_closes_and_moves_as_before(to: str, name: str, tmp_path: Path) -> None:
    robot = eurdf.load(name, geometry=False)
    export, imported = round_trip(robot, to, tmp_path)
    lost = {loss.name for loss in export.losses if loss.effect is Effect.DROPPED and loss.code != "export-compliance"}
    unsaid = {each.type for each in robot.constraints if each.name in lost}
    assert unsaid <= {"mjcf": set(), "drake": {"distance"}}.get(to, {"distance", "coupling"})
    if unsaid:
        return
    found = build_robot(replace(imported.mechanism, root=robot.mechanism.root), geometry=False)
    assert len(found.mechanism.closures) == len(robot.mechanism.closures)
    q = robot.configurations["assembled"]
    known = {*found.slots, ROOT_JOINT}
    same = {name: each for name, each in robot.joint_positions(q).items() if name in known}
    closed = found.configuration(same) if to == "mjcf" else there(export, found, q)
    assert np.abs(eurdf.residual(found, closed)).max() < 1e-6
    assert eurdf.analyze(found, closed).mobility == eurdf.analyze(robot, q).mobility


def with_limits(robot: Robot, random: np.random.Generator) -> Robot:
    """The robot with limits on every axis of every joint that can have some."""

    def limited(joint: Joint) -> Joint:
        if joint.type is JointType.FIXED:
            return joint
        n, nv = len(joint.type.coordinates), joint.type.nv
        values: dict[str, Any] = {name: tuple(random.uniform(1.0, 9.0, nv).tolist()) for name in ("velocity", "effort")}
        if joint.type is not JointType.CONTINUOUS and joint.type.quaternion is None:
            values["lower"] = tuple(random.uniform(-9.0, -7.0, n).tolist())
            values["upper"] = tuple(random.uniform(7.0, 9.0, n).tolist())
        return replace(joint, properties=replace(joint.properties, **values))

    joints = tuple(map(limited, robot.mechanism.joints))
    return build_robot(replace(robot.mechanism, joints=joints), geometry=False)


#: For each property, the words of the losses that name it.
LOST_BY = {
    "lower": ("limits", "position-limit"),
    "upper": ("limits", "position-limit"),
    "velocity": ("limits", "velocity"),
    "effort": ("effort",),
    "damping": ("damping",),
    "friction": ("friction",),
    "armature": ("armature",),
}


def assert_same_properties(robot: Robot, found: Robot, export: eurdf.convert.Export) -> None:
    """Limits, damping, friction and armature of each axis that is a joint with one axis, unless a loss names them."""
    lost = {(loss.name, word) for loss in export.losses for word in loss.code.removeprefix("export-").split("-")}
    lost |= {(loss.name, loss.code.removeprefix("export-")) for loss in export.losses}
    theirs = {joint.name: joint.properties for joint in found.mechanism.joints}
    mine = {joint.name: joint.properties for joint in robot.mechanism.joints}
    compared = 0
    for part in export.coordinates.parts:
        if part.mimics or len(part.ratios) != len(part.names):
            continue
        for name, (index, multiplier, zero) in zip(part.names, part.ratios, strict=True):
            assert multiplier == 1.0
            for key, words in LOST_BY.items():
                if not any((part.joint, word) in lost for word in words):
                    (value,) = getattr(theirs[name], key)
                    expected = getattr(mine[part.joint], key)[index] + (zero if key in ("lower", "upper") else 0.0)
                    assert value == pytest.approx(expected, rel=1e-12), (name, key)
                    compared += 1
    assert compared


def assert_same_robot(robot: Robot, found: Robot, export: eurdf.convert.Export, seed: int) -> None:
    """Poses of bodies, openings of the closures that both have, and M, at a configuration where loops are open."""
    random = np.random.default_rng(seed)
    assembled = robot.configurations["assembled"]
    q = pin.integrate(robot.model, assembled, random.uniform(-0.2, 0.2, robot.model.nv))
    q2 = there(export, found, q)
    for each, at in ((robot, q), (found, q2)):
        pin.framesForwardKinematics(each.model, each.data, at)
    for body in robot.mechanism.bodies:
        one, other = (each.data.oMf[each.model.getFrameId(body.name, pin.FrameType.BODY)] for each in (robot, found))
        np.testing.assert_allclose(other.homogeneous, one.homogeneous, atol=1e-9, err_msg=body.name)
    assert_same_mass_matrix(robot, q, found, q2)
    lost = {loss.name for loss in export.losses if loss.effect is Effect.DROPPED}
    theirs = {each.name: each for each in eurdf.kinematics.closure_openings(found, q2)}
    for opening, closure in zip(eurdf.kinematics.closure_openings(robot, q), robot.constraints, strict=True):
        if closure.name in lost or closure.type == "coupling":
            continue
        other = theirs.pop(closure.name)
        np.testing.assert_allclose((other.position, other.angle), (opening.position, opening.angle), atol=1e-8)


def assert_same_mass_matrix(robot: Robot, q: Any, found: Robot, q2: Any) -> None:
    """M, without armatures, where the velocities of both are matched by those of the bodies."""
    jacobians = []
    for each, at in ((robot, q), (found, q2)):
        pin.computeJointJacobians(each.model, each.data, at)
        ids = [each.model.getFrameId(body.name, pin.FrameType.BODY) for body in robot.mechanism.bodies]
        jacobians.append(np.vstack([pin.computeFrameJacobian(each.model, each.data, at, id_) for id_ in ids]))
    C, *_ = np.linalg.lstsq(jacobians[1], jacobians[0], rcond=None)
    np.testing.assert_allclose(jacobians[1] @ C, jacobians[0], atol=1e-9)
    M, M2 = (mass_matrix(without_armature(each).model, at) for each, at in ((robot, q), (found, q2)))
    np.testing.assert_allclose(C.T @ M2 @ C, M, atol=1e-8 * np.abs(M).max())
