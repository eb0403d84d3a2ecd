"""The couplings: each of joints with one coordinate of their own, and none the multiple of another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from eurdf.diagnostics import Fix, Hint
from eurdf.format.closure_model import CouplingEntry
from eurdf.format.fixes import named, renumbered
from eurdf.format.yaml_text import flow
from eurdf.linking.joints import Joints
from eurdf.mechanism.constraint import Coupling
from eurdf.mechanism.joint import Mimic, drivers
from eurdf.reading.yaml_reader import YamlDocument

#: Coefficients relative to the largest one are equal if they differ by no more.
_EQUAL = 1e-9


def link_couplings(entries: Sequence[CouplingEntry], closures: Sequence[str], joints: Joints) -> tuple[Coupling, ...]:
    """Look the joints of every coupling up, and check that no coupling states what another one does."""
    report, document = joints.reporter.report, joints.reporter.document
    couplings: list[Coupling] = []
    taken: dict[str, str] = dict.fromkeys(closures, "closure")
    names = {*taken, *(entry.name for entry in entries)}
    for entry in entries:
        if entry.name in taken:
            report(
                "duplicate-coupling-name",
                f"there is already a {taken[entry.name]} '{entry.name}'",
                (*entry.pointer, "name"),
                "give every closure and coupling a unique name",
                partial(renumbered, document, (*entry.pointer, "name"), entry.name, names),
            )
            continue
        taken[entry.name] = "coupling"
        checked = [name in joints.faulty or _can_be_coupled(name, entry, joints) for name in entry.joints]
        if not all(checked):
            continue
        twin = next((each for each in couplings if _proportional(dict(each.coefficients), entry.joints)), None)
        if twin is not None:
            message = f"coupling '{entry.name}' is a multiple of coupling '{twin.name}'"
            report("coupling-duplicate", message, entry.pointer, "which of them relates other joints?")
            continue
        couplings.append(Coupling(entry.name, tuple(entry.joints.items()), entry.offset))
    return tuple(couplings)


def _can_be_coupled(name: str, entry: CouplingEntry, joints: Joints) -> bool:
    """EU-CPL-002, EU-CPL-003: a joint exists, and has one coordinate, which is its own."""
    merged, report, pointer = joints.merged, joints.reporter.report, (*entry.pointer, "joints", name)
    fixes: Sequence[Fix] = ()
    joint = joints.by_name.get(name)
    hint: Hint
    if joint is None and name not in merged:
        others = (other.name for other in joints.by_name.values() if other.type.nv == 1 and other.mimic is None)
        message = f"'{name}' is not a joint of the robot"
        joints.report_name("unknown-coupled-joint", message, pointer, name, others, key=True)
        return False
    if joint is None or name in merged:
        why, hint = f"it was merged into the spherical joint '{merged[name]}'", "couple joints that are not merged"
    elif joint.mimic is not None:
        mimics = {each.name: each.mimic for each in joints.by_name.values() if each.mimic is not None}
        leader = drivers(mimics).get(name, joint.mimic)
        why = f"it mimics '{leader.joint}'"
        hint = f"couple '{leader.joint}': '{name}' is {leader.multiplier:g} · '{leader.joint}'"
        hint += f" {'-' if leader.offset < 0.0 else '+'} {abs(leader.offset):g}" if leader.offset else ""
        if not leader.offset and leader.joint not in entry.joints:
            fixes = (_with_leader(name, entry, leader, joints.reporter.document),)
    elif joint.type.is_fixed:
        why, hint = "it is fixed", "leave it out; if it is locked at an angle, add what it contributes to the offset"
    elif joint.type.nv != 1:
        why = f"it is {joint.type} and has {joint.type.nv} velocities"
        hint = "couple revolute, continuous, prismatic or helical joints"
    else:
        return True
    report("coupling-joint", f"joint '{name}' cannot be coupled: {why}", pointer, hint, fixes, key=True)
    return False


def _with_leader(name: str, entry: CouplingEntry, leader: Mimic, document: YamlDocument) -> Fix:
    """The same relation with the joint that a mimic joint is a multiple of, and without that one."""
    pointer, coefficient = (*entry.pointer, "joints", name), entry.joints[name] * leader.multiplier
    edits = *named(document, pointer, True, leader.joint), document.edit(pointer, flow(coefficient))
    return Fix(f"write {leader.joint}: {flow(coefficient)}", edits)


def _proportional(one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """EU-CPL-004: whether the coefficients of two couplings have one ratio."""
    if one.keys() != other.keys():
        return False
    a, b = ({name: value / max(map(abs, each.values())) for name, value in each.items()} for each in (one, other))
    return any(all(abs(a[name] - sign * b[name]) <= _EQUAL for name in a) for sign in (1.0, -1.0))
