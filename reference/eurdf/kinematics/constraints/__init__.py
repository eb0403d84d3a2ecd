"""The kinds of constraint: for each its residual, Jacobian, drift and scale.

To add a kind: a class in `eurdf.mechanism.constraint`, a file here, and its line in `KINDS`.
"""

from __future__ import annotations

from typing import Any

from eurdf.kinematics.constraints.coupling import Couplings
from eurdf.kinematics.constraints.distance import DistanceClosures
from eurdf.kinematics.constraints.frame import FrameClosures
from eurdf.kinematics.constraints.hinge import HingeClosures
from eurdf.kinematics.constraints.kind import Kind
from eurdf.kinematics.constraints.point import PointClosures
from eurdf.mechanism.constraint import Constraint

_ALL: tuple[type[Kind[Any]], ...] = (PointClosures, FrameClosures, HingeClosures, DistanceClosures, Couplings)

#: What evaluates the constraints of each class.
KINDS: dict[type[Constraint], type[Kind[Any]]] = {kind.data: kind for kind in _ALL}
