"""Plain URDF: a spanning tree."""
