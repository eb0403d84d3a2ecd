"""The files of a robot."""

from __future__ import annotations

from pathlib import Path

from eurdf.format.schema import FILES
from eurdf.writing.description import describe_mechanism, version_needed
from robots.builder.drawing import Drawing
from robots.builder.mechanism import mechanism_of
from robots.builder.version_1 import can_be_version_1, version_1_text

_COMMENTS = ("Written by build.py beside this file: change it there.",)
_SCHEMAS = "../../schema"


def write(drawing: Drawing, folder: Path) -> None:
    """Writes ``robot.urdf``, ``robot.yaml`` and, if version 1 can describe the robot, ``robot.v1.yaml`` into a folder.

    Otherwise, a ``robot.v1.yaml`` in the folder is removed.
    """
    mechanism = mechanism_of(drawing)
    schema = FILES["2" if version_needed(mechanism) == "2.0" else "2.1"]
    files = describe_mechanism(
        mechanism, schema=f"{_SCHEMAS}/{schema}", comments=_COMMENTS, materials=drawing.materials
    )
    (folder / "robot.urdf").write_bytes(files.urdf)
    (folder / "robot.yaml").write_bytes(files.yaml.encode())
    old = folder / "robot.v1.yaml"
    if can_be_version_1(mechanism):
        old.write_bytes(version_1_text(mechanism, f"{_SCHEMAS}/{FILES['1']}", _COMMENTS).encode())
    else:
        old.unlink(missing_ok=True)
