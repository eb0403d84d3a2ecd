"""Robots that touch the world: their contacts count as closures do, and are where they were asked for."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.errors import NotClosable
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.robot import build_robot
from eurdf.writing.description import NotWritable, describe_mechanism
from support.by_hand import some_inertia
from support.mechanisms import closed_tree

seeds = st.integers(0, 2**32 - 1)
FEET = {"left_sole": "6d", "right_sole": "3d"}


@pytest.fixture(scope="module")
def digit() -> Any:
    return eurdf.load("digit_2legs", geometry=False)


@pytest.fixture(scope="module")
def standing(digit: Any) -> Any:
    return digit.with_contacts(FEET)


def placement(robot: Any, frame: str, q: Any) -> Any:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.model.getFrameId(frame)]


def some_contact(kind: str, place: Any, random: np.random.Generator) -> Any:
    """A contact of a kind that holds where its frame is at a place."""
    axis = random.normal(size=3)
    away = place.translation + 1.3 * axis / np.linalg.norm(axis)
    return {"hinge": {"type": kind, "axis": axis}, "distance": {"type": kind, "length": 1.3, "at": away}}.get(
        kind, kind
    )


@given(seed=seeds, kind=st.sampled_from(["3d", "6d", "hinge", "distance"]), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=25, deadline=None)
def test_contact_counts_as_closure_in_random_mechanisms(seed: int, kind: str, root: Any) -> None:
    random = np.random.default_rng(seed)
    robot, q = closed_tree(random, ("3d", "coupling"), root)
    root_body, *bodies = robot.mechanism.bodies
    heavy = replace(robot.mechanism, bodies=(replace(root_body, inertia=some_inertia(random)), *bodies))
    robot = build_robot(heavy, geometry=False)
    rigid = rigid_roots(root_body.name, heavy.joints)
    frame = str(random.choice([body for body, at in rigid.items() if at != root_body.name]))
    touching = robot.with_contacts({frame: some_contact(kind, placement(robot, frame, q), random)}, at=q)
    assert touching.constraints[:-1] == robot.constraints
    assert np.abs(eurdf.residual(touching, q)).max() < 1e-11
    _, K = eurdf.residual_and_jacobian(touching, q)
    many = eurdf.batch.residual_and_jacobian(touching, np.array([q] * 40))[1]
    np.testing.assert_allclose(many, np.broadcast_to(K, many.shape), atol=1e-11)
    moved = [pin.integrate(robot.model, q, step * v) for v in np.eye(robot.model.nv) for step in (1e-6, -1e-6)]
    r = eurdf.batch.residual(touching, np.array(moved))
    np.testing.assert_allclose((r[::2] - r[1::2]).T / 2e-6, K, atol=1e-6 * np.abs(K).max())

    v, tau = eurdf.project_velocity(touching, q, random.normal(size=robot.model.nv)), random.normal(size=robot.model.nv)
    found = eurdf.forward_dynamics(touching, q, v, tau=tau)
    np.testing.assert_allclose(
        K @ found.a, eurdf.kinematics.constraint_acceleration(touching, q, v), atol=1e-7 * scale(found.a)
    )
    # pin.rnea is right where mimic joints are, unlike Pinocchio's solver of constraints.
    left = pin.rnea(robot.model, robot.data, q, v, found.a) - tau - eurdf.springs.spring_force(robot, q)
    np.testing.assert_allclose(left, K.T @ np.concatenate(found.forces), atol=1e-7 * scale(left, found.a))
    assert found.forces[frame] is found.forces[-1]


def scale(*values: Any) -> float:
    return 1.0 + max(float(np.abs(each).max()) for each in values)


@pytest.mark.parametrize("name", ["digit_2legs", "disney_2legs", "cassie_2legs"])
def test_forces_and_accelerations_are_those_of_constraint_models_by_hand(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    frames = ["left_foot", "right_foot"] if name == "disney_2legs" else ["left_sole", "right_sole"]
    touching = robot.with_contacts(dict(zip(frames, ("6d", "3d"), strict=True)))
    q, model = touching.configurations["assembled"], robot.model
    random = np.random.default_rng(0)
    v, u = (
        eurdf.project_velocity(touching, q, random.normal(size=model.nv)),
        random.normal(size=len(robot.actuation.idx_v)),
    )
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for each in robot.constraint_models:
        models.append(each)
    for frame, type_ in zip(frames, (pin.ContactType.CONTACT_6D, pin.ContactType.CONTACT_3D), strict=True):
        own = model.frames[model.getFrameId(frame)]
        oMf = placement(robot, frame, q)
        models.append(pin.RigidConstraintModel(type_, model, own.parentJoint, own.placement, 0, oMf, pin.LOCAL))
    for each in models:
        datas.append(each.createData())
    data = model.createData()
    pin.initConstraintDynamics(model, data, models, datas)
    tau = robot.actuation.selection @ u + eurdf.springs.spring_force(robot, q)
    a = pin.constraintDynamics(model, data, q, v, tau, models, datas, pin.ProximalSettings(1e-14, 1e-14, 1e-8, 50))
    found = eurdf.forward_dynamics(touching, q, v, u)
    np.testing.assert_allclose(found.a, a, atol=1e-8 * scale(a))
    for frame, of in zip(frames, list(datas)[-2:], strict=True):  # joint 1 carries the frame, on which this force acts
        force = of.contact_force.vector if len(found.forces[frame]) == 6 else of.contact_force.linear
        np.testing.assert_allclose(found.forces[frame], force, atol=1e-7 * scale(data.lambda_c))
    back = eurdf.inverse_dynamics(touching, q, v, found.a)
    tau = robot.actuation.selection @ back.u
    np.testing.assert_allclose(eurdf.forward_dynamics(touching, q, v, tau=tau).a, found.a, atol=1e-7 * scale(a))
    mine, by_hand = touching.constraint_models[-2:], list(models)[-2:]
    assert [each.type for each in mine] == [each.type for each in by_hand]


def test_feet_stay_and_energy_is_kept_in_simulation(standing: Any) -> None:
    q = standing.configurations["assembled"]
    v = eurdf.project_velocity(standing, q, 0.3 * np.random.default_rng(1).normal(size=standing.model.nv))
    moved = eurdf.simulate(standing, q, v, duration=0.1, step=1e-3)
    assert np.abs(moved.q[-1] - q).max() > 0.02
    places = [placement(standing, "left_sole", each) for each in moved.q]
    assert max(np.abs((places[0].inverse() * each).homogeneous - np.eye(4)).max() for each in places) < 1e-10
    right = np.array([placement(standing, "right_sole", each).translation for each in moved.q])
    assert np.abs(right - right[0]).max() < 1e-10
    assert moved.energy_error < 1e-5 * moved.energy_exchanged


def test_every_function_respects_contacts(standing: Any) -> None:
    q, random = standing.configurations["assembled"], np.random.default_rng(2)
    somewhere = pin.integrate(standing.model, q, 0.05 * random.normal(size=standing.model.nv))
    one = standing.with_contacts({}, at=q)
    assert one.constraints == standing.constraints
    found = [eurdf.assemble(standing, somewhere).q, eurdf.project_configuration(standing, somewhere)]
    found.append(eurdf.batch.project_configuration(standing, [somewhere]).q[0])
    torso = placement(standing, "torso", q)
    torso.translation -= (0.0, 0.01, 0.03)
    found.append(eurdf.inverse_kinematics(standing, {"torso": torso.translation}, q).q)
    for each in found:
        assert (placement(standing, "left_sole", q).inverse() * placement(standing, "left_sole", each)).isIdentity(1e-9)
        step = placement(standing, "right_sole", q).translation - placement(standing, "right_sole", each).translation
        assert np.abs(step).max() < 1e-9
    np.testing.assert_allclose(placement(standing, "torso", found[-1]).translation, torso.translation, atol=1e-7)
    assert eurdf.analyze(standing, q).rank == 45
    locked = eurdf.lock(standing, "left_motor_knee", q)
    assert locked.mechanism.contacts == standing.mechanism.contacts
    other = pickle.loads(pickle.dumps(locked)).with_contacts({"torso": "3d"})
    assert isinstance(other, eurdf.results.LockedRobot)
    assert [each.name for each in other.constraints[-3:]] == ["left_sole", "right_sole", "torso"]


def test_motors_move_a_robot_on_one_foot() -> None:
    robot = eurdf.load("toddlerbot_2legs", geometry=False)
    standing = robot.with_contacts({"left_sole": "6d"})
    q = standing.configurations["assembled"]
    u, _ = eurdf.split_configuration(standing, q)
    random = np.random.default_rng(0)
    values = u + 0.05 * random.uniform(-1.0, 1.0, (3, len(u)))
    many = eurdf.batch.forward_kinematics(standing, values)
    assert many.converged.all()
    for value, each in zip(values, many.q, strict=True):
        np.testing.assert_allclose(eurdf.forward_kinematics(standing, value), each, atol=1e-8)
        assert (placement(standing, "left_sole", q).inverse() * placement(standing, "left_sole", each)).isIdentity(1e-9)
        free = eurdf.forward_kinematics(robot, value)  # the same but for where the root is
        np.testing.assert_allclose(each[7:], free[7:], atol=1e-8)


def test_contact_is_at_the_place_that_is_stated(digit: Any) -> None:
    place = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.1, 0.5), np.array([0.3, -0.2, 0.1]))
    for at in (place, place.homogeneous):
        robot = digit.with_contacts({"left_sole": {"type": "6d", "at": at}})
        q = robot.configurations["assembled"]
        assert placement(robot, "left_sole", q).isApprox(place, 1e-9)
    point = placement(robot, "right_sole", q).act(np.array([0.01, 0.0, 0.02]))
    robot = robot.with_contacts({"right_sole": {"type": "3d", "at": point}})
    q = robot.configurations["assembled"]
    np.testing.assert_allclose(placement(robot, "right_sole", q).translation, point, atol=1e-9)
    assert placement(robot, "left_sole", q).isApprox(place, 1e-9)
    with pytest.raises(NotClosable, match="'right_sole' by"):
        robot.with_contacts({"imu": {"type": "3d", "at": (9.0, 0.0, 0.0)}})


@pytest.mark.parametrize(
    ("contacts", "message"),
    [
        (["left_sole"], "contacts is \\['left_sole'\\]; expected a mapping"),
        ({"left_sol": "6d"}, "no link, joint or frame 'left_sol'; did you mean 'left_sole'"),
        ({"left_sole": "7d"}, "type '7d'; a contact is one of '3d', '6d', 'hinge' and 'distance'"),
        ({"left_sole": "coupling"}, "type 'coupling'; a contact is one of"),
        ({"left_sole": 6}, "contacts\\['left_sole'\\] is 6; expected a type"),
        ({"left_sole": {"type": "distance"}}, "of type distance needs 'length'"),
        ({"left_sole": {"type": "distance", "length": 0.0}}, "\\['length'\\] is 0.0; expected at least 0.0001"),
        ({"left_sole": {"type": "hinge", "axis": [0, 0, 0]}}, "direction of length zero"),
        ({"left_sole": {"type": "hinge", "axis": [0, 1]}}, "has the shape \\(2,\\); expected \\(3,\\)"),
        (
            {"left_sole": {"type": "6d", "axis": [0, 0, 1]}},
            "unknown key 'axis'; a contact of type 6d has 'type' and 'at'",
        ),
        ({"left_sole": {"type": "hinge", "axis": [0, 0, 1], "axes": np.eye(3)[:2]}}, "which exclude each other"),
        ({"left_sole": {"type": "6d", "at": [1.0, 2.0]}}, "\\['at'\\] has the shape"),
        ({"left_sole": {"type": "6d", "at": 2.0 * np.eye(4)}}, "last row"),
        ({"left_foot": "3d", "left_free_foot2": "3d"}, "'left_free_foot2' and 'left_foot' are the same frame"),
    ],
)
def test_bad_contact_is_one_clear_error(digit: Any, contacts: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        digit.with_contacts(contacts)


def test_contact_needs_a_moving_frame_and_a_new_name(standing: Any) -> None:
    with pytest.raises(ValueError, match="'left_sole' is already the name of a constraint, of type 6d"):
        standing.with_contacts({"left_sole": "3d"})
    with pytest.raises(NotClosable, match="at is no closed configuration"):
        standing.with_contacts({}, at=pin.neutral(standing.model) + 0.01)
    leg = eurdf.load("digit_leg", geometry=False)
    with pytest.raises(ValueError, match="frame 'torso' is fixed to the world"):
        leg.with_contacts({"torso": "3d"})
    with pytest.raises(ValueError, match="at has the shape"):
        leg.with_contacts({"foot": "3d"}, at=np.zeros(3))
    with pytest.raises(KeyError, match="did you mean 'left_sole'"):
        eurdf.forward_dynamics(standing, standing.configurations["assembled"], {}).forces["left_sol"]


def test_contacts_are_no_silent_part_of_files(standing: Any) -> None:
    export = eurdf.export(standing, "mjcf")
    assert [loss.name for loss in export.losses if loss.code == "export-contact"] == list(FEET)
    assert not export.robot.mechanism.contacts
    with pytest.raises(NotWritable, match="contact 'left_sole'"):
        describe_mechanism(standing.mechanism)


def test_transmission_of_a_robot_that_stands() -> None:
    robot = eurdf.load("unitree_g1", geometry=False)
    q, joints = eurdf.assemble(robot).q, ["left_ankle_pitch_joint", "left_ankle_roll_joint"]
    standing = robot.with_contacts({"left_sole": "6d"}, at=q)
    np.testing.assert_allclose(
        eurdf.transmission(standing, joints, q).G, eurdf.transmission(robot, joints, q).G, atol=1e-9
    )
    with pytest.raises(ValueError, match="cannot have the contact 'left_sole'"):
        eurdf.transmissions.prepare_transmission(standing, joints).c_source("ankle")


def test_fixed_robot_is_the_same_with_a_closure_to_its_root() -> None:
    leg = eurdf.load("digit_leg", geometry=False)
    touching = leg.with_contacts({"foot": "3d"})
    (contact,), mechanism = touching.mechanism.contacts, leg.mechanism
    same: Mechanism = replace(mechanism, closures=(*mechanism.closures, contact))
    closed = build_robot(same, geometry=False)
    q, v = touching.configurations["assembled"], np.zeros(leg.model.nv)
    one, other = (eurdf.forward_dynamics(each, q, v) for each in (touching, closed))
    np.testing.assert_allclose(one.a, other.a, atol=1e-9 * scale(one.a))
