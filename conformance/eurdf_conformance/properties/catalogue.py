"""All laws, and the properties that they are in the suite: one a level and version."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.properties import agreement, derivative, mobility
from eurdf_conformance.properties.law import Law
from eurdf_conformance.properties.relations import (
    ball_closure,
    base,
    coordinates,
    elementary,
    following,
    locking,
    lumping,
    merging,
    renaming,
    saying,
    spelling,
    swapping,
    twins,
    units,
)
from eurdf_conformance.properties.trying import try_law
from eurdf_conformance.suite.property import Property

LAWS: tuple[Law, ...] = (
    *agreement.LAWS,
    *derivative.LAWS,
    *mobility.LAWS,
    *renaming.LAWS,
    *spelling.LAWS,
    *twins.LAWS,
    *saying.LAWS,
    *swapping.LAWS,
    *ball_closure.LAWS,
    *base.LAWS,
    *units.LAWS,
    *locking.LAWS,
    *elementary.LAWS,
    *merging.LAWS,
    *following.LAWS,
    *lumping.LAWS,
    *coordinates.LAWS,
)


def properties() -> Iterator[Property]:
    """Each law at each of its levels, for each version, with the clauses that are of that version."""
    clauses = read_clauses()
    for law in LAWS:
        for level in law.levels:
            for version in law.versions:
                cited = tuple(name for name in law.clauses if version in clauses[name].versions)
                yield Property(law.name, law.title, cited, level, (version,), partial(try_law, law, level))


def law_of(name: str) -> Law:
    """The law of a name."""
    return next(law for law in LAWS if law.name == name)


PROPERTIES: tuple[Property, ...] = tuple(properties())
