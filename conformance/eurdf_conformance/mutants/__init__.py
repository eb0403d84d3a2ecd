"""Mutants: the reference reader, each time with one thing broken, to see that the suite would tell.

A mutant is a function that returns a deviation: a context manager in which one function of the reference is another.
Its docstring says what is broken, and its decorator which clause. Each is a reader,
``--parser=eurdf_conformance.mutants:last_row_first`` as it were; `matrix` writes down by which cases and properties
each is caught, and only one that cites the mutant's clause counts.

How they patch: `accepting` and `silent` have a mutant for each diagnostic that is not told; `refusing` those that have a
rule too many; the other modules, by topic, misread, with `deviation` and `of_the_reference` as their tools.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eurdf_conformance.mutants.mutant import Mutant


def __getattr__(name: str) -> Mutant:
    """The mutant of a name."""
    # Only now: the modules of the mutants are parts of this one.
    from eurdf_conformance.mutants.catalogue import MUTANTS

    try:
        return MUTANTS[name]
    except KeyError:
        raise AttributeError(f"there is no mutant '{name}'") from None
