"""The public names of the package, each with the module that defines it."""

from eurdf import batch as batch
from eurdf.checking.check import check as check
from eurdf.checking.load import load as load
from eurdf.collection import collection_names as collection_names
from eurdf.diagnostics import Diagnostic as Diagnostic
from eurdf.diagnostics.report import Report as Report
from eurdf.exceptions import CannotExpand as CannotExpand
from eurdf.exceptions import EurdfError as EurdfError
from eurdf.exceptions import InvalidRobot as InvalidRobot
from eurdf.exceptions import MissingExtra as MissingExtra
from eurdf.exceptions import RobotNotFound as RobotNotFound
from eurdf.exporting.coordinates import Coordinates as Coordinates
from eurdf.exporting.exceptions import CannotExport as CannotExport
from eurdf.exporting.export import Export as Export
from eurdf.exporting.export import export as export
from eurdf.kinematics.analysis import Analysis as Analysis
from eurdf.kinematics.analysis import LoopAnalysis as LoopAnalysis
from eurdf.kinematics.analysis import Motion as Motion
from eurdf.kinematics.analysis import analyze as analyze
from eurdf.kinematics.assembly import Assembly as Assembly
from eurdf.kinematics.assembly import assemble as assemble
from eurdf.kinematics.differential_inverse_kinematics import FrameVelocity as FrameVelocity
from eurdf.kinematics.differential_inverse_kinematics import (
    differential_inverse_kinematics as differential_inverse_kinematics,
)
from eurdf.kinematics.dynamics import ForwardDynamics as ForwardDynamics
from eurdf.kinematics.dynamics import InverseDynamics as InverseDynamics
from eurdf.kinematics.dynamics import achievable_acceleration as achievable_acceleration
from eurdf.kinematics.dynamics import forward_dynamics as forward_dynamics
from eurdf.kinematics.dynamics import inverse_dynamics as inverse_dynamics
from eurdf.kinematics.exceptions import CannotLock as CannotLock
from eurdf.kinematics.exceptions import DependentActuators as DependentActuators
from eurdf.kinematics.exceptions import InconsistentMotion as InconsistentMotion
from eurdf.kinematics.exceptions import LockedOpen as LockedOpen
from eurdf.kinematics.exceptions import NotClosable as NotClosable
from eurdf.kinematics.exceptions import NumericalOverflow as NumericalOverflow
from eurdf.kinematics.exceptions import SimulationDiverged as SimulationDiverged
from eurdf.kinematics.exceptions import StepTooLongWarning as StepTooLongWarning
from eurdf.kinematics.exceptions import UnderactuatedMotion as UnderactuatedMotion
from eurdf.kinematics.exceptions import UndeterminedMotion as UndeterminedMotion
from eurdf.kinematics.forward_kinematics import forward_kinematics as forward_kinematics
from eurdf.kinematics.inverse_kinematics import FrameError as FrameError
from eurdf.kinematics.inverse_kinematics import InverseKinematics as InverseKinematics
from eurdf.kinematics.inverse_kinematics import inverse_kinematics as inverse_kinematics
from eurdf.kinematics.locking import LockedRobot as LockedRobot
from eurdf.kinematics.locking import lock as lock
from eurdf.kinematics.mass_matrix import mass_matrix as mass_matrix
from eurdf.kinematics.opening import Opening as Opening
from eurdf.kinematics.position_limit import JointAtLimit as JointAtLimit
from eurdf.kinematics.projection import project_acceleration as project_acceleration
from eurdf.kinematics.projection import project_configuration as project_configuration
from eurdf.kinematics.projection import project_velocity as project_velocity
from eurdf.kinematics.residual import closure_openings as closure_openings
from eurdf.kinematics.residual import residual as residual
from eurdf.kinematics.residual import residual_and_jacobian as residual_and_jacobian
from eurdf.kinematics.sensitivity import actuated_jacobian as actuated_jacobian
from eurdf.kinematics.sensitivity import dq_dq_actuated as dq_dq_actuated
from eurdf.kinematics.simulation import Simulation as Simulation
from eurdf.kinematics.simulation import simulate as simulate
from eurdf.kinematics.split import merge_configuration as merge_configuration
from eurdf.kinematics.split import merge_velocity as merge_velocity
from eurdf.kinematics.split import split_configuration as split_configuration
from eurdf.kinematics.split import split_velocity as split_velocity
from eurdf.kinematics.springs import spring_energy as spring_energy
from eurdf.kinematics.springs import spring_force as spring_force
from eurdf.kinematics.sweep import MotionPath as MotionPath
from eurdf.kinematics.sweep import Sweep as Sweep
from eurdf.kinematics.sweep import sweep as sweep
from eurdf.loss import Loss as Loss
from eurdf.mechanism.mechanism import Mechanism as Mechanism
from eurdf.pinocchio.constraint import NoConstraintModel as NoConstraintModel
from eurdf.pinocchio.robot import Robot as Robot

__version__: str
