"""All diagnostic codes: phase, severity, clause and title of each.

A code is permanent: once published it is never renamed and never used for another error. A code that begins with ``x-``
is advice of this parser (EU-DIA-006): a warning that no clause requires.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from typing import NamedTuple


class Phase(str, Enum):
    """The stage of the pipeline that reports an error; an error suppresses the later ones that it would cause."""

    __str__ = str.__str__

    YAML = "yaml"
    SCHEMA = "schema"
    URDF = "urdf"
    LINK = "link"
    SEMANTIC = "semantic"
    INERTIA = "inertia"
    CLOSURE = "closure"
    ADVICE = "advice"


#: Prefix of the codes of this parser's own warnings (EU-DIA-006).
OWN_PREFIX = "x-"

#: With errors of these phases a robot could only be built by guessing: ``eurdf.load`` refuses it.
REFUSED_PHASES = frozenset({Phase.YAML, Phase.SCHEMA, Phase.URDF, Phase.LINK, Phase.SEMANTIC})


class Severity(str, Enum):
    """An error violates a MUST of the specification; a warning violates a SHOULD, or is advice."""

    __str__ = str.__str__

    ERROR = "error"
    WARNING = "warning"


class Rule(NamedTuple):
    """One diagnostic code.

    Attributes:
        code: Its permanent name.
        phase: The phase that reports it.
        severity: Error or warning.
        clause: Id of the violated clause of the specification; None for advice of this parser.
        title: The error in general, as one sentence.
    """

    code: str
    phase: Phase
    severity: Severity
    clause: str | None
    title: str


#: The phases, and below each its codes; advice has neither clauses nor severities.
_TABLE = """
yaml:
file-unreadable            EU-FIL-001 error   The file cannot be read.
file-too-large             EU-FIL-002 error   The file is larger than the allowed maximum.
file-not-utf8              EU-FIL-003 error   The file is not UTF-8 text.
yaml-syntax                EU-YML-001 error   The file is not well-formed YAML.
yaml-empty                 EU-YML-002 error   The file does not contain a YAML mapping.
yaml-several-documents     EU-YML-003 error   The file contains more than one YAML document.
yaml-duplicate-key         EU-YML-004 error   A mapping has a duplicate key.
yaml-unknown-tag           EU-YML-005 error   A node has a tag that is not in the YAML 1.2 core schema.
yaml-alias                 EU-YML-006 error   An alias is undefined, recursive, or expands beyond the allowed size.
yaml-too-deep              EU-YML-007 error   Nodes are nested deeper than the allowed maximum.
yaml-key-not-string        EU-YML-008 error   A mapping key is not a string.
yaml-not-finite            EU-YML-009 error   A number is infinite or NaN.
yaml-version               EU-YML-010 error   A %YAML directive states a version other than 1.2.
schema:
unsupported-version        EU-VER-001 error   The file states an unknown version of Extended URDF.
unknown-key                EU-EXT-001 error   A mapping has a key that is not part of the format.
near-miss-key              EU-ONE-002 warning A user-defined key is similar to a key of the format.
missing-key                EU-SCH-001 error   A required key is missing.
wrong-type                 EU-SCH-002 error   A value has the wrong type.
wrong-length               EU-SCH-003 error   A list has the wrong length.
wrong-value                EU-SCH-004 error   A value is not one of the allowed values.
out-of-range               EU-SCH-005 error   A number is outside the allowed range.
conflicting-keys           EU-SCH-006 error   Two keys exclude each other.
urdf:
urdf-not-found             EU-FIL-004 error   The URDF file that the description names does not exist.
xml-syntax                 EU-URD-001 error   The file is not well-formed XML.
xml-doctype                EU-URD-002 error   The XML has a document type declaration.
urdf-root-element          EU-URD-003 error   The root element is not <robot>.
urdf-version               EU-URD-037 error   The robot states an unknown version of URDF.
urdf-missing-element       EU-URD-004 error   A required child element is missing.
urdf-missing-attribute     EU-URD-005 error   A required attribute is missing.
urdf-repeated-element      EU-URD-006 error   An element occurs more than once where only one is allowed.
urdf-bad-number            EU-URD-007 error   A numeric attribute does not contain the required finite numbers.
urdf-empty-name            EU-URD-008 error   A name is empty.
urdf-duplicate-link        EU-URD-009 error   Two links have the same name.
urdf-duplicate-joint       EU-URD-010 error   Two joints have the same name.
urdf-reserved-name         EU-URD-011 error   A link, joint or frame has a reserved name.
urdf-two-orientations      EU-URD-040 error   An <origin> has both rpy and quat_xyzw.
urdf-zero-quaternion       EU-URD-041 error   The quaternion of an <origin> is zero.
urdf-joint-type            EU-URD-012 error   A joint has an unknown type.
urdf-zero-axis             EU-URD-013 error   The axis of a moving joint is zero.
urdf-unknown-link          EU-URD-014 error   A joint names a link that does not exist.
urdf-no-link               EU-URD-015 error   The robot has no link.
urdf-two-parents           EU-URD-016 error   A link is the child of two joints.
urdf-cycle                 EU-URD-017 error   Joints form a cycle, so the robot is not a tree.
urdf-two-roots             EU-URD-018 error   More than one link has no parent.
urdf-reversed-limits       EU-URD-019 error   A lower limit is above the upper limit.
urdf-negative-limit        EU-URD-020 error   A limit of a rate or an effort, damping or friction is negative.
urdf-mimic-unknown         EU-URD-021 error   A joint mimics a joint that does not exist.
urdf-mimic-cycle           EU-URD-022 error   Joints mimic one another in a cycle.
urdf-mimic-kind            EU-URD-023 error   A mimic joint or its leader does not have exactly one coordinate.
urdf-mimic-fixed           EU-URD-036 warning A fixed joint has a <mimic>, which has no effect.
urdf-geometry              EU-URD-024 error   A geometry is not exactly one shape with valid dimensions.
urdf-no-range              EU-URD-025 warning A revolute or prismatic joint has the position limits 0 and 0.
urdf-unknown-element       EU-URD-026 warning An unknown element or attribute has a name similar to one of URDF.
urdf-later-version         EU-URD-038 warning The URDF has an attribute or a shape of a later version of URDF.
urdf-closure-ignored       EU-URD-027 warning The URDF contains a closure of another dialect, which has no effect.
urdf-mesh-missing          EU-URD-028 warning A mesh file is not found.
urdf-unknown-material      EU-URD-029 warning A material is used but not defined.
urdf-texture-missing       EU-URD-033 warning A texture names no file, or one that is not found.
urdf-mesh-unreadable       EU-URD-034 error   A mesh file cannot be read as a mesh.
urdf-planar-axis           EU-URD-030 warning The axis of a planar joint is not z, and is read as z.
link:
unknown-frame              EU-FRM-001 error   A name is not a link, joint or frame of the robot.
ambiguous-frame            EU-FRM-002 error   A name refers to two different frames.
duplicate-frame            EU-FRM-003 error   The name of a frame is already in use.
duplicate-closure-name     EU-CLO-001 error   Two closures have the same name.
closure-same-frame         EU-CLO-002 error   A closure connects a frame with itself.
closure-same-body          EU-CLO-003 error   A closure connects two frames that cannot move relative to each other.
closure-duplicate          EU-CLO-004 error   Two closures connect the same two frames.
duplicate-coupling-name    EU-CPL-001 error   A coupling has the name of a closure or of another coupling.
unknown-coupled-joint      EU-CPL-002 error   A coupling names a joint that does not exist.
unknown-joint              EU-JNT-001 error   A name is not a joint of the robot.
unknown-actuator           EU-ACT-001 error   An actuator names a joint that does not exist.
own-key-is-joint           EU-EXT-003 warning A user-defined key is the name of a joint, but has no effect on it.
length-mismatch            EU-ONE-003 error   Two corresponding lists have different lengths.
duplicate-actuator-name    EU-ACT-008 error   Two actuators have the same name.
duplicate-replacement      EU-JNT-002 error   A joint is changed or merged more than once.
duplicate-joint-name       EU-JNT-003 error   The name of a joint that the description creates is already in use.
semantic:
actuator-immobile          EU-ACT-002 error   An actuated joint cannot move.
actuator-duplicate         EU-ACT-003 error   A joint is listed as an actuator twice.
actuator-mimic             EU-ACT-004 error   An actuated joint is a mimic joint.
actuator-merged            EU-ACT-005 error   An actuated joint was merged into another.
actuator-control-reversed  EU-ACT-009 error   The lower bound of a control range is above the upper bound.
joint-mimics               EU-JNT-004 error   A mimic joint is changed or merged, or its leader is replaced or merged.
joint-not-mimic            EU-JNT-033 error   A joint is freed that mimics no other.
joint-kind                 EU-JNT-005 error   The type of a joint does not allow this replacement.
joint-axis-zero            EU-JNT-006 error   An axis of a universal joint is zero.
joint-axes-parallel        EU-JNT-007 error   Two axes of a universal joint, or of joints to merge, are parallel.
joint-pitch-zero           EU-JNT-008 error   The pitch of a helical joint is zero.
number-out-of-bounds       EU-FIL-005 error   A number is larger or smaller than the bounds allow.
joint-property             EU-JNT-009 error   A property does not fit the type of the joint.
joint-limits-reversed      EU-JNT-010 error   A lower limit is above the upper limit.
merge-not-chain            EU-JNT-011 error   Joints to merge are not a chain of three rotary joints.
merge-inertia              EU-JNT-012 error   A link between joints to merge has mass.
merge-closure-frame        EU-JNT-013 error   A closure has a frame on a link between joints to merge.
merge-axes                 EU-JNT-014 error   The axes of joints to merge do not intersect in one point.
configuration-joint        EU-CFG-001 error   A configuration names a joint without coordinates.
configuration-length       EU-CFG-002 error   A configuration has the wrong number of coordinates for a joint.
configuration-quaternion   EU-CFG-003 error   A quaternion does not have unit length.
configuration-limits       EU-CFG-004 error   A coordinate is outside the limits of its joint.
closure-compliance         EU-CLO-020 error   A closure without orientation has an angular compliance.
closure-axis-zero          EU-CLO-013 error   An axis of a hinge is zero.
coupling-joint             EU-CPL-003 error   A coupled joint does not have exactly one coordinate of its own.
coupling-duplicate         EU-CPL-004 error   A coupling is a multiple of another one.
closure-type-unknown       EU-CLO-007 warning A closure has a user-defined type and is not part of the model.
inertia:
negative-mass              EU-INR-001 error   A mass is negative.
inertia-not-psd            EU-INR-002 error   A rotational inertia is not positive semidefinite.
inertia-triangle           EU-INR-003 warning The principal moments of an inertia violate the triangle inequality.
leaf-without-inertia       EU-INR-004 error   The last moving link of a chain has no mass or no inertia about its joint.
closure:
assembled-open             EU-CLO-005 error   A closure is open at the assembled configuration.
closure-cannot-close       EU-CLO-006 error   No configuration closes the loops.
advice:
x-angle-in-degrees         An angle is probably in degrees, because it is large.
x-length-in-millimetres    A length is probably in millimetres, because it is large.
x-tiny-robot               No length of a robot with closures reaches a millimetre.
x-open-at-neutral          The loops are open at neutral, and one change closes them exactly there.
x-quaternion-order         A quaternion is probably in the order w, x, y, z.
x-near-assembled           A configuration has nearly the name 'assembled', which none has.
x-no-closure               A robot with actuators has no closure, but frames that are probably those of one.
x-no-actuator              A robot with closures has no actuator.
x-actuator-several         An actuated joint has several velocities; a motor has one.
x-shaky-loops              Loops are rigid: they cannot move, or to first order only.
x-dependent-actuators      Actuators cannot move independently, or cannot move at all.
x-uncontrolled-motion      A motion other than the spin of a rod remains when every actuator is held.
x-motor-not-actuated       A joint that is named as a motor is not actuated, and another of its loop is.
x-closes-beyond-limits     The loops close only with joints beyond their limits.
x-mimic-ignored            A joint with a <mimic> moves freely: it has no actuator, and version 1 ignores <mimic>.
x-massless-link            A link of a loop has no mass.
x-implausible-inertia      A mass or moments of inertia are probably in another unit, or missing.
x-implausible-drive        A limit, a gear ratio or a rotor inertia of a joint is probably in another unit, or missing.
x-implausible-mimic        A mimic joint moves beyond its own limits for most of the range of its leader.
x-asymmetric               Left and right differ in a value, although most of their values agree.
x-other-format             A YAML file states closures for another program.
x-xacro-warning            A xacro file was expanded with warnings.
x-urdf-outside-folder      The URDF that a description names is outside the folder of the description.
x-file-outside-folder      A mesh or texture is outside the folder of the robot and the packages that are given.
x-mesh-format              A mesh has a format that this parser does not read.
x-loops-not-checked        The loops were not checked in full: there are too many, or too many of them share joints.
"""


def _rules() -> Iterator[Rule]:
    for row in _TABLE.strip().splitlines():
        code, *more = row.split(maxsplit=1)
        if not more:
            phase = Phase(code.removesuffix(":"))
        elif phase is Phase.ADVICE:
            yield Rule(code, phase, Severity.WARNING, None, *more)
        else:
            clause, severity, title = more[0].split(maxsplit=2)
            yield Rule(code, phase, Severity(severity), clause, title)


#: Every rule by its code.
REGISTRY: dict[str, Rule] = {rule.code: rule for rule in _rules()}
