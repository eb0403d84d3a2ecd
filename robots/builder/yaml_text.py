"""A drawing as the text of the YAML file, in either version of the format."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from robots.builder.drawing import Body, Closure, Drawing, Frame
from robots.builder.joint import Joint
from robots.builder.number_text import DECIMALS, number_text
from robots.builder.shape import rpy_of

Value = str | float | Sequence["Value"] | Mapping[str, "Value"]

_WIDTH = 100
_PLAIN = re.compile(r"[A-Za-z_][\w.,()/ -]*|[36]d")
_NOT_PLAIN = frozenset({"true", "false", "null", "yes", "no", "on", "off", "y", "n"})
_SCHEMA = "# yaml-language-server: $schema=../../schema/extended-urdf-{}.schema.json\n"
_HEAD = "# Written by build.py beside this file: change it there.\n"


def yaml_text(drawing: Drawing) -> str:
    """The description in the lowest version that can say it; a drawing is assembled with every joint at its neutral."""
    later = any(joint.spring for joint in drawing.joints) or drawing.couplings
    version = "2.1" if later or len(_plain(drawing)) < len(drawing.closures) else "2.0"
    content: dict[str, Value] = {
        "extended_urdf": version,
        "urdf": "robot.urdf",
        "root": "" if drawing.root == "fixed" else drawing.root,
        "closures": [_closure(closure) for closure in drawing.closures],
        "couplings": [{"name": coupling.name, "joints": coupling.joints} for coupling in drawing.couplings],
        "joints": {joint.name: _type_2(joint) for joint in _replaced(drawing)} | _springs(drawing),
        "actuators": [_actuator(joint) for joint in drawing.joints if joint.motor],
        "frames": [_frame(frame, drawing.bodies[frame.body]) for frame in drawing.frames],
        "configurations": {"assembled": {}, **drawing.configurations},
        "metadata": drawing.metadata,
    }
    return _SCHEMA.format(version) + _HEAD + _text(content)


def version_1_text(drawing: Drawing) -> str:
    """The description in version 1, without what that cannot say: `NOT_IN_VERSION_1` of the quality rules."""
    replaced = _replaced(drawing)
    content: dict[str, Value] = {
        "closed_loop": [closure.frames for closure in _plain(drawing)],
        "type": [closure.type for closure in _plain(drawing)],
        "name_mot": [joint.name for joint in drawing.joints if joint.motor],
        "joint_name": [joint.name for joint in replaced],
        "joint_type": [_type_1(joint) for joint in replaced],
    }
    return _SCHEMA.format("1") + _HEAD + _text(content)


def _plain(drawing: Drawing) -> list[Closure]:
    """The closures of types that every version has."""
    return [closure for closure in drawing.closures if closure.type in ("3d", "6d")]


def _closure(closure: Closure) -> Value:
    entry: dict[str, Value] = {"name": closure.name, "type": closure.type, "frames": closure.frames}
    if closure.axis is not None:
        entry["axis"] = closure.axis
    if closure.type == "distance":
        entry["length"] = math.dist(*closure.points)
    return entry


def _replaced(drawing: Drawing) -> list[Joint]:
    """The joints that URDF cannot say."""
    return [joint for joint in drawing.joints if joint.type in ("spherical", "universal")]


def _type_2(joint: Joint) -> Value:
    """What a joint is in version 2.0; the axes of a universal one are x and y of its frame."""
    return {"type": "universal", "axes": "xy"} if joint.type == "universal" else joint.type


def _springs(drawing: Drawing) -> dict[str, Value]:
    """The joints with springs, in version 2.1."""
    return {
        joint.name: {"stiffness": joint.spring.stiffness, **({"rest": joint.spring.rest} if joint.spring.rest else {})}
        for joint in drawing.joints
        if joint.spring
    }


def _actuator(joint: Joint) -> Value:
    """A joint with a motor; a mapping where the gear or the rotor is known."""
    assert joint.motor
    gear = {} if joint.motor.gear_ratio == 1.0 else {"gear_ratio": joint.motor.gear_ratio}
    rotor = {"rotor_inertia": joint.motor.rotor_inertia} if joint.motor.rotor_inertia else {}
    return {"joint": joint.name, **gear, **rotor} if gear or rotor else joint.name


def _frame(frame: Frame, body: Body) -> Value:
    """A frame on its body, whose own axes may be turned."""
    place = {
        "xyz": (body.rotation.T @ np.subtract(frame.at, body.origin)).tolist(),
        "rpy": rpy_of(body.rotation.T),
    }
    turned = {key: [round(float(value), DECIMALS) for value in values] for key, values in place.items() if any(values)}
    return {"name": frame.name, "link": frame.body, **turned}


def _type_1(joint: Joint) -> str:
    """The same in version 1."""
    return "UJOINT_XY" if joint.type == "universal" else joint.type.upper()


def _text(content: Mapping[str, Value]) -> str:
    """The mapping in block style, without the keys that have nothing to say."""
    return "".join(f"{line}\n" for line in _block({key: value for key, value in content.items() if value}))


def _block(value: Mapping[str, Value] | Sequence[Value]) -> Iterator[str]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _entry(f"{_scalar(key)}:", inner)
    else:
        for inner in value:
            if isinstance(inner, Mapping):
                first, *rest = _block(inner)
                yield f"- {first}"
                yield from (f"  {line}" for line in rest)
            else:
                yield from _entry("-", inner)


def _entry(head: str, value: Value) -> Iterator[str]:
    """One entry of a mapping or a list; a list of plain values is on the same line if it fits there."""
    if isinstance(value, str | float):
        yield f"{head} {_scalar(value)}"
        return
    if not isinstance(value, Mapping):
        scalars = [_scalar(inner) for inner in value if isinstance(inner, str | float)]
        line = f"{head} [{', '.join(scalars)}]"
        if len(scalars) == len(value) and len(line) <= _WIDTH:
            yield line
            return
    if not value:
        yield f"{head} {{}}"
        return
    yield head
    yield from (f"  {line}" for line in _block(value))


def _scalar(value: str | float) -> str:
    if not isinstance(value, str):
        return number_text(value)
    plain = _PLAIN.fullmatch(value) and value.lower() not in _NOT_PLAIN and value == value.strip()
    return value if plain else json.dumps(value, ensure_ascii=False)
