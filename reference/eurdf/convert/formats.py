"""Names of the formats, and of what a user can choose of an export; this module loads no format."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Literal, get_args

from eurdf.diagnostics.wording import did_you_mean

#: The formats to export to. One is the package here of its name, with ``_`` for ``-``.
EXPORTS = ("mjcf", "usd", "drake", "loop-joint", "sdf", "urdf")

# The format of each program, by words that people use for it.
_PROGRAMS = {
    "mjcf": "mujoco mjx mjlab brax",
    "usd": "isaac isaacsim isaaclab omniverse newton usda usdc",
    "sdf": "gazebo gz ignition sdformat",
    "urdf": "pinocchio ros pybullet moveit",
}


def format_meant(word: str, formats: Iterable[str]) -> str:
    """What to say of a word that is no format: the one that was probably meant, or all."""
    formats, folded = tuple(formats), re.sub(r"[^a-z0-9]", "", word.casefold())
    meant = next((name for name, words in _PROGRAMS.items() if name in formats and folded in words.split()), None)
    hint = f"did you mean '{meant}'?" if meant else did_you_mean(word, formats)
    return hint or f"the formats are: {', '.join(formats)}"


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
