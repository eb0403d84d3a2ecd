"""One value of one side of a robot is changed; the conventions of a side are not its values."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from eurdf.advice.mirrored_names import mirrored_names
from eurdf.advice.symmetry import advise_on_symmetry
from eurdf.diagnostics import Diagnostics
from eurdf.linking.robot_files import ReadRobot, read_robot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from support.places import ROBOTS

TWO_SIDED = ["battobot", "cassie_2legs", "digit_2legs", "kangaroo_2legs", "talos_2legs", "tello", "unitree_g1"]

ROBOT = st.sampled_from(TWO_SIDED)
FACTORS = st.floats(1.3, 3.0) | st.floats(0.3, 0.75)


@cache
def read(name: str) -> ReadRobot:
    return read_robot(ROBOTS / name)


def advice(name: str, mechanism: Mechanism) -> list[str]:
    diagnostics = Diagnostics()
    advise_on_symmetry(read(name)._replace(linked=mechanism), diagnostics)
    assert {found.code for found in diagnostics} <= {"x-asymmetric"}
    return [found.message for found in diagnostics if found.place.line]


def chosen(data: st.DataObject, items: Any, sided: Callable[[Any], bool]) -> Any:
    image = mirrored_names([item.name for item in items])
    return data.draw(st.sampled_from([item for item in items if item.name in image and sided(item)]))


def scaled(value: Any, factor: float) -> Any:
    if isinstance(value, Pose):
        return Pose(scaled(value.xyz, factor), value.quaternion)
    return tuple(factor * each for each in value) if isinstance(value, tuple) else factor * value


@given(st.data(), ROBOT, FACTORS, st.sampled_from(["mass", "moments", "pose"]))
def test_inertia_of_one_side_is_reported(data: st.DataObject, name: str, factor: float, what: str) -> None:
    mechanism = read(name).mechanism
    body = chosen(data, mechanism.bodies, lambda each: each.inertia and math.hypot(*each.inertia.pose.xyz) > 0.03)
    changed = replace(body, inertia=replace(body.inertia, **{what: scaled(getattr(body.inertia, what), factor)}))
    bodies = tuple(changed if each is body else each for each in mechanism.bodies)
    (message,) = advice(name, replace(mechanism, bodies=bodies))
    assert f"'{body.name}'" in message


@given(st.data(), ROBOT, FACTORS, st.sampled_from(["placement", "upper", "velocity", "effort", "damping", "armature"]))
def test_value_of_one_joint_is_reported(data: st.DataObject, name: str, factor: float, what: str) -> None:
    mechanism = read(name).mechanism
    joint = chosen(data, mechanism.joints, lambda j: j.type.is_ranged and math.hypot(*j.placement.xyz) > 0.03)
    if what == "placement":
        changed = replace(joint, placement=scaled(joint.placement, factor))
    else:
        values = getattr(joint.properties, what)
        assume(values and values[0] and math.isfinite(values[0]))
        changed = joint.with_properties(replace(joint.properties, **{what: scaled(values, factor)}))
    joints = tuple(changed if each is joint else each for each in mechanism.joints)
    (message,) = advice(name, replace(mechanism, joints=joints))
    assert f"'{joint.name}'" in message


@given(st.data(), ROBOT)
def test_actuator_or_closure_of_one_side_is_reported(data: st.DataObject, name: str) -> None:
    mechanism = read(name).mechanism
    joint = chosen(data, mechanism.joints, lambda each: each.name in mechanism.actuators)
    actuators = tuple(each for each in mechanism.actuators if each != joint.name)
    (message,) = advice(name, replace(mechanism, actuators=actuators))
    assert f"'{joint.name}'" in message
    closure = chosen(data, mechanism.closures, lambda _: True)
    closures = tuple(each for each in mechanism.closures if each is not closure)
    (message,) = advice(name, replace(mechanism, closures=closures))
    assert closure.a.body in message


@given(st.data(), ROBOT, st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3), st.booleans())
def test_frame_and_sense_of_one_side_are_conventions(data, name: str, rpy: list[float], reverse: bool) -> None:
    """A link has its frame turned, and its joint the opposite axis and limits."""
    mechanism = read(name).mechanism
    joint = chosen(data, mechanism.joints, lambda each: each.type.is_ranged)
    turn = Pose.from_xyz_rpy((0.0, 0.0, 0.0), tuple(rpy))
    back, p = turn.inverse(), joint.properties
    changed = replace(joint, offset=joint.offset * turn)
    if reverse:
        limits = replace(p, lower=tuple(-x for x in p.upper), upper=tuple(-x for x in p.lower))
        changed = replace(changed, axes=(tuple(-x for x in joint.axes[0]),), properties=limits)

    def turned(item: Any, key: str, is_on: bool) -> Any:
        return replace(item, **{key: back * getattr(item, key)}) if is_on and item is not None else item

    joints = tuple(
        changed if each is joint else turned(each, "placement", each.parent == joint.child) for each in mechanism.joints
    )
    bodies = tuple(
        replace(each, inertia=turned(each.inertia, "pose", each.name == joint.child)) for each in mechanism.bodies
    )
    closures = tuple(
        replace(
            each,
            **{side: turned(getattr(each, side), "pose", getattr(each, side).body == joint.child) for side in "ab"},
        )
        for each in mechanism.closures
    )
    couplings = tuple(
        replace(
            each,
            coefficients=tuple((key, -c if reverse and key == joint.name else c) for key, c in each.coefficients),
        )
        for each in mechanism.couplings
    )
    robot = replace(mechanism, joints=joints, bodies=bodies, closures=closures, couplings=couplings)
    assert advice(name, robot) == []


@pytest.mark.parametrize("reverse", [False, True])
@given(st.data(), st.floats(0.2, 5.0) | st.floats(-5.0, -0.2))
def test_coupling_of_one_side_is_reported_if_not_a_multiple(reverse: bool, data: st.DataObject, factor: float) -> None:
    mechanism = read("tello").mechanism
    coupling = chosen(data, mechanism.couplings, lambda _: True)
    joint = data.draw(st.sampled_from(coupling.joints))
    changed = replace(
        coupling,
        coefficients=tuple(
            (name, factor * (-c if reverse and name == joint else c)) for name, c in coupling.coefficients
        ),
    )
    couplings = tuple(changed if each is coupling else each for each in mechanism.couplings)
    found = advice("tello", replace(mechanism, couplings=couplings))
    assert [f"'{coupling.name}'" in each for each in found] == [True] * reverse


@given(st.data(), st.sampled_from(["battobot", "cassie_2legs", "digit_2legs", "tello"]))
def test_range_of_the_opposite_sense_is_reported(data: st.DataObject, name: str) -> None:
    mechanism = read(name).mechanism
    joint = chosen(data, mechanism.joints, lambda each: each.type.is_ranged and each.mimic is None)
    lower, upper = joint.ranges[0]
    assume(math.isfinite(lower) and math.isfinite(upper) and abs(lower + upper) > 0.1 * (upper - lower))
    changed = joint.with_properties(replace(joint.properties, lower=(-upper,), upper=(-lower,)))
    joints = tuple(changed if each is joint else each for each in mechanism.joints)
    (message,) = advice(name, replace(mechanism, joints=joints))
    assert f"range of joint '{joint.name}'" in message or f"'{joint.name}': " in message


@pytest.mark.parametrize(
    "names",
    [
        *("left_knee right_knee", "KneeLeft KneeRight", "l_hip_r r_hip_r", "LHipYaw RHipYaw", "FL_hip FR_hip"),
        *("rl rr", "LARM_WRIST_R RARM_WRIST_R", "hipL hipR", "l_left r_right"),
    ],
)
def test_name_has_a_mirrored_name(names: str) -> None:
    left, right = names.split()
    assert mirrored_names([left, "hip", right, "roll"]) == {left: right, right: left}


def test_front_and_rear_are_not_mirrored() -> None:
    legs = ["lf", "rf", "lr", "rr", "link", "wheel"]
    assert mirrored_names(legs) == {"lf": "rf", "rf": "lf", "lr": "rr", "rr": "lr"}
