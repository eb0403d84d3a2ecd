"""What other formats and textbooks call what a description states, and how they write a number."""

from __future__ import annotations

import math
import re
from collections.abc import Container, Mapping

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

_ROOTS = {"fixed": "world base static", "floating": "free freeflyer free_flyer float mobile"}

_KEYS = {
    "stiffness": "spring spring_stiffness spring_constant k",
    "rest": "springref spring_reference rest_position rest_length",
    "damping": "damper",
    "friction": "frictionloss friction_loss",
    "gear_ratio": "gear ratio reduction",
    "rotor_inertia": "rotor motor_inertia",
    "joint": "name motor",
    "link": "body",
    "xyz": "pos position translation",
    "rpy": "euler",
    "lower": "min minimum",
    "upper": "max maximum",
    "effort": "torque force max_torque max_force",
    "velocity": "speed max_speed",
}

_UNITS = {
    **dict.fromkeys(("deg", "degree", "degrees", "°"), (math.pi / 180.0, "rad")),
    "rad": (1.0, "rad"),
    "m": (1.0, "m"),
    "mm": (0.001, "m"),
}
_WITH_UNIT = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*\*?\s*([a-z]+|°)", re.IGNORECASE)
_WITH_PI = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)?)\s*\*?\s*(?:pi|π)\s*(?:/\s*(\d+\.?\d*))?", re.IGNORECASE)
_FRACTION = re.compile(r"([-+]?\d+\.?\d*)\s*/\s*(\d+\.?\d*)")


def type_meant(key: str | int, word: str) -> str | None:
    """The type, or root, that a word means under a key of the file, also one of version 1; None if none."""
    closures = {type_: kind.called for type_, kind in REGISTRY.items()}
    kinds = _ROOTS if key == "root" else _JOINTS if str(key).startswith("joint") else closures
    return _meant(word, kinds)


def key_meant(word: str, known: Container[str]) -> str | None:
    """The known key that a word means elsewhere; None if none."""
    return _meant(word, {key: words for key, words in _KEYS.items() if key in known})


def _meant(word: str, words_of: Mapping[str, str]) -> str | None:
    folded = re.sub(r"[^a-z0-9]+", "_", word.casefold()).strip("_").removesuffix("_joint")
    return next((meant for meant, words in words_of.items() if folded in (meant, *words.split())), None)


def number_meant(text: str) -> tuple[float, str] | None:
    """The number that a text states with a unit, π or a slash, and its unit in a description; None if it has none."""
    if found := _WITH_UNIT.fullmatch(text.strip()):
        number, unit = found.groups()
        if unit.casefold() in _UNITS:
            factor, ours = _UNITS[unit.casefold()]
            return float(number) * factor, ours
    if (found := _WITH_PI.fullmatch(text.strip())) and float(found[2] or 1.0):
        sign = f"{found[1]}1" if found[1] in ("", "+", "-") else found[1]
        return float(sign) * math.pi / float(found[2] or 1.0), "rad"
    if (found := _FRACTION.fullmatch(text.strip())) and float(found[2]):
        return float(found[1]) / float(found[2]), ""
    return None
