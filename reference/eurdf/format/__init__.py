"""The two files as typed data: the description of either version, and the URDF."""
