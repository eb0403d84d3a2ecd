"""A mechanism in version 1 of the format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eurdf.format.yaml_text import Value, YamlEntry, lines_of, modeline, text_of
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism


def can_be_version_1(mechanism: Mechanism) -> bool:
    """Whether version 1 has every constraint of a mechanism: the robot moves as in version 2."""
    return not mechanism.couplings and all(closure.type in ("3d", "6d") for closure in mechanism.closures)


def version_1_text(mechanism: Mechanism, schema: str, comments: Sequence[str]) -> str:
    """The description in version 1, without what that cannot say: `NOT_IN_VERSION_1` of the quality rules.

    Args:
        mechanism: One that `can_be_version_1`; its closures are between named frames, and the axes of its universal
            joints are x and y.
        schema: Path of the schema, for the first line.
        comments: Lines of text below it.
    """
    types = {JointType.SPHERICAL: "SPHERICAL", JointType.UNIVERSAL: "UJOINT_XY"}
    replaced = {joint.name: types[joint.type] for joint in mechanism.joints if joint.type in types}
    content: Mapping[str, Value] = {
        "closed_loop": [[anchor.frame for anchor in closure.anchors] for closure in mechanism.closures],
        "type": [closure.type for closure in mechanism.closures],
        "name_mot": mechanism.actuators,
        "joint_name": list(replaced),
        "joint_type": list(replaced.values()),
    }
    first, *rest = (YamlEntry(lines_of(key, value)) for key, value in content.items() if value or key == "closed_loop")
    head = (modeline(schema), *(f"# {line}" for line in comments))
    return text_of([YamlEntry(first.lines, head), *rest])
