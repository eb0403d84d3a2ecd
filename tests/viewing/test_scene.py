"""What is drawn of a robot, without a viewer."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.viewing.scene import Scene
from eurdf.viewing.surface import Surface, surface_of


def volume(surface: Surface) -> float:
    """Volume inside of triangles that are counterclockwise seen from outside, m³."""
    a, b, c = (surface.vertices[surface.triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        (coal.Box(0.2, 0.3, 0.4), 0.2 * 0.3 * 0.4),
        (coal.Sphere(0.5), 4.0 / 3.0 * np.pi * 0.5**3),
        (coal.Cylinder(0.3, 0.8), np.pi * 0.3**2 * 0.8),
        (coal.Capsule(0.3, 0.8), np.pi * 0.3**2 * (0.8 + 4.0 / 3.0 * 0.3)),
    ],
    ids=["box", "sphere", "cylinder", "capsule"],
)
def test_surface_encloses_the_shape(shape: coal.ShapeBase, expected: float) -> None:
    surface = surface_of(shape)
    assert volume(surface) == pytest.approx(expected, rel=0.02)  # polygons of 36 sides are 0.5 % smaller than circles
    shape.computeLocalAABB()
    assert np.abs(surface.vertices).max(axis=0) == pytest.approx(shape.aabb_local.max_, rel=1e-9)


def test_bodies_are_where_the_model_has_them() -> None:
    robot = eurdf.load("digit_leg")
    q = robot.configurations["assembled"]
    scene = Scene(robot, q)
    placed = scene.at(q)
    pin.framesForwardKinematics(robot.model, robot.data, q)
    for number, name in enumerate(scene.bodies):
        frame = robot.model.getFrameId(name, pin.FrameType.BODY)
        assert placed.pose(number).isApprox(robot.data.oMf[frame], 1e-12), name
    # The same for each shape, with Pinocchio's placements.
    data = robot.visual_model.createData()
    pin.updateGeometryPlacements(robot.model, robot.data, robot.visual_model, data, q)
    visuals = [part for part in scene.parts if part.kind == "visual"]
    for part, oMg in zip(visuals, data.oMg, strict=True):
        assert (placed.pose(part.body) * part.pose).isApprox(oMg, 1e-12)


def test_what_is_placed_stays_when_the_robot_moves_on() -> None:
    robot = eurdf.load("digit_leg")
    closed = robot.configurations["assembled"]
    scene = Scene(robot, closed)
    placed = scene.at(closed)
    before = placed.poses.copy()
    elsewhere = scene.at(pin.integrate(robot.model, closed, np.full(robot.model.nv, 0.1)))
    assert (placed.poses == before).all()
    assert np.abs(elsewhere.poses - before).max() > 0.1


def test_closure_lines_meet_where_loops_are_closed() -> None:
    robot = eurdf.load("digit_leg")
    closed = robot.configurations["assembled"]
    scene = Scene(robot, closed)
    lines = scene.closure_lines(scene.at(closed))
    gaps = np.linalg.norm(lines[:, 1, 1] - lines[:, 1, 0], axis=1)
    assert gaps.max() < 1e-9
    open_ = pin.integrate(robot.model, closed, np.linspace(0.1, 0.3, robot.model.nv))
    placed = scene.at(open_)
    lines = scene.closure_lines(placed)
    gaps = np.linalg.norm(lines[:, 1, 1] - lines[:, 1, 0], axis=1)
    assert gaps == pytest.approx([opening.position for opening in placed.openings], rel=1e-9)


def test_axis_is_that_of_the_joint() -> None:
    """Turning a joint about its axis leaves points of the axis where they are."""
    robot = eurdf.load("digit_leg")
    q = robot.configurations["assembled"]
    scene = Scene(robot, q)
    lines = scene.axis_lines(scene.at(q))
    joints = {joint.name: joint for joint in robot.mechanism.joints}
    turned = 0
    for number, axis in enumerate(scene.axes):
        if joints[axis.joint].type not in ("revolute", "continuous"):
            continue
        v = np.zeros(robot.model.nv)
        v[robot.tree.velocities_of(axis.joint)[0]] = 0.3
        moved = scene.axis_lines(scene.at(pin.integrate(robot.model, q, v)))
        assert moved[number] == pytest.approx(lines[number], abs=1e-12)
        turned += 1
    assert turned >= 6


def test_inertia_ellipsoid_has_the_moments_of_the_body() -> None:
    robot = eurdf.load("digit_leg")
    scene = Scene(robot, robot.configurations["assembled"])
    ellipsoids = [part for part in scene.parts if part.kind == "inertia"]
    assert ellipsoids
    for part in ellipsoids:
        inertia = robot.mechanism.bodies[part.body].inertia
        a, b, c = np.abs(part.surface.vertices).max(axis=0)
        # The polygons of the sphere reach its radius along z and x, and nearly along y.
        solid = inertia.mass / 5.0 * np.diag((b * b + c * c, a * a + c * c, a * a + b * b))
        R = part.pose.rotation
        xx, xy, xz, yy, yz, zz = inertia.moments
        stated = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
        here = pin.XYZQUATToSE3([*inertia.pose.xyz, *inertia.pose.quaternion]).rotation
        assert R @ solid @ R.T == pytest.approx(here @ stated @ here.T, rel=0.03, abs=0.03 * np.trace(stated))


def test_missing_mesh_leaves_the_rest(tmp_path) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(
        '<robot name="bare"><link name="base"><visual><geometry><mesh filename="gone.stl"/></geometry></visual></link>'
        '<link name="tip"/><joint name="j" type="continuous"><parent link="base"/><child link="tip"/>'
        '<origin xyz="0 0 1"/></joint></robot>'
    )
    robot = eurdf.load(file)
    scene = Scene(robot, pin.neutral(robot.model))
    assert not scene.has_visuals
    assert scene.skeleton(scene.at(pin.neutral(robot.model))) == pytest.approx(np.array([[[0, 0, 0], [0, 0, 1]]]))
