"""What defines each level: what a parser is asked, what of its answer is compared, and what the answer can show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from eurdf_conformance.level import Level
from eurdf_conformance.protocol.message import Quantity
from eurdf_conformance.text_enum import TextEnum


class Compared(TextEnum):
    """The part of an answer that is compared with what is expected."""

    #: Whether the files are accepted.
    OUTCOME = "outcome"
    #: The canonical description of accepted files.
    ROBOT = "robot"
    #: Quantities at configurations of an accepted robot, for which the parser is asked to evaluate.
    VALUES = "values"
    #: The diagnostics.
    ISSUES = "issues"


@dataclass(frozen=True, slots=True)
class LevelSpec:
    """What defines a level.

    Attributes:
        compared: The part of the answer that is compared.
        clause: The clause that every item of the level tests.
        shows: The levels whose clauses an answer can show.
        defining: The quantities asked for at each configuration, each with the clauses that define it, which a failure
            shows.
    """

    compared: Compared
    clause: str
    shows: Sequence[Level]
    defining: Mapping[Quantity, Sequence[str]] = field(default_factory=dict)

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What is asked for at each configuration."""
        return tuple(self.defining)


#: Every level.
LEVELS: Mapping[Level, LevelSpec] = {
    Level.ACCEPT: LevelSpec(Compared.OUTCOME, "EU-CNF-002", (Level.ACCEPT,)),
    Level.STRUCTURE: LevelSpec(Compared.ROBOT, "EU-CAN-001", (Level.ACCEPT, Level.STRUCTURE)),
    Level.KINEMATICS: LevelSpec(
        Compared.VALUES,
        "EU-PRO-008",
        (Level.ACCEPT, Level.STRUCTURE, Level.KINEMATICS),
        {
            "poses": ("EU-JNT-025", "EU-FRM-006"),
            "residuals": ("EU-CLO-008", "EU-CLO-009", "EU-CLO-014"),
            "jacobian": ("EU-CLO-010", "EU-JNT-026"),
        },
    ),
    Level.DYNAMICS: LevelSpec(
        Compared.VALUES,
        "EU-PRO-009",
        (Level.ACCEPT, Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        {
            "mass_matrix": ("EU-INR-005", "EU-INR-006", "EU-JNT-026"),
            "mass": ("EU-INR-005",),
            "center_of_mass": ("EU-INR-005",),
        },
    ),
    Level.DIAGNOSE: LevelSpec(Compared.ISSUES, "EU-DIA-001", (Level.ACCEPT, Level.DIAGNOSE)),
}


def levels_comparing(*compared: Compared) -> tuple[Level, ...]:
    """The levels at which one of some parts of an answer is compared."""
    return tuple(level for level, spec in LEVELS.items() if spec.compared in compared)
