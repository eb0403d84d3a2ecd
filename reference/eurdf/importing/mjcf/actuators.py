"""The actuators."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from eurdf.importing.mjcf.joint_properties import largest_effort
from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Motor


def read_actuators(reading: MjcfReading) -> tuple[tuple[str, ...], dict[str, Motor]]:
    """Names of the actuated joints, which get gears and effort limits, and the motors that say more than these."""
    model = reading.model
    groups: dict[str, list[tuple[int, int]]] = {}
    for index in range(len(model["actuator_trntype"])):
        stated = model.names["actuator"][index] or f"actuator {index}"
        joint = _driven_joint(reading, index, stated)
        step = None if joint is None else reading.steps.get(joint)
        if joint is None or step is None:
            if joint is not None or model["actuator_trntype"][index] != "tendon":
                reading.losses.add("import-actuator", stated)
            continue
        mine = groups.setdefault(step.name, [])
        most = 3 if step.type is JointType.SPHERICAL else 6 if step.type is JointType.FLOATING else len(step.joints)
        alone = most == 1 or step.type is JointType.HELICAL
        if (mine and alone) or (joint in [each for _, each in mine] and _joint_kind(reading, joint) != "ball"):
            reading.losses.add("import-second-actuator", stated)
        else:
            mine.append((index, joint))
    motors: dict[str, Motor] = {}
    fixed = {joint.name for joint in reading.joints if joint.type.is_fixed or joint.mimic}
    actuated = []
    for name, group in groups.items():
        if name in fixed:
            for index, _ in group:
                reading.losses.add("import-actuator", model.names["actuator"][index] or f"actuator {index}")
            continue
        motor = _motor(reading, name, group)
        if motor is not None:
            motors[name] = motor
        actuated.append(name)
    return tuple(actuated), motors


def _joint_kind(reading: MjcfReading, joint: int) -> str:
    return str(reading.model["jnt_type"][joint])


def _driven_joint(reading: MjcfReading, index: int, stated: str) -> int | None:
    """The MuJoCo joint that an actuator drives, if it is one."""
    model = reading.model
    kind, (element, *_) = model["actuator_trntype"][index], model["actuator_trnid"][index]
    if kind in ("joint", "jointinparent"):
        return int(element)
    if kind != "tendon":
        return None
    wraps = reading.wraps(element)
    joints = [joint for what, joint, _ in wraps if what == "joint"]
    leaders = {_leader(reading, joint) for joint in joints}
    if not wraps or len(joints) < len(wraps) or len(leaders) != 1:
        reading.losses.add("import-actuator", stated, "is left out: its tendon moves several joints independently")
        return None
    reading.losses.add("import-tendon-actuator", stated)
    return leaders.pop()


def _leader(reading: MjcfReading, joint: int) -> int:
    """The joint that moves a joint: at the end of a chain of equalities between two joints."""
    model, visited = reading.model, {joint}
    found = True
    while found:
        found = False
        for index, kind in enumerate(model["eq_type"]):
            follower, leader = model["eq_obj1id"][index], model["eq_obj2id"][index]
            if kind == "joint" and model["eq_active0"][index] and follower == joint and leader >= 0:
                if leader in visited:
                    return joint
                visited.add(leader)
                joint, found = leader, True
    return joint


def _motor(reading: MjcfReading, name: str, group: Sequence[tuple[int, int]]) -> Motor | None:
    """Give a joint the gear and the effort limit of its actuators; its motor, if it says more than these."""
    model = reading.model
    (at,) = (i for i, joint in enumerate(reading.joints) if joint.name == name)
    joint = reading.joints[at]
    nv = joint.type.nv
    stated = [model.names["actuator"][index] for index, _ in group]
    shown = stated[0] or name
    if nv > 1 and all(each == f"{stated[0].removesuffix('_1')}_{i + 1}" for i, each in enumerate(stated)):
        shown = stated[0].removesuffix("_1")
    bounds = [_bounds(reading, index, shown) for index, _ in group]
    control = bounds[0] if len(set(bounds)) == 1 else None
    gear = float(model["actuator_gear"][group[0][0]][0])
    changes: dict[str, tuple[float, ...]] = {}
    if nv == 1 and gear not in (0.0, 1.0):
        changes["gear_ratio"] = (gear,)
    effort = joint.properties.effort
    if control is not None and not any(map(math.isfinite, effort)):
        largest = largest_effort(reading, control, shown)
        changes["effort"] = effort = (largest,) * nv
        reading.losses.add(
            "import-effort-limit", name, f"is not stated: {largest:g}, the most of its actuator, is taken"
        )
    reading.joints[at] = replace(joint, properties=replace(joint.properties, **changes))
    if control is not None and all(control == (-each, each) for each in effort):
        control = None
    return Motor(shown, control) if shown != name or control is not None else None


def _bounds(reading: MjcfReading, index: int, shown: str) -> tuple[float, float] | None:
    """The range of the torque or force of an actuator on its joint; None if it has none."""
    model = reading.model
    gear = float(model["actuator_gear"][index][0]) or 1.0
    if model["jnt_type"] and _driven_kind(reading, index) in ("ball", "free"):
        gear = 1.0  # several numbers: the axis
    kinds = (model["actuator_gaintype"][index], model["actuator_biastype"][index], model["actuator_dyntype"][index])
    is_motor = kinds == ("fixed", "none", "none")
    limits = []
    if is_motor and model["actuator_ctrllimited"][index]:
        at = index if not model["actuator_ctrladr"] else model["actuator_ctrladr"][index]
        gain = float(model["actuator_gainprm"][index][0])
        limits.append(sorted(gain * each for each in model["actuator_ctrlrange"][at]))
    if not is_motor:
        reading.losses.add("import-actuator-gain", shown)
    if model["actuator_forcelimited"][index]:
        limits.append(model["actuator_forcerange"][index])
    if not limits:
        return None
    lower, upper = sorted((gear * max(each[0] for each in limits), gear * min(each[1] for each in limits)))
    return lower, upper


def _driven_kind(reading: MjcfReading, index: int) -> str:
    model = reading.model
    if model["actuator_trntype"][index] not in ("joint", "jointinparent"):
        return ""
    return _joint_kind(reading, model["actuator_trnid"][index][0])
