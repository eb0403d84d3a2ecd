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
    from eurdf.exceptions import EurdfError, InvalidRobot, RobotNotFound
    from eurdf.kinematics.analysis import Analysis, analyze
    from eurdf.kinematics.assembly import Assembly, assemble
    from eurdf.loading import load
    from eurdf.mechanism.mechanism import Mechanism
    from eurdf.pinocchio.robot import Robot

__version__ = "0.1.0"

_HOMES = {
    "Analysis": "eurdf.kinematics.analysis",
    "Assembly": "eurdf.kinematics.assembly",
    "Diagnostic": "eurdf.diagnostics",
    "EurdfError": "eurdf.exceptions",
    "InvalidRobot": "eurdf.exceptions",
    "Mechanism": "eurdf.mechanism.mechanism",
    "Report": "eurdf.diagnostics.report",
    "Robot": "eurdf.pinocchio.robot",
    "RobotNotFound": "eurdf.exceptions",
    "analyze": "eurdf.kinematics.analysis",
    "assemble": "eurdf.kinematics.assembly",
    "check": "eurdf.checking",
    "collection_names": "eurdf.collection",
    "load": "eurdf.loading",
}

__all__ = [
    "Analysis",
    "Assembly",
    "Diagnostic",
    "EurdfError",
    "InvalidRobot",
    "Mechanism",
    "Report",
    "Robot",
    "RobotNotFound",
    "__version__",
    "analyze",
    "assemble",
    "check",
    "collection_names",
    "load",
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
