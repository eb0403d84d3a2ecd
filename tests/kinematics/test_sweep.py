"""A sweep leads one actuator as far as stops allow, and knows what ends its way: linkages whose answers are known."""

from __future__ import annotations

import math
import re
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

import eurdf
from robots.builder import Cylinder, Drawing, Motor, ball, revolute, write
from support.wild import WILD, needs_wild

LEFT = (0.0, 1.0, 0.0)
MOTOR = Motor(effort=1.0, velocity=1.0)

SCREW = """\
<robot name="screw">
  <link name="base"/>
  <link name="spindle">{inertial}</link>
  <link name="nut">{inertial}</link>
  <link name="carriage">{inertial}</link>
  <joint name="motor" type="continuous">
    <parent link="base"/><child link="spindle"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="thread" type="continuous">
    <parent link="spindle"/><child link="nut"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="base"/><child link="carriage"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>
""".replace(
    "{inertial}", '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)

SCREW_CLOSED = """\
extended_urdf: "2.0"
closures: [{name: fit, type: 6d, frames: [nut, carriage]}]
joints: {thread: {type: helical, pitch: 0.01}}
actuators: [motor]
"""


def bar(start, end):
    return Cylinder(start, end, radius=0.005, mass=0.1)


def linkage(folder, pins, driven="crank", stops=None, passive_stops=None):
    """A four-bar linkage in the plane y = 0 with the pins crank, coupler, rocker's tip and rocker; its robot."""
    a, b, c, d = ((x, 0.0, z) for x, z in pins)
    robot = Drawing("linkage", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={})

    def pin_of(name, parent, at):
        limits = stops if name == driven else passive_stops if name == "rocker" else None
        return revolute(name, parent, at, LEFT, degrees=limits, motor=MOTOR if name == driven else None)

    robot.body("ground", None, bar(a, d), material="steel")
    robot.body("crank_bar", pin_of("crank", "ground", a), bar(a, b), material="steel")
    robot.body("coupler_bar", pin_of("coupler", "crank_bar", b), bar(b, c), material="steel")
    robot.body("rocker_bar", pin_of("rocker", "ground", d), bar(d, c), material="steel")
    robot.close("tip", "3d", "coupler_bar", "rocker_bar", c)
    write(robot, folder)
    return eurdf.load(folder)


#: Crank 10, coupler 34, rocker 25, ground 43 cm, as in robots/four_bar.
CRANK_AND_ROCKER = ((0.0, 0.0), (0.06, 0.08), (0.36, 0.24), (0.43, 0.0))


def test_a_crank_comes_round_and_the_rocker_swings_as_the_law_of_cosines_says(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    found = eurdf.sweep(robot, "crank")
    assert (found.lower.end, found.upper.end, found.comes_round) == ("half turn", "half turn", True)
    assert found.stops == (-math.pi, math.pi)
    assert found.upper.configurations.shape == (201, robot.model.nq)
    tips = []
    for q in (*found.lower.configurations, *found.upper.configurations):
        pin.framesForwardKinematics(robot.model, robot.data, q)
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        x, _, z = robot.data.oMf[robot.model.getFrameId("tip_b")].translation
        tips.append(math.atan2(z, 0.43 - x))
    for way, reach in ((min(tips), 0.24), (max(tips), 0.44)):
        cosine = (0.43**2 + 0.25**2 - reach**2) / (2.0 * 0.43 * 0.25)
        assert way == pytest.approx(math.acos(cosine), abs=1e-4)


def test_a_rocker_that_drives_ends_at_the_dead_points_where_crank_and_coupler_are_in_line(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, driven="rocker", stops=(-120.0, 120.0))
    found = eurdf.sweep(robot, "rocker")
    drawn = math.atan2(0.24, 0.07)
    ends = []
    for way in (found.lower, found.upper):
        assert way.end == "dead point"
        assert way.joint is None
        assert 0.0 < way.singularity < 0.05
        assert way.residual < 1e-12
        ends.append(drawn + way.reached)
    for end, reach in zip(ends, (0.24, 0.44), strict=True):
        cosine = (0.43**2 + 0.25**2 - reach**2) / (2.0 * 0.43 * 0.25)
        assert end == pytest.approx(math.acos(cosine), abs=1e-3)


def test_a_parallelogram_does_not_pass_through_the_place_where_it_is_flat(tmp_path):
    # There it could go on as a parallelogram or crossed: on either branch the loops stay closed.
    robot = linkage(tmp_path, ((0.0, 0.0), (0.0, 0.1), (0.3, 0.1), (0.3, 0.0)))
    found = eurdf.sweep(robot, "crank")
    for way in (found.lower, found.upper):
        assert way.end == "dead point"
        assert abs(way.reached) == pytest.approx(math.pi / 2.0, abs=0.02)
    assert found.comes_round is None


def test_a_start_in_a_dead_point_is_one(tmp_path):
    robot = linkage(tmp_path, ((0.0, 0.0), (0.1, 0.0), (0.4, 0.0), (0.3, 0.0)))
    found = eurdf.sweep(robot, "crank")
    assert (found.lower.end, found.upper.end) == ("dead point", "dead point")
    assert found.lower.reached == pytest.approx(0.0, abs=0.02)


def test_the_way_ends_at_the_stop_of_a_passive_joint(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, passive_stops=(-180.0, 1.0))
    found = eurdf.sweep(robot, "crank", steps=50)
    ends = {way.end: way for way in (found.lower, found.upper)}
    way = ends["passive stop"]
    assert way.joint == "rocker"
    assert (way.configurations[:, robot.model.idx_qs[robot.model.getJointId("rocker")]] <= math.radians(1.0)).all()
    there = eurdf.forward_kinematics(robot, {"crank": way.reached})
    # The stop is in the file to 0.1 mrad; between two steps the way is taken as straight.
    assert there[robot.model.idx_qs[robot.model.getJointId("rocker")]] == pytest.approx(math.radians(1.0), abs=1e-3)


def test_an_actuator_with_stops_within_what_the_linkage_allows_comes_to_both(tmp_path):
    found = eurdf.sweep(linkage(tmp_path, CRANK_AND_ROCKER, stops=(-40.0, 90.0)), "crank")
    assert (found.lower.end, found.upper.end, found.comes_round) == ("stop", "stop", None)
    assert (found.lower.reached, found.upper.reached) == pytest.approx(found.stops)
    assert found.stops == pytest.approx((math.radians(-40.0), math.radians(90.0)), abs=1e-4)


def test_the_correction_after_a_step_is_quartered_by_halving_it(tmp_path):
    # In parts of the step, it is halved.
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    coarse, fine = (eurdf.sweep(robot, "crank", steps=steps).upper.correction for steps in (200, 400))
    assert coarse < 0.01
    assert fine == pytest.approx(coarse / 2.0, rel=0.05)


def test_a_screw_does_not_come_round(tmp_path):
    (tmp_path / "robot.urdf").write_text(SCREW)
    (tmp_path / "robot.yaml").write_text(SCREW_CLOSED)
    found = eurdf.sweep(eurdf.load(tmp_path), "motor")
    assert (found.lower.end, found.upper.end, found.comes_round) == ("half turn", "half turn", False)
    ends = found.upper.configurations[-1][-1], found.lower.configurations[-1][-1]
    assert abs(ends[0] - ends[1]) == pytest.approx(0.01)


def test_an_actuator_in_no_loop_comes_to_its_stops():
    found = eurdf.sweep(eurdf.load("digit_leg", geometry=False), "motor_hip_z")
    assert (found.lower.end, found.upper.end) == ("stop", "stop")
    assert found.lower.reached == pytest.approx(found.stops[0])
    assert found.upper.singularity == pytest.approx(1.0)


def test_other_actuators_are_held_and_rods_do_not_spin_more_than_they_must():
    robot = eurdf.load("digit_leg", geometry=False)
    found = eurdf.sweep(robot, "motor_knee")
    moved = found.upper.configurations[-1] - found.upper.configurations[0]
    held = [name for name in robot.actuation.joints if name != "motor_knee"]
    assert not moved[[robot.model.idx_qs[robot.model.getJointId(name)] for name in held]].any()
    for joint in ("ball_rod1_start", "ball_rod2_end"):
        first = robot.model.idx_qs[robot.model.getJointId(joint)]
        assert not moved[first : first + 4].any()


def test_what_has_no_stops_to_be_swept_between_is_refused(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    with pytest.raises(ValueError, match="'rocker' is no actuated joint"):
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


def test_an_actuator_without_a_range_turns_as_far_as_it_goes(tmp_path):
    linkage(tmp_path, CRANK_AND_ROCKER, stops=(-40.0, 90.0), passive_stops=(-180.0, 1.0))
    robot = without_ranges(tmp_path)
    q0 = eurdf.forward_kinematics(robot, {"crank": 0.3})
    found = eurdf.sweep(robot, "crank", q0)
    assert (found.lower.end, found.upper.end, found.comes_round) == ("half turn", "half turn", True)
    assert found.stops == pytest.approx((0.3 - math.pi, 0.3 + math.pi))
    assert (found.lower.reached, found.upper.reached) == pytest.approx(found.stops)
    strict = eurdf.sweep(robot, "crank", q0, limits="strict")
    assert strict.stops == (0.0, 0.0)


def test_without_limits_stops_are_passed(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, stops=(-40.0, 90.0), passive_stops=(-180.0, 1.0))
    found = eurdf.sweep(robot, "crank", limits=False)
    assert (found.lower.end, found.upper.end, found.comes_round) == ("half turn", "half turn", True)


def test_a_slide_without_a_range_goes_as_far_as_the_loops_reach(tmp_path):
    (tmp_path / "robot.urdf").write_text(SCREW)
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\nactuators: [slide]\n')
    found = eurdf.sweep(without_ranges(tmp_path), "slide")
    assert (found.lower.end, found.upper.end) == ("characteristic length", "characteristic length")
    assert (found.lower.reached, found.upper.reached, found.comes_round) == (-1.0, 1.0, None)


def test_a_passive_joint_beyond_its_stop_may_come_back_but_not_go_farther(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER, passive_stops=(-180.0, 180.0))
    rocker = robot.model.idx_qs[robot.model.getJointId("rocker")]
    whole = eurdf.sweep(robot, "crank", steps=50)
    back = [way for way in (whole.lower, whole.upper) if way.configurations[1, rocker] < 0.0]
    assert len(back) == 1
    upper = robot.model.upperPositionLimit
    upper[rocker] = -0.1  # it starts at 0
    robot.model.upperPositionLimit = upper
    found = eurdf.sweep(robot, "crank", steps=50)
    ends = {way.configurations[-1, rocker] < -0.05: way for way in (found.lower, found.upper)}
    assert all(way.configurations[:, rocker].max() <= 1e-9 for way in ends.values())
    assert any(way.configurations[:, rocker].min() < -0.1 for way in (found.lower, found.upper))


@needs_wild
def test_sweeps_of_a_published_robot_divide_by_nothing():
    # Warnings are errors here. Its balls are three revolutes, one of which a hip does not move.
    robot = eurdf.load(WILD / "digit_like_2legs", geometry=False)
    for limits in (True, "strict"):
        found = eurdf.sweep(robot, "motor_hip_y", steps=20, limits=limits)
        assert found.lower.end == ("half turn" if limits is True else "stop")


def test_loops_that_cannot_be_closed_are_said_to_be_open(tmp_path):
    robot = linkage(tmp_path, CRANK_AND_ROCKER)
    robot.constraint_models[0].joint1_placement = pin.SE3(np.eye(3), np.array((9.0, 0.0, 0.0)))
    with pytest.raises(eurdf.NotClosable):
        eurdf.sweep(robot, "crank")
