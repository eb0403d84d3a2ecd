"""The actuators of an MJCF file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from eurdf.convert.mjcf.compiled import Element
from eurdf.convert.mjcf.read_joints import largest_effort
from eurdf.convert.mjcf.read_state import MjcfReading, name_of
from eurdf.mechanism.mechanism import Motor


def read_actuators(reading: MjcfReading) -> tuple[tuple[str, ...], dict[str, Motor]]:
    """Names of the actuated joints, which get gears and effort limits, and the motors that say more than these."""
    groups: dict[str, list[tuple[Element, Element]]] = {}
    for actuator in reading.model["actuator"]:
        joint = reading.driven(actuator)
        if actuator.trntype == "tendon":
            joint = _joint_of_tendon(reading, actuator)
            if joint is None:
                continue
        whole = None if joint is None else reading.whole.get(joint.index)
        if joint is None or whole is None:
            reading.losses.add("import-actuator", name_of(actuator, "actuator"))
            continue
        group = groups.setdefault(whole.name, [])
        is_driven = joint in [each for _, each in group] and joint.type != "ball"
        if (group and whole.type.nv == 1) or is_driven:
            reading.losses.add("import-second-actuator", name_of(actuator, "actuator"))
        else:
            group.append((actuator, joint))
    motors: dict[str, Motor] = {}
    actuated = []
    for name, group in groups.items():
        if reading.joints[name].type.is_fixed or reading.joints[name].mimic:
            for actuator, _ in group:
                reading.losses.add("import-actuator", name_of(actuator, "actuator"))
            continue
        motor = _motor(reading, name, [actuator for actuator, _ in group])
        if motor is not None:
            motors[name] = motor
        actuated.append(name)
    return tuple(actuated), motors


def _joint_of_tendon(reading: MjcfReading, actuator: Element) -> Element | None:
    """The one joint that moves all that the tendon of an actuator goes by."""
    wraps = reading.wraps(actuator.trnid[0])
    joints = [wrap.objid for wrap in wraps if wrap.type == "joint"]
    leaders = {_leader(reading, joint) for joint in joints}
    if len(joints) < len(wraps) or len(leaders) != 1:
        message = "is left out: its tendon moves several joints independently"
        reading.losses.add("import-actuator", name_of(actuator, "actuator"), message)
        return None
    reading.losses.add("import-tendon-actuator", name_of(actuator, "actuator"))
    return reading.model["jnt"][leaders.pop()]


def _leader(reading: MjcfReading, joint: int) -> int:
    """The joint that moves a joint: at the end of a chain of equalities between two joints."""
    leaders: dict[int, int] = {}
    for each in reading.model["eq"]:
        if each.type == "joint" and each.active0 and each.obj2id >= 0:
            leaders.setdefault(each.obj1id, each.obj2id)
    visited = {joint}
    while joint in leaders and leaders[joint] not in visited:
        joint = leaders[joint]
        visited.add(joint)
    return joint


def _motor(reading: MjcfReading, name: str, actuators: Sequence[Element]) -> Motor | None:
    """Give a joint the gear and the effort limit of its actuators; its motor, if it says more than these."""
    joint = reading.joints[name]
    nv = joint.type.nv
    stem = actuators[0].name.removesuffix("_1")
    is_split = nv > 1 and [actuator.name for actuator in actuators] == [
        f"{stem}_{i + 1}" for i in range(len(actuators))
    ]
    shown = stem if is_split else actuators[0].name or name
    bounds = {_bounds(reading, actuator, shown) for actuator in actuators}
    control = bounds.pop() if len(bounds) == 1 else None
    gear = float(actuators[0].gear[0])
    changes: dict[str, tuple[float, ...]] = {}
    if nv == 1 and gear not in (0.0, 1.0):
        changes["gear_ratio"] = (gear,)
    effort = joint.properties.effort
    if control is not None and not any(map(math.isfinite, effort)):
        largest = largest_effort(reading, control, shown)
        changes["effort"] = effort = (largest,) * nv
        message = f"is not stated: {largest:g}, the most of its actuator, is taken"
        reading.losses.add("import-effort-limit", name, message)
    reading.joints[name] = replace(joint, properties=replace(joint.properties, **changes))
    if control is not None and all(control == (-each, each) for each in effort):
        control = None
    return Motor(shown, control) if shown != name or control is not None else None


def _bounds(reading: MjcfReading, actuator: Element, shown: str) -> tuple[float, float] | None:
    """The range of the torque or force of an actuator on its joint; None if it has none."""
    joint = reading.driven(actuator)
    # Of a joint with several velocities, the numbers of the gear are the axis.
    gear = 1.0 if joint is not None and joint.type in ("ball", "free") else float(actuator.gear[0]) or 1.0
    limits = []
    if (actuator.gaintype, actuator.biastype, actuator.dyntype) != ("fixed", "none", "none"):
        reading.losses.add("import-actuator-gain", shown)
    elif actuator.ctrllimited:
        limits.append(sorted(float(actuator.gainprm[0]) * each for each in actuator.ctrlrange))
    if actuator.forcelimited:
        limits.append(actuator.forcerange)
    if not limits:
        return None
    lower, upper = sorted((gear * max(each[0] for each in limits), gear * min(each[1] for each in limits)))
    return lower, upper
