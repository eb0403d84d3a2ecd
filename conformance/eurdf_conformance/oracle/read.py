"""Reads a robot from its two files."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from eurdf_conformance.level import Version
from eurdf_conformance.oracle.configuration import require_within_limits
from eurdf_conformance.oracle.description import Description
from eurdf_conformance.oracle.merging import with_merges_found
from eurdf_conformance.oracle.near import is_near
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.plain_value import text
from eurdf_conformance.oracle.robot import OracleRobot
from eurdf_conformance.oracle.tree import build
from eurdf_conformance.oracle.urdf import Urdf, read_urdf
from eurdf_conformance.oracle.version1 import KEYS as KEYS_1
from eurdf_conformance.oracle.version1 import version1
from eurdf_conformance.oracle.version2 import KEYS as KEYS_2
from eurdf_conformance.oracle.version2 import version2
from eurdf_conformance.oracle.yaml_text import value_of


def read(description: Path | None, urdf: Path, version: Version | None = None) -> OracleRobot:
    """The robot of two valid files.

    Args:
        description: The YAML file; None: there is none, and the URDF is all.
        urdf: The URDF that it names; what it says itself of where that is does not count here.
        version: The version that the description must be of; of a bare URDF, that which it is read as (2 if left out).

    Raises:
        NotRead: The oracle is not sure what they say.
    """
    found = described(description) if description else Description(version=version or "2")
    if version not in (None, found.version):
        raise NotRead(f"the description is of version {found.version}")
    for names in (
        (closure.name for closure in found.closures),
        (actuator.joint for actuator in found.actuators),
        (actuator.name or actuator.joint for actuator in found.actuators),
    ):
        if any(count > 1 for count in Counter(names).values()):
            raise NotRead("a closure or an actuator that occurs twice")
    source = freed(read_urdf(urdf), found)
    if found.version == "1":
        source = source.without_mimics()
        found = with_merges_found(found, source)
    robot = OracleRobot(source, found, build(source, found))
    robot.canonical()  # so that every name in the description is looked up
    for configuration in found.configurations.values():
        require_within_limits(robot.tree, configuration)
    return robot


def freed(urdf: Urdf, description: Description) -> Urdf:
    """The URDF without the mimics of the joints that the description frees, EU-JNT-033."""
    for name, change in description.changes.items():
        if change.freed:
            named = change.merges or (name,)
            mimicking = [each for each in named if each in urdf.joints and urdf.joints[each].mimic]
            if not mimicking:
                raise NotRead(f"{name!r} mimics no joint")
            urdf = urdf.without_mimics(mimicking)
    return urdf


def described(path: Path) -> Description:
    """The description in a file, of the version that it states, EU-VER-001 to 003."""
    document = value_of(text_of(path))
    if not isinstance(document, dict):
        raise NotRead("the description is not a mapping")
    if "extended_urdf" in document:
        text(document["extended_urdf"])
        return version2(document)
    if not document.keys() & set(KEYS_1):
        misspelt = any(is_near(key, "extended_urdf") for key in document if not key.startswith("x-"))
        if misspelt or document.keys() & set(KEYS_2):
            raise NotRead("keys of version 2 without its first")
    return version1(document)


def text_of(path: Path) -> str:
    """UTF-8 text, with or without a byte order mark, EU-FIL-003."""
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise NotRead(f"{path.name} is not UTF-8") from error
