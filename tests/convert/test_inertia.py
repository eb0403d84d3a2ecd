"""Inertias of any kind and orientation: simulators keep what is written, and changes are losses of that size."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.convert.inertia import about_centre
from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import Robot, build_robot
from support.exported import InMuJoCo
from support.plain_urdf import inertial, link_element
from support.plain_urdf import robot as robot_element

#: Principal moments: of a body, a ball, a rod, a plate, a point, almost a plate; and of what no body is.
SHAPES = (
    (2, 3, 4),
    (1, 1, 1),
    (0, 1, 1),
    (0.7, 1.1, 1.8),
    (0, 0, 0),
    (1, 2, 3 - 1e-9),
    (0.6, 0.9, 2.2),
    (-0.1, 1, 1),
    (0, 0, 1),
)
TURNS = ((0, 0, 0, 1), (0, 0, 1, 0), (0, 0, 1, 1), (0, 0, 3e-7, 1), (1, 2, 3, 4))

quaternions = st.one_of(
    st.sampled_from(TURNS), st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda given: np.linalg.norm(given) > 0.1)
)


def single(shape: tuple[float, ...], scale: float, turn: tuple[float, ...], mass: float) -> Robot:
    """A body that floats, whose products of inertia are about the axes of the body."""
    pose = Pose(quaternion=tuple(np.divide(turn, np.linalg.norm(turn)).tolist()))
    a, b, c = (float(scale * each) for each in shape)
    moments = about_centre(Inertia(mass, pose, (a, 0.0, 0.0, b, 0.0, c)))
    inertia = Inertia(mass, Pose(), tuple(moments[np.triu_indices(3)].tolist()))
    return build_robot(Mechanism("single", "2.1", "floating", (Body("body", inertia),), ()), geometry=False)


def in_reader(robot: Robot, export: eurdf.convert.Export) -> tuple[float, Any]:
    """Mass, and rotational inertia (3, 3) about the centre of mass along the axes of the body."""
    if export.format == "mjcf":
        body = InMuJoCo(robot, export).model.body("body")
        w, *xyz = body.iquat.tolist()
        a, b, c = body.inertia.tolist()
        return body.mass[0], about_centre(Inertia(0.0, Pose(quaternion=(*xyz, w)), (a, 0.0, 0.0, b, 0.0, c)))
    if export.format == "usd":
        from support.in_usd import InUsd

        with TemporaryDirectory() as folder:
            stage = InUsd(export, Path(folder))
        prim = stage.prims("bodies")["body"]
        moments = sorted(stage.principal_moments(prim))
        assert moments[0] > 0.0
        assert moments[0] + moments[1] >= moments[2]
        mass, _, found = stage.inertia(prim)
        return mass, found
    from support.drake_witness import InDrake

    there = InDrake(robot, export, "sdf" if export.format == "sdf" else "urdf")
    found = there.plant.GetBodyByName("body").CalcSpatialInertiaInBodyFrame(there.context)
    return found.get_mass(), found.CalcRotationalInertia().CopyToFullMatrix3()


@pytest.mark.parametrize("to", ["mjcf", "drake", "sdf", "usd"])
@given(
    shape=st.sampled_from(SHAPES),
    scale=st.sampled_from([1.0, 1e-3, 30.0, 1e-6, 1e-10, 1e-14, 1e-15]),
    turn=quaternions,
    mass=st.sampled_from([1.0, 1e-3, 0.0]),
)
@example(shape=(0.6, 0.9, 2.2), scale=1.0, turn=(1, 2, 3, 4), mass=1.0)
@example(shape=(1, 1, 1), scale=1e-14, turn=(1, 2, 3, 4), mass=1.0)
@settings(max_examples=80)
def test_reader_has_our_inertia_but_for_losses(
    to: str, shape: tuple[float, ...], scale: float, turn: tuple[float, ...], mass: float
) -> None:
    robot = single(shape, scale, turn, mass)
    export = eurdf.export(robot, to)
    found_mass, found = in_reader(robot, export)
    (given_body,) = robot.mechanism.bodies
    assert given_body.inertia is not None
    expected = about_centre(given_body.inertia)
    losses = {loss.code: loss.message for loss in export.losses}
    # What a link without mass gets is below that.
    less = 1e-9 if "export-massless-link" in losses else 0.0
    stated = float(losses["export-inertia"].split()[-2]) if "export-inertia" in losses else 0.0
    # Changes of the three principal moments, each stated to two digits.
    rounding = 1e-6 if to == "usd" else 1e-11
    assert abs(found_mass - mass) <= less + rounding * mass
    change = np.linalg.eigvalsh(found - expected)
    assert np.abs(change).max() <= 1.06 * max(stated, less) + rounding * np.abs(expected).max()
    assert losses or (min(shape) >= 0 and 2 * max(shape) <= 1.1 * sum(shape))


@pytest.mark.parametrize("to", ["mjcf", "drake", "sdf", "usd"])
def test_negative_mass_is_refused(to: str) -> None:
    with pytest.raises(eurdf.errors.CannotExport, match=r"link .body. has the mass -1\.5 kg"):
        eurdf.export(robot_element(link_element("body", inertial(-1.5))), to, root="floating")
