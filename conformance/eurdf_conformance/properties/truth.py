"""The oracle's reading of a mechanism, without writing and parsing YAML text."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from tempfile import NamedTemporaryFile

from eurdf_conformance.level import Version
from eurdf_conformance.oracle import OracleRobot
from eurdf_conformance.oracle.merging import with_merges_found
from eurdf_conformance.oracle.read import freed
from eurdf_conformance.oracle.tree import build
from eurdf_conformance.oracle.urdf import read_urdf
from eurdf_conformance.oracle.version1 import version1
from eurdf_conformance.oracle.version2 import version2
from eurdf_conformance.properties.document import document
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.urdf import urdf_text


def truth(mechanism: Mechanism, version: Version = "2") -> OracleRobot:
    """The robot that the two files of a mechanism describe.

    Raises:
        NotRead: The oracle is not sure what they say.
    """
    return _truth(mechanism.model_dump_json(), version)


@lru_cache(maxsize=512)
def _truth(text: str, version: Version) -> OracleRobot:
    mechanism = Mechanism.model_validate_json(text)
    with NamedTemporaryFile() as file:
        file.write(urdf_text(mechanism).encode())
        file.flush()
        urdf = read_urdf(Path(file.name))
    description = (version1 if version == "1" else version2)(document(mechanism, version))
    if version == "1":
        description = with_merges_found(description, urdf)
    urdf = freed(urdf, description)
    return OracleRobot(urdf, description, build(urdf, description))
