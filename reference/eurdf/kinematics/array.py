"""Types of the arrays that the kinematics passes on."""

from __future__ import annotations

from eurdf.array import Indices as Indices
from eurdf.array import Mask as Mask
from eurdf.array import Matrix as Matrix
from eurdf.array import Vector as Vector
