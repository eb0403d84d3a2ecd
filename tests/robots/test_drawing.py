"""The builder of the collection: what is drawn weighs what it weighs, and is written as it is meant."""

import math

import numpy as np
import pinocchio as pin
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

import eurdf
from eurdf.pinocchio.configuration import configuration_vector
from robots.builder import (
    Box,
    Cylinder,
    Drawing,
    Motor,
    Solid,
    Sphere,
    Spring,
    ball,
    prismatic,
    revolute,
    universal,
    write,
)
from robots.builder.mechanism import mechanism_of
from robots.builder.mirror import mirrored_shape
from robots.builder.shape import along, rotation_of, rpy_of
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


@given(cylinders)
def test_cylinder_is_aligned_with_its_ends(cylinder):
    axis = np.subtract(cylinder.end, cylinder.start)
    aligned = rotation_of(along(axis)) @ [0.0, 0.0, cylinder.length]
    assert aligned == pytest.approx(math.copysign(1.0, aligned @ axis) * axis, abs=1e-10)


def test_numbers_are_short_and_without_noise():
    robot = pendulum()
    robot.body(
        "tip", ball("tip_ball", "arm", (0.1 + 0.2, 0.1, 1.0)), Sphere((0.3, 0.1, 1.0), 0.1, 0.1 + 0.2), material="steel"
    )
    mechanism = mechanism_of(robot)
    assert mechanism.joints[1].placement.xyz == (0.3, 0.0, 0.0)
    assert mechanism.bodies[2].inertia.mass == 0.3


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


def version_1(folder):
    return yaml.safe_load((folder / "robot.v1.yaml").read_text())


def test_joint_is_at_its_drawn_pose(written):
    robot = pendulum()
    robot.body("tip", ball("tip_ball", "arm", (0.3, 0.1, 0.4)), Sphere((0.3, 0.1, 0.4), 0.1, 1.0), material="steel")
    joints = {joint.get("name"): joint for joint in written(robot)[0].iterfind("joint")}
    assert joints["swing"].find("origin").get("xyz") == "0 0.1 1"
    assert joints["tip_ball"].find("origin").get("xyz") == "0.3 0 -0.6"
    assert joints["tip_ball"].get("type") == "continuous"


def test_axis_is_unit_and_limits_are_relative(written):
    joint = written(pendulum())[0].find("joint")
    assert joint.find("axis").get("xyz") == "0 1 0"
    limit = {key: float(value) for key, value in joint.find("limit").attrib.items()}
    assert limit == {"lower": -1.5708, "upper": 1.0472, "effort": 3.0, "velocity": 4.0}
    assert dict(joint.find("dynamics").attrib) == {"damping": "0.1", "friction": "0"}


def test_only_contact_shapes_are_collision_shapes(written):
    base, arm = written(pendulum())[0].iterfind("link")
    assert base.find("collision/geometry/box").get("size") == "0.2 0.2 0.1"
    assert arm.find("visual/geometry/sphere").get("radius") == "0.1"
    assert arm.find("collision") is None


def test_rod_is_two_halves_joined_by_balls(written, tmp_path):
    robot = pendulum()
    robot.rod("link", ("base", (0.2, 0.0, 1.0)), ("arm", (0.2, 0.1, 0.4)), radius=0.01, mass=0.4, material="steel")
    assert [joint.name for joint in robot.joints] == ["swing", "ball_link_start", "ball_link_end"]
    assert sum(solid_of(robot.bodies[f"link_{side}"].shapes).mass for side in ("start", "end")) == pytest.approx(0.4)
    description = written(robot)[1]
    assert description["closures"] == [{"name": "link", "type": "6d", "frames": ["link_a", "link_b"]}]
    assert description["joints"] == {"ball_link_start": "spherical", "ball_link_end": "spherical"}
    assert version_1(tmp_path)["joint_type"] == ["SPHERICAL", "SPHERICAL"]
    welds = {
        joint.get("name"): np.array(joint.find("origin").get("xyz").split(), dtype=float)
        for joint in written(robot)[0].iterfind("joint[@type='fixed']")
    }
    assert welds["weld_link_a"] == pytest.approx([0.0, 0.05, -0.3])
    assert welds["weld_link_b"] == pytest.approx([0.0, -0.05, 0.3])


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


@given(
    point.map(lambda rpy: tuple(3.0 * angle for angle in rpy)) | st.tuples(coordinate, st.just(math.pi / 2), coordinate)
)
def test_rotation_matches_roll_pitch_yaw(rpy):
    rotation = rotation_of(rpy)
    assert rotation_of(rpy_of(rotation)) == pytest.approx(rotation, abs=1e-12)


def test_slider_travel_is_relative_to_drawn_pose(written):
    robot = pendulum()
    slider = prismatic("slide", "arm", (0.0, 0.1, 0.3), (0.0, 0.0, -3.0), metres=(0.1, 0.4), drawn=0.25)
    robot.body("piston", slider, Sphere((0.0, 0.1, 0.2), 0.1, mass=1.0), material="steel")
    joint = written(robot)[0].find("joint[@name='slide']")
    assert (joint.get("type"), joint.find("axis").get("xyz")) == ("prismatic", "0 0 -1")
    assert (joint.find("limit").get("lower"), joint.find("limit").get("upper")) == ("-0.15", "0.15")


def test_rod_with_point_end_is_one_body(written):
    robot = pendulum()
    rod_between(robot, ("ball", "point"))
    assert [joint.name for joint in robot.joints] == ["swing", "ball_link"]
    assert solid_of(robot.bodies["link"].shapes).mass == pytest.approx(0.4)
    assert written(robot)[1]["closures"] == [{"name": "link", "type": "3d", "frames": ["link_a", "link_b"]}]


def test_closures_and_couplings_of_version_2_1_are_drawn_closed(written, tmp_path):
    robot = pendulum()
    for side, y in (("left", 0.3), ("right", -0.3)):
        at = (0.0, y, 0.5)
        robot.body(
            f"{side}_crank",
            revolute(f"{side}_turn", "base", at, (1.0, 0.2, 0.0)),
            Sphere(at, 0.1, 2.0),
            material="steel",
        )
    robot.hinge("pin", "left_crank", "right_crank", (0.0, 0.0, 0.5), (0.0, 3.0, 4.0))
    robot.distance("tie", ("arm", (0.1, 0.0, 0.2)), ("left_crank", (0.1, 0.3, 0.6)))
    robot.couple("gear", left_turn=1.0, right_turn=-2.0)
    (tmp_path / "robot.v1.yaml").write_text("# of an earlier drawing")
    description = written(robot)[1]
    assert description["extended_urdf"] == "2.1"
    assert [closure["type"] for closure in description["closures"]] == ["hinge", "distance"]
    assert description["closures"][1]["length"] == pytest.approx(0.5)
    assert description["couplings"] == [{"name": "gear", "joints": {"left_turn": 1.0, "right_turn": -2.0}}]
    assert not (tmp_path / "robot.v1.yaml").exists()
    built = eurdf.load(tmp_path, geometry=False)
    assert [constraint.type for constraint in built.constraints] == ["hinge", "distance", "coupling"]
    assert np.abs(eurdf.residual(built, built.configurations["assembled"])).max() < 1e-12


def test_mirror_repeats_hinges_distances_and_couplings():
    robot = pendulum()
    at = (0.0, 0.3, 0.5)
    robot.body("left_crank", revolute("left_turn", "base", at, (1.0, 0.0, 0.0)), material="steel")
    robot.body("left_bar", revolute("left_bend", "left_crank", at, (1.0, 0.0, 0.0)), material="steel")
    robot.hinge("left_pin", "left_bar", "base", (0.0, 0.4, 0.5), (0.0, 1.0, 0.5))
    robot.distance("left_tie", ("left_bar", (0.0, 0.4, 0.1)), ("base", (0.0, 0.2, 0.1)))
    robot.couple("left_gear", left_turn=1.0, left_bend=-1.0)
    robot.mirror("left", "right")
    pin, tie = robot.closures[2:]
    assert (pin.name, pin.bodies, pin.axis) == ("right_pin", ("right_bar", "base"), (0.0, -1.0, 0.5))
    assert (tie.type, tie.points) == ("distance", ((0.0, -0.4, 0.1), (0.0, -0.2, 0.1)))
    assert robot.couplings[1].joints == {"right_turn": 1.0, "right_bend": -1.0}


def test_rod_on_universal_joint_cannot_spin(written, tmp_path):
    robot = pendulum()
    rod_between(robot, ("ball", "universal"))
    description = written(robot)[1]
    assert description["joints"]["universal_link_end"] == {"type": "universal", "axes": "xy"}
    assert version_1(tmp_path)["joint_type"] == ["SPHERICAL", "UJOINT_XY"]
    loaded = eurdf.load(tmp_path)
    assert not loaded.diagnostics
    analysis = eurdf.analyze(loaded)
    assert (analysis.nv, analysis.rank, analysis.uncontrolled) == (6, 6, 0)


def limb():
    """A floating trunk with a left arm of every kind of joint, all of them askew, and the right arm mirrored."""
    robot = Drawing("limb", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={}, root="floating")
    robot.body("trunk", None, Box((0.0, 0.0, 0.0), (0.1, 0.2, 0.3), mass=5.0), material="steel")
    shoulder = revolute("left_shoulder", "trunk", (0.0, 0.1, 0.1), (1.0, 2.0, 3.0), motor=Motor(1.0, 1.0))
    upper = Box((0.0, 0.3, 0.1), (0.1, 0.3, 0.05), mass=1.0, rpy=(0.3, -0.2, 0.7))
    robot.body("left_upper", shoulder, upper, material="steel", contacts=(upper,))
    slide = prismatic("left_slide", "left_upper", (0.0, 0.5, 0.1), (0.1, 1.0, 0.2), metres=(-0.1, 0.1))
    robot.body("left_lower", slide, Cylinder((0.0, 0.5, 0.1), (0.1, 0.7, 0.0), 0.03, mass=0.5), material="steel")
    wrist = universal("left_wrist", "left_lower", (0.1, 0.8, 0.0), (1.0, 1.0, 0.0), (1.0, -1.0, 0.5))
    robot.body("left_hand", wrist, Sphere((0.2, 0.85, 0.1), 0.05, mass=0.2), material="steel")
    finger = ball("left_finger", "left_hand", (0.2, 0.9, 0.0))
    robot.body("left_tip", finger, Box((0.2, 1.0, 0.0), (0.02, 0.2, 0.03), mass=0.1), material="steel")
    rod = {"radius": 0.01, "mass": 0.1, "material": "steel", "ends": ("universal", "ball")}
    robot.rod("left_rod", ("trunk", (0.1, 0.1, 0.1)), ("left_tip", (0.2, 1.0, 0.1)), **rod)
    robot.mirror("left", "right")
    return robot


def test_mirrored_side_has_equal_coordinates(tmp_path):
    write(limb(), tmp_path)
    robot = eurdf.load(tmp_path, root="fixed")
    random = np.random.default_rng(5)
    left = {
        "left_shoulder": [random.uniform(-3.0, 3.0)],
        "left_slide": [0.07],
        "left_wrist": random.uniform(-1.0, 1.0, 2).tolist(),
        **{name: unit_quaternion(random) for name in ("left_finger", "ball_left_rod_end")},
        "universal_left_rod_start": random.uniform(-1.0, 1.0, 2).tolist(),
    }
    right = {
        name.replace("left", "right"): [-value[0], value[1], -value[2], value[3]] if len(value) == 4 else value
        for name, value in left.items()
    }
    q = configuration_vector(robot.mechanism, robot.model, left | right)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)

    def position(body):
        return data.oMf[robot.model.getFrameId(body)].translation

    bodies = [body for body in limb().bodies if "left" in body]
    assert len(bodies) == 6
    for body in bodies:
        assert position(body.replace("left", "right")) == pytest.approx(position(body) * [1.0, -1.0, 1.0], abs=1e-12)


def test_springs_are_written_in_version_2_1_and_mirrored(tmp_path):
    robot = Drawing("legs", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={}, root="floating")
    robot.body("trunk", None, Sphere((0.0, 0.0, 1.0), 0.1, mass=5.0), material="steel")
    shin = revolute(
        "left_shin", "trunk", (0.0, 0.2, 0.5), (1.0, 1.0, 0.0), degrees=(-9.0, 9.0), spring=Spring(900.0, 0.1)
    )
    robot.body("left_leg", shin, Sphere((0.0, 0.2, 0.3), 0.1, mass=1.0), material="steel")
    slide = prismatic(
        "left_slide", "left_leg", (0.0, 0.2, 0.1), (0.0, 0.0, 1.0), metres=(0.0, 0.1), spring=Spring(5000.0)
    )
    robot.body("left_foot", slide, Sphere((0.0, 0.2, 0.0), 0.1, mass=1.0), material="steel")
    robot.mirror("left", "right")
    write(robot, tmp_path)
    loaded = eurdf.load(tmp_path)
    assert loaded.mechanism.version == "2.1"
    springs = {joint.name: (joint.properties.stiffness, joint.properties.rest) for joint in loaded.mechanism.joints}
    assert springs["left_shin"] == springs["right_shin"] == ((900.0,), (0.1,))
    assert springs["left_slide"] == springs["right_slide"] == ((5000.0,), (0.0,))
    first = (tmp_path / "robot.yaml").read_text().splitlines()[0]
    assert first.endswith("extended-urdf-2.1.schema.json")


def test_motors_frames_configurations_and_solids_are_written_and_mirrored(tmp_path):
    robot = Drawing("legs", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={}, root="floating")
    robot.body("trunk", None, Sphere((0.0, 0.0, 1.0), 0.1, mass=5.0), material="steel")
    motor = Motor(
        50.0, 6.0, damping=0.5, gear_ratio=9.0, rotor_inertia=1e-3, armature=0.1, name="left_drive", control=(-5.0, 6.0)
    )
    inertia = np.array([[0.03, 0.001, 0.002], [0.001, 0.04, 0.003], [0.002, 0.003, 0.05]])
    at, damper = (0.0, 0.2, 0.5), Spring(900.0, damping=1.5)
    robot.body("left_leg", universal("left_hip", "trunk", at, (0.6, 0.8, 0.0), (0.0, 0.0, 1.0)), material="steel")
    robot.body(
        "left_foot",
        revolute("left_knee", "left_leg", at, (0.0, 1.0, 0.0), motor=motor, spring=damper),
        Sphere((0.0, 0.2, 0.3), 0.1, mass=1.0),
        material="steel",
        solid=Solid(2.0, (0.01, 0.22, 0.3), inertia),
    )
    robot.frame("left_sole", "left_foot", (0.1, 0.25, 0.0))
    robot.frame("left_mark", "left_leg", (0.1, 0.3, 0.5), rpy=(0.3, 0.2, 0.1))
    robot.mirror("left", "right")
    robot.configure("bent", left_knee=0.4, right_knee=0.4)
    write(robot, tmp_path)
    loaded = eurdf.load(tmp_path)
    for knee in (joint for joint in loaded.mechanism.joints if "knee" in joint.name):
        found = knee.properties
        assert (found.gear_ratio, found.rotor_inertia, found.damping) == ((9.0,), (1e-3,), (2.0,))
        assert found.armature == (0.1,)
        assert loaded.mechanism.motors[knee.name].name == knee.name.replace("knee", "drive")
        assert loaded.mechanism.motors[knee.name].control == (-5.0, 6.0)
    data = loaded.model.createData()
    pin.framesForwardKinematics(loaded.model, data, loaded.configurations["assembled"])
    flip = np.diag([1.0, -1.0, 1.0])
    for side, mirror in (("left", np.eye(3)), ("right", flip)):
        solid = loaded.model.inertias[loaded.model.getJointId(f"{side}_knee")]
        assert solid.mass == 2.0
        assert solid.inertia == pytest.approx(mirror @ inertia @ mirror, abs=1e-15)
        mark = rotation_of((0.3, 0.2, 0.1))
        for name, place, turn in (("sole", (0.1, 0.25, 0.0), np.eye(3)), ("mark", (0.1, 0.3, 0.5), mark)):
            pose = data.oMf[loaded.model.getFrameId(f"{side}_{name}")]
            assert pose.translation == pytest.approx(mirror @ place, abs=1e-12)
            assert pose.rotation == pytest.approx(mirror @ turn @ mirror, abs=1e-12)
    expected = configuration_vector(loaded.mechanism, loaded.model, {"left_knee": [0.4], "right_knee": [0.4]})
    assert loaded.configurations["bent"] == pytest.approx(expected)


def test_drawing_without_springs_is_written_in_version_2_0(written):
    assert written(limb())[1]["extended_urdf"] == "2.0"


def unit_quaternion(random):
    value = random.normal(size=4)
    return (value / np.linalg.norm(value)).tolist()


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
