"""Canonical descriptions, drawn at random, and the same with another style, for the tests of their comparison."""

import math
import string
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from eurdf_conformance.comparison.coordinates import COORDINATES, VELOCITIES, has_quaternion, neutral
from eurdf_conformance.protocol.message import CanonicalRobot

NAMES = st.text(string.ascii_lowercase + "_/ ~é✓", min_size=1, max_size=6)
NUMBERS = st.floats(-1e3, 1e3).filter(lambda number: number == 0 or abs(number) > 1e-6)
OWN = st.recursive(
    st.none() | st.booleans() | st.integers(-5, 5) | NUMBERS | NAMES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=3),
    max_leaves=5,
)


@dataclass(frozen=True)
class Read:
    """A canonical description, and the links of each body."""

    robot: CanonicalRobot
    bodies: list[list[str]]


@st.composite
def quaternions(draw: st.DrawFn) -> list[float]:
    four = draw(st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: math.hypot(*q) > 0.1))
    return [number / math.hypot(*four) for number in four]


@st.composite
def coordinates(draw: st.DrawFn, kind: str) -> list[float]:
    count = COORDINATES[kind] - (4 if has_quaternion(kind) else 0)
    numbers = draw(st.lists(NUMBERS, min_size=count, max_size=count))
    return numbers + (draw(quaternions()) if has_quaternion(kind) else [])


@st.composite
def robots(draw: st.DrawFn) -> Read:
    """A tree of bodies with any joints, and the rest of what a description can say."""
    links = draw(st.lists(NAMES, min_size=4, max_size=9, unique=True))
    cuts = sorted(draw(st.lists(st.integers(1, len(links) - 1), min_size=1, max_size=4, unique=True)))
    bodies = [links[a:b] for a, b in zip([0, *cuts], [*cuts, len(links)], strict=True)]
    names = draw(st.lists(NAMES, min_size=len(bodies) - 1, max_size=len(bodies) - 1, unique=True))
    joints = [draw(_joint(name, bodies, index)) for index, name in enumerate(names, 1)]
    driven = [joint for joint in joints if draw(st.booleans())]
    configurations = {
        name: {joint["name"]: draw(coordinates(joint["type"])) for joint in joints if draw(st.booleans())}
        for name in draw(st.lists(NAMES, max_size=2, unique=True))
    }
    closures = draw(st.lists(NAMES, max_size=3, unique=True))
    robot = {
        "name": draw(NAMES),
        "version": draw(st.sampled_from(["1", "2"])),
        "root": draw(st.sampled_from(["fixed", "floating"])),
        "links": links,
        "frames": draw(st.lists(NAMES, max_size=3, unique=True)),
        "joints": joints,
        "closures": [
            {
                "name": name,
                "type": draw(st.sampled_from(["3d", "6d"])),
                "a": draw(st.sampled_from(links)),
                "b": draw(st.sampled_from(links)),
            }
            for name in closures
        ],
        "actuators": [
            {
                "joint": joint["name"],
                "gear_ratio": draw(st.lists(NUMBERS, min_size=nv, max_size=nv)),
                "rotor_inertia": draw(st.lists(NUMBERS, min_size=nv, max_size=nv)),
            }
            for joint in driven
            for nv in [VELOCITIES[joint["type"]]]
        ],
        "configurations": configurations,
        "own": {f"/x-{index}": draw(OWN) for index in range(draw(st.integers(0, 2)))},
    }
    return Read(CanonicalRobot.model_validate(robot), bodies)


@st.composite
def _joint(draw: st.DrawFn, name: str, bodies: list[list[str]], index: int) -> dict[str, Any]:
    kind = draw(st.sampled_from(list(COORDINATES)))
    nv = VELOCITIES[kind]
    bounded = 0 if kind in ("planar", "spherical", "floating") else COORDINATES[kind]
    bounds: st.SearchStrategy[Any] = NUMBERS
    if kind == "continuous":
        bounds = st.none()
    elif kind != "revolute":
        bounds = NUMBERS | st.none()
    mimic = {"joint": draw(NAMES), "multiplier": draw(NUMBERS), "offset": draw(NUMBERS)}
    return {
        "name": name,
        "type": kind,
        "parent": draw(st.sampled_from(bodies[draw(st.integers(0, index - 1))])),
        "child": draw(st.sampled_from(bodies[index])),
        "lower": draw(st.lists(bounds, min_size=bounded, max_size=bounded)),
        "upper": draw(st.lists(bounds, min_size=bounded, max_size=bounded)),
        **{key: draw(st.lists(NUMBERS | st.none(), min_size=nv, max_size=nv)) for key in ("velocity", "effort")},
        **{key: draw(st.lists(NUMBERS, min_size=nv, max_size=nv)) for key in ("damping", "friction", "armature")},
        "mimic": mimic if kind in ("revolute", "prismatic") and draw(st.booleans()) else None,
    }


@st.composite
def restyled(draw: st.DrawFn, read: Read) -> CanonicalRobot:
    """The same description as another parser may write it."""
    robot = read.robot.model_dump(mode="json")
    body = {link: links for links in read.bodies for link in links}
    for joint in robot["joints"]:
        joint["parent"], joint["child"] = (draw(st.sampled_from(body[joint[end]])) for end in ("parent", "child"))
        if joint["type"] == "continuous" and draw(st.booleans()):
            joint["type"] = "revolute"
    for closure in robot["closures"]:
        closure["a"], closure["b"] = (draw(st.sampled_from(body[closure[end]])) for end in ("a", "b"))
    for actuator in robot["actuators"]:
        if all(ratio == 1 for ratio in actuator["gear_ratio"]) and draw(st.booleans()):
            actuator["gear_ratio"] = None
        if not any(actuator["rotor_inertia"]) and draw(st.booleans()):
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
    for joint in list(robot["joints"]):
        if joint["type"] == "universal" and draw(st.booleans()):
            split(robot, joint)
    for key in ("links", "frames", "joints", "closures", "actuators"):
        robot[key] = draw(st.permutations(robot[key]))
    return CanonicalRobot.model_validate(robot)


def split(robot: dict[str, Any], joint: dict[str, Any]) -> None:
    """Write a universal joint as two revolutes about a body of its own."""
    first, second = f"{joint['name']}_1", f"{joint['name']}_2"
    lists = ("lower", "upper", "velocity", "effort", "damping", "friction", "armature")
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
