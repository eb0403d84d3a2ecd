"""The public names, each with the module that defines it."""

from eurdf.transmissions.array_kernel import ArrayMap as ArrayMap
from eurdf.transmissions.grid_search import BoundaryPoint as BoundaryPoint
from eurdf.transmissions.impedance import Impedance as Impedance
from eurdf.transmissions.impedance import impedance_map as impedance_map
from eurdf.transmissions.inertia import ReflectedInertia as ReflectedInertia
from eurdf.transmissions.inertia import reflected_inertia as reflected_inertia
from eurdf.transmissions.limits import CommonLimits as CommonLimits
from eurdf.transmissions.limits import SerialLimits as SerialLimits
from eurdf.transmissions.limits import serial_limits as serial_limits
from eurdf.transmissions.plot import plot_workspace as plot_workspace
from eurdf.transmissions.polynomial_map import PolynomialMap as PolynomialMap
from eurdf.transmissions.polytope import Polytope as Polytope
from eurdf.transmissions.positions import Positions as Positions
from eurdf.transmissions.positions import actuator_values as actuator_values
from eurdf.transmissions.positions import joint_values as joint_values
from eurdf.transmissions.prepared import PreparedTransmission as PreparedTransmission
from eurdf.transmissions.prepared import prepare_transmission as prepare_transmission
from eurdf.transmissions.reach import Stop as Stop
from eurdf.transmissions.reachable_set import Workspace as Workspace
from eurdf.transmissions.reachable_set import workspace as workspace
from eurdf.transmissions.serial_model import SerialTwin as SerialTwin
from eurdf.transmissions.serial_model import serial_twin as serial_twin
from eurdf.transmissions.transmission import Transmission as Transmission
from eurdf.transmissions.transmission import Transmissions as Transmissions
