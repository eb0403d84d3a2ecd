"""URDF with the loop joints of Isaac Sim."""
