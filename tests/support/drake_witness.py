"""Drake as a witness: an exported robot in a `MultibodyPlant`."""

from __future__ import annotations

import tempfile
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pydrake", reason="Drake is not installed: pip install -e '.[drake]'")

import eurdf
from eurdf.convert.verification.drake_model import Plant, SdfTree
from eurdf.convert.verification.read_model import Exported
from eurdf.pinocchio.robot import Robot


class InDrake(Plant):
    """An exported robot in Drake."""

    def __init__(self, robot: Robot, export: eurdf.convert.Export, kind: str = "urdf", time_step: float = 1e-3) -> None:
        super().__init__(export.main.decode(), kind, time_step)
        self.robot, self.coordinates = robot, export.coordinates

    @property
    def names(self) -> list[str]:
        """Names of the joints that move, in the order of Drake's vectors."""
        return [joint.name() for joint in self.joints]

    def at(self, q: Any, v: Any | None = None) -> Any:
        """Move there; returns T: Drake's velocities are T v."""
        self.plant.SetPositions(self.context, self.coordinates.to_q(q))
        v = np.zeros(self.robot.model.nv) if v is None else v
        self.plant.SetVelocities(self.context, self.coordinates.to_v(q, v))
        return self.coordinates.rates(q)

    @property
    def inertia_matrix(self) -> Any:
        return self.mass_matrix

    @property
    def bias(self) -> Any:
        """Forces of inertia and gravity at no acceleration."""
        return self.plant.CalcBiasTerm(self.context) - self.plant.CalcGravityGeneralizedForces(self.context)


class TreeInDrake(SdfTree):
    """The tree of a robot exported to SDFormat, in Drake."""

    def __init__(self, robot: Robot, export: eurdf.convert.Export) -> None:
        with tempfile.TemporaryDirectory() as folder:
            super().__init__(Exported(export.write(folder)[0], robot, export.coordinates, export.start))
        self.names = list(export.coordinates.names)  # Drake's vectors are in another order, which `at` knows

    bias = None

    def at(self, q: Any, v: Any | None = None) -> Any:
        return super().at(q)

    def pose(self, frame: str) -> Any:
        return self.there.pose(frame)

    @property
    def inertia_matrix(self) -> Any:
        return self.there.mass_matrix
