"""Mutants: parsers with one thing wrong, to test that the suite notices. `MUTANTS` has them by what is wrong.

`mutant` says how they are made; those of `missing_rules` are made of the list of codes. `PROTOCOL_MUTANTS` are parsers
that violate the protocol.
"""

from importlib import import_module
from pkgutil import iter_modules

from mutants.mutant import Mutant, mutants_of
from mutants.protocol import PROTOCOL_MUTANTS

_ALL = [mutant for found in iter_modules(__path__) for mutant in mutants_of(import_module(f"mutants.{found.name}"))]
MUTANTS = {mutant.breaks: mutant for mutant in _ALL}
assert len(MUTANTS) == len(_ALL), "two mutants are wrong alike"

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
