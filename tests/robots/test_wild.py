"""Published robots that nobody here wrote, where they are present: what is built of them, what is wrong with them."""

from __future__ import annotations

from collections import Counter

import pytest

import eurdf
from support.wild import FACTS, WILD

if not FACTS:
    pytest.skip("no published robots: put their folder at ../shared/wild, beside the checkout", allow_module_level=True)


#: Errors of the published files: everything that `check` finds, but for the meshes that were left out.
ERRORS = {name: {"urdf-no-range"} for name in FACTS}
ERRORS["kangaroo_like"] |= {"closure-cannot-close"}
ERRORS["5bar_linkage"] |= {"x-implausible-inertia"}  # its sphere weighs 654 t


@pytest.fixture(scope="module")
def robots() -> dict[str, eurdf.Robot]:
    return {name: eurdf.load(WILD / name, geometry=False) for name in FACTS}


@pytest.mark.parametrize("name", FACTS)
def test_model_has_published_dimensions(robots: dict[str, eurdf.Robot], name: str) -> None:
    robot, facts = robots[name], FACTS[name]
    model = robot.model
    assert (model.nq, model.nv, model.njoints - 1) == (facts["nq"], facts["nv"], facts["joints"])
    kinds = Counter(joint.shortname().removeprefix("JointModel") for joint in list(model.joints)[1:])
    assert kinds == facts["joint_types"]
    assert (len(robot.constraint_models), robot.mechanism.nc) == (facts["closures"], facts["nc"])
    assert len(robot.actuation.idx_v) == facts["actuated"]


@pytest.mark.parametrize("name", FACTS)
def test_motion_has_published_dimensions(robots: dict[str, eurdf.Robot], name: str) -> None:
    facts = FACTS[name]
    analysis = eurdf.analyze(robots[name])
    assert analysis.closes == facts["closes"]
    assert (analysis.rank, analysis.mobility, analysis.uncontrolled) == (
        facts["rank"],
        facts["mobility"],
        facts["uncontrolled"],
    )
    if facts["closes"]:
        assert analysis.residual < 1e-8
    else:
        assert analysis.residual == pytest.approx(facts["residual"], rel=0.05)


@pytest.mark.parametrize("name", FACTS)
def test_only_known_errors_are_found(name: str) -> None:
    report = eurdf.check(WILD / name)
    assert {found.code for found in report.diagnostics} - {"urdf-mesh-missing"} == ERRORS[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in FACTS if FACTS[name]["closes"]])
def test_every_actuator_moves_without_range(robots: dict[str, eurdf.Robot], name: str) -> None:
    robot = robots[name]
    for actuator in robot.actuation.joints:
        found = eurdf.sweep(robot, actuator, steps=10)
        assert found.upper.reached - found.lower.reached > 0.05
        assert {found.lower.end, found.upper.end} <= {"half turn", "dead point", "passive limit"}


@pytest.mark.parametrize("name", FACTS)
def test_mass_is_published_one(robots: dict[str, eurdf.Robot], name: str) -> None:
    mass = sum(inertia.mass for inertia in list(robots[name].model.inertias)[1:])
    assert mass == pytest.approx(FACTS[name]["mass"], rel=1e-8)
