"""Errors that can be put into the files of any mechanism: each is one replacement of text, with its code and place."""

from __future__ import annotations

import re
from dataclasses import dataclass

from eurdf_conformance.level import Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.files import DESCRIPTION, URDF

#: In `Fault.text`: the place of the diagnostic.
_PLACE = "¦"

#: A block mapping, to its end; and the axis of a joint that has one.
_END = r"(?ms)^(\w+:.*?)\s*\Z"
_AXIS = r'(?s)(<joint name="\w+" type="(?:revolute|continuous|prismatic)">(?:(?!</joint>).)*?<axis xyz=")[^"]+"'

_TWO: tuple[Version, ...] = ("2",)
_BOTH: tuple[Version, ...] = ("1", "2")


@dataclass(frozen=True, slots=True)
class Fault:
    """One error.

    Attributes:
        name: What is wrong, in words.
        code: Code of its diagnostic.
        file: The file that has it.
        pattern: Regular expression of the text that is replaced, in any of the places where it occurs.
        text: The replacement, as `re.Match.expand` reads it; a broken bar is before the place of the diagnostic.
        fix: What to do about it.
        versions: Versions of the format of the descriptions that can have it.
    """

    name: str
    code: str
    file: str
    pattern: str
    text: str
    fix: str
    versions: tuple[Version, ...] = _BOTH


@dataclass(frozen=True, slots=True)
class Faulty:
    """A file with one error: its text, and the line and column of the diagnostic, from 1."""

    fault: Fault
    text: str
    line: int
    column: int


FAULTS = (
    Fault(
        "unknown parent", "urdf-unknown-link", URDF, r'<parent link="(\w+)', r'<parent link="¦\1_gone', "Name a link."
    ),
    Fault(
        "second link of a name",
        "urdf-duplicate-link",
        URDF,
        r'(?s)(<link name="(\w+)".*)(</robot>)',
        r'\1<link name="¦\2" />\3',
        "Give the link another name.",
    ),
    Fault(
        "second root", "urdf-two-roots", URDF, "(</robot>)", r'<link name="¦loose" />\1', "Connect the link by a joint."
    ),
    Fault(
        "number with a unit",
        "urdf-bad-number",
        URDF,
        r'<mass value="([^"]+)"',
        r'<mass value="¦\1kg"',
        "Write the number alone.",
    ),
    Fault(
        "unknown joint type",
        "urdf-joint-type",
        URDF,
        r'(<joint name="\w+" type=")\w+',
        r"\1¦rotary",
        "Write a type of URDF.",
    ),
    Fault(
        "no child",
        "urdf-missing-element",
        URDF,
        r'(?s)(<joint name="\w+")((?:(?!</joint>).)*?)<child link="\w+" />',
        r"¦\1\2",
        "Name the child.",
    ),
    Fault("open element", "xml-syntax", URDF, r"</robot>\s*\Z", r"¦", "Close the element."),
    Fault("negative effort", "urdf-negative-limit", URDF, r'effort="[^"]+"', r'effort="¦-1.0"', "Write the magnitude."),
    Fault("zero axis", "urdf-zero-axis", URDF, _AXIS, r'\1¦0 0 0"', "Write a direction."),
    Fault(
        "text that is not finite",
        "urdf-bad-number",
        URDF,
        r'<mass value="[^"]+"',
        r'<mass value="¦inf"',
        "Write a number.",
    ),
    Fault("unknown key", "unknown-key", DESCRIPTION, _END, r"\1\n¦closurs: []\n", "Write `closures`.", _TWO),
    Fault(
        "second key of a name",
        "yaml-duplicate-key",
        DESCRIPTION,
        r"(?m)^(\w+)(:(?s:.*))\Z",
        r"\1\2¦\1: 1\n",
        "Remove one.",
    ),
    Fault("open bracket", "yaml-syntax", DESCRIPTION, _END, r"\1\n¦x-more: [1, 2\n", "Close the bracket."),
    Fault("second document", "yaml-several-documents", DESCRIPTION, _END, r"\1\n¦---\nx-more: 1\n", "Remove it."),
    Fault("unknown tag", "yaml-unknown-tag", DESCRIPTION, _END, r"\1\nx-more: ¦!own 1\n", "Remove the tag."),
    Fault("unknown alias", "yaml-alias", DESCRIPTION, _END, r"\1\nx-more: ¦*gone\n", "Set the anchor."),
    Fault(
        "unknown version",
        "unsupported-version",
        DESCRIPTION,
        r'extended_urdf: "2.0"',
        'extended_urdf: ¦"3.7"',
        "Write 2.0.",
        _TWO,
    ),
    Fault("closure of no type", "wrong-value", DESCRIPTION, r'type: "[36]d"', 'type: ¦"4d"', "Write 3d or 6d.", _TWO),
    Fault(
        "unknown frame", "unknown-frame", DESCRIPTION, r"(frames: \[.*, )(\w+)\]", r"\1¦\2_gone]", "Name a frame.", _TWO
    ),
    Fault(
        "unknown frame",
        "unknown-frame",
        DESCRIPTION,
        r"(?m)^(  - \[\w+, )(\w+)\]$",
        r"\1¦\2_gone]",
        "Name a frame.",
        ("1",),
    ),
    Fault(
        "unknown actuated joint",
        "unknown-actuator",
        DESCRIPTION,
        r"(name_mot: \[)(\w+)",
        r"\1¦\2_gone",
        "Name a joint.",
        ("1",),
    ),
    Fault(
        "unknown actuated joint",
        "unknown-actuator",
        DESCRIPTION,
        r"(  - \{joint: |actuators: \[)(\w+)",
        r"\1¦\2_gone",
        "Name a joint.",
        _TWO,
    ),
    Fault(
        "root of no kind",
        "wrong-value",
        DESCRIPTION,
        r'(extended_urdf: "2.0"\n)(?:root: floating\n)?',
        r"\1root: ¦moving\n",
        "Write fixed or floating.",
        _TWO,
    ),
    Fault(
        "number that is not finite",
        "yaml-not-finite",
        DESCRIPTION,
        r"gear_ratio: [^,}]+",
        "gear_ratio: ¦.inf",
        "Write a number.",
        _TWO,
    ),
    Fault(
        "unknown joint in a configuration",
        "configuration-joint",
        DESCRIPTION,
        r"(  (?:assembled|open): \{)(\w+:)",
        r"\1¦nowhere: 0.1, \2",
        "Name a joint.",
        _TWO,
    ),
    Fault(
        "unknown joint", "unknown-joint", DESCRIPTION, r"(joints:\n)", r"\1  ¦nowhere: fixed\n", "Name a joint.", _TWO
    ),
)


def with_fault(fault: Fault, text: str, chance: Chance) -> Faulty | None:
    """The text of a file with an error, in one of the places that can have it; None if there is none."""
    found = list(re.finditer(fault.pattern, text))
    if not found:
        return None
    match = chance.one_of(found)
    wrong = text[: match.start()] + match.expand(fault.text) + text[match.end() :]
    before, _, after = wrong.partition(_PLACE)
    return Faulty(fault, before + after, before.count("\n") + 1, len(before) - before.rfind("\n"))
