"""The XML files of a robot: their format, and the numbers, poses and names of their elements."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from lxml import etree

from eurdf.diagnostics import Diagnostic, FileError, Place, did_you_mean
from eurdf.errors import CannotImport
from eurdf.format.conventions import VERSION_KEY
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.mesh_files.folders import Folders
from eurdf.reading.other_formats import ROOTS, OtherFormat, of_element, of_mapping, of_root
from eurdf.reading.robot_source import is_xml
from eurdf.reading.source import read_source
from eurdf.reading.xml_reader import read_xml
from eurdf.reading.yaml_reader import read_yaml


def read_root(path: Path) -> etree._Element:
    """The root element of an XML file.

    Raises:
        CannotImport: It cannot be read, is not XML, is too large, or has entities.
    """
    try:
        return read_xml(read_source(path)).root
    except FileError as error:
        raise _unreadable(path, error.diagnostic) from None


def _unreadable(path: Path, found: Diagnostic) -> CannotImport:
    where = f"{found.file}:{found.line}: " if found.line else ""
    return CannotImport(path, "; ".join((where + found.message, *([found.hint] if found.hint else []))))


def recognized(path: Path) -> str:
    """The name of the format of a file.

    Raises:
        CannotImport: It is of no format that can be imported.
    """
    _refuse_yaml(path)
    root = read_root(path)
    found = _dialect(path, root) if root.tag == "robot" else of_root(str(root.tag))
    if found is None:
        expected = ", ".join(f"<{tag}>" for tag in ROOTS)
        raise CannotImport(path, f"its root element is <{root.tag}>; it must be one of {expected}")
    return found.importer


def _refuse_yaml(path: Path) -> None:
    """Refuse a file that describes loops in YAML, or is a description."""
    try:
        source = read_source(path)
    except FileError as error:
        raise _unreadable(path, error.diagnostic) from None
    if is_xml(source):
        return
    try:
        data = read_yaml(source).data
    except FileError:
        return  # what is wrong with it as XML is reported
    if found := of_mapping(data):
        raise CannotImport(path, found.hint)
    if VERSION_KEY in data:
        raise CannotImport(path, "it is a description; use it as it is: `eurdf check`")


def _dialect(path: Path, root: etree._Element) -> OtherFormat:
    found = [(element, dialect) for element in root if (dialect := of_element(element))]
    if not found:
        raise CannotImport(
            path, "it is a URDF without loops of another dialect; use it as it is: `eurdf check`, `eurdf generate`"
        )
    element, dialect = next((each for each in found if each[1].importer), found[0])
    if not dialect.importer:
        raise CannotImport(path, f"{path.name}:{element.sourceline}: {dialect.hint}")
    return dialect


def inside(path: Path, file: Path, folders: Folders) -> None:
    """Refuse a file that is outside the folders of the robot, with symbolic links followed.

    Raises:
        CannotImport: It is outside.
    """
    if not folders.admit(file):
        raise CannotImport(
            path,
            f"it uses '{file}', which is outside the folder of the robot, {folders}; copy it there, or name a folder "
            "that has both with --within (within= in Python); --allow-outside (allow_outside=True) reads files from "
            "anywhere",
        )


def places_of_names(sources: Sequence[Path]) -> dict[str, Place]:
    """The place of the first element of each name, in files that may be missing or have errors."""
    found: dict[str, Place] = {}
    for path in sources:
        try:
            root = read_root(path)
        except CannotImport:
            continue
        for element in root.iter("*"):
            name, line = element.get("name"), element.sourceline
            if name and isinstance(line, int):
                found.setdefault(name, Place(os.fspath(path), line))
    return found


class Elements:
    """Reads the elements of one file, and refuses what is wrong with file and line."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def refuse(self, element: etree._Element, reason: str) -> CannotImport:
        """The exception for an error in an element."""
        line = element.sourceline
        where = f"{self.path.name}:{line}: " if isinstance(line, int) else ""
        return CannotImport(self.path, f"{where}{reason}")

    def numbers(self, element: etree._Element, text: str | None, count: int, what: str) -> tuple[float, ...]:
        """Finite numbers in a text, separated by spaces."""
        try:
            values = tuple(float(word) for word in (text or "").split())
        except ValueError:
            values = ()
        if len(values) != count or not all(map(math.isfinite, values)):
            wanted = "one finite number" if count == 1 else f"{count} finite numbers separated by spaces"
            of = "" if what == f"<{element.tag}>" else f" of {named(element)}"
            raise self.refuse(element, f"{what}{of} is '{text or ''}'; it must be {wanted}")
        return values

    def attribute(self, element: etree._Element, name: str, default: float | None = None) -> float:
        """The number in an attribute; refused if it is missing and has no default."""
        text = element.get(name)
        if text is None and default is not None:
            return default
        return self.numbers(element, text, 1, f"'{name}'")[0]

    def vector(self, element: etree._Element, name: str, default: Vector3 | None = None) -> Vector3:
        """The three numbers in an attribute."""
        text = element.get(name)
        if text is None and default is not None:
            return default
        x, y, z = self.numbers(element, text, 3, f"'{name}'")
        return x, y, z

    def axis(self, element: etree._Element) -> Vector3:
        """The axis in the attribute ``xyz``, of any length but zero."""
        axis = self.vector(element, "xyz")
        if not any(axis):
            raise self.refuse(element, f"'xyz' of {named(element)} is '{element.get('xyz')}'; an axis must not be zero")
        return axis

    def pose(self, element: etree._Element | None) -> Pose:
        """The pose in the attributes ``xyz`` and ``rpy`` of an element; the identity without it."""
        if element is None:
            return IDENTITY
        if element.get("quat_xyzw") is not None:
            raise self.refuse(element, f"{named(element)} has 'quat_xyzw'; only links and joints can; use 'rpy'")
        zero = (0.0, 0.0, 0.0)
        return Pose.from_xyz_rpy(self.vector(element, "xyz", zero), self.vector(element, "rpy", zero))

    def link(self, element: etree._Element, name: str | None, links: Iterable[str]) -> str:
        """The name of a link that exists."""
        known = list(links)
        if name not in known:
            hint = did_you_mean(name or "", known)
            more = f"; {hint}" if hint else ""
            raise self.refuse(element, f"{named(element)} names the link '{name or ''}', which does not exist{more}")
        return str(name)

    def child(self, element: etree._Element, *tags: str) -> etree._Element:
        """The first child with one of some tags."""
        found = next((child for child in element if child.tag in tags), None)
        if found is None:
            raise self.refuse(element, f"{named(element)} has no <{tags[0]}>")
        return found


def named(element: etree._Element) -> str:
    """How a message names an element."""
    name = element.get("name")
    tag = local(element)
    return f"<{tag}>" if name is None else f"<{tag}> '{name}'"


def local(element: etree._Element) -> str:
    """The tag of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]
