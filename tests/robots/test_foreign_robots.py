"""Robots that nobody here wrote, exported to every format and read back by the program that the file is for."""

from __future__ import annotations

import pytest

import eurdf
from eurdf.convert.formats import EXPORTS
from support.wild import INVALID, PACKAGE_DIRS, ROBOTS

pytestmark = pytest.mark.slow

if not ROBOTS:
    pytest.skip(
        "no published robots: install example-robot-data, name its folder robots in EURDF_EXAMPLE_ROBOT_DATA, or put a "
        "folder at ../shared/wild, beside the checkout",
        allow_module_level=True,
    )

#: Formats whose meshes are converted, which takes up to a minute: robots are exported to them without shapes.
CONVERTED = ("usd", "drake")


def exported(name: str, to: str) -> eurdf.convert.Export:
    if to in CONVERTED:
        return eurdf.export(eurdf.load(ROBOTS[name], geometry=False), to)
    return eurdf.export(ROBOTS[name], to, package_dirs=PACKAGE_DIRS)


@pytest.mark.parametrize("to", EXPORTS)
@pytest.mark.parametrize("name", [name for name in ROBOTS if name not in INVALID])
def test_start_is_closed_and_within_limits(name: str, to: str) -> None:
    try:
        found = exported(name, to).verify(seconds=0.0)
    except eurdf.errors.MissingExtra as missing:
        pytest.skip(str(missing))
    assert found.findings == ()
    assert [each for each in found.openings if max(each.position, each.angle) > 1e-8] == []


@pytest.mark.parametrize("name", sorted(ROBOTS.keys() & INVALID.keys()))
def test_invalid_robot_is_refused(name: str) -> None:
    with pytest.raises(eurdf.InvalidRobot) as error:
        eurdf.load(ROBOTS[name])
    assert {each.code for each in error.value.diagnostics if each.severity == "error"} == {INVALID[name]}
