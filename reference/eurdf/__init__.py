"""Extended URDF: robots with closed kinematic chains, from a URDF and one YAML file.

The public names are loaded when first used, so that checking a file does not wait for a simulator.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eurdf.checking import check
    from eurdf.collection import collection_names
    from eurdf.diagnostics import Diagnostic
    from eurdf.diagnostics.report import Report
    from eurdf.exceptions import (
        CannotExpand,
        CannotLock,
        DependentActuators,
        EurdfError,
        InconsistentMotion,
        InvalidRobot,
        LockedOpen,
        MissingExtra,
        NotClosable,
        RobotNotFound,
        SimulationDiverged,
        UnderactuatedMotion,
        UndeterminedMotion,
    )
    from eurdf.kinematics.analysis import Analysis, LoopAnalysis, Motion, analyze
    from eurdf.kinematics.assembly import Assembly, assemble
    from eurdf.kinematics.differential_inverse_kinematics import FrameVelocity, differential_inverse_kinematics
    from eurdf.kinematics.dynamics import (
        ForwardDynamics,
        InverseDynamics,
        achievable_acceleration,
        forward_dynamics,
        inverse_dynamics,
    )
    from eurdf.kinematics.forward_kinematics import forward_kinematics
    from eurdf.kinematics.inverse_kinematics import FrameError, InverseKinematics, inverse_kinematics
    from eurdf.kinematics.locking import LockedRobot, lock
    from eurdf.kinematics.mass_matrix import mass_matrix
    from eurdf.kinematics.position_limit import JointAtLimit
    from eurdf.kinematics.projection import project_acceleration, project_configuration, project_velocity
    from eurdf.kinematics.residual import Opening, closure_openings, residual, residual_and_jacobian
    from eurdf.kinematics.sensitivity import actuated_jacobian, dq_dq_actuated
    from eurdf.kinematics.simulation import Simulation, simulate
    from eurdf.kinematics.split import merge_configuration, merge_velocity, split_configuration, split_velocity
    from eurdf.kinematics.sweep import Sweep, Way, sweep
    from eurdf.loading import load
    from eurdf.mechanism.mechanism import Mechanism
    from eurdf.pinocchio.robot import Robot

__version__ = "0.1.0"

_NAMES = {
    "eurdf.checking": ("check",),
    "eurdf.collection": ("collection_names",),
    "eurdf.diagnostics": ("Diagnostic",),
    "eurdf.diagnostics.report": ("Report",),
    "eurdf.exceptions": (
        "CannotExpand",
        "CannotLock",
        "DependentActuators",
        "EurdfError",
        "InconsistentMotion",
        "InvalidRobot",
        "LockedOpen",
        "MissingExtra",
        "NotClosable",
        "RobotNotFound",
        "SimulationDiverged",
        "UnderactuatedMotion",
        "UndeterminedMotion",
    ),
    "eurdf.kinematics.analysis": ("Analysis", "LoopAnalysis", "Motion", "analyze"),
    "eurdf.kinematics.assembly": (
        "Assembly",
        "assemble",
    ),
    "eurdf.kinematics.differential_inverse_kinematics": (
        "FrameVelocity",
        "differential_inverse_kinematics",
    ),
    "eurdf.kinematics.dynamics": (
        "ForwardDynamics",
        "InverseDynamics",
        "achievable_acceleration",
        "forward_dynamics",
        "inverse_dynamics",
    ),
    "eurdf.kinematics.forward_kinematics": ("forward_kinematics",),
    "eurdf.kinematics.inverse_kinematics": (
        "FrameError",
        "InverseKinematics",
        "inverse_kinematics",
    ),
    "eurdf.kinematics.locking": (
        "LockedRobot",
        "lock",
    ),
    "eurdf.kinematics.mass_matrix": ("mass_matrix",),
    "eurdf.kinematics.position_limit": ("JointAtLimit",),
    "eurdf.kinematics.projection": (
        "project_acceleration",
        "project_configuration",
        "project_velocity",
    ),
    "eurdf.kinematics.residual": (
        "Opening",
        "closure_openings",
        "residual",
        "residual_and_jacobian",
    ),
    "eurdf.kinematics.sensitivity": (
        "actuated_jacobian",
        "dq_dq_actuated",
    ),
    "eurdf.kinematics.simulation": (
        "Simulation",
        "simulate",
    ),
    "eurdf.kinematics.split": (
        "merge_configuration",
        "merge_velocity",
        "split_configuration",
        "split_velocity",
    ),
    "eurdf.kinematics.sweep": ("Sweep", "Way", "sweep"),
    "eurdf.loading": ("load",),
    "eurdf.mechanism.mechanism": ("Mechanism",),
    "eurdf.pinocchio.robot": ("Robot",),
}
_HOMES = {name: home for home, names in _NAMES.items() for name in names}

__all__ = [
    "Analysis",
    "Assembly",
    "CannotExpand",
    "CannotLock",
    "DependentActuators",
    "Diagnostic",
    "EurdfError",
    "ForwardDynamics",
    "FrameError",
    "FrameVelocity",
    "InconsistentMotion",
    "InvalidRobot",
    "InverseDynamics",
    "InverseKinematics",
    "JointAtLimit",
    "LockedOpen",
    "LockedRobot",
    "LoopAnalysis",
    "Mechanism",
    "MissingExtra",
    "Motion",
    "NotClosable",
    "Opening",
    "Report",
    "Robot",
    "RobotNotFound",
    "Simulation",
    "SimulationDiverged",
    "Sweep",
    "UnderactuatedMotion",
    "UndeterminedMotion",
    "Way",
    "__version__",
    "achievable_acceleration",
    "actuated_jacobian",
    "analyze",
    "assemble",
    "check",
    "closure_openings",
    "collection_names",
    "differential_inverse_kinematics",
    "dq_dq_actuated",
    "forward_dynamics",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_kinematics",
    "load",
    "lock",
    "mass_matrix",
    "merge_configuration",
    "merge_velocity",
    "project_acceleration",
    "project_configuration",
    "project_velocity",
    "residual",
    "residual_and_jacobian",
    "simulate",
    "split_configuration",
    "split_velocity",
    "sweep",
]


def __getattr__(name: str) -> Any:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'eurdf' has no attribute '{name}'")
    value = getattr(importlib.import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
