"""The transmission between motors and the joints of an equivalent serial robot: motor side ↔ serial side.

The package is not named ``transmission``, since `eurdf.transmission` is the function.
"""
