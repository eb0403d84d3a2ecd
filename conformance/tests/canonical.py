"""Canonical descriptions of the corpus, and the same with another style, for the tests of their comparison."""

import math
from typing import Any

from hypothesis import strategies as st

from eurdf_conformance.comparison.coordinates import has_quaternion, neutral
from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.expected import Expected
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.protocol.message import CanonicalRobot

#: Of version 1, some describe universal joints as two revolutes; what is to have another style has none.
_SAID = [case.expected for case in all_cases() if isinstance(case.case, ValidCase) and case.case.version != "1"]
READ = [each for each in _SAID if len(each.robot.links) < 12]


@st.composite
def restyled(draw: st.DrawFn, read: Expected) -> CanonicalRobot:
    """The same description as another parser may write it."""
    robot = read.robot.model_dump(mode="json")
    body = {link: links for links in read.bodies for link in links}
    for joint in robot["joints"]:
        joint["parent"], joint["child"] = (draw(st.sampled_from(body[joint[end]])) for end in ("parent", "child"))
        if joint["type"] == "continuous" and draw(st.booleans()):
            joint["type"] = "revolute"
    for closure in robot["closures"]:
        for end in ("a", "b"):
            closure[end] = closure[end] and draw(st.sampled_from(body[closure[end]]))
    for actuator in robot["actuators"]:
        if all(ratio == 1 for ratio in actuator["gear_ratio"] or ()) and draw(st.booleans()):
            actuator["gear_ratio"] = None
        if not any(actuator["rotor_inertia"] or ()) and draw(st.booleans()):
            actuator["rotor_inertia"] = None
    kinds = {joint["name"]: joint["type"] for joint in read.robot.model_dump()["joints"]}
    for configuration in robot["configurations"].values():
        for joint, kind in kinds.items():
            given = configuration.get(joint)
            if given is None and draw(st.booleans()):
                configuration[joint] = neutral(kind)
            elif given == neutral(kind) and draw(st.booleans()):
                del configuration[joint]
            elif given is not None and has_quaternion(kind) and draw(st.booleans()):
                configuration[joint] = [*given[:-4], *(-number for number in given[-4:])]
            elif given is not None and kind == "continuous":
                configuration[joint] = [given[0] + math.tau * draw(st.integers(-2, 2))]
    named = {motor["joint"] for motor in robot["actuators"] if motor.get("name") or motor.get("control")}
    for joint in list(robot["joints"]):
        if joint["type"] == "universal" and joint["name"] not in named and draw(st.booleans()):
            split(robot, joint)
    for key in ("links", "frames", "joints", "closures", "actuators"):
        robot[key] = draw(st.permutations(robot[key]))
    return CanonicalRobot.model_validate(robot)


def split(robot: dict[str, Any], joint: dict[str, Any]) -> None:
    """Write a universal joint as two revolutes about a body of its own."""
    first, second = f"{joint['name']}_1", f"{joint['name']}_2"
    lists = [key for key, value in joint.items() if isinstance(value, list)]
    # Of one kind: both are bounded, or neither is.
    kind = "revolute" if joint["lower"][0] is not None or joint["upper"][0] is not None else "continuous"
    halves = [
        joint | {"name": name, "type": kind} | {key: [joint[key][index]] for key in lists}
        for index, name in enumerate((first, second))
    ]
    if (halves[1]["lower"], halves[1]["upper"]) == ([None], [None]) and kind == "revolute":
        return
    if kind == "continuous" and (halves[1]["lower"], halves[1]["upper"]) != ([None], [None]):
        return
    virtual = "between ✗"
    taken = {other["child"] for other in robot["joints"]}
    while virtual in taken or virtual in robot["links"]:
        virtual += "'"
    halves[0]["child"] = halves[1]["parent"] = virtual
    robot["joints"] = [other for other in robot["joints"] if other is not joint] + halves
    for actuator in [actuator for actuator in robot["actuators"] if actuator["joint"] == joint["name"]]:
        robot["actuators"].remove(actuator)
        for index, name in enumerate((first, second)):
            parts = {key: actuator[key] and [actuator[key][index]] for key in ("gear_ratio", "rotor_inertia")}
            robot["actuators"].append({"joint": name, **parts})
    for configuration in robot["configurations"].values():
        if (angles := configuration.pop(joint["name"], None)) is not None:
            configuration.update({first: angles[:1], second: angles[1:]})


def numbers_in(value: Any, where: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """The places of the numbers of a JSON value."""
    if isinstance(value, dict):
        return [found for key, each in value.items() for found in numbers_in(each, (*where, key))]
    if isinstance(value, list):
        return [found for index, each in enumerate(value) for found in numbers_in(each, (*where, index))]
    return [where] if isinstance(value, int | float) and not isinstance(value, bool) else []


def with_number(value: Any, where: tuple[str | int, ...], number: float) -> Any:
    """A JSON value with another number in one place."""
    if not where:
        return number
    copy = dict(value) if isinstance(value, dict) else list(value)
    copy[where[0]] = with_number(value[where[0]], where[1:], number)
    return copy


def number_at(value: Any, where: tuple[str | int, ...]) -> float:
    """The number in one place of a JSON value."""
    for key in where:
        value = value[key]
    assert isinstance(value, int | float)
    return value
