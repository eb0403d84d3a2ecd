"""The public names, each with the module that defines it."""

from eurdf.robot_functions import achievable_acceleration as achievable_acceleration
from eurdf.robot_functions import calibrate as calibrate
from eurdf.robot_functions import closure_openings as closure_openings
from eurdf.robot_functions import constraint_acceleration as constraint_acceleration
from eurdf.robot_functions import dq_dq_actuated as dq_dq_actuated
from eurdf.robot_functions import dq_dq_actuated_derivative as dq_dq_actuated_derivative
from eurdf.robot_functions import inertial_regressor as inertial_regressor
from eurdf.robot_functions import inverse_dynamics_derivatives as inverse_dynamics_derivatives
from eurdf.robot_functions import merge_velocity as merge_velocity
from eurdf.robot_functions import split_velocity as split_velocity
