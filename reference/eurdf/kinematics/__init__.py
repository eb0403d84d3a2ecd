"""Kinematics of the closed mechanism: residual of the closures, assembly, dimensions."""
