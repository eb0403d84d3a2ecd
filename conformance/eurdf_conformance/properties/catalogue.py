"""All properties, and the items that they become in the suite: one per level and version."""

from __future__ import annotations

from eurdf_conformance.properties import agreement, derivative, mobility
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.relations import (
    ball_closure,
    base,
    closing,
    coordinates,
    elementary,
    following,
    freeing,
    locking,
    lumping,
    merging,
    renaming,
    saying,
    spelling,
    springs,
    swapping,
    twins,
    units,
)

PROPERTIES: tuple[Property, ...] = (
    *agreement.PROPERTIES,
    *derivative.PROPERTIES,
    *mobility.PROPERTIES,
    *renaming.PROPERTIES,
    *spelling.PROPERTIES,
    *twins.PROPERTIES,
    *saying.PROPERTIES,
    *swapping.PROPERTIES,
    *ball_closure.PROPERTIES,
    *closing.PROPERTIES,
    *base.PROPERTIES,
    *units.PROPERTIES,
    *locking.PROPERTIES,
    *elementary.PROPERTIES,
    *merging.PROPERTIES,
    *following.PROPERTIES,
    *freeing.PROPERTIES,
    *springs.PROPERTIES,
    *lumping.PROPERTIES,
    *coordinates.PROPERTIES,
)


def property_of(name: str) -> Property:
    """The property with a name."""
    return next(prop for prop in PROPERTIES if prop.name == name)
