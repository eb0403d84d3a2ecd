"""The format of a file, by its content."""

from __future__ import annotations

from pathlib import Path

from eurdf.importing.exceptions import CannotImport
from eurdf.importing.xml_files import read_root

_ROOTS = {"mujoco": "mjcf", "mujocoinclude": "mjcf"}


def recognized(path: Path) -> str:
    """The name of the format of a file.

    Raises:
        CannotImport: It is not XML, or of no format that can be imported.
    """
    tag = read_root(path).tag
    if tag not in _ROOTS:
        raise CannotImport(
            path, f"its root element is <{tag}>; expected one of: {', '.join(f'<{root}>' for root in _ROOTS)}"
        )
    return _ROOTS[tag]
