"""Readers that lack one rule: what it forbids, they accept, and make of it what the table says."""

from __future__ import annotations

from functools import partial

from eurdf.diagnostics.registry import REGISTRY
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.mutants.deviation import Deviation, result
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted

#: By the code that such a reader lacks.
_INSTEAD = {
    "file-unreadable": "What cannot be read is an empty file.",
    "file-too-large": "No file is too large.",
    "file-not-utf8": "Bytes that are no UTF-8 are replaced by something.",
    "yaml-syntax": "What stands after a fault of syntax is left out.",
    "yaml-empty": "A description that is no mapping says nothing, and so nothing wrong.",
    "yaml-several-documents": "Of several YAML documents the first is read.",
    "yaml-duplicate-key": "Of two equal keys the last one counts, as in PyYAML.",
    "yaml-unknown-tag": "Tags are passed over.",
    "yaml-alias": "An alias that means nothing is null.",
    "yaml-too-deep": "Nothing is nested too deep.",
    "yaml-key-not-string": "A key that is no string is turned into one.",
    "yaml-not-finite": "Infinity is a number.",
    "yaml-version": "The directive %YAML is passed over.",
    "unsupported-version": "Whatever version a description says, it is read as the one that is known.",
    "unknown-key": "A key that the format lacks is passed over.",
    "missing-key": "A key that is missing has some default.",
    "wrong-type": "A value of another type is turned into the one that it should be.",
    "wrong-length": "What a list has too much is left out, what it lacks is 0.",
    "wrong-value": "A word that is none of those allowed is taken for the first of them.",
    "out-of-range": "A number may be any number.",
    "conflicting-keys": "Of two keys that exclude one another one is passed over.",
    "length-mismatch": "Of two lists that go together the longer one is cut.",
    "urdf-not-found": "A URDF that does not exist is looked for elsewhere.",
    "xml-syntax": "XML is read as HTML is, whatever stands there.",
    "xml-doctype": "A document type is read, with its entities.",
    "urdf-root-element": "The root element may have any name.",
    "urdf-missing-element": "An element that is missing has some default.",
    "urdf-missing-attribute": "An attribute that is missing is 0, or empty.",
    "urdf-repeated-element": "Of two elements the first one counts.",
    "urdf-bad-number": "A number is read as far as it is one, as by C's strtod.",
    "urdf-empty-name": "A name may be empty.",
    "urdf-duplicate-link": "Of two links of one name the last one counts.",
    "urdf-duplicate-joint": "Of two joints of one name the last one counts.",
    "urdf-reserved-name": "Any name may be given.",
    "urdf-joint-type": "A joint of an unknown type is fixed.",
    "urdf-zero-axis": "An axis without a direction is x.",
    "urdf-unknown-link": "A joint to an unknown link is left out.",
    "urdf-no-link": "A robot may have no link.",
    "urdf-two-parents": "A link with two parents is there twice, as in Pinocchio, whose model is wrong in silence.",
    "urdf-cycle": "The last joint of a cycle is left out.",
    "urdf-two-roots": "What hangs from a second root is left out.",
    "urdf-reversed-limits": "Limits that are reversed are swapped.",
    "urdf-negative-limit": "A limit may be negative.",
    "urdf-mimic-unknown": "A joint that mimics an unknown one moves freely.",
    "urdf-mimic-cycle": "The last joint of a cycle of mimics moves freely.",
    "urdf-mimic-kind": "Any joint may mimic any other.",
    "urdf-geometry": "A geometry that is none is left out.",
    "unknown-frame": "A closure whose frame is unknown is left out.",
    "ambiguous-frame": "A name that stands for two frames is that of the link.",
    "duplicate-frame": "Of two frames of one name the last one counts.",
    "duplicate-closure-name": "Closures may have the same name.",
    "closure-same-frame": "A frame may be joined to itself.",
    "closure-same-body": "Two frames of one body may be joined.",
    "closure-duplicate": "A closure may be stated twice.",
    "unknown-joint": "A name that is no joint's is dropped, as by the published loader.",
    "unknown-actuator": "A motor that is no joint is dropped, as by the published loader.",
    "duplicate-replacement": "Of what is said twice of a joint the last word counts.",
    "duplicate-joint-name": "Two joints may have the same name.",
    "actuator-immobile": "An actuated joint need not move.",
    "actuator-duplicate": "A joint may be actuated twice.",
    "actuator-mimic": "A joint that mimics may be actuated.",
    "actuator-merged": "An actuator of a joint that was merged is dropped.",
    "joint-mimics": "A joint that mimics, or is mimicked, may be changed.",
    "joint-kind": "Any joint may become any other.",
    "joint-axis-zero": "An axis of a universal joint may be zero.",
    "joint-axes-parallel": "The axes of a universal joint may be parallel.",
    "joint-pitch-zero": "A helical joint without a pitch is revolute.",
    "joint-property": "A property that does not fit its joint is passed over.",
    "joint-limits-reversed": "Limits that the description reverses are swapped.",
    "merge-not-chain": "Any three joints may be merged.",
    "merge-inertia": "Links between merged joints are left out, whatever they weigh.",
    "merge-closure-frame": "Links between merged joints may carry a frame of a closure.",
    "merge-axes": "Axes of merged joints need not meet.",
    "configuration-joint": "Coordinates of what is no joint that moves are dropped.",
    "configuration-length": "Coordinates too many are left out, those that are lacking are 0.",
    "configuration-quaternion": "A quaternion is brought to unit length, whatever its own.",
    "configuration-limits": "Limits are not heeded in configurations.",
}


def _forgiving(code: str) -> Deviation:
    def forgiven(answer: Accepted | Rejected) -> Accepted | Rejected:
        errors = {issue.code for issue in answer.issues if issue.severity == "error"}
        return accepted() if errors == {code} else answer

    return result(Reference, "load", forgiven)


def accepting(code: str, clause: str | None = None, name: str | None = None) -> Mutant:
    """A reader that lacks a rule.

    Args:
        code: Code of what it accepts.
        clause: The clause that it breaks, if not the one of the code.
        name: What it is called, if not after the code.
    """
    name = name or f"accepts_{code.replace('-', '_')}"
    return Mutant(name, clause or REGISTRY[code].clause, _INSTEAD[code], partial(_forgiving, code))


ACCEPTING = tuple(accepting(code) for code in _INSTEAD)
