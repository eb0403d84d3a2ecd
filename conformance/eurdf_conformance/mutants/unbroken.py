"""The clauses with a MUST that no mutant breaks, each with the reason."""

from __future__ import annotations

UNBROKEN = {
    "EU-CAN-005": "It binds who compares two canonical descriptions, which no reader does.",
    "EU-CNF-006": "It binds editions of the specification, not a program.",
    "EU-PRO-006": "It binds runners, which are tested with fake readers.",
    "EU-PRO-010": "It binds runners, which are tested with fake readers.",
    "EU-SEC-003": "What a reader does on a network is nothing that it says.",
    "EU-URD-034": "Meshes are read where geometry is loaded, which the suite does not ask for.",
}
