"""The functions of the kinematics that take any robot: a `Robot`, a path, or the name of a robot of the collection."""

from __future__ import annotations

from eurdf.kinematics import (
    analysis,
    assembly,
    calibration,
    derivatives,
    dynamics,
    forward,
    inverse,
    locking,
    project,
    regressor,
    sensitivity,
    simulation,
)
from eurdf.kinematics import residual as _residual
from eurdf.kinematics import split as _split
from eurdf.kinematics import sweep as _sweep
from eurdf.loading import of_any_robot

achievable_acceleration = of_any_robot(dynamics.achievable_acceleration)
actuated_jacobian = of_any_robot(sensitivity.actuated_jacobian)
analyze = of_any_robot(analysis.analyze)
assemble = of_any_robot(assembly.assemble)
calibrate = of_any_robot(calibration.calibrate)
closure_openings = of_any_robot(_residual.closure_openings)
constraint_acceleration = of_any_robot(_residual.constraint_acceleration)
differential_inverse_kinematics = of_any_robot(sensitivity.differential_inverse_kinematics)
dq_dq_actuated = of_any_robot(sensitivity.dq_dq_actuated)
dq_dq_actuated_derivative = of_any_robot(derivatives.dq_dq_actuated_derivative)
dynamics_derivatives = of_any_robot(derivatives.dynamics_derivatives)
forward_dynamics = of_any_robot(dynamics.forward_dynamics)
forward_kinematics = of_any_robot(forward.forward_kinematics)
inertial_regressor = of_any_robot(regressor.inertial_regressor)
inverse_dynamics = of_any_robot(dynamics.inverse_dynamics)
inverse_dynamics_derivatives = of_any_robot(derivatives.inverse_dynamics_derivatives)
inverse_kinematics = of_any_robot(inverse.inverse_kinematics)
lock = of_any_robot(locking.lock, geometry=True)
mass_matrix = of_any_robot(dynamics.mass_matrix)
merge_configuration = of_any_robot(_split.merge_configuration)
merge_velocity = of_any_robot(_split.merge_velocity)
project_acceleration = of_any_robot(project.project_acceleration)
project_configuration = of_any_robot(project.project_configuration)
project_velocity = of_any_robot(project.project_velocity)
residual = of_any_robot(_residual.residual)
residual_and_jacobian = of_any_robot(_residual.residual_and_jacobian)
simulate = of_any_robot(simulation.simulate)
split_configuration = of_any_robot(_split.split_configuration)
split_velocity = of_any_robot(_split.split_velocity)
sweep = of_any_robot(_sweep.sweep)
