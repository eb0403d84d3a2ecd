"""Advice: what is within the rules and yet is mostly a mistake. Each piece has what it warns of and near misses."""

from __future__ import annotations

import re
import shutil
import struct
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import yaml
from lxml import etree

import eurdf
from eurdf.advice.actuation import advise_on_actuation
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.collection import collection_names
from eurdf.diagnostics import Diagnostic, Diagnostics
from eurdf.kinematics.evaluate import evaluator
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.pose import Vector3
from eurdf.pinocchio.robot import build_robot
from support.described import body
from support.places import ROBOTS
from support.plain_urdf import joint_element
from support.plain_urdf import robot as robot_element


@pytest.fixture
def advice(tmp_path: Path) -> Callable[..., list[Diagnostic]]:
    """What `eurdf.check` finds in a robot of the collection after an edit of its files."""

    def found(
        name: str,
        edit: Callable[[dict], object] = lambda description: None,
        urdf: Callable[[str], str] = lambda text: text,
    ) -> list[Diagnostic]:
        folder = Path(tempfile.mkdtemp(dir=tmp_path))
        shutil.copytree(
            ROBOTS / name, folder, ignore=shutil.ignore_patterns("*.png", "*.py", "__pycache__"), dirs_exist_ok=True
        )
        described, tree = folder / "robot.yaml", folder / "robot.urdf"
        description = yaml.safe_load(described.read_text(encoding="utf-8"))
        edit(description)
        described.write_text(yaml.safe_dump(description, sort_keys=False), encoding="utf-8")
        tree.write_text(urdf(tree.read_text(encoding="utf-8")), encoding="utf-8")
        return list(eurdf.check(folder).diagnostics)

    return found


def actuated(entry: str | dict) -> str:
    return entry if isinstance(entry, str) else entry["joint"]


def without(*joints: str) -> Callable[[dict], object]:
    """Takes actuators out."""

    def edit(description: dict) -> None:
        description["actuators"] = [each for each in description["actuators"] if actuated(each) not in joints]

    return edit


def typed(kind: str, *closures: str) -> Callable[[dict], object]:
    """Gives closures another type."""

    def edit(description: dict) -> None:
        for each in description["closures"]:
            if each["name"] in closures:
                each["type"] = kind

    return edit


def codes(found: list[Diagnostic]) -> list[str]:
    return [each.code for each in found]


@pytest.mark.parametrize("name", collection_names())
def test_collection_needs_no_advice(name: str) -> None:
    assert [str(found) for found in eurdf.check(name).diagnostics] == []


def test_closures_without_actuator_are_reported(advice) -> None:
    (found,) = advice("four_bar", without("motor_crank"))
    assert (found.code, found.severity, found.clause, found.pointer) == ("x-no-actuator", "warning", None, "/closures")
    assert "1 closure and no actuator" in found.message
    assert "'actuators'" in (found.hint or "")


def test_misspelt_actuator_key_suppresses_advice(tmp_path: Path) -> None:
    shutil.copy(ROBOTS / "four_bar" / "robot.urdf", tmp_path)
    text = (ROBOTS / "four_bar" / "robot.v1.yaml").read_text(encoding="utf-8")
    for key, expected in (("name_motor", ["near-miss-key"]), ("motors", ["x-no-actuator"])):
        (tmp_path / "robot.yaml").write_text(text.replace("name_mot", key), encoding="utf-8")
        report = eurdf.check(tmp_path)
        assert codes(list(report.diagnostics)) == expected
    assert "'name_mot'" in (report.diagnostics[0].hint or "")
    assert report.diagnostics[0].pointer == "/closed_loop"


def test_tree_needs_no_actuator(tmp_path: Path) -> None:
    shutil.copy(ROBOTS / "four_bar" / "robot.urdf", tmp_path)
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\n', encoding="utf-8")
    assert eurdf.check(tmp_path).diagnostics == ()


@pytest.mark.parametrize(
    ("name", "closure", "actuators"),
    [
        ("digit_leg_3d", "achilles", ["motor_knee"]),
        ("four_bar", "rocker_pin", ["motor_crank"]),
        ("talos_2legs", "left_rod", ["left_motor_shin"]),
        ("kangaroo_leg", "hip_rod", ["motor_leg_length"]),
        ("delta", "rod_2a", ["motor_1", "motor_2", "motor_3"]),
    ],
)
def test_locking_6d_closure_is_named_and_3d_suggested(advice, name, closure, actuators) -> None:
    (found,) = advice(name, typed("6d", closure))
    text = (ROBOTS / name / "robot.yaml").read_text(encoding="utf-8")
    index = [each["name"] for each in yaml.safe_load(text)["closures"]].index(closure)
    assert (found.code, found.pointer) == ("x-dependent-actuators", f"/closures/{index}")
    assert all(f"'{actuator}'" in found.message for actuator in actuators)
    assert f"type 3d for closure '{closure}'" in (found.hint or "")


def test_locking_hinge_gets_the_hint_of_a_6d_closure() -> None:
    """What the advice asks of a closure is the same for every kind."""
    description, robot = read_robot(ROBOTS / "four_bar"), eurdf.load(ROBOTS / "four_bar", geometry=False)
    assert description.linked is not None
    (pin_,) = robot.mechanism.closures
    across = HingeClosure(pin_.name, pin_.a, pin_.b, ((0.0, 0.0, 1.0), _axis_of_b_along_z_of_a(robot, pin_)))
    locked = build_robot(replace(robot.mechanism, closures=(across,)), geometry=False)
    diagnostics = Diagnostics()
    advise_on_actuation(description, locked, eurdf.analyze(locked, eurdf.assemble(robot).q), diagnostics)
    (found,) = diagnostics
    assert (found.code, found.pointer) == ("x-dependent-actuators", "/closures/0")
    assert any(f"type 3d for closure '{pin_.name}'" in (fix.question or "") for fix in found.proposals)


def _axis_of_b_along_z_of_a(robot: eurdf.Robot, closure: Closure) -> Vector3:
    """The direction in B of the z axis of A, where the loops are closed."""
    end = replace(robot.mechanism, closures=(FrameClosure(closure.name, closure.a, closure.b),))
    trial = build_robot(end, geometry=False)
    (turn,) = evaluator(trial, few=True).at(eurdf.assemble(robot).q[None]).poses.rotation[0]
    return tuple(turn.T[:, 2].tolist())


def test_dependent_actuators_are_named_if_no_closure_locks(advice) -> None:
    (found,) = advice("four_bar", lambda description: description["actuators"].append("free_rocker"))
    assert (found.code, found.pointer) == ("x-dependent-actuators", "/actuators/1")
    assert "'motor_crank'" in found.message
    assert "'free_rocker'" in found.message
    assert "remove 'free_rocker' from 'actuators'" in (found.hint or "")


def test_advice_on_a_loop_ignores_couplings_beside_it(tmp_path: Path) -> None:
    inertia = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    wheels = "".join(
        f'<link name="{name}_body">{inertia}</link><joint name="{name}" type="continuous">'
        f'<parent link="ground"/><child link="{name}_body"/></joint>'
        for name in ("wheel_1", "wheel_2")
    )
    text = (ROBOTS / "four_bar" / "robot.urdf").read_text(encoding="utf-8")
    (tmp_path / "robot.urdf").write_text(text.replace("</robot>", f"{wheels}</robot>"), encoding="utf-8")
    description = yaml.safe_load((ROBOTS / "four_bar" / "robot.yaml").read_text(encoding="utf-8"))
    description["extended_urdf"] = "2.1"
    description["couplings"] = [{"name": "belt", "joints": {"wheel_1": 1, "wheel_2": -1}}]
    description["actuators"] += ["free_rocker", "wheel_1"]
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(description), encoding="utf-8")
    (found,) = eurdf.check(tmp_path).diagnostics
    assert (found.code, found.pointer) == ("x-dependent-actuators", "/actuators/1")


@pytest.mark.parametrize(
    ("kind", "verb"), [("helical, pitch: 0.01", "cannot move: "), ("cylindrical", "independently: ")]
)
def test_freely_turning_actuator_is_not_called_locked(tmp_path: Path, kind: str, verb: str) -> None:
    arm = chain(joint("shoulder", "a", "b"), joint("elbow", "b", "c"), joint("wrist", "c", "d"))
    pin = "{name: pin, type: 3d, frames: [{link: d, xyz: [0.2, 0, 0]}, {link: a, xyz: [0.7, 0, 0]}]}"
    found = checked(tmp_path, arm, f"joints: {{elbow: {{type: {kind}}}}}\nclosures: [{pin}]\nactuators: [elbow]\n")
    (dependent,) = [each for each in found if each.code == "x-dependent-actuators"]
    assert "actuator 'elbow' cannot move" in dependent.message
    assert verb in dependent.message


FILES = {
    name: yaml.safe_load((ROBOTS / name / "robot.yaml").read_text(encoding="utf-8")) for name in collection_names()
}
#: The robots on a fixed root; those that walk are large, and have the same linkages.
STANDING = [name for name, file in FILES.items() if "root" not in file and file["actuators"]]


@pytest.mark.parametrize("name", STANDING)
def test_missing_actuator_leaves_reported_motion(advice, name: str) -> None:
    actuators = FILES[name]["actuators"]
    (found,) = advice(name, without(actuated(actuators[-1])))
    alone = len(actuators) == 1
    assert found.code == ("x-no-actuator" if alone else "x-uncontrolled-motion")
    assert found.pointer == ("/closures" if alone else "/actuators")


def test_free_orientation_leaves_reported_motion(advice) -> None:
    (found,) = advice("talos_leg", typed("3d", "rod"))
    assert found.code == "x-uncontrolled-motion"
    assert "use type 6d" in (found.hint or "")


def test_skipped_closure_suppresses_motion_advice(advice) -> None:
    assert codes(advice("delta", typed("x-magnet", "rod_2a"))) == ["closure-type-unknown"]


WHEEL = """
  <link name="wheel">
    <inertial>
      <origin xyz="{lever} 0.02 0"/>
      <mass value="0.2"/>
      <inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0002" iyz="0" izz="0.0001"/>
    </inertial>
  </link>
  <joint name="axle" type="continuous">
    <parent link="{parent}"/>
    <child link="wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
</robot>"""


@pytest.mark.parametrize(("lever", "expected"), [("0", []), ("0.05", ["x-uncontrolled-motion"])])
def test_wheel_needs_no_actuator_but_pendulum_does(advice, lever: str, expected: list[str]) -> None:
    def urdf(text: str) -> str:
        parent = text.split('<link name="')[1].split('"')[0]
        return text.replace("</robot>", WHEEL.format(lever=lever, parent=parent))

    assert codes(advice("four_bar", urdf=urdf)) == expected


@pytest.mark.parametrize(
    ("bars", "springs", "reported"),
    [(4, "", True), (4, "t", False), (4, "tu", False), (5, "t", True), (5, "tu", False)],
)
def test_motion_against_a_spring_needs_no_actuator(tmp_path: Path, bars: int, springs: str, reported: bool) -> None:
    joints = [joint(*names, limits="-3 3") for names in ("sab", "tbc", "ucd", "vde", "wef")[:bars]]
    ends = f"{{link: {'abcdef'[bars]}, xyz: [0.2, 0, 0]}}, {{link: a, xyz: [0.7, 0.1, 0]}}"
    sprung = ", ".join(f"{name}: {{stiffness: 5.0}}" for name in springs)
    pin = f"{{name: pin, type: 3d, frames: [{ends}]}}"
    yaml = f"joints: {{{sprung}}}\nclosures: [{pin}]\nactuators: [s]\n"
    found = checked(tmp_path, chain(*joints, names="abcdef"), yaml)
    assert codes(found) == ["x-uncontrolled-motion"] * reported


def rocker(lower: float, upper: float) -> Callable[[str], str]:
    """Gives the rocker of the four-bar linkage other limits; it swings from -0.798 to 0.031 rad."""
    return lambda text: text.replace('lower="-0.9372" upper="0.11"', f'lower="{lower}" upper="{upper}"')


def without_configurations(description: dict) -> None:
    del description["configurations"]


@pytest.mark.parametrize(
    ("lower", "upper", "expected"),
    [
        (0.3, 0.6, ["x-closes-beyond-limits"]),
        (-1.2, -0.9, ["x-closes-beyond-limits"]),
        (-0.9, -0.3, []),  # at the start it is beyond, but it closes within
        (0.02, 0.6, []),
        (0, 0, ["urdf-no-range"]),
    ],
)
def test_closing_only_beyond_limits_is_reported(advice, lower, upper, expected: list[str]) -> None:
    found = advice("four_bar", without_configurations, rocker(lower, upper))
    assert codes(found) == expected
    if expected == ["x-closes-beyond-limits"]:
        assert (found[0].severity, found[0].clause, found[0].pointer) == ("warning", None, "/closures/0")
        assert "least open: 'rocker_pin' by " in found[0].message
        side, limit = ("below", lower) if lower > 0.0 else ("above", upper)
        hint = rf"they close with 'free_rocker' (\S+) rad {side} its \w+ limit {limit}: correct"
        match = re.search(hint, found[0].hint or "")
        assert match is not None
        farthest = 0.031 if lower > 0.0 else -0.798  # where the rocker comes nearest to its limits
        assert float(match[1]) >= abs(limit - farthest) - 1e-3


def test_solution_within_limits_is_not_reported(advice, monkeypatch) -> None:
    from eurdf.advice import limits as module

    robot = eurdf.load("four_bar", geometry=False)
    closed = eurdf.forward_kinematics(robot, {"motor_crank": 2.0})

    def found(robot: eurdf.Robot, q0: object = None, limits: bool = False) -> eurdf.results.Assembly:
        q = np.array([0.0, 1.0, 0.0, 0.0, 1.0]) if limits else closed
        opening = eurdf.results.Opening("rocker_pin", 0.1 if limits else 0.0, 0.0)
        return eurdf.results.Assembly(q, 0.1 if limits else 0.0, not limits, not limits, 1, (opening,))

    (angle,) = robot.joint_positions(closed)["free_rocker"]
    monkeypatch.setattr(module, "assemble", found)
    assert codes(advice("four_bar", without_configurations, rocker(angle - 0.01, angle + 0.01))) == []


def test_joint_outside_loops_can_exceed_limits(advice) -> None:
    def urdf(text: str) -> str:
        lid = WHEEL.format(lever="0", parent=text.split('<link name="')[1].split('"')[0])
        lid = lid.replace("continuous", "revolute").replace(
            '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit lower="1" upper="2" effort="1" velocity="1"/>'
        )
        return text.replace("</robot>", lid)

    def driven(description: dict) -> None:
        without_configurations(description)
        description["actuators"].append("axle")

    assert codes(advice("four_bar", driven, urdf)) == []


def link(name: str, mass: float = 1.0) -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="0.01 0 0"/><mass value="{mass}"/>'
        '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>'
    )


def joint(
    name: str,
    parent: str,
    child: str,
    kind: str = "revolute",
    limits: str = "-1 1",
    xyz: str = "0.2 0 0",
    more: str = "",
) -> str:
    lower, upper = limits.split()
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}"/>'
        f'<axis xyz="0 0 1"/><limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>{more}</joint>'
    )


def chain(*joints: str, links: str = "", names: str = "abcd") -> str:
    return f'<robot name="r">{"".join(link(name) for name in names[: len(joints) + 1])}{"".join(joints)}{links}</robot>'


def checked(folder: Path, urdf: str, yaml: str = "") -> list[Diagnostic]:
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    if yaml:
        (folder / "robot.yaml").write_text(f'extended_urdf: "2.1"\n{yaml}', encoding="utf-8")
    return list(eurdf.check(folder / ("robot.yaml" if yaml else "robot.urdf")).diagnostics)


@pytest.mark.parametrize("limits", ["-90 90", "0 135", "-22.5 22.5", "-13 13", "-180 180", "-0.5 360", "-720 720"])
def test_revolute_limits_in_degrees_are_reported(tmp_path: Path, limits: str) -> None:
    (found,) = checked(tmp_path, chain(joint("knee", "a", "b", limits=limits)))
    assert found.code == "x-angle-in-degrees"
    assert "of joint 'knee' is" in found.message
    assert "angles are in rad" in (found.hint or "")
    assert found.pointer.startswith("/robot/joint/limit/@")


@pytest.mark.parametrize(
    "limits",
    ["-3 3", "-6.2832 6.2832", "-9.42 9.42", "-10 10", "-12.5664 12.5664", "-18.85 18.85", "-100 100", "-1000 1000",
     "-1e16 1e16", "-31.4159 31.4159", "-13.37 13.37"],
)  # fmt: skip
def test_limits_of_wrists_and_of_other_joints_are_in_rad(tmp_path: Path, limits: str) -> None:
    for kind, given in (("revolute", limits), ("continuous", "-90 90"), ("prismatic", "-90 90")):
        assert checked(tmp_path, chain(joint("knee", "a", "b", kind, limits=given))) == []


def test_ambiguous_limits_are_degrees_beside_others(tmp_path: Path) -> None:
    urdf = chain(joint("knee", "a", "b", limits="-100 100"), joint("hip", "b", "c", limits="-90 100"))
    (found,) = checked(tmp_path, urdf)
    assert "'hip' is -90 rad" in found.message
    assert "3 more such angles" in found.message


@pytest.mark.parametrize(("rpy", "expected"), [("90 0 0", 1), ("0 0 -7", 1), ("0 6.2832 -3.1416", 0), ("7.854 0 0", 0)])
@pytest.mark.parametrize("place", ["joint", "inertial"])
def test_orientation_beyond_a_turn_is_in_degrees(tmp_path: Path, rpy: str, expected: int, place: str) -> None:
    old = 'xyz="0.2 0 0"' if place == "joint" else 'xyz="0.01 0 0"'
    urdf = chain(joint("knee", "a", "b")).replace(old, f'{old} rpy="{rpy}"', 1)
    found = checked(tmp_path, urdf)
    assert codes(found) == ["x-angle-in-degrees"] * expected
    assert all(each.pointer.endswith("/origin/@rpy") for each in found)


@pytest.mark.parametrize("rpy", ["90 0 0", "${pi} x 0"])
def test_orientation_outside_links_and_joints_is_ignored(tmp_path: Path, rpy: str) -> None:
    gazebo = f'<gazebo reference="a"><visual><origin rpy="{rpy}"/></visual></gazebo>'
    assert checked(tmp_path, chain(joint("knee", "a", "b"), links=gazebo)) == []


@pytest.mark.parametrize(
    ("yaml", "pointer"),
    [
        ("frames:\n  - {name: tip, link: b, rpy: [90, 0, 0]}\n", "/frames/0/rpy/0"),
        ("joints:\n  knee: {limits: {lower: -90, upper: 90}}\n", "/joints/knee/limits/lower"),
        ("configurations:\n  bent: {wheel: 45}\n", "/configurations/bent/wheel"),
        ("joints:\n  knee: {stiffness: 2, rest: 45}\n", "/joints/knee/rest"),
        ("joints:\n  knee: {type: universal, axes: xy, stiffness: 2, rest: [0, 45]}\n", "/joints/knee/rest"),
        ("joints:\n  slide: {stiffness: 2, rest: 45}\n", None),
        ("configurations:\n  wound: {wheel: 12.75}\n  bent: {wheel: 25.12}\n", None),
        ("configurations:\n  out: {slide: 45}\n", None),
        ("frames:\n  - {name: tip, link: b, xyz: [0, 0, 9]}\n", None),
        ("joints:\n  slide: {limits: {lower: -90, upper: 90}}\n", None),
    ],
)
def test_angles_of_description_in_degrees_are_reported(tmp_path: Path, yaml: str, pointer: str | None) -> None:
    slide = joint("slide", "c", "d", "prismatic", limits="-90 90")
    found = checked(tmp_path, chain(joint("knee", "a", "b"), joint("wheel", "b", "c", "continuous"), slide), yaml)
    assert [(each.code, each.pointer) for each in found] == ([("x-angle-in-degrees", pointer)] if pointer else [])


def scaled(urdf: str, size: float) -> str:
    tree = etree.fromstring(urdf.encode())
    for origin in tree.iter("origin"):
        if origin.get("xyz"):
            origin.set("xyz", " ".join(repr(size * float(number)) for number in origin.get("xyz").split()))
    return etree.tostring(tree).decode()


@pytest.mark.parametrize(("size", "expected"), [(1e-4, 1), (1e-2, 0)])
def test_robot_below_a_millimetre_is_reported(advice, size: float, expected: int) -> None:
    found = [each for each in advice("five_bar_6d", urdf=partial(scaled, size=size)) if each.code == "x-tiny-robot"]
    assert len(found) == expected
    for each in found:
        assert "and no length of the robot is larger" in each.message
        assert each.pointer.endswith("/origin/@xyz")


def test_robot_in_millimetres_is_reported_once(advice) -> None:
    for name in ("talos_leg", "delta", "stewart_platform"):
        found = advice(name, urdf=partial(scaled, size=1000.0))
        lengths = [each for each in found if each.code == "x-length-in-millimetres"]
        assert len(lengths) == 1
        assert "all links weigh" in lengths[0].message
        assert lengths[0].pointer.endswith("/origin/@xyz")


@pytest.mark.parametrize(
    ("xyz", "mass", "expected"), [("300 0 0", 1.0, 1), ("12 0 0", 1.0, 1), ("12 0 0", 4000.0, 0), ("9 0 0", 1.0, 0)]
)
def test_heavy_crane_can_be_long(tmp_path: Path, xyz: str, mass: float, expected: int) -> None:
    urdf = chain(joint("boom", "a", "b", xyz=xyz)).replace('<mass value="1.0"/>', f'<mass value="{mass}"/>')
    assert codes(checked(tmp_path, urdf)).count("x-length-in-millimetres") == expected


def test_single_outlier_length_is_reported_at_its_place(tmp_path: Path) -> None:
    arm = (joint("shoulder", "a", "b"), joint("elbow", "b", "c"))
    for xyz, place in (("0 0 -250", "joint"), ("0 0 -19", None)):
        found = checked(tmp_path, chain(*arm, joint("wrist", "c", "d", xyz=xyz)))
        assert [each.pointer for each in found] == (["/robot/joint[3]/origin/@xyz"] if place else [])
    far = chain(*arm).replace('<origin xyz="0.01 0 0"/>', '<origin xyz="0 120 0"/>', 1)
    (found,) = checked(tmp_path, far)
    assert (found.code, found.pointer) == ("x-length-in-millimetres", "/robot/link[1]/inertial/origin/@xyz")
    assert "the distance of the centre of mass of link 'a' from its origin is 120 m" in found.message
    (found,) = checked(tmp_path, chain(*arm), "frames:\n  - {name: tip, link: c, xyz: [0, 0, 310]}\n")
    assert (found.code, found.pointer) == ("x-length-in-millimetres", "/frames/0/xyz")
    assert "310 mm are 0.31 m" in (found.hint or "")


def test_placement_in_world_is_no_length(tmp_path: Path) -> None:
    placed = joint("placed", "a", "b", "fixed", xyz="4000 0 0")
    assert checked(tmp_path, chain(placed, joint("hip", "b", "c"), joint("knee", "c", "d"))) == []


@pytest.mark.parametrize("kind", ["binary", "ascii", "obj"])
@pytest.mark.parametrize(("size", "scale", "expected"), [(300.0, "", 1), (0.3, "", 0), (300.0, "0.001 0.001 0.001", 0)])
def test_unscaled_mesh_in_millimetres_is_reported(
    tmp_path: Path, kind: str, size: float, scale: str, expected: int
) -> None:
    corners = [(0.0, 0.0, 0.0), (size, 0.0, 0.0), (0.0, size / 2, 0.0)]
    if kind == "obj":
        content = "".join(f"v {x} {y} {z}\n" for x, y, z in corners).encode() + b"f 1 2 3\n"
    elif kind == "ascii":
        vertices = "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners)
        content = f"solid m\nfacet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\nendsolid m\n".encode()
    else:
        content = bytes(80) + struct.pack("<I", 1) + struct.pack("<12f", 0, 0, 1, *sum(corners, ())) + bytes(2)
    file = "part." + ("obj" if kind == "obj" else "stl")
    (tmp_path / file).write_bytes(content)
    attribute = f'scale="{scale}"' if scale else ""
    mesh = f'<visual><geometry><mesh filename="{file}" {attribute}/></geometry></visual>'
    urdf = chain(joint("knee", "a", "b")).replace('<link name="b">', f'<link name="b">{mesh}')
    found = checked(tmp_path, urdf)
    assert codes(found) == ["x-length-in-millimetres"] * expected
    assert all("scale=" in (each.hint or "") for each in found)


@pytest.mark.parametrize("content", [b"", b"solid", b"v a b c\n", bytes(200), b"v 1 2\n", b"\xff" * 300])
@pytest.mark.parametrize("file", ["part.stl", "part.obj", "part.dae"])
def test_unreadable_mesh_has_no_size(tmp_path: Path, file: str, content: bytes) -> None:
    (tmp_path / file).write_bytes(content)
    mesh = f'<visual><geometry><mesh filename="{file}"/></geometry></visual>'
    found = checked(tmp_path, chain(joint("k", "a", "b")).replace('<link name="b">', f'<link name="b">{mesh}'))
    assert codes(found) == ["urdf-mesh-unreadable"]


BALL = "joints:\n  neck: {type: spherical}\nconfigurations:\n  look: {neck: [%s]}\n"


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [("1, 0, 0, 0", 1), ("-1, 0, 0, 0", 1), ("0, 0, 0, 1", 0), ("0, 1, 0, 0", 0), ("0.7071068, 0, 0, 0.7071068", 0)],
)
def test_identity_written_w_first_is_reported(tmp_path: Path, numbers: str, expected: int) -> None:
    found = checked(tmp_path, chain(joint("neck", "a", "b")), BALL % numbers)
    assert codes(found) == ["x-quaternion-order"] * expected
    assert all(each.pointer == "/configurations/look/neck" for each in found)
    assert all("it is the identity only then" in each.message for each in found)
    assert all("x, y, z, w" in (each.hint or "") for each in found)


def test_floating_root_on_its_back_is_w_first(tmp_path: Path) -> None:
    yaml = "root: floating\nconfigurations:\n  home: {root_joint: [0, 0, 1, 1, 0, 0, 0]}\n"
    assert codes(checked(tmp_path, chain(joint("neck", "a", "b")), yaml)) == ["x-quaternion-order"]


def quaternions_of(robot: eurdf.Robot, q: np.ndarray) -> dict[str, list[float]]:
    """Of the spherical joints of a model."""
    model = robot.model
    return {
        name: q[model.idx_qs[index] : model.idx_qs[index] + 4].tolist()
        for index, name in enumerate(model.names)
        if model.nqs[index] == 4
    }


def test_configuration_closing_only_w_first_is_reported(advice) -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q = robot.configurations["assembled"].copy()
    knee = robot.model.joints[robot.model.getJointId("motor_knee")].idx_q
    q[knee] += 0.1
    closed = eurdf.assemble(robot, q, hold=["motor_knee"])
    balls = quaternions_of(robot, closed.q)
    angles = {
        name: float(closed.q[robot.model.idx_qs[index]])
        for index, name in enumerate(robot.model.names)
        if robot.model.nqs[index] == 1
    }

    def state(order: Callable[[list[float]], list[float]], name: str) -> Callable[[dict], object]:
        def edit(description: dict) -> None:
            description["configurations"][name] = {**angles, **{ball: order(q) for ball, q in balls.items()}}

        return edit

    assert advice("digit_leg", state(list, "bent")) == []
    found = advice("digit_leg", state(lambda q: [q[3], *q[:3]], "crouch"))
    assert set(codes(found)) == {"x-quaternion-order"}
    assert all("the loops close only then" in each.message for each in found)


def test_assembled_closing_only_w_first_has_hint(advice) -> None:
    def edit(description: dict) -> None:
        description["configurations"]["assembled"] = {"ball_achilles_start": [1, 0, 0, 0]}

    (found,) = advice("digit_leg", edit)
    assert found.code == "assembled-open"
    assert "write x, y, z, w in place of w, x, y, z" in (found.hint or "")


def test_coordinates_with_too_few_digits_are_named(advice) -> None:
    def edit(description: dict) -> None:
        description["configurations"]["assembled"] = {"motor_crank": 0.00002}

    (found,) = advice("four_bar", edit)
    assert found.code == "assembled-open"
    assert "stay open by" in (found.hint or "")
    assert "write more digits" in (found.hint or "")


def test_joint_left_out_of_assembled_is_named(advice) -> None:
    def edit(description: dict) -> None:
        description["configurations"]["assembled"] = {"motor_crank": 0.02}

    def too_far(urdf: str) -> str:
        return urdf.replace('<origin xyz="0.43 0 0"/>', '<origin xyz="5 0 0"/>')

    (found,) = advice("four_bar", edit)
    assert found.code == "assembled-open"
    assert found.fix is not None
    assert (found.hint or "").startswith("state 'free_coupler', 'free_rocker' too, as `eurdf assemble --write --force`")
    (found,) = advice("four_bar", edit, too_far)
    assert found.code == "assembled-open"
    assert "`eurdf assemble" not in (found.hint or "")


def massless(*names: str) -> Callable[[str], str]:
    """Takes the inertia of links out."""

    def edit(urdf: str) -> str:
        tree = etree.fromstring(urdf.encode())
        for each in tree.iterchildren("link"):
            if each.get("name") in names:
                each.remove(each.find("inertial"))
        return etree.tostring(tree).decode()

    return edit


@pytest.mark.parametrize(("name", "part"), [("four_bar", "crank"), ("digit_leg", "crank1"), ("bennett", "follower")])
def test_loop_link_without_mass_is_reported(advice, name: str, part: str) -> None:
    (found,) = advice(name, urdf=massless(part))
    assert found.code == "x-massless-link"
    assert f"link '{part}' of a loop has no mass but extends" in found.message
    assert found.pointer.startswith("/robot/link[")


def test_free_massless_link_makes_mass_matrix_singular(advice) -> None:
    (found,) = advice("disney_leg", urdf=massless("outer_bracket"))
    assert found.code == "x-massless-link"
    assert "'ball_ankle' and 'free_bracket'" in found.message
    assert "the mass matrix is singular" in found.message


def test_massless_link_of_floating_root_is_reported(tmp_path: Path) -> None:
    arm = chain(joint("shoulder", "a", "b"), joint("elbow", "b", "c"), joint("wrist", "c", "d"))
    pin = "{name: pin, type: 3d, frames: [{link: d, xyz: [0.2, 0, 0]}, {link: a, xyz: [0.7, 0, 0]}]}"
    yaml = f"root: floating\nclosures: [{pin}]\nactuators: [shoulder]\n"
    (found,) = checked(tmp_path, massless("a", "b")(arm), yaml)
    assert (found.code, found.pointer) == ("x-massless-link", "/robot/link[1]")
    assert "link 'a' of a loop has no mass and can move by 'root_joint' and " in found.message


def test_armature_replaces_mass(advice) -> None:
    def edit(description: dict) -> None:
        description["joints"] = {"motor_crank": {"armature": 0.01}}

    assert advice("four_bar", edit, massless("crank")) == []


@pytest.mark.parametrize("axes", ["0 1 0", "0 0 1"])
def test_massless_universal_cross_is_fine_unless_axes_coincide(advice, axes: str) -> None:
    def cross(urdf: str) -> str:
        tree = etree.fromstring(urdf.encode())
        coupler = next(each for each in tree.iter("joint") if each.get("name") == "free_coupler")
        child = coupler.find("child")
        added = f"""<robot><link name="cross"/><joint name="second" type="continuous"><parent link="cross"/>
            <child link="{child.get("link")}"/><axis xyz="{axes}"/></joint></robot>"""
        child.set("link", "cross")
        tree.extend(etree.fromstring(added))
        return etree.tostring(tree).decode()

    found = advice("four_bar", urdf=cross)
    hinge = next(joint for joint in etree.parse(ROBOTS / "four_bar" / "robot.urdf").iter("joint"))
    same = hinge.find("axis").get("xyz").split() == axes.split()
    assert ("x-massless-link" in codes(found)) == same


def test_rounded_urdf_numbers_that_open_loops_are_named(advice) -> None:
    def out_of_plane(distance: str) -> Callable[[str], str]:
        def edit(urdf: str) -> str:
            tree = etree.fromstring(urdf.encode())
            weld = next(each for each in tree.iter("joint") if each.get("name") == "weld_tip_a")
            weld.append(etree.fromstring(f'<origin xyz="0 {distance} 0"/>'))
            return etree.tostring(tree).decode()

        return edit

    for distance, rounded in (("0.000006", True), ("0.006", False)):
        (found,) = advice("five_bar", without_configurations, out_of_plane(distance))
        assert found.code == "closure-cannot-close"
        assert ("with more digits" in (found.hint or "")) == rounded
        assert ("stay open by" in (found.hint or "")) == rounded


@pytest.mark.parametrize("number", ["1e12", "-1e15"])
def test_implausible_number_is_not_called_wrong_unit(tmp_path: Path, number: str) -> None:
    urdf = chain(joint("shoulder", "a", "b"), joint("elbow", "b", "c"), joint("wrist", "c", "d", xyz=f"0 0 {number}"))
    assert checked(tmp_path, urdf.replace('xyz="0.01 0 0"', f'xyz="0.01 0 0" rpy="0 0 {number}"', 1)) == []


def test_too_large_loops_are_named(advice, monkeypatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.analysis._MOST_WORK", 10.0)
    (found,) = advice("digit_leg_3d", typed("6d", "achilles"))
    assert (found.code, found.pointer) == ("x-loops-not-checked", "/closures")
    assert "ranks were not computed" in found.message


# -- What `check` reports of loops that move to first order only


def two_bars(folder: Path, span: float) -> tuple[str, ...]:
    """Codes reported of two bars of 0.5 m in a row between two points at a distance, m."""
    axis = '<axis xyz="0 0 1"/>'
    joints = [
        joint_element("first", "continuous", "base", "left", axis),
        joint_element("second", "continuous", "left", "right", axis, '<origin xyz="0.5 0 0" rpy="0 0 0"/>'),
    ]
    (folder / "robot.urdf").write_text(
        robot_element(body("base"), body("left"), body("right"), *joints), encoding="utf-8"
    )
    frames = f"[{{link: right, xyz: [0.5, 0, 0]}}, {{link: base, xyz: [{span}, 0, 0]}}]"
    text = f'extended_urdf: "2.0"\nclosures:\n  - {{name: end, type: 3d, frames: {frames}}}\nactuators: [first]\n'
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    return tuple(found.code for found in eurdf.check(folder).diagnostics)


def test_stretched_bars_are_shaky_and_bent_ones_rigid(tmp_path: Path) -> None:
    assert two_bars(tmp_path, 1.0) == ("x-shaky-loops",)
    assert two_bars(tmp_path, 0.8) == ("x-dependent-actuators",)


def test_immobile_or_outside_links_need_no_mass(advice) -> None:
    assert advice("four_bar", urdf=massless("ground")) == []
    assert advice("digit_leg", urdf=massless("hip")) == []


def test_two_jointly_locking_closures_are_named_together(advice) -> None:
    (found,) = advice("unitree_g1_ankle", typed("6d", "rod_a", "rod_b"))
    assert "type 3d for closures 'rod_a', 'rod_b'" in (found.hint or "")
