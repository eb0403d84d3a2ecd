"""What other formats and textbooks call what a description states, and how they write a number."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

#: Types of closures, by their words elsewhere.
_CLOSURES = {
    "3d": "ball point point_to_point connect position spherical",
    "6d": "weld welded fixed lock rigid pose",
    "hinge": "pin revolute rotary rotational continuous",
    "distance": "rod bar link strut rope tendon",
}

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

# By the key whose value is the type, or whose items are: also those of version 1.
_TYPES = {
    key: {word: meant for meant, words in kinds.items() for word in words.split()}
    for key, kinds in (("closures", _CLOSURES), ("type", _CLOSURES), ("joints", _JOINTS), ("joint_type", _JOINTS))
}

_UNITS = {
    **dict.fromkeys(("deg", "degree", "degrees", "°"), (math.pi / 180.0, "rad")),
    **dict.fromkeys(("rad", "radian", "radians"), (1.0, "rad")),
    **dict.fromkeys(("m", "meter", "metre", "meters", "metres"), (1.0, "m")),
    "cm": (0.01, "m"),
    "mm": (0.001, "m"),
}
_WITH_UNIT = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*\*?\s*([a-z]+|°)", re.IGNORECASE)
_WITH_PI = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)?)\s*\*?\s*(?:pi|π)\s*(?:/\s*(\d+\.?\d*))?", re.IGNORECASE)

#: Two keys that name one side each: 'body1' and 'body2', 'link_a' and 'link_b'.
_SIDE = re.compile(r"(?P<stem>\D*?[^\W\d_])[_-]?(?P<side>[12ab])", re.IGNORECASE)


def type_meant(key: str | int, word: str) -> str | None:
    """The type that a word means under a key of the file, 'closures', 'joints' or those of version 1; None if none."""
    folded = re.sub(r"[^a-z0-9]+", "_", word.casefold()).strip("_").removesuffix("_joint")
    words = _TYPES.get(str(key), {})
    return folded if folded in words.values() else words.get(folded)


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


def two_sides(keys: Mapping[str, object]) -> tuple[str, str] | None:
    """The first two keys that differ in the side that they name, and have names or poses as values."""
    first: dict[str, str] = {}
    for key, value in keys.items():
        if (found := _SIDE.fullmatch(key)) and isinstance(value, str | dict):
            if found["stem"] in first:
                return first[found["stem"]], key
            first[found["stem"]] = key
    return None
