"""The plugin of ros2_control: compiled against a stub of its interface, loaded by its name and driven."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

import eurdf
from eurdf.transmissions.prepared import PreparedTransmission
from eurdf.transmissions.ros2_package import ros2_package
from support.compiled import NOT_FINITE, OK, TOO_FAR
from support.places import ROOT
from support.transmissions import DRIVEN

STUB = ROOT / "tests" / "support" / "ros2_control"
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-fPIC", f"-I{STUB / 'include'}")
KINDS = ("position", "velocity", "effort")


def prepared(name: str = "unitree_g1_ankle") -> PreparedTransmission:
    return eurdf.transmissions.prepare_transmission(eurdf.load(name, geometry=False), DRIVEN[name])


class Hardware:
    """The plugin of a package, with what a component of ros2_control does."""

    def __init__(self, package: Path) -> None:
        if shutil.which("cc") is None or shutil.which("c++") is None:
            pytest.skip("no compiler: install `cc` and `c++`")
        (source,), (header,) = package.glob("src/*.c"), package.glob("include/*/*.hpp")
        name, kept = header.parent.name, package / "kernel.o"
        subprocess.run(["cc", "-std=c99", *STRICT, f"-I{header.parent}", "-c", source, "-o", kept], check=True)
        include, made = f"-I{header.parent.parent}", package / "driven.so"
        files = [f"-DDRIVEN={name}", f"-I{header.parent}", package / "src" / "plugin.cpp", STUB / "driver.cpp", kept]
        subprocess.run(["c++", "-std=c++17", *STRICT, include, *files, "-shared", "-o", made], check=True)
        self.library = ctypes.CDLL(str(made))
        self.library.handle.restype = ctypes.POINTER(ctypes.c_double)
        self.library.load.restype = ctypes.c_char_p
        self.urdf = etree.parse(package / "transmission.xml").getroot()
        plugin = etree.parse(package / "plugins.xml").find(f"class[@name='{self.urdf.findtext('plugin')}']")
        assert plugin is not None
        self.type = str(plugin.get("type"))
        assert etree.parse(package / "package.xml").findtext("name") == name

    def load(self, elements: Sequence[Any], left_out: Sequence[str] = (), again: Sequence[str] = ()) -> str:
        """Load with (is it a joint, name, role, mechanical_reduction, offset), and all handles but some; the error."""
        self.library.clear()
        for of_joint, name, role, *numbers in elements:
            self.library.element(of_joint, name.encode(), role.encode(), *map(ctypes.c_double, numbers))
        self.value = {
            (name, kind): self.library.handle(of_joint, name.encode(), kind.encode())
            for of_joint, name, *_ in elements
            for kind in KINDS
            for label in [f"{name}/{kind}"]
            for _ in range(0 if label in left_out else 2 if label in again else 1)
        }
        return str(self.library.load(self.type.encode()).decode())

    def at(self, names: Sequence[str], kind: str, values: Any = None) -> Any:
        """The values of some handles, after they are set."""
        for name, value in zip(names, () if values is None else values, strict=values is not None):
            self.value[name, kind][0] = value
        return np.array([self.value[name, kind][0] for name in names])


@pytest.fixture(scope="module")
def ankle(tmp_path_factory: pytest.TempPathFactory) -> Hardware:
    folder = tmp_path_factory.mktemp("ankle")
    prepared().ros2_package().write(folder)
    return Hardware(folder)


ELEMENTS = [
    (True, "left roll", "free_roll", -2.0, 0.3),
    (True, "left pitch", "free_pitch", 1.0, 0.0),
    (False, "b", "motor_b", 16.0, -0.2),
    (False, "a", "motor_a", -9.0, 0.1),
]


def test_both_directions_are_those_of_python(ankle: Hardware) -> None:
    assert ankle.load(ELEMENTS) == ""
    exact, random = prepared(), np.random.default_rng(1)
    joints, motors = ("left pitch", "left roll"), ("a", "b")
    # In ros2_control, a joint at x / reduction + offset and a motor at reduction * x + offset.
    of_joints, joint_offset = np.array([1.0, -0.5]), np.array([0.0, 0.3])
    of_motors, motor_offset = np.array([-9.0, 16.0]), np.array([0.1, -0.2])
    for _ in range(20):
        point = random.uniform((-0.7, -0.2), (0.4, 0.2))
        positions, G = exact.at_joints(point)
        velocity, torque = random.normal(size=2), 10.0 * random.normal(size=2)
        motor_side = motor_offset + of_motors * positions, of_motors * (G @ velocity), torque / of_motors
        joint_side = joint_offset + of_joints * point, of_joints * velocity, (G.T @ torque) / of_joints
        for given, asked, start, goal in (
            (motors, joints, motor_side, joint_side),
            (joints, motors, joint_side, motor_side),
        ):
            for kind, values in zip(KINDS, start, strict=True):
                ankle.at(given, kind, values)
            assert ankle.library.run(given == motors) == OK
            for kind, values in zip(KINDS, goal, strict=True):
                assert ankle.at(asked, kind) == pytest.approx(values, rel=1e-9, abs=1e-9), (given, kind)
            power = [ankle.at(side, "effort") @ ankle.at(side, "velocity") for side in (joints, motors)]
            scale = np.abs(motor_side[1] * motor_side[2]).sum()
            assert abs(power[0] - power[1]) < 1e-12 * scale


def test_failed_call_changes_no_output(ankle: Hardware) -> None:
    for position, status in ((float("nan"), NOT_FINITE), (50.0, TOO_FAR)):
        assert ankle.load(ELEMENTS) == ""
        for given, asked in (("a", "b"), ("left pitch", "left roll")), (("left pitch", "left roll"), ("a", "b")):
            zero = [0.1, -0.2] if given[0] == "a" else [0.0, 0.3]
            ankle.at(given, "position", zero)
            assert ankle.library.run(given[0] == "a") == OK
            before = {kind: ankle.at(asked, kind) for kind in KINDS}
            ankle.at(given, "position", [position, zero[1]])
            ankle.at(given, "effort", [7.0, 8.0])
            assert ankle.library.run(given[0] == "a") == status
            assert all(np.array_equal(ankle.at(asked, kind), before[kind]) for kind in KINDS)


def test_what_is_missing_is_named(ankle: Hardware) -> None:
    efforts = [f"{name}/effort" for _, name, *_ in ELEMENTS]
    assert ankle.load(ELEMENTS, efforts) == ""  # an interface that none has is not mapped
    assert ankle.load(ELEMENTS, [*efforts[1:], "a/position"]).endswith("one handle with a value: a/position")
    assert ankle.load(ELEMENTS, efforts[2:]).endswith("value: a/effort, b/effort")
    assert ankle.load(ELEMENTS, again=["left roll/velocity"]).endswith("value: left roll/velocity")
    assert ankle.load(ELEMENTS[1:]) == "transmission 't': it needs 2 <joint>, and has 1"
    for index, changed, message in (
        (0, (True, "left roll", "roll", 1.0, 0.0), "no <joint> has the role 'free_roll'"),
        (2, (False, "a", "motor_b", 1.0, 0.0), "two <actuator> have the name 'a'"),
        (3, (False, "a", "motor_a", 0.0, 0.0), "mechanical_reduction of 'a' must not be 0"),
    ):
        assert message in ankle.load([*ELEMENTS[:index], changed, *ELEMENTS[index + 1 :]])


def test_motors_that_leave_the_joints_open_are_refused() -> None:
    half = eurdf.transmissions.prepare_transmission("unitree_g1_ankle", DRIVEN["unitree_g1_ankle"], motors="motor_a")
    with pytest.raises(eurdf.errors.NoTransmission, match="B_J is not determined"):
        half.ros2_package()


def test_any_names_and_single_precision(tmp_path: Path) -> None:
    exact, point = prepared(), np.array([-0.3, 0.05])
    joints, motors = ['"é\\n??/', "<&>"], ["int", "motor's"]
    ros2_package(exact.c_source("Leg__1", real="float"), "K & <L>", joints, motors, "float").write(tmp_path)
    hardware = Hardware(tmp_path)
    elements = [(each.tag == "joint", each.get("name"), each.get("role"), 1.0, 0.0) for each in hardware.urdf[1:]]
    assert hardware.load(elements) == ""
    hardware.at(joints, "position", point)
    assert hardware.library.run(False) == OK
    assert hardware.at(motors, "position") == pytest.approx(exact.at_joints(point).positions, abs=2e-5)


def test_cmake_builds_and_installs_it(tmp_path: Path) -> None:
    if shutil.which("cmake") is None:
        pytest.skip("cmake is not installed")
    prepared().ros2_package().write(tmp_path / "package")
    configure = ["cmake", "-S", tmp_path / "package", "-B", tmp_path / "build", "-Werror=dev"]
    installed = tmp_path / "installed"
    subprocess.run(
        [*configure, f"-DCMAKE_PREFIX_PATH={STUB / 'cmake'}", f"-DCMAKE_INSTALL_PREFIX={installed}"], check=True
    )
    subprocess.run(["cmake", "--build", tmp_path / "build", "--target", "install"], check=True)
    (library,) = installed.glob("lib/lib*.so")
    assert ctypes.CDLL(str(library)).plugin
    assert len(list(installed.rglob("*.xml"))) == len(list(installed.rglob("include/*/*/*"))) == 2
