"""Errors in what version 2.1 adds to a description."""

from __future__ import annotations

from eurdf_conformance.fresh.fault import Fault, Subject
from eurdf_conformance.properties.files import DESCRIPTION


def _fault(name: str, subject: Subject, code: str, pattern: str, text: str, fix: str) -> Fault:
    return Fault(name, subject, code, DESCRIPTION, pattern, text, fix, ("2.1",))


def _without(key: str) -> str:
    """A description without a key at its top, to its end."""
    return rf"(?ms)\A((?!.*^{key}:).*?)\s*\Z"


def _only_coupling(what: str, code: str, keys: str, fix: str) -> Fault:
    """An error in a coupling that is added to a description without one."""
    text = rf"\1\ncouplings:\n  - {{name: only, {keys}}}\n"
    return _fault(f"{what} in the only coupling", Subject.COUPLING, code, _without("couplings"), text, fix)


FAULTS_2_1 = (
    # Closures
    _fault(
        "axis that is zero",
        Subject.CLOSURE,
        "closure-axis-zero",
        r"axis: \[[^]]+\]",
        "axis: ¦[0, 0.0, -0.0]",
        "Write a direction.",
    ),
    _fault(
        "second axis that is zero",
        Subject.CLOSURE,
        "closure-axis-zero",
        r"(type: hinge, .*axes: \[\[[^]]+\]), \[[^]]+\]",
        r"\1, ¦[0, 0, 0]",
        "Write a direction.",
    ),
    _fault(
        "axis of a closure that is no hinge",
        Subject.CLOSURE,
        "conflicting-keys",
        r'(type: (?:"[36]d"|distance), )',
        r"\1¦axis: [0, 0, 1], ",
        "Remove it.",
    ),
    _fault(
        "length of a hinge",
        Subject.CLOSURE,
        "conflicting-keys",
        "(type: hinge, )",
        r"\1¦length: 0.1, ",
        "Remove it.",
    ),
    _fault(
        "length that is 0",
        Subject.CLOSURE,
        "out-of-range",
        r"length: [^,}]+",
        "length: ¦0.0",
        "Write a length.",
    ),
    _fault(
        "distance without a length",
        Subject.CLOSURE,
        "missing-key",
        r"\{(name: \w+, type: distance, .*), length: [^,}]+",
        r"¦{\1",
        "Write its length.",
    ),
    _fault(
        "angular compliance of a point",
        Subject.CLOSURE,
        "closure-compliance",
        r'(type: (?:"3d"|distance), .*compliance: \{linear: [^}]+)',
        r"\1, angular: ¦0.1",
        "Remove it.",
    ),
    _fault(
        "negative compliance",
        Subject.CLOSURE,
        "out-of-range",
        r"compliance: \{linear: [^,}]+",
        "compliance: {linear: ¦-0.001",
        "Write its size.",
    ),
    _fault(
        "short distance, of a tree",
        Subject.CLOSURE,
        "out-of-range",
        _without("closures"),
        r"\1\nclosures:\n  - {name: short, type: distance, frames: [one, other], length: ¦1e-05}\n",
        "Write a length.",
    ),
    # Couplings
    _fault(
        "unknown coupled joint",
        Subject.COUPLING,
        "unknown-coupled-joint",
        r"(name: coupling_\d, joints: \{)(\w+)",
        r"\1¦\2_gone",
        "Name a joint.",
    ),
    _only_coupling("zero coefficient", "out-of-range", "joints: {one: 1.0, other: ¦0.0}", "Write a coefficient."),
    _only_coupling("only one joint", "wrong-length", "joints: ¦{one: 1.0}", "Name another joint."),
    _only_coupling("unknown key", "unknown-key", "joints: {one: 1, other: 2}, ¦sum: 0", "Write `offset`."),
    _only_coupling("text as coefficient", "wrong-type", 'joints: {one: 1, other: ¦"2"}', "Write a number."),
    _only_coupling("list of joints", "wrong-type", "joints: ¦[one, other]", "Write the coefficients."),
    _fault(
        "unknown joint in the only coupling",
        Subject.COUPLING,
        "unknown-coupled-joint",
        # A number in a configuration is the coordinate of a joint that can be coupled.
        r"(?ms)\A((?!.*^couplings:).*assembled: \{(?:[^\n]*, )?(joint\w+): -?[\d.e-]+[,}].*?)\s*\Z",
        r"\1\ncouplings:\n  - {name: only, joints: {\2: 1.0, ¦nowhere: 2.0}}\n",
        "Name a joint.",
    ),
    _fault(
        "coefficient that is 0",
        Subject.COUPLING,
        "out-of-range",
        r"(name: coupling_\d, joints: \{\w+: )[^,}]+",
        r"\1¦-0.0",
        "Leave out the joint.",
    ),
    _fault(
        "coupling of one joint",
        Subject.COUPLING,
        "wrong-length",
        r"(name: coupling_\d, joints: )(\{\w+: [^,}]+)[^}]*\}",
        r"\1¦\2}",
        "Name another joint.",
    ),
    _fault(
        "coupling twice",
        Subject.COUPLING,
        "coupling-duplicate",
        r"(  - )(\{name: coupling_\d)(, joints: \{[^}]+\})(.*\n)",
        r"\1\2\3\4\1¦\2_again\3, offset: 7.0}\n",
        "Remove one.",
    ),
    _fault(
        "coupling of the name of a closure",
        Subject.COUPLING,
        "duplicate-coupling-name",
        r"(?s)(name: (closure_\d).*)name: coupling_\d",
        r"\1name: ¦\2",
        "Give it another name.",
    ),
    _fault(
        "unknown key of a coupling",
        Subject.COUPLING,
        "unknown-key",
        r"(name: coupling_\d, )",
        r"\1¦factor: 2, ",
        "Remove it.",
    ),
    # Springs, and joints that are freed
    _fault(
        "negative stiffness",
        Subject.SPRING,
        "out-of-range",
        r"stiffness: (\[?)[^][,}]+",
        r"stiffness: \1¦-1.5",
        "Write the stiffness.",
    ),
    _fault(
        "negative stiffness of another joint",
        Subject.SPRING,
        "out-of-range",
        r"(?m)^(joints:\n)",
        r"\1  one: {stiffness: ¦-2}\n",
        "Write the stiffness.",
    ),
    _fault(
        "negative stiffness of the only joint",
        Subject.SPRING,
        "out-of-range",
        _without("joints"),
        r"\1\njoints:\n  one: {stiffness: ¦-2}\n",
        "Write the stiffness.",
    ),
    _fault(
        "rest without a spring",
        Subject.SPRING,
        "missing-key",
        r"(?m)^(  \w+: )(\{(?:type: (?:uni|cyl|hel)|limits|damping|friction|armature)(?:(?!stiffness).)*)\}$",
        r"\1\2, ¦rest: 0.1}",
        "Write the stiffness.",
    ),
    _fault(
        "too many stiffnesses",
        Subject.SPRING,
        "joint-property",
        r"stiffness: (?:\[[^]]+\]|[^,}]+)",
        "stiffness: ¦[1.0, 2.0, 3.0]",
        "Write one for each coordinate.",
    ),
    _fault(
        "spring on a ball",
        Subject.SPRING,
        "joint-property",
        r"(?m)^(  \w+: )\{(type: spherical(?:(?!mimic).)*)\}$",
        r"\1{\2, stiffness: ¦3.0}",
        "Remove it.",
    ),
    _fault(
        "freed joint that mimics none",
        Subject.SPRING,
        "joint-not-mimic",
        r"(?m)^(  \w+: \{type: (?:(?!mimic).)*)\}$",
        r"\1, mimic: ¦false}",
        "Remove it.",
    ),
    _fault(
        "freed joint that is to mimic",
        Subject.SPRING,
        "wrong-value",
        "mimic: false",
        "mimic: ¦true",
        "Write false, or remove it.",
    ),
    # Motors
    _fault(
        "control range from high to low",
        Subject.MOTOR,
        "actuator-control-reversed",
        r"control: \[[^]]+\]",
        "control: ¦[1.5, -1.5]",
        "Write the smaller one first.",
    ),
    _fault(
        "control range of one number",
        Subject.MOTOR,
        "wrong-length",
        r"control: \[([^,]+), [^]]+\]",
        r"control: ¦[\1]",
        "Write two numbers.",
    ),
    _fault(
        "control range of another motor",
        Subject.MOTOR,
        "wrong-length",
        r"(?m)^(actuators:\n)",
        r"\1  - {joint: one, control: ¦[1, 2, 3]}\n",
        "Write two numbers.",
    ),
    _fault(
        "control range of a motor before the others",
        Subject.MOTOR,
        "wrong-length",
        r"(?m)^(actuators: \[)",
        r"\1{joint: one, control: ¦[1, 2, 3]}, ",
        "Write two numbers.",
    ),
    _fault(
        "control range of the only motor",
        Subject.MOTOR,
        "wrong-length",
        _without("actuators"),
        r"\1\nactuators:\n  - {joint: one, control: ¦[1, 2, 3]}\n",
        "Write two numbers.",
    ),
    _fault(
        "motor of the name of another one",
        Subject.MOTOR,
        "duplicate-actuator-name",
        r"(?s)(actuators:\n  - (\w+)\n.*)name: motor of \w+",
        r"\1name: ¦\2",
        "Give it another name.",
    ),
    _fault(
        "empty name of a motor",
        Subject.MOTOR,
        "wrong-value",
        r"name: motor of \w+",
        'name: ¦""',
        "Write a name.",
    ),
    _fault(
        "motor without a joint",
        Subject.MOTOR,
        "missing-key",
        r"(?s)(actuators:.*  - )\{joint: \w+, ",
        r"\1¦{",
        "Name its joint.",
    ),
)
