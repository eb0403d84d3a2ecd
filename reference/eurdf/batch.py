"""Kinematics of many configurations at once, for sampling, workspace maps and data sets.

Each function takes and returns arrays whose first axis has B elements, and equals the function of the same name in
`eurdf`, element by element, to 1e-9. Elements that do not converge state the reason and do not affect others. Memory is
bounded, since elements are worked on in blocks; blocks can go to threads, or to any `concurrent.futures.Executor`.
"""

from __future__ import annotations

from eurdf.kinematics import batch
from eurdf.kinematics.batch import ActuatedJacobian as ActuatedJacobian
from eurdf.kinematics.batch import ForwardKinematics as ForwardKinematics
from eurdf.kinematics.batch import ForwardKinematicsReason as ForwardKinematicsReason
from eurdf.kinematics.batch import InverseKinematics as InverseKinematics
from eurdf.kinematics.batch import Projection as Projection
from eurdf.kinematics.batch import Solutions as Solutions
from eurdf.loading import of_any_robot as _of_any_robot

actuated_jacobian = _of_any_robot(batch.actuated_jacobian)
constraint_acceleration = _of_any_robot(batch.constraint_acceleration)
dynamics_derivatives = _of_any_robot(batch.dynamics_derivatives)
forward_kinematics = _of_any_robot(batch.forward_kinematics)
inverse_kinematics = _of_any_robot(batch.inverse_kinematics)
project_configuration = _of_any_robot(batch.project_configuration)
residual = _of_any_robot(batch.residual)
residual_and_jacobian = _of_any_robot(batch.residual_and_jacobian)
