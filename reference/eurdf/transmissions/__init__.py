"""The transmission between motors and the joints of an equivalent serial robot: motor side ↔ serial side.

The package is not named ``transmission``, since `eurdf.transmission` is the function.
"""

from eurdf.public_names import public_names as _public_names

__getattr__, __dir__ = _public_names(__name__, __file__)
