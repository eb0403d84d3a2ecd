"""Numbers, poses and names in the elements of an XML file."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

from lxml import etree

from eurdf.diagnostics import did_you_mean
from eurdf.importing.exceptions import CannotImport
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3


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
