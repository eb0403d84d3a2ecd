"""Drake on an exported robot."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from pydrake.systems.analysis import Simulator

import eurdf
from benchmarks.simulators.run import Refused, Run, split
from eurdf.convert.verification.drake_model import Plant
from eurdf.convert.verification.read_model import CannotRead


def run_drake(robot: eurdf.Robot, step: float, steps: int) -> Run | Refused:
    """Simulate a robot with Drake, in discrete time with the SAP solver, the one that has constraints."""
    export = eurdf.export(robot, "drake")
    try:
        plant = Plant(export.main.decode(), "urdf", step).plant
        simulator = Simulator(plant)
    except (CannotRead, RuntimeError) as error:
        return Refused(str(error))
    context = simulator.get_mutable_context()
    start: Any = export.coordinates.to_q(robot.configurations["assembled"])
    plant.SetPositions(context, start)
    bodies = [plant.get_body(index) for index in plant.GetBodyIndices(plant.GetModelInstanceByName(robot.model.name))]
    bodies = [body for body in bodies if body.name() in {each.name for each in robot.mechanism.bodies}]
    found = np.empty((steps + 1, len(bodies), 18))
    seconds = 0.0
    for index in range(steps + 1):
        for number, body in enumerate(bodies):
            pose = plant.EvalBodyPoseInWorld(context, body)
            velocity = plant.EvalBodySpatialVelocityInWorld(context, body)
            centre = pose.rotation().matrix() @ body.CalcCenterOfMassInBodyFrame(context)
            linear = velocity.translational() + np.cross(velocity.rotational(), centre)
            R = pose.rotation().matrix().ravel()
            found[index, number] = np.concatenate((R, pose.translation(), linear, velocity.rotational()))
        if index < steps:
            begin = time.process_time()
            try:
                simulator.AdvanceTo((index + 1) * step)
            except RuntimeError as error:
                return Refused(f"at {index * step:.2g} s: {error}")
            seconds += time.process_time() - begin
    rows = 3 * plant.num_constraints()  # of these robots, all are ball constraints: one for 3d, three for 6d
    names = tuple(body.name() for body in bodies)
    duration = step * steps
    return Run(plant.num_velocities(), rows, names, *split(found), duration=duration, seconds=seconds / duration)
