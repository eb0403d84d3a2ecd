"""The order and the YAML style of files change nothing."""

from __future__ import annotations

from typing import Any

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.document import document
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.urdf import urdf_text
from eurdf_conformance.properties.yaml_text import yaml_text


def reordering(example: Example, version: Version) -> Pair:
    """A mechanism, and the same with its links, joints, keys and elements in another order."""
    mechanism, chance = example.mechanism, example.chance
    other = reordered(mechanism, chance, version)
    keys = shuffled_keys(document(other, version), chance)
    files = Files(yaml_text(keys), urdf_text(other, backwards=True).encode())
    at, frames = mechanism.configurations, None
    return Pair(query_of(mechanism, version, frames=frames), query_of(other, version, files=files, at=at))


def restyling(example: Example, version: Version) -> Pair:
    """A mechanism, and the same files in another spelling."""
    query = query_of(example.mechanism, version)
    text = yaml_text(document(example.mechanism, version), example.chance)
    return Pair(query, query_of(example.mechanism, version, files=Files(text, query.files.urdf)))


def reordered(mechanism: Mechanism, chance: Chance, version: Version) -> Mechanism:
    """The mechanism in another order; closures keep theirs in version 1, where it gives their names."""
    closures = mechanism.closures if version == "1" else tuple(chance.shuffled(mechanism.closures))
    return mechanism.replace(
        links=tuple(chance.shuffled(mechanism.links)),
        joints=tuple(chance.shuffled(mechanism.joints)),
        changes=dict(chance.shuffled(mechanism.changes.items())),
        frames=tuple(chance.shuffled(mechanism.frames)),
        closures=closures,
        actuators=tuple(chance.shuffled(mechanism.actuators)),
    )


def shuffled_keys(value: Any, chance: Chance) -> Any:
    """A value whose mappings, at every level, have their keys in another order."""
    if isinstance(value, dict):
        return {key: shuffled_keys(item, chance) for key, item in chance.shuffled(value.items())}
    return [shuffled_keys(item, chance) for item in value] if isinstance(value, list) else value


PROPERTIES = (
    Property(
        "reordering",
        "The order of links, joints, keys and elements changes nothing.",
        ("EU-CAN-005", "EU-JNT-025", "EU-CLO-010", "EU-INR-006"),
        (Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        related(reordering),
    ),
    Property(
        "yaml-style",
        "A different style of YAML with the same meaning under the core schema changes nothing.",
        ("EU-YML-011", "EU-YML-001", "EU-YML-005", "EU-YML-006", "EU-YML-010", "EU-FIL-003", "EU-SCH-002"),
        (Level.STRUCTURE, Level.KINEMATICS),
        related(restyling),
    ),
)
