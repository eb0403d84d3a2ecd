"""Reading a robot in Python without any check, against bare `pin.buildModelFromUrdf` on the same URDF.

`read_unchecked` is a short function that parses both files with the libraries that `eurdf` uses (lxml, libyaml), makes
plain values of the description, and builds the model that `pin.buildModelFromUrdf` makes of the URDF. It checks
nothing, keeps no positions for messages, and changes no joint as the description says. The column "with values" adds
the frozen values of `robot.mechanism`, made from their fields. The last column is all of `eurdf.load(geometry=False)`.
All three are ratios to the peer, which is compiled code and does not read the description. What `eurdf.load` takes
beyond that is for checks, positions in the files, and linking the two files.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree
from yaml import CSafeLoader
from yaml.events import AliasEvent, MappingStartEvent, ScalarEvent, SequenceStartEvent

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.load import ROOT, robots
from benchmarks.table import Table, duration, ratio
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.pinocchio.joint_model import joint_models

_INF = math.inf
_HERE = pin.SE3.Identity()
_XML = etree.XMLParser(remove_blank_text=True, remove_comments=True, remove_pis=True, collect_ids=False)
_MOMENTS = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
_LIMITS = ["lower", "upper", "effort", "velocity"]

#: Joints that a robot of the table has, at least.
_JOINTS = 10


def tables(published: bool = True) -> Iterator[Table]:
    """One table, of the robots with 10 joints or more.

    Args:
        published: Whether to measure published robots, too, where they are present beside the checkout.
    """
    columns = ("robot", "joints", "unchecked", "pin", "ratio", "with values", "`eurdf.load`")
    folders = [folder for folder in robots() if published or folder.parent == ROOT / "robots"]
    yield Table(columns, [row for folder in folders for row in _rows(folder)])


def _rows(folder: Path) -> Iterator[tuple[str, ...]]:
    robot = eurdf.load(folder, geometry=False)
    if robot.model.njoints - 1 < _JOINTS:
        return
    made = list(_values(robot.mechanism, set()))
    functions: list[Callable[[], object]] = [
        partial(pin.buildModelFromUrdf, str(folder / "robot.urdf")),
        partial(read_unchecked, folder),
        lambda: (read_unchecked(folder), [kind(*arguments, **named) for kind, arguments, named in made]),
        partial(eurdf.load, folder, geometry=False),
    ]
    peer, floor, with_values, ours = least_times(functions, 150)
    yield (
        folder.name,
        str(robot.model.njoints - 1),
        duration(floor),
        duration(peer),
        ratio(floor, peer),
        ratio(with_values, peer),
        ratio(ours, peer),
    )


def read_unchecked(folder: Path) -> tuple[pin.Model, Any]:
    """The model of a robot's URDF without mimic joints, and the values in its description.

    Args:
        folder: Has a sound ``robot.yaml`` and ``robot.urdf``.
    """
    with open(folder / "robot.yaml", "rb") as stream:
        description = _description(stream.read())
    with open(folder / "robot.urdf", "rb") as stream:
        root: Any = etree.fromstring(stream.read(), _XML)
    inertias: dict[str, pin.Inertia | None] = {}
    joints: dict[str, list[tuple[Any, ...]]] = {}
    children = set()
    for element in root[:]:
        if element.tag == "link":
            inertias[element.get("name")] = _inertia(element)
        elif element.tag == "joint":
            joint = _joint(element)
            joints.setdefault(joint[2], []).append(joint)
            children.add(joint[3])
    (base,) = inertias.keys() - children
    return _model(root.get("name"), base, inertias, joints), description


def _inertia(link: Any) -> pin.Inertia | None:
    for inertial in link[:]:
        if inertial.tag == "inertial":
            placement = _HERE
            for element in inertial[:]:
                tag = element.tag
                if tag == "origin":
                    placement = _placement(element)
                elif tag == "mass":
                    mass = float(element.get("value"))
                elif tag == "inertia":
                    texts = element.values() if element.keys() == _MOMENTS else map(element.get, _MOMENTS)
                    xx, xy, xz, yy, yz, zz = map(float, texts)
            moments = np.array((xx, xy, xz, xy, yy, yz, xz, yz, zz)).reshape(3, 3)
            try:
                return placement.act(pin.Inertia(mass, np.zeros(3), moments))
            except RuntimeError:  # moments that no body has, which Pinocchio's parser takes
                inertia = pin.Inertia(mass, np.zeros(3), np.zeros((3, 3)))
                inertia.inertia = moments
                return placement.act(inertia)
    return None


def _joint(joint: Any) -> tuple[Any, ...]:
    placement, axis, damping, friction = _HERE, "1 0 0", 0.0, 0.0
    limits: tuple[float, ...] = (-_INF, _INF, _INF, _INF)
    for element in joint[:]:
        tag = element.tag
        if tag == "parent":
            parent = element.get("link")
        elif tag == "child":
            child = element.get("link")
        elif tag == "origin":
            placement = _placement(element)
        elif tag == "axis":
            axis = element.get("xyz")
        elif tag == "limit":
            if element.keys() == _LIMITS:
                limits = tuple(map(float, element.values()))
            else:
                limits = tuple(float(element.get(key, "0")) for key in _LIMITS)
        elif tag == "dynamics":
            damping, friction = float(element.get("damping", "0")), float(element.get("friction", "0"))
    return joint.get("name"), joint.get("type"), parent, child, placement, axis, limits, damping, friction


def _placement(origin: Any) -> pin.SE3:
    xyz, rpy = origin.get("xyz"), origin.get("rpy")
    x, y, z = map(float, xyz.split()) if xyz else (0.0, 0.0, 0.0)
    if not rpy or rpy == "0 0 0":
        return pin.XYZQUATToSE3([x, y, z, 0.0, 0.0, 0.0, 1.0])
    roll, pitch, yaw = map(float, rpy.split())
    sr, cr = math.sin(roll / 2.0), math.cos(roll / 2.0)
    sp, cp = math.sin(pitch / 2.0), math.cos(pitch / 2.0)
    sy, cy = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    quaternion = sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy
    return pin.XYZQUATToSE3([x, y, z, *quaternion, cr * cp * cy + sr * sp * sy])


@cache
def _moving(kind: str, axis: str) -> tuple[pin.JointModel, int, int]:
    """The joint model, which nearly all loads share with one before, and its numbers of coordinates and velocities."""
    direction = tuple(map(float, axis.split()))
    (shared,) = joint_models(Joint("", JointType(kind), "", "", axes=(direction,)))  # type: ignore[arg-type]
    model = pin.JointModel(shared)
    return model, model.nq, model.nv


def _model(name: str, base: str, inertias: dict[str, Any], joints: dict[str, list[tuple[Any, ...]]]) -> pin.Model:
    model = pin.Model()
    model.name = name
    inertia = inertias[base]
    frame = model.addFrame(
        pin.Frame(base, 0, 0, _HERE, pin.FrameType.BODY, pin.Inertia.Zero() if inertia is None else inertia)
    )
    lower: list[float] = []
    upper: list[float] = []
    velocity: list[float] = []
    effort: list[float] = []
    dampings: list[float] = []
    frictions: list[float] = []
    stack = [(joint, 0, frame, _HERE) for joint in sorted(joints.get(base, ()), reverse=True, key=_name)]
    while stack:
        (name, kind, _, body, placement, axis, limits, damping, friction), joint_id, frame, at = stack.pop()
        inertia = inertias[body]
        if at is not _HERE:
            placement = at * placement
        if kind == "fixed":
            mass = pin.Inertia.Zero() if inertia is None else inertia
            frame = model.addFrame(pin.Frame(name, joint_id, frame, placement, pin.FrameType.FIXED_JOINT, mass))
        else:
            moving, nq, nv = _moving(kind, axis)
            joint_id = model.addJoint(joint_id, moving, placement, name)
            frame = model.addJointFrame(joint_id, frame)
            placement = _HERE
            if inertia is not None:
                model.appendBodyToJoint(joint_id, inertia, _HERE)
            low, high, most, rate = limits
            lower += (low,) if nq == 1 else (-1.01,) * nq
            upper += (high,) if nq == 1 else (1.01,) * nq
            velocity += (rate,) * nv
            effort += (most,) * nv
            dampings += (damping,) * nv
            frictions += (friction,) * nv
        frame = model.addBodyFrame(body, joint_id, placement, frame)
        below = joints.get(body)
        if below:
            stack += [(joint, joint_id, frame, placement) for joint in sorted(below, reverse=True, key=_name)]
    model.lowerPositionLimit, model.upperPositionLimit = np.array(lower), np.array(upper)
    model.upperVelocityLimit, model.upperEffortLimit = np.array(velocity), np.array(effort)
    model.lowerVelocityLimit, model.lowerEffortLimit = model.upperVelocityLimit, -model.upperEffortLimit
    model.damping, model.upperDryFrictionLimit = np.array(dampings), np.array(frictions)
    model.lowerDryFrictionLimit = -model.upperDryFrictionLimit
    return model


def _name(joint: tuple[Any, ...]) -> str:
    return str(joint[0])


def _description(data: bytes) -> Any:
    """The plain values of a description: mappings, lists, texts and numbers."""
    next_event: Callable[[], Any] = CSafeLoader(data).get_event
    next_event(), next_event()  # the stream and the document begin
    anchors: dict[str, Any] = {}
    current: Any = []  # whose one item is the top level
    key: str | None = None  # of the mapping that `current` is, once it came
    around: list[tuple[Any, str | None]] = []
    while True:
        event = next_event()
        kind = type(event)
        if kind is ScalarEvent:
            value = event.value
            if event.implicit[0] and value[:1] in _BEGINS_NUMBER:
                with suppress(ValueError):
                    value = float(value)
            if type(current) is dict and key is None:
                key = value
                continue
        elif kind is MappingStartEvent:
            value = {}
        elif kind is SequenceStartEvent:
            value = []
        elif kind is AliasEvent:
            value = anchors[event.anchor]
        elif around:
            current, key = around.pop()
            continue
        else:
            return current[0]
        if type(current) is dict:
            current[key], key = value, None
        else:
            current.append(value)
        if kind is not AliasEvent and event.anchor is not None:
            anchors[event.anchor] = value
        if kind is MappingStartEvent or kind is SequenceStartEvent:
            around.append((current, key))
            current, key = value, None


_BEGINS_NUMBER = frozenset("+-.0123456789")


def _values(value: Any, seen: set[int]) -> Iterator[tuple[type, tuple[Any, ...], dict[str, Any]]]:
    """Class and arguments of each frozen value in a mechanism, once each."""
    if is_dataclass(value) and not isinstance(value, type):
        if id(value) in seen:
            return
        seen.add(id(value))
        stated = [each for each in fields(value) if each.init]
        arguments = tuple(getattr(value, each.name) for each in stated if not each.kw_only)
        named = {each.name: getattr(value, each.name) for each in stated if each.kw_only}
        yield type(value), arguments, named
        for argument in (*arguments, *named.values()):
            yield from _values(argument, seen)
    elif isinstance(value, tuple):
        for item in value:
            yield from _values(item, seen)
