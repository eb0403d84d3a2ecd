"""The URDF as typed data, checked by itself: numbers, names, and one tree of links.

What urdfdom and Pinocchio swallow in silence (a link with two parents, a second root, a missing mass) is refused here,
before any C++ sees the file.
"""
