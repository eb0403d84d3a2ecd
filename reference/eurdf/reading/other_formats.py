"""The formats of others: how a file of each is recognized, and what to do with it.

Every command asks this table, so that all say the same.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from eurdf.diagnostics import FileError, Place

if TYPE_CHECKING:
    from lxml import etree

_CLOSURES = (
    "write each loop under 'closures' in the description: "
    "{name: NAME, type: 3d, frames: [{link: A, xyz: [x, y, z]}, {link: B, xyz: [x, y, z]}]}"
)
_HINGE = "type: hinge and axes: [AXIS_IN_A, AXIS_IN_B] of version 2.1"


class OtherFormat(NamedTuple):
    """A format that is not Extended URDF, what to do with a file of it, and its name for ``eurdf import``, or ""."""

    title: str
    hint: str
    importer: str = ""


def _imported(name: str, title: str) -> OtherFormat:
    return OtherFormat(title, f"this is {title}: import it with `eurdf import FILE -o FOLDER`", name)


def _not_imported(title: str, instead: str) -> OtherFormat:
    return OtherFormat(title, f"`eurdf import` cannot read {title}; {instead}")


#: The formats that `eurdf import` reads, by name.
IMPORTED = {
    each.importer: each
    for each in (
        _imported("mjcf", "MJCF, for MuJoCo"),
        _imported("sdf", "SDFormat, for Gazebo"),
        _imported("loop-joint", "URDF with the loop joints of Isaac Sim"),
        _imported("drake", "URDF with the joints and constraints of Drake"),
        _imported("urdf-plus", "URDF+, of generalized_rbda"),
    )
}

_URDF = OtherFormat("URDF", "give its file a name that ends with .urdf")
_USD = _not_imported("USD", "import the MJCF or the SDFormat of the robot, or use its URDF")
_CONSTRAINT = _not_imported("the <constraint> proposed for URDF", f"{_CLOSURES}; if it keeps an axis, {_HINGE}")
_SCIKIT_ROBOT = _not_imported(
    "loop_closures.yaml of scikit-robot",
    f"{_CLOSURES}, with {_HINGE}; its points and axes are in the frame of the root at zero",
)
_ROBONEX = _not_imported("loop_closures.yaml of robonex", f"{_CLOSURES}; for 'pin_loops', {_HINGE}")

_BY_ROOT = {"mujoco": IMPORTED["mjcf"], "mujocoinclude": IMPORTED["mjcf"], "sdf": IMPORTED["sdf"]}

#: Elements of a robot that only one dialect of URDF has.
_BY_ELEMENT = {
    "loop_joint": IMPORTED["loop-joint"],
    "fixed_frame": IMPORTED["loop-joint"],
    "loop": IMPORTED["urdf-plus"],
    "loop_constraint": IMPORTED["urdf-plus"],
    "coupling": IMPORTED["urdf-plus"],
    "constraint": _CONSTRAINT,
}

#: Namespaces of others, by their usual prefix.
NAMESPACES = {"drake": "http://drake.mit.edu"}

#: Root elements of the files that can be imported, in the order for messages.
ROOTS = (*_BY_ROOT, "robot")

_BEFORE_ROOT = re.compile(r"\s+|<\?.*?\?>|<!--.*?-->", re.DOTALL)
_ROOT = re.compile(r"<([A-Za-z_][\w.-]*)")
_MOST_BEFORE_ROOT = 100
_USD_TEXT = "#usda"
_USD_CRATE = b"PXR-USDC"
_ZIP = b"PK\x03\x04"


def of_root(tag: str) -> OtherFormat | None:
    """The format of an XML file with a root element."""
    return _BY_ROOT.get(tag)


def of_element(element: etree._Element) -> OtherFormat | None:
    """The dialect of URDF that has an element in ``robot``. Drake knows its own by the prefix."""
    tag = str(element.tag)
    is_drake = element.prefix == "drake" or tag.startswith(f"{{{NAMESPACES['drake']}}}")
    return IMPORTED["drake"] if is_drake else _BY_ELEMENT.get(tag)


def of_mapping(data: Mapping[str, Any]) -> OtherFormat | None:
    """The format of a YAML file that is no description."""
    if "ball_loops" in data or "pin_loops" in data:
        return _ROBONEX
    closures = data.get("closures")
    if isinstance(closures, list) and any(isinstance(each, dict) and "link_a" in each for each in closures):
        return _SCIKIT_ROBOT
    return None


def of_text(text: str) -> OtherFormat | None:
    """The format of a text that is no YAML."""
    if text.startswith(_USD_TEXT):
        return _USD
    at = 0
    for _ in range(_MOST_BEFORE_ROOT):
        if not (before := _BEFORE_ROOT.match(text, at)):
            break
        at = before.end()
    root = _ROOT.match(text, at)
    if root is None:
        return None
    return _URDF if root[1] == "robot" else of_root(root[1])


def of_binary(data: bytes) -> OtherFormat | None:
    """The format of bytes that are no text."""
    if data.startswith(_USD_CRATE):
        return _USD
    # USDZ is an archive whose first file is USD.
    length = int.from_bytes(data[26:28], "little")
    is_archive = data.startswith(_ZIP) and re.search(rb"\.usd[ac]?\Z", data[30 : 30 + length])
    return _USD if is_archive else None


def other_format(code: str, found: OtherFormat, place: Place) -> FileError:
    """The error, with a code, of a file that has another format and begins at a place."""
    return FileError(code, f"the file is {found.title}", place, found.hint)
