"""Kinematics of many configurations at once, for sampling, workspace maps and data sets.

Each function takes and returns arrays whose first axis has B elements, and equals the function of the same name in
`eurdf`, element by element, to 1e-9. Elements that do not converge state the reason and do not affect others. Memory is
bounded, since elements are worked on in blocks; blocks can go to threads, or to any `concurrent.futures.Executor`.
"""

from eurdf.kinematics.batch import ActuatedJacobian as ActuatedJacobian
from eurdf.kinematics.batch import ForwardKinematics as ForwardKinematics
from eurdf.kinematics.batch import ForwardKinematicsReason as ForwardKinematicsReason
from eurdf.kinematics.batch import InverseKinematics as InverseKinematics
from eurdf.kinematics.batch import Projection as Projection
from eurdf.kinematics.batch import actuated_jacobian as actuated_jacobian
from eurdf.kinematics.batch import forward_kinematics as forward_kinematics
from eurdf.kinematics.batch import inverse_kinematics as inverse_kinematics
from eurdf.kinematics.batch import project_configuration as project_configuration
from eurdf.kinematics.batch import residual as residual
from eurdf.kinematics.batch import residual_and_jacobian as residual_and_jacobian
