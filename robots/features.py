"""The features of the format that a description uses, as its file writes them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

#: Every feature of versions 2.0 and 2.1 that a file can use or not.
FEATURES = (
    *("floating root", "3d", "6d", "hinge", "distance", "couplings", "compliance"),
    *("spherical", "universal", "cylindrical", "helical", "planar", "fixed", "merges", "mimic: false"),
    *("limits", "armature", "stiffness", "rest", "gear_ratio", "rotor_inertia", "name of actuator", "control"),
    *("frames", "named configurations", "x- keys"),
)


def features_of(folder: Path) -> list[str]:
    """Features that the robot in a folder uses, in the order of `FEATURES`."""
    content = yaml.safe_load((folder / "robot.yaml").read_text(encoding="utf-8"))
    found = set(_features(content))
    if 'type="planar"' in (folder / "robot.urdf").read_text(encoding="utf-8"):
        found.add("planar")
    return [feature for feature in FEATURES if feature in found]


def _features(content: Mapping[str, Any]) -> Iterator[str]:
    if content.get("root") == "floating":
        yield "floating root"
    yield from (key for key in ("couplings", "frames") if content.get(key))
    if set(content.get("configurations", ())) - {"assembled"}:
        yield "named configurations"
    if any(key.startswith("x-") for key in content):
        yield "x- keys"
    for closure in content.get("closures", ()):
        yield closure["type"]
        if "compliance" in closure:
            yield "compliance"
    for joint in content.get("joints", {}).values():
        entry = {"type": joint} if isinstance(joint, str) else joint
        yield entry.get("type", "")
        yield from (key for key in ("merges", "limits", "armature", "stiffness", "rest") if key in entry)
        if entry.get("mimic") is False:
            yield "mimic: false"
    for actuator in content.get("actuators", ()):
        if isinstance(actuator, Mapping):
            yield from (key for key in ("gear_ratio", "rotor_inertia", "control") if key in actuator)
            if "name" in actuator:
                yield "name of actuator"
