"""Mesh files: where they may be, what they must be, and the other files that they name."""
