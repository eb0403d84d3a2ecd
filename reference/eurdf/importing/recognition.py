"""The format of a file, by its content."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from eurdf.importing.exceptions import CannotImport
from eurdf.importing.xml_files import read_root

_ROOTS = {"mujoco": "mjcf", "mujocoinclude": "mjcf", "sdf": "sdf"}

#: Elements of a robot that only one dialect of URDF has.
_DIALECTS = {
    "loop_joint": "loop-joint",
    "fixed_frame": "loop-joint",
    "loop": "urdf-plus",
    "loop_constraint": "urdf-plus",
    "coupling": "urdf-plus",
}


def recognized(path: Path) -> str:
    """The name of the format of a file.

    Raises:
        CannotImport: It is not XML, or of no format that can be imported.
    """
    root = read_root(path)
    if root.tag == "robot":
        return _dialect(path, root)
    if root.tag not in _ROOTS:
        expected = ", ".join(f"<{tag}>" for tag in (*_ROOTS, "robot"))
        raise CannotImport(path, f"its root element is <{root.tag}>; it must be one of {expected}")
    return _ROOTS[str(root.tag)]


def _dialect(path: Path, root: etree._Element) -> str:
    for element in root:
        tag = str(element.tag)
        if tag in _DIALECTS:
            return _DIALECTS[tag]
        if tag.startswith(("{http://drake.mit.edu}", "drake:")):
            return "drake"
    raise CannotImport(
        path, "it is a URDF without loops of another dialect; use it as it is: `eurdf check`, `eurdf generate`"
    )
