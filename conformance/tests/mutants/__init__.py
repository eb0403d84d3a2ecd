"""Mutants: parsers with one thing wrong, to test that the suite notices. `MUTANTS` has them by name.

Each is a sentence that says what is wrong, and a deviation, registered for the clause that it violates, and how: the
parser reads other files than it is given (`reads_…`), gives them another meaning (`means`), or gives another answer
(`answers`, `describes`, `evaluates`, `reports`, `refuses`). Those of `missing_rules` are made of the list of codes.
`PROTOCOL_MUTANTS` are parsers that violate the protocol.
"""

from mutants import (  # noqa: F401  each adds its own
    answering,
    closures,
    frames,
    inertias,
    joint_properties,
    joints,
    merging,
    missing_rules,
    numbers,
    reading_descriptions,
    reading_urdf,
    reading_yaml,
    reporting,
)
from mutants.mutant import MUTANTS, Mutant
from mutants.protocol import PROTOCOL_MUTANTS

#: The clauses with a MUST that no mutant violates, each with the reason.
UNBROKEN = {
    "EU-CAN-005": "It binds who compares two canonical descriptions, not a parser.",
    "EU-CNF-006": "It binds editions of the specification, not a program.",
    "EU-JNT-035": "A parser need not compute forces or energies, so the protocol asks for none.",
    "EU-PRO-006": "It binds runners, which are tested with misbehaving parsers.",
    "EU-PRO-010": "It binds runners, which are tested with misbehaving parsers.",
    "EU-SEC-003": "What a parser does on a network is not in its answers.",
    "EU-URD-034": "A parser need not read meshes, and the suite does not ask for them.",
}

__all__ = ["MUTANTS", "PROTOCOL_MUTANTS", "UNBROKEN", "Mutant"]
