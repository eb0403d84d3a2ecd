"""The reference parser, `eurdf`, behind the protocol: ``--parser=eurdf_conformance.adapters.reference:PARSER``."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import eurdf
from eurdf.advice.loops import closure_diagnostics
from eurdf.diagnostics import Diagnostic
from eurdf.diagnostics.wording import encodable
from eurdf.errors import RobotNotFound
from eurdf.linking.mesh_files import find_meshes
from eurdf.linking.robot_files import ReadRobot, read_robot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf_conformance.adapters.reference_canonical import canonical_robot
from eurdf_conformance.adapters.reference_values import Quantities
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Issue, Quantity, Rejected, Values
from eurdf_conformance.protocol.reply import accepted, rejected


class Reference:
    """`eurdf` as a parser. Subclasses can change one method at a time."""

    name = "eurdf"
    version = eurdf.__version__
    language = "Python"
    claims: Mapping[Version, Sequence[Level]] = dict.fromkeys(VERSIONS, tuple(Level))

    def __init__(self) -> None:
        self._robot: Robot | None = None

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        """EU-PRO-004: read a robot; it is rejected if it could only be built by guessing (EU-CNF-001).

        Errors of inertia and of closures are reported with the robot (EU-CNF-003).
        """
        self._robot = None
        try:
            read = self.describe(description, urdf)
        except RobotNotFound as none:
            code = "file-unreadable"
            return rejected(Issue(code=code, file=description.name, line=None, column=None, message=str(none)))
        found = list(read.diagnostics)
        if read.tree is not None:
            found += find_meshes(read.urdf).diagnostics
        if read.linked is None or read.diagnostics.refused:
            return rejected(*self.issues(found))
        self._robot = build_robot(read.mechanism, geometry=False)
        found += closure_diagnostics(read, self._robot)
        return accepted(self.canonical(read.mechanism), self.issues(found))

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> list[Values]:
        """EU-PRO-005: evaluate the robot of the last `load`."""
        if self._robot is None:
            raise ValueError("the last load did not accept a robot")
        return [self.values(self._robot, each, frames, quantities) for each in configurations]

    def describe(self, description: Path, urdf: Path) -> ReadRobot:
        """The robot as read. The parser itself checks that the URDF of the description exists."""
        return read_robot(description, urdf if os.path.lexists(urdf) else None)

    def issues(self, found: Iterable[Diagnostic]) -> list[Issue]:
        """Diagnostics in the form of the protocol."""
        return [
            Issue(
                code=each.code,
                severity=each.severity.value,
                file=encodable(Path(each.file).name),
                line=each.line,
                column=each.column,
                message=encodable(each.message + (f" ({each.hint})" if each.hint else "")),
            )
            for each in found
        ]

    def canonical(self, mechanism: Mechanism) -> CanonicalRobot:
        """The canonical description."""
        return canonical_robot(mechanism)

    def values(
        self,
        robot: Robot,
        configuration: Mapping[str, Sequence[float]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> Values:
        """The requested quantities at one configuration."""
        return Quantities(robot, configuration, frames).values(quantities)


PARSER = Reference()
