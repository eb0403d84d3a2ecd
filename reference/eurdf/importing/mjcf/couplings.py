"""The equalities that relate coordinates of joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.step import SCALAR
from eurdf.mechanism.constraint import (
    Coupling,
)
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType


def read_couplings(reading: MjcfReading) -> tuple[Coupling, ...]:
    """The linear relations of joints; those that an export made of mimic joints are mimic joints again."""
    model = reading.model
    found: list[Coupling] = []
    seen: set[tuple[tuple[str, float], ...]] = set()
    for index in range(len(model["eq_type"])):
        if index in reading.consumed:
            continue
        stated = model.names["equality"][index] or f"equality {index}"
        terms = _terms(reading, index)
        if terms is None:
            reading.losses.add("import-equality", stated)
            continue
        coefficients, offset = terms
        if len(coefficients) < 2:
            _lock(reading, coefficients, offset, stated)
            continue
        (first, _), *_ = coefficients.items()
        if len(coefficients) == 2 and stated == f"{first}/mimic" and _mimic(reading, coefficients, offset):
            reading.losses.add("import-softness", first)
            continue
        terms_ = sorted(coefficients.items())
        direction = tuple((name, value / terms_[0][1]) for name, value in terms_)
        if direction in seen:
            reading.losses.add("import-redundant-equality", stated)
            continue
        seen.add(direction)
        name = reading.equalities.new(model.names["equality"][index] or "_".join(coefficients))
        found.append(Coupling(name, tuple(coefficients.items()), offset))
        reading.losses.add("import-softness", name)
    return tuple(found)


def _terms(reading: MjcfReading, index: int) -> tuple[dict[str, float], float] | None:
    """Coefficients by joint, and offset, of a linear equality; None if it is no such equality."""
    model = reading.model
    kind, data = model["eq_type"][index], model["eq_data"][index]
    if kind not in ("joint", "tendon") or any(data[2:5]):
        return None
    sides = []
    for element in (model["eq_obj1id"][index], model["eq_obj2id"][index]):
        terms: dict[str, float] = {}
        offset = 0.0
        wraps = [("joint", element, 1.0)] if kind == "joint" else reading.wraps(element) if element >= 0 else []
        for what, joint, coefficient in wraps if element >= 0 else ():
            step = reading.steps.get(joint)
            if what != "joint" or step is None or step.type not in SCALAR:
                return None
            terms[step.name] = terms.get(step.name, 0.0) + coefficient
            offset += coefficient * model["qpos0"][model["jnt_qposadr"][joint]]
        sides.append((terms, offset))
    (coefficients, offset), (others, other) = sides
    for name, value in others.items():
        coefficients[name] = coefficients.get(name, 0.0) - data[1] * value
    offset += data[0] - data[1] * other
    return {name: float(value) for name, value in coefficients.items() if value}, float(offset)


def _lock(reading: MjcfReading, coefficients: Mapping[str, float], offset: float, stated: str) -> None:
    """A joint that an equality holds at a value."""
    if not coefficients:
        reading.losses.add("import-redundant-equality", stated)
        return
    ((name, c),) = coefficients.items()
    value = offset / c
    (index,) = (i for i, joint in enumerate(reading.joints) if joint.name == name)
    joint = reading.joints[index]
    if stated == f"{name}/locked" and value:  # as an export writes equal limits
        kind = JointType.REVOLUTE if joint.type is JointType.CONTINUOUS else joint.type
        properties = replace(joint.properties, lower=(value,), upper=(value,))
        reading.joints[index] = replace(joint, type=kind, properties=properties)
        return
    placement = joint.placement * joint.transform((value,))
    reading.joints[index] = Joint(name, JointType.FIXED, joint.parent, joint.child, placement, joint.offset)
    reading.losses.add("import-locked-joint", name, f"is fixed at {value:g}, where an equality holds it")


def _mimic(reading: MjcfReading, coefficients: Mapping[str, float], offset: float) -> bool:
    """Make the first of two joints mimic the other; False if it cannot."""
    (follower, c), (leader, k) = coefficients.items()
    for index, joint in enumerate(reading.joints):
        if joint.name == follower and joint.type in SCALAR and joint.type is not JointType.HELICAL:
            reading.joints[index] = replace(joint, mimic=Mimic(leader, -k / c, offset / c))
            return True
    return False
