"""Renaming changes nothing but names."""

from __future__ import annotations

from collections.abc import Callable

from eurdf_conformance.json_pointer import key_of, step
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.document import names1
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.names import Names, keyed, new_names, renamed
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.protocol.message import CanonicalRobot, Jacobian, MassMatrix, Values

Name = Callable[[str], str]


def renaming(example: Example, version: Version) -> Pair:
    """A mechanism, and the same with unusual names."""
    mechanism = example.mechanism
    names = new_names(mechanism, example.chance, version)
    joint = joint_names(mechanism, names, version)
    return Pair(
        query_of(mechanism, version),
        query_of(renamed(mechanism, names), version),
        carry=lambda values, index: values_renamed(values, names, joint),
        carry_robot=lambda robot: robot_renamed(robot, names, joint),
    )


def joint_names(mechanism: Mechanism, names: Names, version: Version) -> Name:
    """New names of joints; in version 1 a universal joint is two joints, whose names contain its own."""
    if version == "2":
        return names.joint
    pairs = {name: name.removeprefix(joint) for joint in mechanism.changes for name in names1(mechanism, joint)}
    return lambda name: (
        names.joint(name.removesuffix(pairs[name])) + pairs[name] if pairs.get(name) else names.joint(name)
    )


def values_renamed(values: Values, names: Names, joint: Name) -> Values:
    """The same values with other names."""
    changed: dict[str, object] = {}
    if values.poses is not None:
        changed["poses"] = keyed(values.poses, names.frame)
    if values.residuals is not None:
        changed["residuals"] = keyed(values.residuals, names.closure)
    if (K := values.jacobian) is not None:
        columns = [(joint(name), i) for name, i in K.columns]
        changed["jacobian"] = Jacobian(columns=columns, rows=keyed(K.rows, names.closure))
    if (M := values.mass_matrix) is not None:
        changed["mass_matrix"] = MassMatrix(columns=[(joint(name), i) for name, i in M.columns], matrix=M.matrix)
    return values.model_copy(update=changed)


def robot_renamed(robot: CanonicalRobot, names: Names, joint: Name) -> CanonicalRobot:
    """The same canonical description under other names; what the mechanism does not name keeps the name it was given.

    That is a body that is none of links, and whatever a parser makes up.
    """
    link = names.link
    return robot.model_copy(
        update={
            "links": [link(name) for name in robot.links],
            "frames": [names.frames.get(name, name) for name in robot.frames],
            "joints": [
                each.model_copy(
                    update={
                        "name": joint(each.name),
                        "parent": link(each.parent),
                        "child": link(each.child),
                        "mimic": each.mimic and each.mimic.model_copy(update={"joint": joint(each.mimic.joint)}),
                    }
                )
                for each in robot.joints
            ],
            "closures": [
                each.model_copy(update={"name": names.closure(each.name), "a": link(each.a), "b": link(each.b)})
                for each in robot.closures
            ],
            "actuators": [each.model_copy(update={"joint": joint(each.joint)}) for each in robot.actuators],
            "configurations": {
                names.configurations.get(name, name): keyed(configuration, joint)
                for name, configuration in robot.configurations.items()
            },
            "own": {_pointer(pointer, joint): value for pointer, value in robot.own.items()},
        }
    )


def _pointer(pointer: str, joint: Name) -> str:
    """A JSON pointer to user data, which may contain the name of a joint."""
    match pointer.split("/"):
        case ["", "joints", name, *rest]:
            return "/".join([f"/joints{step(joint(key_of(name)))}", *rest])
    return pointer


PROPERTIES = (
    Property(
        "renaming",
        "Other names, in any script, change only the names.",
        ("EU-URD-011", "EU-FRM-004", "EU-FRM-005", "EU-YML-011", "EU-YML-008"),
        (Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        related(renaming),
    ),
)
