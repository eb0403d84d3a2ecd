"""A property: a statement that holds for any parser and any mechanism, checked on one mechanism at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example, frozen_examples
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.mechanism import Mechanism

#: How a parser violates a property on one example.
Check = Callable[[Harness, Example, Version, Level], list[Difference]]

#: Size of the largest member of a family that is explored.
LARGEST = 11

#: Versions in which relations are asked; what version 2.1 adds has relations of its own.
SHARED: tuple[Version, ...] = ("1", "2")

#: Number of frozen examples tried, among those that the property applies to.
MOST = 16


def anything(mechanism: Mechanism) -> bool:
    """The property applies to every mechanism."""
    return True


def closed(mechanism: Mechanism) -> bool:
    """The property applies to mechanisms with closures or couplings."""
    return bool(mechanism.closures or mechanism.couplings)


@dataclass(frozen=True)
class Property:
    """A statement that holds for any parser and any mechanism.

    Attributes:
        name: Permanent.
        title: What holds, as a sentence.
        clauses: The clauses that it tests; of a version, those that are of it.
        levels: Levels at which it is asked.
        check: How a parser departs from it.
        versions: Versions of the format for which it is asked.
        applies: Whether it says something of a mechanism.
        examples: The examples of every certification.
        closures: So many closures has a mechanism at least that is drawn for it.
        family: Of a property on one family of mechanisms, its members by their size, up to `LARGEST`.
        smallest: Size of the smallest member.
    """

    name: str
    title: str
    clauses: tuple[str, ...]
    levels: tuple[Level, ...]
    check: Check
    versions: tuple[Version, ...] = SHARED
    applies: Callable[[Mechanism], bool] = anything
    examples: Callable[[Version], Sequence[Example]] = frozen_examples
    closures: int = 0
    family: Callable[[int], Example] | None = None
    smallest: int = 1

    def frozen(self, version: Version) -> list[Example]:
        """The examples of every certification that the property applies to."""
        return [example for example in self.examples(version) if self.applies(example.mechanism)][:MOST]
