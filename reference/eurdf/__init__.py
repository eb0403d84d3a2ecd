"""Extended URDF: robots with closed kinematic chains, from a URDF and one YAML file."""

from eurdf.public_names import public_names as _public_names

__version__ = "0.1.0"

__getattr__, __dir__ = _public_names(__name__, __file__)
