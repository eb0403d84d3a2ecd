"""The oracle as a parser like any other: properties that hold of it are properties that can be met."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.oracle import OracleRobot, read
from eurdf_conformance.protocol.message import Accepted, Quantity, Values
from eurdf_conformance.protocol.reply import accepted

Configuration = Mapping[str, Sequence[float]]

#: Robots by the contents of their two files: tests have the same ones read again and again.
_READ: dict[tuple[bytes, bytes], OracleRobot] = {}
_MOST_KEPT = 500


class OracleParser:
    """The oracle behind the protocol."""

    name = "oracle"
    version = "1"
    language = "Python"
    claims: Mapping[Version, Sequence[Level]] = dict.fromkeys(VERSIONS, tuple(Level))

    def __init__(self) -> None:
        self.robot: OracleRobot | None = None

    def load(self, description: Path, urdf: Path) -> Accepted:
        texts = description.read_bytes(), urdf.read_bytes()
        if texts not in _READ:
            if len(_READ) == _MOST_KEPT:
                _READ.clear()
            _READ[texts] = read(description, urdf)
        self.robot = _READ[texts]
        return accepted(self.robot.canonical())

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> list[Values]:
        assert self.robot is not None
        return [self.robot.evaluate(q, frames, quantities) for q in configurations]
