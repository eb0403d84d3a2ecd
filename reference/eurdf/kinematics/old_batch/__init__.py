"""Kinematics of many elements at once; the public names are those of `eurdf.batch`.

Each function does for arrays of elements what the function of the same name in `eurdf` does for one. Elements are first
in arguments and results, and last within.
"""
