"""The builder of the collection: what is drawn weighs what it weighs, and is written as it is meant."""

import math

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from robots.builder import Box, Cylinder, Drawing, Motor, Sphere, ball, revolute, universal, write
from robots.builder.mirror import mirrored_shape
from robots.builder.shape import along, rotation_of
from robots.builder.solid import solid_of

coordinate = st.floats(-1.0, 1.0)
point = st.tuples(coordinate, coordinate, coordinate)
size = st.floats(0.01, 1.0)
boxes = st.builds(Box, point, st.tuples(size, size, size), size, point)
cylinders = st.builds(Cylinder, point, point, size, size).filter(lambda cylinder: cylinder.length > 0.01)
spheres = st.builds(Sphere, point, size, size)


def orientation(shape):
    """Roll, pitch and yaw of a shape in the world."""
    if isinstance(shape, Cylinder):
        return along(np.subtract(shape.end, shape.start))
    return shape.rpy if isinstance(shape, Box) else (0.0, 0.0, 0.0)


def points_of(shape):
    """Equal point masses with the same second moments as the solid: its Gauss points."""
    signs = (-1.0, 1.0)
    if isinstance(shape, Box):
        local = [np.array([x, y, z]) * shape.size / math.sqrt(12.0) for x in signs for y in signs for z in signs]
    elif isinstance(shape, Cylinder):
        r, h = shape.radius / math.sqrt(2.0), shape.length / math.sqrt(12.0)
        local = [np.array([r * x, r * y, h * z]) for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)) for z in signs]
    else:
        local = [sign * axis * shape.radius * math.sqrt(0.6) for axis in np.eye(3) for sign in signs]
    rotation = rotation_of(orientation(shape))
    return [(shape.mass / len(local), np.array(shape.center) + rotation @ at) for at in local]


@given(st.lists(boxes | cylinders | spheres, min_size=1, max_size=4))
def test_body_mass_matches_sampled_shapes(shapes):
    cloud = [masspoint for shape in shapes for masspoint in points_of(shape)]
    mass = sum(m for m, _ in cloud)
    center = sum(m * at for m, at in cloud) / mass
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in ((m, at - center) for m, at in cloud))
    solid = solid_of(shapes)
    assert solid.mass == pytest.approx(mass)
    assert solid.center == pytest.approx(center, abs=1e-12)
    assert solid.inertia == pytest.approx(inertia, abs=1e-12)


def pendulum():
    robot = Drawing("pendulum", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={"note": "two words: 1, 'a' # b"})
    base = Box((0.0, 0.0, 1.0), (0.2, 0.2, 0.1), mass=2.0)
    robot.body("base", None, base, material="steel", contacts=(base,))
    motor = Motor(effort=3.0, velocity=4.0, damping=0.1)
    arm = revolute("swing", "base", (0.0, 0.1, 1.0), (0.0, 2.0, 0.0), degrees=(-60.0, 90.0), drawn=30.0, motor=motor)
    robot.body("arm", arm, Sphere((0.0, 0.1, 0.5), 0.1, mass=1.0), material="steel")
    return robot


@pytest.fixture
def written(tmp_path):
    """Writes a drawing, and returns the root of its URDF and its description in YAML."""

    def files(robot):
        write(robot, tmp_path)
        return etree.parse(tmp_path / "robot.urdf").getroot(), yaml.safe_load((tmp_path / "robot.yaml").read_text())

    return files


@pytest.mark.parametrize(
    "text", ["yes", "No", "null", "1.0", "1e3", "012", "a: b", "- a", "", " a", "a ", "a #b", "é", "~", "3d"]
)
def test_text_survives_round_trip(text, written):
    robot = pendulum()
    robot.metadata = {"note": text}
    assert written(robot)[1]["metadata"] == {"note": text}


def rod_between(robot, ends, name="link"):
    robot.rod(
        name, ("base", (0.2, 0.0, 1.0)), ("arm", (0.2, 0.1, 0.4)), radius=0.01, mass=0.4, material="steel", ends=ends
    )


def hang_unnamed(robot):
    robot.body("left_arm", ball("left_ball", "base", (0.0, 0.0, 0.0)), material="steel")
    robot.body("tip", ball("tip_ball", "left_arm", (0.0, 0.0, 0.0)), material="steel")
    robot.mirror("left", "right")


def hold_unnamed(robot):
    robot.body("left_arm", ball("left_ball", "base", (0.0, 0.0, 0.0)), material="steel")
    robot.close("loop", "3d", "base", "left_arm", (0.0, 0.0, 0.0))
    robot.mirror("left", "right")


@given(boxes | cylinders | spheres)
def test_mirrored_shape_has_mirrored_inertia(shape):
    flip = np.diag([1.0, -1.0, 1.0])
    solid, mirrored = solid_of([shape]), solid_of([mirrored_shape(shape)])
    assert mirrored.mass == solid.mass
    assert mirrored.center == pytest.approx(flip @ solid.center)
    assert mirrored.inertia == pytest.approx(flip @ solid.inertia @ flip, abs=1e-12)


@pytest.mark.parametrize(
    ("draw", "complaint"),
    [
        (lambda robot, ball: robot.body("arm", ball("b", "base"), material="steel"), "two bodies 'arm'"),
        (lambda robot, ball: robot.body("tip", ball("swing", "base"), material="steel"), "two joints 'swing'"),
        (lambda robot, ball: robot.body("tip", ball("b", "bse"), material="steel"), "'bse', which is not drawn"),
        (lambda robot, ball: robot.body("tip", None, material="steel"), "second root"),
        (lambda robot, ball: robot.body("tip", ball("b", "base"), material="gold"), "'gold', which is no material"),
        (lambda robot, ball: robot.close("loop", "3d", "arm", "tip", (0.0, 0.0, 0.0)), "'tip', which is not drawn"),
        (
            lambda robot, ball: robot.frame("sole", "tip", (0.0, 0.0, 0.0)),
            "frame 'sole' is on 'tip', which is not drawn",
        ),
        (lambda robot, ball: robot.configure("bent", b=1.0), "configuration 'bent' is of 'b', which is not drawn"),
        (lambda robot, ball: rod_between(robot, ("point", "ball")), "starts in a point"),
        (lambda robot, ball: universal("u", "arm", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)), "perpendicular"),
        (lambda robot, ball: robot.mirror("arm", "leg"), "body 'arm' and joint 'swing', one is named 'arm' only"),
        (lambda robot, ball: hang_unnamed(robot), "'tip' hangs from 'left_arm' but is not named 'left'"),
        (lambda robot, ball: hold_unnamed(robot), "closure 'loop' holds 'base' and 'left_arm'"),
    ],
)
def test_disconnected_drawing_is_refused(draw, complaint):
    with pytest.raises(ValueError, match=complaint):
        draw(pendulum(), lambda name, parent: ball(name, parent, (0.0, 0.0, 0.0)))
