"""Mimic joints of version 2.1: freed from their leader, or with properties of their own."""

from __future__ import annotations

import pytest

from support.described import LIMITED, body, codes, load, revolute
from support.plain_urdf import inertial, joint_element, link_element, robot

HEAD = 'extended_urdf: "2.1"\n'


def chain() -> str:
    """`third` mimics `second`, which mimics `first`."""
    law = '<mimic joint="{}" multiplier="{}" offset="0.1"/>'
    return robot(
        link_element("base", inertial()),
        *(body(name) for name in ("one", "two", "three")),
        revolute("first", "base", "one"),
        joint_element("second", "revolute", "one", "two", LIMITED.format("1 0 0") + law.format("first", 2)),
        joint_element("third", "revolute", "two", "three", LIMITED.format("0 1 0") + law.format("second", -3)),
    )


def test_freed_joint_moves_by_itself_and_leads_its_followers() -> None:
    found = load(chain(), f"{HEAD}joints: {{second: {{mimic: false}}}}\nactuators: [second, first]\n")
    mimics = {joint.name: joint.mimic for joint in found.mechanism.joints}
    assert mimics["first"] is mimics["second"] is None
    assert mimics["third"] is not None
    assert mimics["third"].joint == "second"
    assert (found.model.nv, found.actuation.joints) == (2, ("second", "first"))


def test_freed_joints_make_the_model_without_mimics() -> None:
    yaml = f"{HEAD}joints: {{second: {{mimic: false}}, third: {{mimic: false}}}}\n"
    assert load(chain(), yaml).model == load(chain(), mimic=False).model


def test_freed_joint_and_its_leader_can_be_replaced() -> None:
    yaml = f"{HEAD}joints:\n  first: spherical\n  second: {{type: helical, pitch: 0.1, mimic: false}}\n"
    assert codes(chain(), yaml) == ["joint-mimics"]  # the third joint mimics the second one
    free = yaml + "  third: {mimic: false}\n"
    types = {joint.name: joint.type.value for joint in load(chain(), free).mechanism.joints}
    assert types == {"first": "spherical", "second": "helical", "third": "revolute"}


def test_freed_joint_left_out_of_a_configuration_is_neutral() -> None:
    more = "joints: {third: {mimic: false}}\nconfigurations: {bent: {first: 0.2}}\n"
    found = load(chain(), HEAD + more)
    assert found.coordinates(found.configurations["bent"])["third"] == (0.0,)
    every = load(chain(), HEAD + more, mimic=False)
    at = every.coordinates(every.configurations["bent"])
    assert (at["third"], at["second"]) == ((0.0,), (pytest.approx(0.5),))


@pytest.mark.parametrize("keys", ["damping: 2", "armature: 0.1, friction: 1", "stiffness: 3, rest: 0.2"])
def test_mimic_joint_has_properties_in_version_2_1(keys: str) -> None:
    yaml = f"joints: {{third: {{{keys}}}}}\n"
    assert codes(chain(), HEAD + yaml) == []
    assert load(chain(), HEAD + yaml).model.nv == 1
    if "stiffness" not in keys:
        assert codes(chain(), yaml) == ["joint-mimics"]


@pytest.mark.parametrize(
    "entry",
    [
        "third: {limits: {velocity: 1}, damping: 2}",
        "third: {type: fixed, damping: 2}",
        "third: fixed",
        "first: {type: spherical, damping: 2}",
    ],
)
def test_mimic_joint_has_no_other_change_in_version_2_1(entry: str) -> None:
    assert codes(chain(), f"{HEAD}joints: {{{entry}}}\n") == ["joint-mimics"]


def test_properties_of_mimic_joints_count_at_the_first_leader() -> None:
    yaml = "joints: {second: {armature: 0.5}, third: {armature: 0.25, damping: 2, friction: 3}, first: {armature: 1}}\n"
    model = load(chain(), HEAD + yaml).model
    assert model.armature.tolist() == pytest.approx([1.0 + 2.0**2 * 0.5 + 6.0**2 * 0.25])
    assert model.damping.tolist() == pytest.approx([6.0**2 * 2.0])
    assert model.upperDryFrictionLimit.tolist() == pytest.approx([6.0 * 3.0])


def test_spring_of_mimic_joint_acts_on_the_first_leader() -> None:
    found = load(chain(), f"{HEAD}joints: {{third: {{stiffness: 5, rest: 0.3}}}}\n")
    (force,) = found.tree.springs.force(found.tree.neutral() + 0.2, 1)
    third = -3.0 * (2.0 * 0.2 + 0.1) + 0.1
    assert force == pytest.approx(-(-3.0 * 2.0) * 5.0 * (third - 0.3))
