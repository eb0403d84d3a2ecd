"""The errors that can be put into the files of any mechanism."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.fresh.fault import Fault, Subject
from eurdf_conformance.fresh.faults2_1 import FAULTS_2_1
from eurdf_conformance.fresh.kind import FreshKind
from eurdf_conformance.level import Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.files import DESCRIPTION, URDF
from eurdf_conformance.properties.mechanism import Pose, Vector
from eurdf_conformance.properties.placement import matrix_of

#: A block mapping, to its end; and the axis of a joint that has one.
_END = r"(?ms)^(\w+:.*?)\s*\Z"
_AXIS = r'(?s)(<joint name="\w+" type="(?:revolute|continuous|prismatic)">(?:(?!</joint>).)*?<axis xyz=")[^"]+"'

_TWO: tuple[Version, ...] = ("2", "2.1")

#: By which part of the largest principal moment an inertia departs from what is allowed: EU-INR-002, EU-INR-003 allow
#: 1e-6.
_LEAST, _MOST = 1e-5, 1e-1

FAULTS = (
    Fault(
        "unknown parent",
        Subject.DANGLING,
        "urdf-unknown-link",
        URDF,
        r'<parent link="(\w+)',
        r'<parent link="¦\1_gone',
        "Name a link.",
    ),
    Fault(
        "second link of a name",
        Subject.DUPLICATE,
        "urdf-duplicate-link",
        URDF,
        r'(?s)(<link name="(\w+)".*)(</robot>)',
        r'\1<link name="¦\2" />\3',
        "Give the link another name.",
    ),
    Fault(
        "second root",
        Subject.TREE,
        "urdf-two-roots",
        URDF,
        "(</robot>)",
        r'<link name="¦loose" />\1',
        "Connect the link by a joint.",
    ),
    Fault(
        "number with a unit",
        Subject.VALUE,
        "urdf-bad-number",
        URDF,
        r'<mass value="([^"]+)"',
        r'<mass value="¦\1kg"',
        "Write the number alone.",
    ),
    Fault(
        "unknown joint type",
        Subject.VALUE,
        "urdf-joint-type",
        URDF,
        r'(<joint name="\w+" type=")\w+',
        r"\1¦rotary",
        "Write a type of URDF.",
    ),
    Fault(
        "unknown version of URDF",
        Subject.VALUE,
        "urdf-version",
        URDF,
        r'<robot name="',
        r'<robot version="¦1.7" name="',
        "Write a version of URDF.",
    ),
    Fault(
        "no child",
        Subject.TREE,
        "urdf-missing-element",
        URDF,
        r'(?s)(<joint name="\w+")((?:(?!</joint>).)*?)<child link="\w+" />',
        r"¦\1\2",
        "Name the child.",
    ),
    Fault("open element", Subject.SYNTAX, "xml-syntax", URDF, r"</robot>\s*\Z", r"¦", "Close the element."),
    Fault(
        "negative effort",
        Subject.VALUE,
        "urdf-negative-limit",
        URDF,
        r'effort="[^"]+"',
        r'effort="¦-1.0"',
        "Write the magnitude.",
    ),
    Fault("zero axis", Subject.VALUE, "urdf-zero-axis", URDF, _AXIS, r'\1¦0 0 0"', "Write a direction."),
    Fault(
        "text that is not finite",
        Subject.VALUE,
        "urdf-bad-number",
        URDF,
        r'<mass value="[^"]+"',
        r'<mass value="¦inf"',
        "Write a number.",
    ),
    Fault(
        "unknown key", Subject.VALUE, "unknown-key", DESCRIPTION, _END, r"\1\n¦closurs: []\n", "Write `closures`.", _TWO
    ),
    Fault(
        "second key of a name",
        Subject.DUPLICATE,
        "yaml-duplicate-key",
        DESCRIPTION,
        r"(?m)^(\w+)(:(?s:.*))\Z",
        r"\1\2¦\1: 1\n",
        "Remove one.",
    ),
    Fault(
        "open bracket", Subject.SYNTAX, "yaml-syntax", DESCRIPTION, _END, r"\1\n¦x-more: [1, 2\n", "Close the bracket."
    ),
    Fault(
        "second document",
        Subject.SYNTAX,
        "yaml-several-documents",
        DESCRIPTION,
        _END,
        r"\1\n¦---\nx-more: 1\n",
        "Remove it.",
    ),
    Fault(
        "unknown tag",
        Subject.SYNTAX,
        "yaml-unknown-tag",
        DESCRIPTION,
        _END,
        r"\1\nx-more: ¦!own 1\n",
        "Remove the tag.",
    ),
    Fault("unknown alias", Subject.SYNTAX, "yaml-alias", DESCRIPTION, _END, r"\1\nx-more: ¦*gone\n", "Set the anchor."),
    Fault(
        "unknown version",
        Subject.VALUE,
        "unsupported-version",
        DESCRIPTION,
        r'extended_urdf: "2\.[01]"',
        'extended_urdf: ¦"3.7"',
        "Write a version of the format.",
        _TWO,
    ),
    Fault(
        "key of version 2.1",
        Subject.VALUE,
        "unknown-key",
        DESCRIPTION,
        _END,
        r"\1\n¦couplings: []\n",
        "Write version 2.1.",
        ("2",),
    ),
    Fault(
        "closure of no type",
        Subject.VALUE,
        "wrong-value",
        DESCRIPTION,
        r'type: "[36]d"',
        'type: ¦"4d"',
        "Write 3d or 6d.",
        _TWO,
    ),
    Fault(
        "unknown frame",
        Subject.DANGLING,
        "unknown-frame",
        DESCRIPTION,
        r"(frames: \[.*, )(\w+)\]",
        r"\1¦\2_gone]",
        "Name a frame.",
        _TWO,
    ),
    Fault(
        "unknown frame",
        Subject.DANGLING,
        "unknown-frame",
        DESCRIPTION,
        r"(?m)^(  - \[\w+, )(\w+)\]$",
        r"\1¦\2_gone]",
        "Name a frame.",
        ("1",),
    ),
    Fault(
        "unknown actuated joint",
        Subject.DANGLING,
        "unknown-actuator",
        DESCRIPTION,
        r"(name_mot: \[)(\w+)",
        r"\1¦\2_gone",
        "Name a joint.",
        ("1",),
    ),
    Fault(
        "unknown actuated joint",
        Subject.DANGLING,
        "unknown-actuator",
        DESCRIPTION,
        r"(  - \{joint: |actuators: \[)(\w+)",
        r"\1¦\2_gone",
        "Name a joint.",
        _TWO,
    ),
    Fault(
        "root of no kind",
        Subject.VALUE,
        "wrong-value",
        DESCRIPTION,
        r'(extended_urdf: "2\.[01]"\n)(?:root: floating\n)?',
        r"\1root: ¦moving\n",
        "Write fixed or floating.",
        _TWO,
    ),
    Fault(
        "number that is not finite",
        Subject.VALUE,
        "yaml-not-finite",
        DESCRIPTION,
        r"gear_ratio: [^,}]+",
        "gear_ratio: ¦.inf",
        "Write a number.",
        _TWO,
    ),
    Fault(
        "unknown joint in a configuration",
        Subject.DANGLING,
        "configuration-joint",
        DESCRIPTION,
        r"(  (?:assembled|open): \{)(\w+:)",
        r"\1¦nowhere: 0.1, \2",
        "Name a joint.",
        _TWO,
    ),
    Fault(
        "unknown joint",
        Subject.DANGLING,
        "unknown-joint",
        DESCRIPTION,
        r"(joints:\n)",
        r"\1  ¦nowhere: fixed\n",
        "Name a joint.",
        _TWO,
    ),
    Fault(
        "second joint of a name",
        Subject.DUPLICATE,
        "urdf-duplicate-joint",
        URDF,
        r'(?s)(<joint name="(\w+)".*?<parent link="(\w+)".*)(</robot>)',
        r'\1<link name="loose" /><joint name="¦\2" type="fixed"><parent link="\3" /><child link="loose" /></joint>\4',
        "Give the joint another name.",
    ),
    Fault(
        "link that hangs from itself",
        Subject.CYCLE,
        "urdf-cycle",
        URDF,
        r'(?s)(<joint name="\w+"(?:(?!<parent).)*<parent link=")\w+("\s*/>\s*<child link="(\w+)")',
        r"¦\1\3\2",
        "Name the link that it hangs from.",
    ),
    Fault(
        "link of two parents",
        Subject.TREE,
        "urdf-two-parents",
        URDF,
        r'(?s)(<parent link="(\w+)"\s*/>\s*<child link="(\w+)".*)(</robot>)',
        r'\1<joint name="second_parent" type="fixed"><parent link="\2" /><child link="¦\3" /></joint>\4',
        "Describe the loop as a closure.",
    ),
    Fault(
        "negative mass",
        Subject.INERTIA,
        "negative-mass",
        URDF,
        r'<mass value="[^"]+"',
        r'<mass value="¦-1e-06"',
        "Write the mass.",
        makes=FreshKind.EITHER,
    ),
    Fault(
        "negative principal moment",
        Subject.INERTIA,
        "inertia-not-psd",
        URDF,
        "<inertia [^>]*>",
        lambda chance: _inertia(chance, (1.0, 1.0, -_little(chance))),
        "Write the moments of a solid.",
        makes=FreshKind.EITHER,
    ),
    Fault(
        "moment larger than the sum of the other two",
        Subject.INERTIA,
        "inertia-triangle",
        URDF,
        "<inertia [^>]*>",
        lambda chance: _inertia(chance, (0.5, 0.4, 0.9 + _little(chance))),
        "Write the moments of a solid.",
        makes=FreshKind.WARNED,
    ),
    *FAULTS_2_1,
)


def _inertia(chance: Chance, principal: Vector) -> str:
    """An `<inertia>` with principal moments, kg·m², along random axes."""
    R = matrix_of(Pose(rpy=(chance.between(-3.0, 3.0), chance.between(-1.5, 1.5), chance.between(-3.0, 3.0))))[:3, :3]
    xx, xy, xz, yy, yz, zz = (R @ np.diag(principal) @ R.T)[np.triu_indices(3)].tolist()
    return f'¦<inertia ixx="{xx!r}" ixy="{xy!r}" ixz="{xz!r}" iyy="{yy!r}" iyz="{yz!r}" izz="{zz!r}" />'


def _little(chance: Chance) -> float:
    """A part of a moment, from almost nothing to a tenth, evenly in its logarithm."""
    return float(_LEAST * (_MOST / _LEAST) ** chance.between(0.0, 1.0))
