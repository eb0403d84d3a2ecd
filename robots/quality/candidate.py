"""A robot to check, with the results that several rules share."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import eurdf
from eurdf.array import Vector
from eurdf.collection import find_robot
from eurdf.kinematics.sweep import Sweep


@dataclass(frozen=True)
class Candidate:
    """A robot in its folder.

    Attributes:
        path: Its description, or its URDF if it has no description.
    """

    path: Path

    @classmethod
    def find(cls, path: str | os.PathLike[str]) -> Candidate:
        """The robot at a path or with a name of the collection.

        Raises:
            RobotNotFound: There is no such robot.
        """
        files = find_robot(path)
        found = files.description or files.urdf
        if not isinstance(found, Path):
            raise eurdf.errors.RobotNotFound(str(path), f"'{path}' is not a file; give the folder of a robot")
        return cls(found.resolve())

    @property
    def folder(self) -> Path:
        """The folder of its files."""
        return self.path.parent

    @cached_property
    def robot(self) -> eurdf.Robot:
        """The robot, loaded without geometry.

        Raises:
            InvalidRobot: It cannot be built.
        """
        return eurdf.load(self.path, geometry=False)

    @property
    def assembled(self) -> Vector | None:
        """Its assembled configuration (nq,), if it has one."""
        return self.robot.configurations.get("assembled")

    @cached_property
    def closes(self) -> bool:
        """Whether a closed configuration is found from the assembled one."""
        return eurdf.assemble(self.robot).closes

    @cached_property
    def sweeps(self) -> dict[str, Sweep | str]:
        """For each actuator of a robot that closes its sweep, or why it has none."""
        found: dict[str, Sweep | str] = {}
        for actuator in self.robot.actuation.joints:
            try:
                found[actuator] = eurdf.sweep(self.robot, actuator)
            except ValueError as reason:
                found[actuator] = str(reason)
        return found
