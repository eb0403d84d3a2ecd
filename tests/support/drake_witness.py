"""Drake as a witness: an exported robot in a `MultibodyPlant`."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pydrake", reason="Drake is not installed: pip install -e '.[drake]'")

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant

import eurdf
from eurdf.pinocchio.robot import Robot

# It warns of each unphysical inertia, and that friction has no effect, which is a loss.
logging.getLogger("drake").setLevel(logging.ERROR)


class InDrake:
    """An exported robot in Drake."""

    def __init__(self, robot: Robot, export: eurdf.Export, kind: str = "urdf", time_step: float = 1e-3) -> None:
        self.robot, self.coordinates = robot, export.coordinates
        self.plant = plant = MultibodyPlant(time_step)
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        Parser(plant).AddModelsFromString(export.main.decode(), kind)
        plant.Finalize()
        self.context = plant.CreateDefaultContext()

    @property
    def names(self) -> list[str]:
        """Names of the joints that move, in the order of Drake's vectors."""
        joints = [self.plant.get_joint(index) for index in self.plant.GetJointIndices()]
        moving = [joint for joint in joints if joint.num_positions()]
        return [joint.name() for joint in sorted(moving, key=lambda joint: joint.position_start())]

    def at(self, q: Any, v: Any | None = None) -> None:
        self.plant.SetPositions(self.context, self.coordinates.to_q(q))
        v = np.zeros(self.robot.model.nv) if v is None else v
        self.plant.SetVelocities(self.context, self.coordinates.to_v(q, v))

    def pose(self, frame: str) -> Any:
        """Of a link or a frame, (4, 4)."""
        return self.plant.GetFrameByName(frame).CalcPoseInWorld(self.context).GetAsMatrix4()

    @property
    def mass_matrix(self) -> Any:
        return self.plant.CalcMassMatrix(self.context)

    @property
    def bias(self) -> Any:
        """Forces of inertia and gravity at no acceleration."""
        return self.plant.CalcBiasTerm(self.context) - self.plant.CalcGravityGeneralizedForces(self.context)
