"""Where simulations of an exported robot start, if its description does not say so."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

import eurdf
from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY
from eurdf.pinocchio.robot import Robot, build_robot
from support.exported import hanging


def with_tool(name: str, lower: float, upper: float) -> Robot:
    """A robot of the collection without configurations, with a joint outside of its loops."""
    mechanism = eurdf.load(name, geometry=False).mechanism
    limits = replace(JointProperties.unlimited(JointType.REVOLUTE), lower=(lower,), upper=(upper,))
    base, axes = mechanism.bodies[0].name, ((0.0, 0.0, 1.0),)
    joint = Joint("tool", JointType.REVOLUTE, base, "tool_link", axes=axes, properties=limits)
    body = Body("tool_link", Inertia(1.0, IDENTITY, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)))
    added = replace(mechanism, bodies=(*mechanism.bodies, body), joints=(*mechanism.joints, joint), configurations={})
    return build_robot(added, geometry=False)


def in_mujoco(export: eurdf.convert.Export) -> tuple[str, mujoco.MjModel, mujoco.MjData]:
    """Name of the first keyframe, and the model there."""
    model = mujoco.MjModel.from_xml_string(export.main.decode())
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return model.key(0).name, model, data


def test_tree_starts_at_the_coordinates_nearest_to_zero() -> None:
    urdf = hanging().replace('lower="-9" upper="9"', 'lower="0.5" upper="9"', 1)
    export = eurdf.export(urdf, "mjcf")
    name, _, data = in_mujoco(export)
    assert (name, data.joint("j").qpos, data.joint("k").qpos) == ("neutral", 0.5, 0.0)
    sdf = eurdf.export(urdf, "sdf")
    assert sdf.coordinates.from_files({"j": (0.5,)}) == pytest.approx(np.zeros(3))
    assert b"<lower>0</lower><upper>8.5</upper>" in b"".join(sdf.main.split())
    assert [loss.name for loss in sdf.losses if loss.code == "export-zero"] == ["neutral"]


@pytest.mark.parametrize("name", ["four_bar", "digit_leg"])
def test_joint_outside_of_loops_starts_within_its_limits(name: str) -> None:
    start, model, data = in_mujoco(eurdf.export(with_tool(name, 0.5, 1.0), "mjcf"))
    assert (start, data.joint("tool").qpos[0]) == ("assembled", 0.5)
    assert np.abs(data.efc_pos[: data.ne]).max() < 1e-8
    within = [
        lower <= data.qpos[at] <= upper
        for (lower, upper), at, limited in zip(model.jnt_range, model.jnt_qposadr, model.jnt_limited, strict=True)
        if limited
    ]
    assert all(within)


def test_mimic_joint_that_starts_beyond_its_limits_is_a_loss() -> None:
    urdf = hanging('<mimic joint="j" multiplier="-2" offset="-10"/>')
    (loss,) = (each for each in eurdf.export(urdf, "mjcf").losses if each.code == "export-beyond-limits")
    assert (loss.name, loss.effect) == ("neutral", "approximate")
    assert "'k' at -10 rad (limits -9 to 9)" in loss.message
