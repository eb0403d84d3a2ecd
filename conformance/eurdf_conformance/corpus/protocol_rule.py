"""The checks of a parser that are no cases: whether it follows the protocol."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ProtocolRule:
    """One check of the protocol.

    Attributes:
        name: Permanent.
        title: What is asked, as a sentence.
        clauses: The clauses that it tests.
    """

    name: str
    title: str
    clauses: tuple[str, ...]


START = ProtocolRule(
    "start",
    "A parser answers `start` with its name and the levels that it claims for this version of the format.",
    ("EU-PRO-001", "EU-PRO-003"),
)
QUIET = ProtocolRule(
    "quiet",
    "A parser answers each request with one line that repeats its id, and writes nothing else to standard output.",
    ("EU-PRO-002", "EU-PRO-001", "EU-PRO-003"),
)
GOES_ON = ProtocolRule(
    "goes-on",
    "After it rejects a description, a parser continues and reads a robot as before.",
    ("EU-PRO-005", "EU-PRO-004"),
)

STOP = ProtocolRule("stop", "A parser answers `stop`, and its process then exits by itself.", ("EU-PRO-001",))

RULES = (START, QUIET, GOES_ON, STOP)

#: Clauses on the suite itself, which its own tests check.
OF_RUNNERS = ("EU-PRO-006", "EU-PRO-010")
