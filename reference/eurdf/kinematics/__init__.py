"""Kinematics of the closed mechanism: residual of the closures, assembly, dimensions."""

from eurdf.public_names import public_names as _public_names

__getattr__, __dir__ = _public_names(__name__, __file__)
