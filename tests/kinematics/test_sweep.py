"""The range of motion that `sweep` finds for one actuator, on linkages with known answers."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot
from robots.builder import Cylinder, Drawing, Motor, ball, revolute, write
from support.described import LIMITED
from support.mechanisms import one_loop
from support.plain_urdf import inertial, joint_element, link_element
from support.plain_urdf import robot as urdf_of
from support.wild import WILD, needs_wild

LEFT = (0.0, 1.0, 0.0)
MOTOR = Motor(effort=1.0, velocity=1.0)

SCREW = urdf_of(
    *(link_element(name, inertial()) for name in ("base", "spindle", "nut", "carriage")),
    joint_element("motor", "continuous", "base", "spindle", '<axis xyz="0 0 1"/>'),
    joint_element("thread", "continuous", "spindle", "nut", '<axis xyz="0 0 1"/>'),
    joint_element("slide", "prismatic", "base", "carriage", LIMITED.format("0 0 1").replace("3", "1")),
)
SCREW_CLOSED = """\
extended_urdf: "2.0"
closures: [{name: fit, type: 6d, frames: [nut, carriage]}]
joints: {thread: {type: helical, pitch: 0.01}}
actuators: [motor]
"""


def bar(start, end):
    return Cylinder(start, end, radius=0.005, mass=0.1)


def linkage(folder, pins, driven="crank", limits=None, passive_limits=None):
    """A four-bar linkage in the plane y = 0 with the pins crank, coupler, rocker's tip and rocker; its robot."""
    a, b, c, d = ((x, 0.0, z) for x, z in pins)
    robot = Drawing("linkage", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={})

    def pin_of(name, parent, at):
        degrees = limits if name == driven else passive_limits if name == "rocker" else None
        return revolute(name, parent, at, LEFT, degrees=degrees, motor=MOTOR if name == driven else None)

    robot.body("ground", None, bar(a, d), material="steel")
    robot.body("crank_bar", pin_of("crank", "ground", a), bar(a, b), material="steel")
    robot.body("coupler_bar", pin_of("coupler", "crank_bar", b), bar(b, c), material="steel")
    robot.body("rocker_bar", pin_of("rocker", "ground", d), bar(d, c), material="steel")
    robot.close("tip", "3d", "coupler_bar", "rocker_bar", c)
    write(robot, folder)
    return eurdf.load(folder)


#: Crank 10, coupler 34, rocker 25, ground 43 cm, as in robots/four_bar.
CRANK_AND_ROCKER = ((0.0, 0.0), (0.06, 0.08), (0.36, 0.24), (0.43, 0.0))


def test_rocker_range_matches_law_of_cosines(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    found = eurdf.sweep(robot, "crank")
    assert (found.lower.end, found.upper.end, found.periodic) == ("half turn", "half turn", True)
    assert found.bounds == (-math.pi, math.pi)
    assert found.upper.configurations.shape == (201, robot.model.nq)
    tips = []
    for q in (*found.lower.configurations, *found.upper.configurations):
        pin.framesForwardKinematics(robot.model, robot.data, q)
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        x, _, z = robot.data.oMf[robot.model.getFrameId("tip_b")].translation
        tips.append(math.atan2(z, 0.43 - x))
    for path, reach in ((min(tips), 0.24), (max(tips), 0.44)):
        cosine = (0.43**2 + 0.25**2 - reach**2) / (2.0 * 0.43 * 0.25)
        assert path == pytest.approx(math.acos(cosine), abs=1e-4)


def test_driving_rocker_stops_at_dead_points(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, driven="rocker", limits=(-120.0, 120.0))
    found = eurdf.sweep(robot, "rocker")
    drawn = math.atan2(0.24, 0.07)
    ends = []
    for path in (found.lower, found.upper):
        assert path.end == "dead point"
        assert path.joint is None
        assert 0.0 < path.singularity < 0.05
        assert path.residual < 1e-12
        ends.append(drawn + path.reached)
    for end, reach in zip(ends, (0.24, 0.44), strict=True):
        cosine = (0.43**2 + 0.25**2 - reach**2) / (2.0 * 0.43 * 0.25)
        assert end == pytest.approx(math.acos(cosine), abs=1e-3)


def test_flat_parallelogram_is_dead_point(tmp_path):
    # Beyond it there are two branches, parallelogram and antiparallelogram: on both the loops stay closed.
    robot = linkage(tmp_path, ((0.0, 0.0), (0.0, 0.1), (0.3, 0.1), (0.3, 0.0)))
    found = eurdf.sweep(robot, "crank")
    for path in (found.lower, found.upper):
        assert path.end == "dead point"
        assert abs(path.reached) == pytest.approx(math.pi / 2.0, abs=0.02)
    assert found.periodic is None


def test_start_at_dead_point_ends_at_once(tmp_path):
    robot = linkage(tmp_path, ((0.0, 0.0), (0.1, 0.0), (0.4, 0.0), (0.3, 0.0)))
    found = eurdf.sweep(robot, "crank")
    assert (found.lower.end, found.upper.end) == ("dead point", "dead point")
    assert found.lower.reached == pytest.approx(0.0, abs=0.02)


def test_path_ends_at_limit_of_passive_joint(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, passive_limits=(-180.0, 1.0))
    found = eurdf.sweep(robot, "crank", steps=50)
    ends = {path.end: path for path in (found.lower, found.upper)}
    path = ends["passive limit"]
    assert path.joint == "rocker"
    assert (path.configurations[:, robot.model.idx_qs[robot.model.getJointId("rocker")]] <= math.radians(1.0)).all()
    there = eurdf.forward_kinematics(robot, {"crank": path.reached})
    # The file gives the limit to 0.1 mrad; the path is interpolated linearly between two steps.
    assert there[robot.model.idx_qs[robot.model.getJointId("rocker")]] == pytest.approx(math.radians(1.0), abs=1e-3)


def test_reachable_limits_end_both_paths(tmp_path):
    found = eurdf.sweep(linkage(tmp_path, CRANK_AND_ROCKER, limits=(-40.0, 90.0)), "crank")
    assert (found.lower.end, found.upper.end, found.periodic) == ("limit", "limit", None)
    assert (found.lower.reached, found.upper.reached) == pytest.approx(found.bounds)
    assert found.bounds == pytest.approx((math.radians(-40.0), math.radians(90.0)), abs=1e-4)


def test_correction_falls_with_square_of_step(tmp_path):
    # `correction` is relative to the step, so halving the step halves it.
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    coarse, fine = (eurdf.sweep(robot, "crank", steps=steps).upper.correction for steps in (200, 400))
    assert coarse < 0.01
    assert fine == pytest.approx(coarse / 2.0, rel=0.05)


def test_screw_is_not_periodic(tmp_path):
    (tmp_path / "robot.urdf").write_text(SCREW)
    (tmp_path / "robot.yaml").write_text(SCREW_CLOSED)
    found = eurdf.sweep(eurdf.load(tmp_path), "motor")
    assert (found.lower.end, found.upper.end, found.periodic) == ("half turn", "half turn", False)
    ends = found.upper.configurations[-1][-1], found.lower.configurations[-1][-1]
    assert abs(ends[0] - ends[1]) == pytest.approx(0.01)


def test_actuator_outside_loops_reaches_its_limits():
    found = eurdf.sweep(eurdf.load("digit_leg", geometry=False), "motor_hip_z")
    assert (found.lower.end, found.upper.end) == ("limit", "limit")
    assert found.lower.reached == pytest.approx(found.bounds[0])
    assert found.upper.singularity == pytest.approx(1.0)


def test_other_actuators_are_held_and_rods_do_not_spin():
    robot = eurdf.load("digit_leg", geometry=False)
    found = eurdf.sweep(robot, "motor_knee")
    moved = found.upper.configurations[-1] - found.upper.configurations[0]
    held = [name for name in robot.actuation.joints if name != "motor_knee"]
    assert not moved[[robot.model.idx_qs[robot.model.getJointId(name)] for name in held]].any()
    for joint in ("ball_rod1_start", "ball_rod2_end"):
        first = robot.model.idx_qs[robot.model.getJointId(joint)]
        assert not moved[first : first + 4].any()


def test_joint_that_cannot_be_swept_is_refused(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    with pytest.raises(ValueError, match="'rocker' is not an actuated joint"):
        eurdf.sweep(robot, "rocker")
    drawing = Drawing("balls", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={})
    drawing.body("ground", None, material="steel")
    drawing.body("arm", ball("shoulder", "ground", (0.0, 0.0, 0.0)), bar((0, 0, 0), (0, 0, 1)), material="steel")
    write(drawing, tmp_path)
    description = tmp_path / "robot.yaml"
    description.write_text(description.read_text() + "actuators: [shoulder]\n")
    with pytest.raises(ValueError, match="'shoulder' has 3 velocities"):
        eurdf.sweep(eurdf.load(tmp_path), "shoulder")


def without_ranges(folder):
    """The robot in a folder, with no range in its URDF."""
    urdf = folder / "robot.urdf"
    urdf.write_text(re.sub(r'(lower|upper)="[^"]*" ?', "", urdf.read_text()))
    return eurdf.load(folder)


def test_actuator_without_range_sweeps_half_turns(tmp_path):
    linkage(tmp_path, CRANK_AND_ROCKER, limits=(-40.0, 90.0), passive_limits=(-180.0, 1.0))
    robot = without_ranges(tmp_path)
    q0 = eurdf.forward_kinematics(robot, {"crank": 0.3})
    found = eurdf.sweep(robot, "crank", q0)
    assert (found.lower.end, found.upper.end, found.periodic) == ("half turn", "half turn", True)
    assert found.bounds == pytest.approx((0.3 - math.pi, 0.3 + math.pi))
    assert (found.lower.reached, found.upper.reached) == pytest.approx(found.bounds)


def test_limits_can_be_ignored(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, limits=(-40.0, 90.0), passive_limits=(-180.0, 1.0))
    found = eurdf.sweep(robot, "crank", limits=False)
    assert (found.lower.end, found.upper.end, found.periodic) == ("half turn", "half turn", True)


def test_slide_without_range_sweeps_characteristic_length(tmp_path):
    (tmp_path / "robot.urdf").write_text(SCREW)
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\nactuators: [slide]\n')
    found = eurdf.sweep(without_ranges(tmp_path), "slide")
    assert (found.lower.end, found.upper.end) == ("characteristic length", "characteristic length")
    assert (found.lower.reached, found.upper.reached, found.periodic) == (-1.0, 1.0, None)


def test_passive_joint_beyond_limit_moves_back_only(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, passive_limits=(-180.0, 180.0))
    rocker = robot.model.idx_qs[robot.model.getJointId("rocker")]
    whole = eurdf.sweep(robot, "crank", steps=50)
    back = [path for path in (whole.lower, whole.upper) if path.configurations[1, rocker] < 0.0]
    assert len(back) == 1
    upper = robot.model.upperPositionLimit
    upper[rocker] = -0.1  # it starts at 0
    robot.model.upperPositionLimit = upper
    found = eurdf.sweep(robot, "crank", steps=50)
    ends = {path.configurations[-1, rocker] < -0.05: path for path in (found.lower, found.upper)}
    assert all(path.configurations[:, rocker].max() <= 1e-9 for path in ends.values())
    assert any(path.configurations[:, rocker].min() < -0.1 for path in (found.lower, found.upper))


@needs_wild
def test_published_robot_is_swept_without_division_by_zero():
    # Warnings are errors here. Its ball joints are three revolutes, and the hip does not move one of them.
    robot = eurdf.load(WILD / "digit_like_2legs", geometry=False)
    found = eurdf.sweep(robot, "motor_hip_y", steps=20)
    assert found.lower.end == "half turn"


def test_robot_that_cannot_close_is_refused(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    (closure,) = robot.mechanism.closures
    far = replace(closure, a=replace(closure.a, pose=Pose((9.0, 0.0, 0.0))))
    robot = build_robot(replace(robot.mechanism, closures=(far,)), geometry=False)
    with pytest.raises(eurdf.errors.NotClosable):
        eurdf.sweep(robot, "crank")


def test_actuator_of_rigid_loops_does_not_move():
    robot = one_loop(["revolute", "prismatic", "revolute", "revolute", "revolute"], "6d", 0)
    assert eurdf.analyze(robot).mobility == 0
    found = eurdf.sweep(robot, "j1", steps=4)
    for path in (found.lower, found.upper):
        assert path.end == "dead point"
        assert len(path.configurations) == 1
        assert path.residual < 1e-12
