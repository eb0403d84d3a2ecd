"""Names of the formats, and of what a user can choose of an export; this module loads nothing."""

from __future__ import annotations

from typing import Literal, get_args

#: The formats to export to. One is the package here of its name, with ``_`` for ``-``.
EXPORTS = ("mjcf", "usd", "drake", "loop-joint", "sdf", "urdf")

#: What actuators become.
Actuators = Literal["motor", "position", "none"]

#: What 3d closures become: what the description states, or hinges where they move as hinges.
ClosureChoice = Literal["stated", "hinge"]

#: What ball joints become in MJCF: what the description states, or three hinges.
JointChoice = Literal["stated", "hinge"]

#: Whether mesh files are copied beside the file, or the file names them where they are.
MeshFileChoice = Literal["copy", "reference"]

ACTUATORS: tuple[str, ...] = get_args(Actuators)
CLOSURES: tuple[str, ...] = get_args(ClosureChoice)
JOINTS: tuple[str, ...] = get_args(JointChoice)
MESH_FILES: tuple[str, ...] = get_args(MeshFileChoice)
