"""The files of a robot."""

from __future__ import annotations

from pathlib import Path

from robots.builder.drawing import Drawing
from robots.builder.urdf_text import urdf_text
from robots.builder.yaml_text import version_1_text, yaml_text


def write(drawing: Drawing, folder: Path) -> None:
    """Writes ``robot.urdf``, ``robot.yaml`` and ``robot.v1.yaml`` into a folder."""
    texts = {
        "robot.urdf": urdf_text(drawing),
        "robot.yaml": yaml_text(drawing),
        "robot.v1.yaml": version_1_text(drawing),
    }
    for name, text in texts.items():
        (folder / name).write_bytes(text.encode())
