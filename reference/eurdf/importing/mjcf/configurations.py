"""The keyframes, and where to assemble from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from eurdf.convert.names import UniqueNames
from eurdf.importing.mjcf.joints import coordinates_at
from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.values import usable, xyzw
from eurdf.linking.configurations import beyond_limits
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism


def read_configurations(
    reading: MjcfReading, mechanism: Mechanism
) -> tuple[dict[str, Mapping[str, tuple[float, ...]]], tuple[str, Mapping[str, tuple[float, ...]]]]:
    """The keyframes that are within limits; and the configuration to assemble from."""
    model = reading.model
    names = UniqueNames(reading.losses, code="import-name")
    found: dict[str, Mapping[str, tuple[float, ...]]] = {}
    keys: dict[str, Mapping[str, tuple[float, ...]]] = {}
    for index, qpos in enumerate(model["key_qpos"]):
        name = names.new(usable(model.names["key"][index]) or f"key_{index}")
        coordinates = _at(reading, qpos, mechanism)
        keys[name] = coordinates
        beyond = beyond_limits(mechanism.joints, coordinates)
        if beyond:
            reading.losses.add("import-configuration", name, f"is left out: '{beyond[0].joint}' is beyond its limits")
        else:
            found[name] = coordinates
    for name in ("assembled", "home", *keys):
        if name in keys:
            return found, (f"keyframe '{name}'", keys[name])
    return found, ("the reference pose", _at(reading, model["qpos0"], mechanism))


def _at(reading: MjcfReading, qpos: Sequence[float], mechanism: Mechanism) -> Mapping[str, tuple[float, ...]]:
    """The coordinates of all joints with some of their own at a configuration of MuJoCo."""
    found: dict[str, tuple[float, ...]] = {}
    if mechanism.root == "floating":
        (joint,) = reading.joints_of[reading.root_body]
        at = reading.model["jnt_qposadr"][joint]
        found[ROOT_JOINT] = (*qpos[at : at + 3], *xyzw(qpos[at + 3 : at + 7]))
    steps = {step.name: step for step in reading.steps.values()}
    for joint_ in mechanism.joints:
        if joint_.name in steps and not joint_.type.is_fixed and joint_.mimic is None:
            found[joint_.name] = coordinates_at(reading, steps[joint_.name], qpos)
    return MappingProxyType(found)
