"""The versions of URDF, compared with Pinocchio's own reader of URDF: the same verdict, and the same model."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

import pinocchio as pin
import pytest

import eurdf
from support.plain_urdf import inertial, joint_element, link_element, pinocchio_reads, robot

#: Pinocchio reads this one in silence, as no rotation.
_ZERO = '<origin quat_xyzw="0 0 0 0"/>'
_CAPSULE = '<capsule radius="0.1" length="0.2"/>'

VERSIONS = ("", "1.0", "1.1", "1.2")
UNKNOWN = ("1", "1.3", "2.0", "abc", "1.10", "1.1.0", "0.9")

ORIGINS = (
    "",
    '<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>',
    '<origin quat_xyzw="0 0 1 1"/>',
    '<origin quat_xyzw="1 -2 0.5 -30" xyz="1 0 0"/>',
    '<origin rpy="0.1 0.2 0.3" quat_xyzw="0 0 1 1"/>',
    '<origin quat_xyzw="0 0 1"/>',
    '<origin quat_xyzw="w x y z"/>',
)
LIMITS = (
    "",
    "<limit/>",
    '<limit effort="3" velocity="4"/>',
    '<limit lower="-1" upper="2"/>',
    '<limit lower="-1" upper="2" effort="3"/>',
    '<limit lower="-1" upper="2" velocity="4"/>',
    '<limit lower="-1" upper="2" effort="3" velocity="4"/>',
    '<limit lower="1" effort="3" velocity="4"/>',
    '<limit upper="1" effort="3" velocity="4"/>',
)
#: Before version 1.2, Pinocchio does not read or compare what is wrong here.
LIMITS_OF_1_2 = (
    '<limit lower="2" upper="-1"/>',
    '<limit lower="-1" upper="2" effort="-3"/>',
    '<limit lower="-1" upper="2" velocity="-4"/>',
    '<limit lower="-1" upper="2" acceleration="-1"/>',
    '<limit lower="-1" upper="2" deceleration="-1"/>',
    '<limit lower="-1" upper="2" jerk="-1"/>',
    '<limit lower="-1" upper="2" jerk="high"/>',
)
RATES = '<limit lower="-1" upper="2" effort="3" velocity="4" acceleration="5" deceleration="6" jerk="7"/>'
TYPES = ("revolute", "prismatic", "continuous", "planar", "floating", "fixed")


def two_links(version: str, kind: str = "revolute", limit: str = LIMITS[6], joint: str = "", inertia: str = "") -> str:
    arm = link_element("arm", inertial(1.0, inertia, (0.1, 0.01, 0.0, 0.2, 0.0, 0.25)))
    element = joint_element("j", kind, "base", "arm", f'<axis xyz="0 0.6 0.8"/>{limit}', joint)
    return robot(link_element("base"), arm, element, version=version)


def combinations() -> Iterator[str]:
    yield from (two_links(version) for version in UNKNOWN)
    for version, origin in itertools.product(VERSIONS, ORIGINS):
        yield two_links(version, joint=origin)
        if version < "1.1" or origin not in ORIGINS[4:]:  # Pinocchio drops an inertia that it cannot read
            yield two_links(version, inertia=origin)
    for version, kind, limit in itertools.product(VERSIONS, TYPES, LIMITS):
        if (kind, limit) not in [("revolute", LIMITS[7]), ("prismatic", LIMITS[7])]:  # reversed before version 1.2
            yield two_links(version, kind, limit)
    yield from (two_links("1.2", kind, limit) for kind, limit in itertools.product(TYPES, LIMITS_OF_1_2))


@pytest.mark.skipif(not pinocchio_reads("1.2"), reason="Pinocchio's reader does not know URDF 1.2")
def test_verdict_and_model_are_those_of_pinocchio(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    accepted = 0
    for text in combinations():
        path.write_text(text, encoding="utf-8")
        try:
            expected = pin.buildModelFromUrdf(str(path))
        except ValueError:
            expected = None
        report = eurdf.check(path)
        assert report.ok == (expected is not None), text
        if expected is not None:
            accepted += 1
            assert eurdf.load(path).model == expected, text
    assert accepted > 150


@pytest.mark.parametrize("version", ["1.1", "1.2"])
@pytest.mark.parametrize("place", ["joint", "inertia"])
def test_quaternion_of_zero_is_an_error(version: str, place: str) -> None:
    with pytest.raises(eurdf.InvalidRobot, match="is zero"):
        eurdf.load(two_links(version, **{place: _ZERO}))


def test_quaternion_has_the_direction_of_its_numbers() -> None:
    def model(quaternion: str) -> pin.Model:
        return eurdf.load(two_links("1.1", joint=f'<origin quat_xyzw="{quaternion}"/>')).model

    for tiny in ("1e-200 0 0 1e-200", "1e-9 0 0 1e-9"):
        assert model(tiny).jointPlacements[1].isApprox(model("1 0 0 1").jointPlacements[1])


@pytest.mark.parametrize(("version", "codes"), [("", ["urdf-later-version"]), ("1.0", ["urdf-geometry"]), ("1.1", [])])
def test_capsule_is_a_shape_of_version_1_1(version: str, codes: list[str]) -> None:
    link = link_element("base", f"<collision><geometry>{_CAPSULE}</geometry></collision>" * 2)
    report = eurdf.check(robot(link, version=version))
    assert sorted({found.code for found in report.diagnostics}) == codes
    assert len(report.diagnostics) == (2 if version == "1.0" else len(codes))


def test_later_attributes_are_counted() -> None:
    text = two_links("1.1", limit=RATES.replace('acceleration="5"', 'acceleration="-5"'))
    found = eurdf.check(text).diagnostics
    assert [each.code for each in found] == ["urdf-later-version"] * 3
    assert "'acceleration' has no effect before URDF 1.2, and <robot> has version 1.1" in str(found[0])
    twice = two_links("", joint=ORIGINS[2], inertia=ORIGINS[2])
    (both,) = eurdf.check(twice).diagnostics
    assert "(2 times in the file)" in both.message


def test_misspelt_limit_of_version_1_2_is_a_warning() -> None:
    report = eurdf.check(two_links("1.2", limit='<limit lower="-1" upper="2" efort="3"/>'))
    assert [(found.code, found.hint) for found in report.diagnostics] == [("urdf-unknown-element", "write 'effort'")]
    missing = eurdf.check(two_links("1.2", limit='<limit lowr="-1" upper="2"/>'))
    assert [(found.code, found.hint) for found in missing.diagnostics] == [
        ("urdf-missing-attribute", "rename 'lowr' to 'lower'")
    ]
    (neither,) = eurdf.check(two_links("1.2", limit='<limit lower="-1"/>')).diagnostics
    assert "states both 'lower' and 'upper'" in str(neither.hint)


@pytest.mark.parametrize("limit", [RATES, RATES.replace(' effort="3" velocity="4"', "")])
@pytest.mark.parametrize("to", ["urdf", "loop-joint"])
def test_exported_urdf_has_the_same_limits(to: str, limit: str) -> None:
    given = eurdf.load(two_links("1.2", limit=limit, joint=ORIGINS[3]))
    export = eurdf.export(given, to)
    there = eurdf.load(export.main.decode())
    assert there.mechanism.joints[0].properties == given.mechanism.joints[0].properties
    assert there.model.jointPlacements[1].isApprox(given.model.jointPlacements[1], 1e-12)
    assert not eurdf.check(export.main.decode()).diagnostics
    assert not any(loss.concept == "acceleration limit" for loss in export.losses)


def test_capsule_is_exported_in_version_1_1() -> None:
    text = robot(link_element("base", f"<collision><geometry>{_CAPSULE}</geometry></collision>"))
    export = eurdf.export(text, "urdf")
    assert not eurdf.check(export.main.decode()).diagnostics


@pytest.mark.parametrize("to", ["mjcf", "sdf", "usd", "drake"])
def test_lost_limits_are_reported(to: str) -> None:
    if to == "usd":
        pytest.importorskip("pxr")
    losses = eurdf.export(two_links("1.2", limit=RATES), to).losses
    assert [loss.name for loss in losses if loss.code == "export-acceleration-limit"] == ["j"]


def test_new_types_keep_the_limits_of_a_joint() -> None:
    lead = 0.2
    urdf = two_links("1.2", "prismatic", RATES)
    helical = eurdf.load(
        f'extended_urdf: "2.0"\njoints: {{j: {{type: helical, pitch: {lead * 6.283185307179586!r}}}}}\n', urdf=urdf
    )
    (properties,) = (joint.properties for joint in helical.mechanism.joints)
    assert properties.acceleration == pytest.approx((5 / lead,))
    assert properties.jerk == pytest.approx((7 / lead,))
    universal = eurdf.load(
        'extended_urdf: "2.0"\njoints: {j: {type: universal, axes: xy}}\n', urdf=two_links("1.2", limit=RATES)
    )
    assert universal.mechanism.joints[0].properties.deceleration == (6.0, 6.0)
