"""The features that a parser may lack: chapter Conformance of the specification."""

from __future__ import annotations

from eurdf_conformance.text_enum import TextEnum


class Feature(TextEnum):
    """A feature of the format that a parser may lack. The list is closed."""

    FLOATING_ROOT = "floating-root"
    PLANAR = "planar"
    FLOATING = "floating"
    SPHERICAL = "spherical"
    UNIVERSAL = "universal"
    CYLINDRICAL = "cylindrical"
    HELICAL = "helical"
    MIMIC = "mimic"
    MESHES = "meshes"
    HINGES = "hinges"
    DISTANCES = "distances"
    COUPLINGS = "couplings"
    COMPLIANCE = "compliance"
    SPRINGS = "springs"
    CONTROL = "control"


def ordered(features: frozenset[Feature]) -> tuple[Feature, ...]:
    """Features in the order of the list."""
    return tuple(feature for feature in Feature if feature in features)
