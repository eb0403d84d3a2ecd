"""Readers that lack one rule: what its code is told of, they accept. That is all they do; they build no robot of it.

Readers that go on, and have a robot in the end, as today's parsers do, are in `going_on`, `version1` and others.
"""

from __future__ import annotations

from functools import partial

from eurdf.diagnostics.registry import REFUSED_PHASES, REGISTRY, Severity
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.mutants.deviation import Deviation, result
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.mutants.of_the_reference import clause_of
from eurdf_conformance.mutants.unbroken import UNBROKEN
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted


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
    rule = REGISTRY[code]
    name = name or f"accepts_{code.replace('-', '_')}"
    breaks = f"Accepts, without a robot, what is told as `{code}`: {rule.title[0].lower()}{rule.title[1:]}"
    return Mutant(name, clause or clause_of(code), breaks, partial(_forgiving, code))


ACCEPTING = tuple(
    accepting(code)
    for code, rule in REGISTRY.items()
    if rule.severity is Severity.ERROR and rule.phase in REFUSED_PHASES and rule.clause not in UNBROKEN
)
