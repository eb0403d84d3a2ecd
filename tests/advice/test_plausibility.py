"""Numbers in another unit, and numbers that are forgotten."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import eurdf
from eurdf.advice.plausibility import advise_on_plausibility
from eurdf.collection import collection_names
from eurdf.diagnostics import Diagnostics
from eurdf.linking.robot_files import ReadRobot, read_robot
from support.places import ROBOTS, ROOT


@cache
def read(name: str) -> ReadRobot:
    return read_robot(ROBOTS / name)


@given(
    st.data(),
    st.sampled_from(collection_names()),
    st.sampled_from([("mass", 1e3), *(("moments", factor) for factor in (1e6, 1e7, 1e9, 1e-3, 0.0))]),
)
def test_inertia_in_another_unit_is_reported(data: st.DataObject, name: str, change: tuple[str, float]) -> None:
    """Of any link with 2 % of the mass, in g, kg·mm², g·cm², g·mm² or tonnes, and without moments."""
    mechanism, (what, factor) = read(name).mechanism, change
    total = sum(body.inertia.mass for body in mechanism.bodies if body.inertia)
    heavy = [body for body in mechanism.bodies if body.inertia and body.inertia.mass > 0.02 * total]
    body = data.draw(st.sampled_from(heavy))
    value = getattr(body.inertia, what)
    value = factor * value if what == "mass" else tuple(factor * each for each in value)
    changed = replace(body, inertia=replace(body.inertia, **{what: value}))
    bodies = tuple(changed if each is body else each for each in mechanism.bodies)
    diagnostics = Diagnostics()
    advise_on_plausibility(read(name)._replace(linked=replace(mechanism, bodies=bodies)), diagnostics)
    (found,) = (each for each in diagnostics if each.code == "x-implausible-inertia")
    assert f"'{body.name}'" in found.message
    assert found.place.line


ANKLE, LEG, EXAMPLE = "robots/unitree_g1_ankle", "robots/cassie_leg", "spec/examples/four_bar"


@pytest.mark.parametrize(
    ("code", "robot", "file", "old", "new", "says", "asks"),
    [
        ("drive", ANKLE, "urdf", 'effort="25"', 'effort="0"', "'motor_a' has the effort limit 0", "largest torque"),
        ("drive", ANKLE, "urdf", 'velocity="37"', 'velocity="2000"', "2000 rad/s", "2000 rpm are 209.4 rad/s"),
        ("drive", LEG, "yaml", "gear_ratio: 25", "gear_ratio: 0.04", "turns more slowly", "is it 25?"),
        ("drive", LEG, "yaml", "rotor_inertia: 6.1e-05", "rotor_inertia: 610", "3.81e+05 kg·m²", "1 g·cm²"),
        (
            "mimic",
            EXAMPLE,
            "urdf",
            '<mimic joint="grip"',
            '<mimic joint="grip" multiplier="-1"',
            "-0.05 to 0 m,",
            "sign",
        ),
        ("mimic", EXAMPLE, "urdf", '<mimic joint="grip"', '<mimic joint="grip" offset="5"', "5 to 5.05", "offset"),
    ],
)
def test_joint_in_another_unit_is_reported(tmp_path: Path, code, robot, file, old, new, says, asks) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        shutil.copy(ROOT / robot / name, tmp_path)
    path = tmp_path / f"robot.{file}"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    (found,) = eurdf.check(tmp_path).diagnostics
    assert found.code == f"x-implausible-{code}"
    assert says in found.message
    assert asks in (found.hint or "")
    assert (found.file, found.line) == (str(path), text[: text.index(old)].count("\n") + 1)


def test_velocity_limit_that_is_a_power_of_ten_is_none(tmp_path: Path) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        text = (ROOT / ANKLE / name).read_text(encoding="utf-8")
        (tmp_path / name).write_text(text.replace('velocity="37"', 'velocity="1000"'), encoding="utf-8")
    assert eurdf.check(tmp_path).diagnostics == ()


def test_spring_beyond_the_limits_is_noted() -> None:
    """A preloaded spring is one on purpose: it is no warning."""
    report = eurdf.check("robotiq_2f85")
    assert report.diagnostics == ()
    assert "the spring of joint 'left_spring_link_joint' never relaxes: its rest, 2.62 rad," in report.notes[0]
