"""The two files of a mechanism, as bytes and on disk."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from eurdf_conformance.level import Version
from eurdf_conformance.properties.document import document
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.urdf import urdf_text
from eurdf_conformance.properties.yaml_text import yaml_text

DESCRIPTION = "robot.yaml"
URDF = "robot.urdf"


@dataclass(frozen=True)
class Files:
    """A description and its URDF."""

    description: bytes
    urdf: bytes

    def write(self, folder: Path) -> tuple[Path, Path]:
        """Write both files into a folder; return their paths."""
        description, urdf = folder / DESCRIPTION, folder / URDF
        description.write_bytes(self.description)
        urdf.write_bytes(self.urdf)
        return description, urdf


def files_of(mechanism: Mechanism, version: Version) -> Files:
    """The files of a mechanism in the usual style."""
    return Files(yaml_text(document(mechanism, version)), urdf_text(mechanism).encode())
