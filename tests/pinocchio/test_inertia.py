"""Masses, centres of mass and mass matrices of models, against NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.mechanism.joint import JointProperties
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.configuration import configuration_vector
from eurdf.pinocchio.model import build_model
from support import by_hand

SEEDS = st.integers(0, 2**32 - 1)


def at_random(seed: int) -> tuple[Mechanism, dict[str, tuple[float, ...]], np.random.Generator]:
    random = np.random.default_rng(seed)
    mechanism = by_hand.tree_of_all_types(random)
    joints = tuple(replace(joint, offset=by_hand.some_pose(random)) for joint in mechanism.joints)
    coordinates = {joint.name: by_hand.some_coordinates(joint.type, random) for joint in joints if joint.type.nv > 0}
    return replace(mechanism, joints=joints), coordinates, random


def mass_matrix(mechanism: Mechanism, coordinates: dict[str, tuple[float, ...]]) -> np.ndarray:
    J = by_hand.jacobians(mechanism, coordinates)
    return sum(J[body.name].T @ by_hand.spatial_inertia(body.inertia) @ J[body.name] for body in mechanism.bodies[1:])


@given(seed=SEEDS)
@settings(deadline=None)
def test_mass_matrix_matches_kinetic_energy_of_bodies_and_armature(seed: int) -> None:
    mechanism, coordinates, random = at_random(seed)
    stated = [JointProperties(armature=tuple(random.uniform(0.0, 1.0, joint.type.nv))) for joint in mechanism.joints]
    joints = [replace(joint, properties=own) for joint, own in zip(mechanism.joints, stated, strict=True)]
    model = build_model(replace(mechanism, joints=tuple(joints)))
    M = pin.crba(model, model.createData(), configuration_vector(mechanism, model, coordinates))
    M = np.triu(M) + np.triu(M, 1).T
    armature = np.diag([value for own in stated for value in own.armature])
    np.testing.assert_allclose(M, mass_matrix(mechanism, coordinates) + armature, atol=1e-10)
    assert np.linalg.eigvalsh(M)[0] > 0.0


@given(seed=SEEDS)
@settings(deadline=None)
def test_gravity_acts_with_weight_of_bodies(seed: int) -> None:
    mechanism, coordinates, _ = at_random(seed)
    model = build_model(mechanism)
    q = configuration_vector(mechanism, model, coordinates)
    torque = np.zeros(model.nv)
    J, poses = by_hand.jacobians(mechanism, coordinates), by_hand.poses(mechanism, coordinates)
    for body in mechanism.bodies[1:]:
        assert body.inertia is not None
        lift = poses[body.name][:3, :3].T @ [0.0, 0.0, 9.81]  # a body at rest is accelerated upwards, seen from itself
        torque += J[body.name].T @ by_hand.spatial_inertia(body.inertia) @ [*lift, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(pin.computeGeneralizedGravity(model, model.createData(), q), torque, atol=1e-10)
