"""The URDF that a description names and that does not exist: what is nearby, and what to write."""

from __future__ import annotations

import difflib
import os
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from eurdf.diagnostics import Diagnostics, Fix
from eurdf.format.fixes import added, restated
from eurdf.format.model import Description
from eurdf.format.yaml_text import scalar
from eurdf.reading.xacro import is_xacro


def report_missing_urdf(path: Path, description: Description, diagnostics: Diagnostics) -> None:
    """EU-FIL-004: the URDF that the description names exists."""
    document = description.document
    home = document.source.folder
    message = f"the URDF '{description.urdf}' does not exist"
    if description.version != "1" and "urdf" not in document.data:
        message += "; it is the default if there is no key 'urdf'"
    hint, only = _urdf_hint(path, home, description)
    fixes: Sequence[Fix] = ()
    if only is not None:
        stated = "urdf" in document.data
        fixes = [restated(document, ("urdf",), only)] if stated else added(document, (), "urdf", only)
    fixes = [replace(fix, summary=hint) for fix in fixes]
    diagnostics.report("urdf-not-found", message, document.place(("urdf",)), hint, fixes)


def _urdf_hint(path: Path, home: Path, description: Description) -> tuple[str, str | None]:
    """A hint with the paths of nearby URDFs from the description, and the one that it may name if there is no other."""
    near = _files_near(path, home, ".urdf") or _files_near(path, home, ".xacro")
    likely = near[0] if len(near) == 1 else None
    if len(near) > 1:
        alike = difflib.get_close_matches(path.stem, [Path(other).stem for other in near], n=1)
        likely = next((other for other in near if alike and Path(other).stem == alike[0]), None)
    meant = likely or (near[0] if near else None)
    option = f"the option --urdf {'FILE' if meant is None else shlex.quote(os.path.normpath(home / meant))}"
    if description.version == "1" and meant is not None and is_xacro(meant):
        fix = f"use {option}"
    elif description.version == "1":
        fix = f"version 1 cannot name the URDF; save it as robot.urdf beside this file, or use {option}"
    elif meant is None:
        fix = f"write its path from this file under the key 'urdf', or use {option}"
    else:
        fix = f"write urdf: {scalar(meant)}"
    if likely:
        return f"there is '{likely}': {fix}", likely if len(near) == 1 and description.version != "1" else None
    if not near:
        return f"there is no URDF nearby: {fix}", None
    shown = ", ".join(f"'{other}'" for other in near[:4]) + (f" and {len(near) - 4} more" if len(near) > 4 else "")
    return f"there are {shown}: {fix}, or use another of these files", None


def _files_near(path: Path, home: Path, suffix: str) -> list[str]:
    """Paths, from the folder of the description, of the files of a kind in the first folder around that has some."""
    for folder in dict.fromkeys((path.parent, home, home / "urdf", home / ".." / "urdf")):
        try:
            files = sorted(other for other in folder.iterdir() if other.suffix.lower() == suffix and other.is_file())
        except (OSError, ValueError):
            continue
        if files:
            return [Path(os.path.relpath(other, home)).as_posix() for other in files]
    return []
