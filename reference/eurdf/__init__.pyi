"""The public names of the package, each with the module that defines it."""

from eurdf import batch as batch
from eurdf import convert as convert
from eurdf import errors as errors
from eurdf import kinematics as kinematics
from eurdf import results as results
from eurdf import springs as springs
from eurdf import transmissions as transmissions
from eurdf import viewing as viewing
from eurdf.collection import collection_names as collection_names
from eurdf.convert.export import export as export
from eurdf.convert.import_robot import import_robot as import_robot
from eurdf.convert.simplify import simplify as simplify
from eurdf.diagnostics import Diagnostic as Diagnostic
from eurdf.diagnostics.report import Report as Report
from eurdf.errors import EurdfError as EurdfError
from eurdf.errors import InvalidRobot as InvalidRobot
from eurdf.loading import check as check
from eurdf.loading import load as load
from eurdf.mechanism.mechanism import Mechanism as Mechanism
from eurdf.pinocchio.robot import Robot as Robot
from eurdf.robot_functions import actuated_jacobian as actuated_jacobian
from eurdf.robot_functions import analyze as analyze
from eurdf.robot_functions import assemble as assemble
from eurdf.robot_functions import differential_inverse_kinematics as differential_inverse_kinematics
from eurdf.robot_functions import dynamics_derivatives as dynamics_derivatives
from eurdf.robot_functions import forward_dynamics as forward_dynamics
from eurdf.robot_functions import forward_kinematics as forward_kinematics
from eurdf.robot_functions import inverse_dynamics as inverse_dynamics
from eurdf.robot_functions import inverse_kinematics as inverse_kinematics
from eurdf.robot_functions import lock as lock
from eurdf.robot_functions import mass_matrix as mass_matrix
from eurdf.robot_functions import merge_configuration as merge_configuration
from eurdf.robot_functions import project_acceleration as project_acceleration
from eurdf.robot_functions import project_configuration as project_configuration
from eurdf.robot_functions import project_velocity as project_velocity
from eurdf.robot_functions import residual as residual
from eurdf.robot_functions import residual_and_jacobian as residual_and_jacobian
from eurdf.robot_functions import simulate as simulate
from eurdf.robot_functions import split_configuration as split_configuration
from eurdf.robot_functions import sweep as sweep
from eurdf.transmissions.transmission import transmission as transmission
from eurdf.viewing.viewer import view as view
from eurdf.writing.new_description import generate as generate
from eurdf.writing.new_description import migrate as migrate

__version__: str
