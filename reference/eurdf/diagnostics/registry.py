"""Every diagnostic code there is: its phase, its severity, the clause it enforces, what it says in general.

A code is permanent: once published it is never renamed and never used for another fault. A code that begins with ``x-``
is advice of this parser alone (EU-DIA-006): a warning that no clause asks for.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Phase(StrEnum):
    """Where in the pipeline a fault is found; an error of one phase keeps the later ones from cascading."""

    YAML = "yaml"
    SCHEMA = "schema"
    URDF = "urdf"
    LINK = "link"
    SEMANTIC = "semantic"
    INERTIA = "inertia"
    CLOSURE = "closure"
    ADVICE = "advice"


#: What the codes of this parser's own warnings begin with (EU-DIA-006).
OWN_PREFIX = "x-"

#: Errors of these phases leave nothing that could be built without guessing: ``eurdf.load`` refuses them.
REFUSED_PHASES = frozenset({Phase.YAML, Phase.SCHEMA, Phase.URDF, Phase.LINK, Phase.SEMANTIC})


class Severity(StrEnum):
    """How bad a finding is: an error is against a MUST of the specification, a warning against a SHOULD or advice."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Rule:
    """What one diagnostic code stands for.

    Attributes:
        code: Its permanent name.
        phase: The phase that finds it.
        severity: Error or warning.
        clause: Id of the clause of the specification that is not met; None for advice of this parser.
        title: What it says in general, as one sentence.
    """

    code: str
    phase: Phase
    severity: Severity
    clause: str | None
    title: str


def _rules(phase: Phase, rows: str) -> list[Rule]:
    rules = []
    for row in rows.strip().splitlines():
        code, clause, severity, title = row.split(maxsplit=3)
        rules.append(Rule(code, phase, Severity(severity), clause, title))
    return rules


def _advice(rows: str) -> list[Rule]:
    """Warnings of this parser alone: a code with `OWN_PREFIX`, and a title (EU-DIA-006)."""
    pairs = (row.split(maxsplit=1) for row in rows.strip().splitlines())
    return [Rule(code, Phase.ADVICE, Severity.WARNING, None, title) for code, title in pairs]


_TABLE = [
    *_rules(
        Phase.YAML,
        """
file-unreadable            EU-FIL-001 error   The file cannot be read.
file-too-large             EU-FIL-002 error   The file is larger than a description may be.
file-not-utf8              EU-FIL-003 error   The file is not UTF-8 text.
yaml-syntax                EU-YML-001 error   The file is not well-formed YAML.
yaml-empty                 EU-YML-002 error   The file holds no YAML mapping.
yaml-several-documents     EU-YML-003 error   The file holds more than one YAML document.
yaml-duplicate-key         EU-YML-004 error   A mapping has the same key twice.
yaml-unknown-tag           EU-YML-005 error   A node has a tag that the YAML 1.2 core schema does not know.
yaml-alias                 EU-YML-006 error   An alias is undefined, contains itself, or expands beyond the bound.
yaml-too-deep              EU-YML-007 error   Nodes are nested deeper than the bound.
yaml-key-not-string        EU-YML-008 error   A mapping key is not a string.
yaml-not-finite            EU-YML-009 error   A number is infinite or not a number.
yaml-version               EU-YML-010 error   A %YAML directive asks for another version than 1.2.
""",
    ),
    *_rules(
        Phase.SCHEMA,
        """
unsupported-version        EU-VER-001 error   The file says a version of Extended URDF that is not known.
unknown-key                EU-EXT-001 error   A mapping has a key that the format does not have.
near-miss-key              EU-ONE-002 warning A key of the user's own is nearly a key of the format.
missing-key                EU-SCH-001 error   A mapping lacks a key that it must have.
wrong-type                 EU-SCH-002 error   A value is of another type than it must be.
wrong-length               EU-SCH-003 error   A list is shorter or longer than it must be.
wrong-value                EU-SCH-004 error   A value is none of those allowed.
out-of-range               EU-SCH-005 error   A number is outside the range allowed.
conflicting-keys           EU-SCH-006 error   Two keys stand together that exclude one another.
""",
    ),
    *_rules(
        Phase.URDF,
        """
urdf-not-found             EU-FIL-004 error   The URDF file that the description names does not exist.
xml-syntax                 EU-URD-001 error   The file is not well-formed XML.
xml-doctype                EU-URD-002 error   The XML has a document type declaration.
urdf-root-element          EU-URD-003 error   The root element is not <robot>.
urdf-missing-element       EU-URD-004 error   An element lacks a child element that it must have.
urdf-missing-attribute     EU-URD-005 error   An element lacks an attribute that it must have.
urdf-repeated-element      EU-URD-006 error   An element stands twice where only one may stand.
urdf-bad-number            EU-URD-007 error   An attribute is not the finite number, or numbers, that it must be.
urdf-empty-name            EU-URD-008 error   A name is empty.
urdf-duplicate-link        EU-URD-009 error   Two links have the same name.
urdf-duplicate-joint       EU-URD-010 error   Two joints have the same name.
urdf-reserved-name         EU-URD-011 error   A name is one that the model needs for itself.
urdf-joint-type            EU-URD-012 error   A joint has a type that URDF does not have.
urdf-zero-axis             EU-URD-013 error   The axis of a moving joint has no direction.
urdf-unknown-link          EU-URD-014 error   A joint names a link that does not exist.
urdf-no-link               EU-URD-015 error   The robot has no link.
urdf-two-parents           EU-URD-016 error   A link is the child of two joints.
urdf-cycle                 EU-URD-017 error   Joints form a cycle, so that the robot is no tree.
urdf-two-roots             EU-URD-018 error   More than one link has no parent.
urdf-reversed-limits       EU-URD-019 error   A lower limit is above the upper one.
urdf-negative-limit        EU-URD-020 error   A limit of velocity or effort, a damping or a friction is negative.
urdf-mimic-unknown         EU-URD-021 error   A joint mimics a joint that does not exist.
urdf-mimic-cycle           EU-URD-022 error   Joints mimic one another in a cycle.
urdf-mimic-kind            EU-URD-023 error   A joint mimics, or is mimicked, that has not exactly one coordinate.
urdf-mimic-fixed           EU-URD-036 warning A fixed joint mimics another, which has no effect.
urdf-geometry              EU-URD-024 error   A geometry is not one shape of positive size.
urdf-no-range              EU-URD-025 warning A revolute or prismatic joint has the range 0 to 0, which is no range.
urdf-unknown-element       EU-URD-026 warning An element or attribute is nearly one that URDF has.
urdf-closure-ignored       EU-URD-027 warning The URDF says a closure in a dialect that is not part of this format.
urdf-mesh-missing          EU-URD-028 warning A mesh file is not found.
urdf-unknown-material      EU-URD-029 warning A material is used but not defined.
urdf-texture-missing       EU-URD-033 warning A texture file is not found.
urdf-mesh-unreadable       EU-URD-034 error   A mesh file is no mesh.
urdf-planar-axis           EU-URD-030 warning The axis of a planar joint is not its z, along which it is read.
""",
    ),
    *_rules(
        Phase.LINK,
        """
unknown-frame              EU-FRM-001 error   A name is no link, joint or frame of the robot.
ambiguous-frame            EU-FRM-002 error   A name stands for two different frames.
duplicate-frame            EU-FRM-003 error   A frame has a name that is taken.
duplicate-closure-name     EU-CLO-001 error   Two closures have the same name.
closure-same-frame         EU-CLO-002 error   A closure joins a frame to itself.
closure-same-body          EU-CLO-003 error   A closure joins two frames that cannot move against each other.
closure-duplicate          EU-CLO-004 error   Two closures join the same two frames.
unknown-joint              EU-JNT-001 error   A name is no joint of the robot.
unknown-actuator           EU-ACT-001 error   An actuator names a joint that does not exist.
own-key-is-joint           EU-EXT-003 warning A key of the user's own is the name of a joint, and says nothing of it.
length-mismatch            EU-ONE-003 error   Two lists that go together have different lengths.
duplicate-replacement      EU-JNT-002 error   A joint is listed twice.
duplicate-joint-name       EU-JNT-003 error   A joint that the description makes has a name that is taken.
""",
    ),
    *_rules(
        Phase.SEMANTIC,
        """
actuator-immobile          EU-ACT-002 error   An actuated joint cannot move.
actuator-duplicate         EU-ACT-003 error   A joint is actuated twice.
actuator-mimic             EU-ACT-004 error   An actuated joint mimics another.
actuator-merged            EU-ACT-005 error   An actuated joint was merged into another.
joint-mimics               EU-JNT-004 error   A joint that mimics, or is mimicked, cannot be replaced.
joint-kind                 EU-JNT-005 error   A joint is of a kind that cannot be replaced so.
joint-axis-zero            EU-JNT-006 error   An axis has no direction.
joint-axes-parallel        EU-JNT-007 error   Axes that must differ are parallel.
joint-pitch-zero           EU-JNT-008 error   A helical joint has no pitch.
joint-property             EU-JNT-009 error   A property does not fit the type of the joint.
joint-limits-reversed      EU-JNT-010 error   A lower limit is above the upper one.
merge-not-chain            EU-JNT-011 error   Joints to merge are no chain of three rotary joints.
merge-inertia              EU-JNT-012 error   A link between joints to merge has inertia.
merge-closure-frame        EU-JNT-013 error   A link between joints to merge carries a closure frame.
merge-axes                 EU-JNT-014 error   The axes of joints to merge do not meet in one point.
configuration-joint        EU-CFG-001 error   A configuration names a joint that has no coordinate.
configuration-length       EU-CFG-002 error   A configuration has too few or too many coordinates for a joint.
configuration-quaternion   EU-CFG-003 error   A quaternion is not of unit length.
configuration-limits       EU-CFG-004 error   A coordinate is outside the limits of its joint.
closure-type-unknown       EU-CLO-007 warning A closure has a type of the user's own, and is left out of the model.
""",
    ),
    *_rules(
        Phase.INERTIA,
        """
negative-mass              EU-INR-001 error   A mass is negative.
inertia-not-psd            EU-INR-002 error   A rotational inertia is not positive semidefinite.
inertia-triangle           EU-INR-003 warning The principal moments of an inertia break the triangle inequality.
leaf-without-inertia       EU-INR-004 error   A moving leaf of the tree has no mass, or no inertia about its joint.
""",
    ),
    *_rules(
        Phase.CLOSURE,
        """
assembled-open             EU-CLO-005 error   A closure is open at the assembled configuration.
closure-cannot-close       EU-CLO-006 error   No configuration closes the loops.
""",
    ),
    *_advice(
        """
x-angle-in-degrees         An angle is so large that it is likely in degrees.
x-length-in-millimetres    A length is so large that it is likely in millimetres.
x-quaternion-order         A quaternion is likely written w first.
x-no-actuator              A robot with closures has no actuator.
x-dependent-actuators      Actuators cannot move independently of one another, or at all.
x-uncontrolled-motion      A motion is possible with every actuator held that is not the spin of a rod.
x-closes-beyond-limits     The loops close only where joints are beyond their limits.
x-mimic-ignored            A mimic joint moves by itself, since version 1 ignores mimics, and has no motor.
x-massless-link            A link of a loop has no mass.
x-xacro-warning            A xacro file was expanded with warnings.
x-loops-not-checked        The loops were not checked in full: too many of them share joints.
""",
    ),
]

#: Every rule by its code.
REGISTRY: dict[str, Rule] = {rule.code: rule for rule in _TABLE}
