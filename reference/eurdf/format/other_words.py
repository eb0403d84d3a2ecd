"""What other formats and textbooks call what a description states, and how they write a number."""

from __future__ import annotations

import math
import re

from eurdf.closures import REGISTRY

#: Types of joints; those that a URDF has too are for the hint on these.
_JOINTS = {
    "spherical": "ball socket ball_socket ball_and_socket sphere",
    "universal": "cardan hooke hooke_s hookes u gimbal",
    "helical": "screw ball_screw lead_screw",
    "cylindrical": "cylinder",
    "fixed": "weld welded rigid lock locked",
    "revolute": "pin hinge rotary rotational",
    "prismatic": "slide slider sliding linear",
}

_UNITS = {
    **dict.fromkeys(("deg", "degree", "degrees", "°"), (math.pi / 180.0, "rad")),
    "rad": (1.0, "rad"),
    "m": (1.0, "m"),
    "mm": (0.001, "m"),
}
_WITH_UNIT = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*\*?\s*([a-z]+|°)", re.IGNORECASE)
_WITH_PI = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)?)\s*\*?\s*(?:pi|π)\s*(?:/\s*(\d+\.?\d*))?", re.IGNORECASE)


def type_meant(key: str | int, word: str) -> str | None:
    """The type that a word means under a key of the file, 'closures', 'joints' or those of version 1; None if none."""
    kinds = _JOINTS if str(key).startswith("joint") else {type_: kind.called for type_, kind in REGISTRY.items()}
    folded = re.sub(r"[^a-z0-9]+", "_", word.casefold()).strip("_").removesuffix("_joint")
    return next((type_ for type_, words in kinds.items() if folded in (type_, *words.split())), None)


def number_meant(text: str) -> tuple[float, str] | None:
    """The number that a text states with a unit or π, and its unit in a description; None if it is neither."""
    if found := _WITH_UNIT.fullmatch(text.strip()):
        number, unit = found.groups()
        if unit.casefold() in _UNITS:
            factor, ours = _UNITS[unit.casefold()]
            return float(number) * factor, ours
    if (found := _WITH_PI.fullmatch(text.strip())) and float(found[2] or 1.0):
        sign = f"{found[1]}1" if found[1] in ("", "+", "-") else found[1]
        return float(sign) * math.pi / float(found[2] or 1.0), "rad"
    return None
