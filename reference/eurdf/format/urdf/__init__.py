"""The URDF as typed data, checked without the YAML file: numbers, names, and one tree of links.

It rejects what urdfdom and Pinocchio accept silently (a link with two parents, a second root, a missing mass) before
any C++ reads the file.
"""
