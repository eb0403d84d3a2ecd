"""The public names, each with the module that defines it."""

from eurdf.explanation import Explanation as Explanation
from eurdf.kinematics.analysis import Analysis as Analysis
from eurdf.kinematics.assembly import Assembly as Assembly
from eurdf.kinematics.calibration import Calibration as Calibration
from eurdf.kinematics.derivatives import DynamicsDerivatives as DynamicsDerivatives
from eurdf.kinematics.derivatives import InverseDynamicsDerivatives as InverseDynamicsDerivatives
from eurdf.kinematics.dynamics import Forces as Forces
from eurdf.kinematics.dynamics import ForwardDynamics as ForwardDynamics
from eurdf.kinematics.dynamics import InverseDynamics as InverseDynamics
from eurdf.kinematics.inverse import FrameError as FrameError
from eurdf.kinematics.inverse import InverseKinematics as InverseKinematics
from eurdf.kinematics.locking import LockedRobot as LockedRobot
from eurdf.kinematics.loop_analysis import LoopAnalysis as LoopAnalysis
from eurdf.kinematics.loop_analysis import Motion as Motion
from eurdf.kinematics.opening import Opening as Opening
from eurdf.kinematics.position_limit import JointAtLimit as JointAtLimit
from eurdf.kinematics.regressor import InertialRegressor as InertialRegressor
from eurdf.kinematics.sensitivity import FrameVelocity as FrameVelocity
from eurdf.kinematics.simulation import Simulation as Simulation
from eurdf.kinematics.sweep import MotionPath as MotionPath
from eurdf.kinematics.sweep import Sweep as Sweep
from eurdf.writing.generation import Generation as Generation
from eurdf.writing.migration import Migration as Migration
