"""The features that the two files of a robot use: the table of chapter Conformance of the specification."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from eurdf_conformance.feature import Feature
from eurdf_conformance.oracle import NotRead
from eurdf_conformance.oracle.urdf import Element, parse
from eurdf_conformance.oracle.yaml_text import value_of
from eurdf_conformance.protocol.message import CanonicalRobot

_JOINTS: Mapping[object, Feature] = {
    "planar": Feature.PLANAR,
    "floating": Feature.FLOATING,
    "spherical": Feature.SPHERICAL,
    "universal": Feature.UNIVERSAL,
    "cylindrical": Feature.CYLINDRICAL,
    "helical": Feature.HELICAL,
}
_CLOSURES: Mapping[object, Feature] = {"hinge": Feature.HINGES, "distance": Feature.DISTANCES}


def features_of_robot(robot: CanonicalRobot) -> frozenset[Feature]:
    """The features that the joints of a robot show; version 1 merges joints without a key."""
    return frozenset(_JOINTS[joint.type] for joint in robot.joints if joint.type in _JOINTS)


def features_of_files(description: bytes, urdf: bytes) -> frozenset[Feature]:
    """The features that two files state; a file that is not YAML or not XML states none."""
    try:
        document = value_of(description.decode("utf-8-sig"))
    except (UnicodeDecodeError, NotRead):
        document = None
    document = _mapping(document)
    try:
        robot = parse(urdf)
    except NotRead:
        robot = Element("robot", {}, [])
    is_first = "extended_urdf" not in document
    stated = _of_version_1(document) if is_first else _of_version_2(document)
    return frozenset((*stated, *_of_urdf(robot, with_mimics=not is_first)))


def _of_version_1(document: Mapping[str, Any]) -> Iterator[Feature]:
    for kind in _list(document.get("joint_type")):
        if kind == "SPHERICAL":
            yield Feature.SPHERICAL
        elif isinstance(kind, str) and kind.startswith("UJOINT"):
            yield Feature.UNIVERSAL


def _of_version_2(document: Mapping[str, Any]) -> Iterator[Feature]:
    if document.get("root") == "floating":
        yield Feature.FLOATING_ROOT
    for change in _mapping(document.get("joints")).values():
        kind = change.get("type") if isinstance(change, Mapping) else change
        if isinstance(kind, str) and kind in _JOINTS:
            yield _JOINTS[kind]
        if _mapping(change).keys() & {"stiffness", "rest"}:
            yield Feature.SPRINGS
    for closure in map(_mapping, _list(document.get("closures"))):
        if isinstance(kind := closure.get("type"), str) and kind in _CLOSURES:
            yield _CLOSURES[kind]
        if "compliance" in closure:
            yield Feature.COMPLIANCE
    if _list(document.get("couplings")):
        yield Feature.COUPLINGS
    if any("control" in _mapping(actuator) for actuator in _list(document.get("actuators"))):
        yield Feature.CONTROL


def _of_urdf(robot: Element, with_mimics: bool) -> Iterator[Feature]:
    for joint in robot.all("joint"):
        if (kind := joint.attributes.get("type")) in ("planar", "floating"):
            yield _JOINTS[kind]
        if with_mimics and joint.all("mimic"):  # EU-ONE-009: version 1 ignores them
            yield Feature.MIMIC
    shapes = (shape for link in robot.all("link") for name in ("visual", "collision") for shape in link.all(name))
    if any(geometry.all("mesh") for shape in shapes for geometry in shape.all("geometry")):
        yield Feature.MESHES


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []
