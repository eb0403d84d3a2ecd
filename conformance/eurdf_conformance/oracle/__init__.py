"""The oracle: a second implementation of the semantics, written from the specification alone.

It is here to compare with, so it is plain before it is quick: NumPy, and about one section of the specification a
module. It reads valid files; whatever it is not sure of it does not read, and says so.

Data flows one way: `yaml_text` and `urdf` read text; `version1` and `version2` make of it one `description`, which is
of either version; `tree` changes the joints by that; `kinematics`, `residual`, `jacobian` and `mass_matrix` say where
things are and how they move; `canonical` says what was read.
"""

from eurdf_conformance.oracle.dimensions import Dimensions
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.read import read
from eurdf_conformance.oracle.robot import OracleRobot

__all__ = ["Dimensions", "NotRead", "OracleRobot", "read"]
