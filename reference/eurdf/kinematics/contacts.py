"""Contacts of a robot with the world: closures between a place in it, frame A, and a frame of the robot, frame B."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures import REGISTRY
from eurdf.closures.se3 import quaternion_of
from eurdf.diagnostics.wording import enumerated, meant
from eurdf.errors import NotClosable
from eurdf.kinematics.assembly import closed_start, openings
from eurdf.kinematics.closing import start
from eurdf.kinematics.evaluate import frames
from eurdf.kinematics.inverse import checked_target
from eurdf.kinematics.named import Named
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.tolerances import SOLVED
from eurdf.mechanism.body import WORLD, Anchor
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_Robot = TypeVar("_Robot", bound="Robot")

_SHAPES: dict[str, tuple[int, ...]] = {"float": (), "Vector3": (3,), "tuple[Vector3, Vector3]": (2, 3)}


def with_contacts(robot: _Robot, contacts: Mapping[str, str | Mapping[str, Any]], at: Named | None = None) -> _Robot:
    """As `Robot.with_contacts`."""
    if not isinstance(contacts, Mapping):
        raise ValueError(f"contacts is {reprlib.repr(contacts)}; expected a mapping from frames to types of closure")
    q = start(robot, at, "at")
    with working_memory(robot, Problem) as problem:
        if at is not None and not problem.closes(q[None])[0]:
            raise NotClosable("at is no closed configuration", openings(problem, q[None]), q)
        q = closed_start(problem, q, SOLVED)
    mechanism, names = robot.mechanism, list(contacts)
    ends = _ends(mechanism, names)
    memory = frames(robot, names, few=True)
    (rotations,), (origins,) = memory.poses(memory.at(q[None]))
    world = mechanism.bodies[0].name if mechanism.root == "fixed" else WORLD
    made = tuple(
        _closure(name, contacts[name], world, ends[name], rotation, origin)
        for name, rotation, origin in zip(names, rotations, origins, strict=True)
    )
    touching = replace(
        robot,
        mechanism=replace(mechanism, contacts=(*mechanism.contacts, *made)),
        diagnose=lambda _: robot.diagnostics,
    )
    with working_memory(touching, Problem) as problem:
        q = closed_start(problem, q, SOLVED, "the given one, with these contacts")
    configurations = MappingProxyType({**mechanism.configurations, "assembled": robot.joint_positions(q)})
    return replace(touching, mechanism=replace(touching.mechanism, configurations=configurations))


def _ends(mechanism: Mechanism, names: list[str]) -> dict[str, Anchor]:
    """The frames of the contacts, by their names, which are those of no constraint."""
    known = {joint.name: Anchor(joint.child) for joint in mechanism.joints}
    known |= {body.name: Anchor(body.name) for body in mechanism.bodies if not body.virtual}
    known |= {frame.name: Anchor(frame.body, frame.pose) for frame in mechanism.frames}
    rigid = rigid_roots(mechanism.bodies[0].name, mechanism.joints)
    constraints = {constraint.name: constraint.type for constraint in mechanism.constraints}
    taken = {(each.b.body, each.b.pose): each.name for each in mechanism.contacts}
    found = {}
    for name in names:
        if name not in known:
            raise ValueError(f"contacts: the robot has no link, joint or frame '{name}'{meant(name, known)}")
        if name in constraints:
            raise ValueError(
                f"contacts: '{name}' is already the name of a constraint, of type {constraints[name]}; "
                "name another frame at this place"
            )
        end = known[name]
        if mechanism.root == "fixed" and rigid[end.body] == mechanism.bodies[0].name:
            raise ValueError(f"contacts: frame '{name}' is fixed to the world; name a frame that moves")
        other = taken.setdefault((end.body, end.pose), name)
        if other != name:
            raise ValueError(f"contacts: '{name}' and '{other}' are the same frame; name it once")
        found[name] = replace(end, frame=name)
    return found


def _closure(
    name: str, contact: str | Mapping[str, Any], world: str, end: Anchor, rotation: Matrix, origin: Vector
) -> Closure:
    """A contact as a closure, at the pose of its frame unless it states a place."""
    what = f"contacts['{name}']"
    stated = {"type": contact} if isinstance(contact, str) else contact
    if not isinstance(stated, Mapping) or "type" not in stated:
        raise ValueError(f"{what} is {reprlib.repr(contact)}; expected a type, or a mapping with 'type'")
    type_ = stated["type"]
    kind = REGISTRY.get(type_) if isinstance(type_, str) else None
    if kind is None:
        raise ValueError(
            f"{what} has the type {type_!r}; a contact is one of {enumerated(list(REGISTRY))}{meant(type_, REGISTRY)}"
        )
    if "at" in stated:
        place = checked_target(f"{what}['at']", stated["at"])
        is_position = isinstance(place, np.ndarray)
        rotation, origin = (rotation, place) if is_position else (place.rotation, place.translation)
    own = {key: value for key, value in stated.items() if key not in ("type", "at")}
    forms = kind.forms()
    form = next((each for each in forms if own.keys() <= each.keys.keys()), None)
    if form is None:
        keys = ["type", "at", *(key for each in forms for key in each.keys)]
        wrong = next((key for key in own if key not in keys), None)
        raise ValueError(
            f"{what} has the unknown key '{wrong}'; a contact of type {type_} has {enumerated(keys)}"
            if wrong is not None
            else f"{what} has the keys {enumerated(list(own))}, which exclude each other"
        )
    values: dict[str, Any] = {}
    for key, about in form.keys.items():
        if key not in own and about.default is None:
            raise ValueError(f"{what} of type {type_} needs '{key}': {about.text}")
        given = checked_array(f"{what}['{key}']", own.get(key, about.default), _SHAPES[about.type])
        if about.least is not None and given < about.least:
            raise ValueError(f"{what}['{key}'] is {given}; expected at least {about.least}")
        if given.ndim and not given.any(axis=-1).all():
            raise ValueError(f"{what}['{key}'] has a direction of length zero")
        values[key] = tuple(map(tuple, given.tolist())) if given.ndim == 2 else tuple(np.atleast_1d(given).tolist())
        values[key] = values[key] if given.ndim else float(given)
    x, y, z = origin.tolist()
    qx, qy, qz, qw = quaternion_of(rotation).tolist()
    a = Anchor(world, Pose.from_xyz_quaternion((x, y, z), (qx, qy, qz, qw)))
    return kind(name, a, end, **kind.values_of(values))
