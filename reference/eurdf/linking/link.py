"""From the two files to one mechanism: every name looked up, every rule that needs both files."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType

from eurdf.diagnostics import Diagnostics, FileError, Proposals
from eurdf.format.closure_model import FrameReference, NamedFrame
from eurdf.format.model import Description
from eurdf.format.read import read_description
from eurdf.format.urdf.data import Urdf
from eurdf.format.urdf.read import JOINT_LIMIT
from eurdf.linking.actuators import link_actuators, with_motor
from eurdf.linking.closures import link_closures
from eurdf.linking.configurations import link_configurations
from eurdf.linking.couplings import link_couplings
from eurdf.linking.frame_names import FrameNames, frame_renumbered
from eurdf.linking.joints import Joints, bodies_of, check_ranges, joint_of
from eurdf.linking.mimics import check_chains, freed_joints, led_configurations
from eurdf.linking.replacement import replace_joints
from eurdf.mechanism.body import Frame
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, Motor, Root, root_joint
from eurdf.mechanism.spanning_tree import depth_first, rigid_roots
from eurdf.reading.source import Source
from eurdf.reading.yaml_node import Pointer, json_pointer
from eurdf.reading.yaml_reader import YamlReporter, read_yaml

#: Velocities that the joints of a robot may have. The memory of a model grows with the square of their number.
VELOCITY_LIMIT = 4_000

#: Constraint rows that closures and couplings of a robot may have: K takes memory for each velocity.
ROW_LIMIT = 20_000


def link(
    urdf: Urdf,
    description: Description | None,
    diagnostics: Diagnostics,
    root: Root | None = None,
    *,
    mimic: bool = True,
) -> Mechanism | None:
    """Link a URDF and its description.

    EU-ONE-009: with a description of version 1, no joint mimics another.

    Args:
        urdf: The URDF, valid by itself.
        description: The description; None for a bare URDF.
        diagnostics: Gets what is found.
        root: In place of the root that the description states.
        mimic: Whether a mimic joint depends on its leader; if not, it is free, as if the URDF had no ``<mimic>``. In a
            named configuration that does not state it, it has the value that its leader would give it.

    Returns:
        The mechanism, or None where an error was found.
    """
    before = diagnostics.error_count
    if description is not None:
        reporter = YamlReporter(description.document, diagnostics)
        urdf = urdf.without_mimics(freed_joints(description.joints, urdf, reporter))
    mimics = {} if mimic else {joint.name: joint.mimic for joint in urdf.joints.values() if joint.mimic}
    if not mimic or (description is not None and description.version == "1"):
        urdf = urdf.without_mimics()
    if description is None:
        mechanism = _bare(urdf, diagnostics, root or "fixed")
    else:
        mechanism = _described(urdf, description, reporter, root or description.root)
        if mimics:
            mechanism = replace(mechanism, configurations=led_configurations(mechanism, mimics))
        _reserve_names(description, reporter, mechanism.root)
    if mechanism.root == "floating":
        _reserve_root_joint(urdf, diagnostics)
    _refuse_too_large(mechanism, urdf, description, diagnostics)
    if diagnostics.error_count == before:
        check_chains(mechanism, urdf, diagnostics)
    return None if diagnostics.error_count > before else mechanism


def reread(text: str, urdf: Urdf, file: str) -> tuple[Mechanism | None, Diagnostics]:
    """Read and link the text of a description, before it is written to a file.

    The mechanism, or None where an error was found; and what was found.
    """
    diagnostics = Diagnostics()
    try:
        document = read_yaml(Source(file, text, text.encode()))
    except FileError as error:
        diagnostics.add(error.diagnostic)
        return None, diagnostics
    description = read_description(document, diagnostics)
    mechanism = None if description is None else link(urdf, description, diagnostics)
    return mechanism, diagnostics


def _refuse_too_large(
    mechanism: Mechanism, urdf: Urdf, description: Description | None, diagnostics: Diagnostics
) -> None:
    """EU-FIL-002: a robot is not so large that its model takes more memory than a machine has."""
    joints, velocities = len(mechanism.joints), sum(joint.type.nv for joint in mechanism.joints)
    place = partial(urdf.document.place, urdf.document.root)
    if joints > JOINT_LIMIT:
        message = f"the robot has {joints:,} joints; the maximum is {JOINT_LIMIT:,}"
    elif velocities > VELOCITY_LIMIT:
        message = f"the joints of the robot have {velocities:,} velocities; the maximum is {VELOCITY_LIMIT:,}"
    elif mechanism.nc > ROW_LIMIT and description is not None:
        largest = "closures" if mechanism.closures else "couplings"
        message = f"the {largest} of the robot have {mechanism.nc:,} constraint rows; the maximum is {ROW_LIMIT:,}"
        place = partial(description.document.place, ("closed_loop" if mechanism.version == "1" else largest,))
    else:
        return
    diagnostics.report("file-too-large", message, place)


def _bare(urdf: Urdf, diagnostics: Diagnostics, root: Root) -> Mechanism:
    bodies = bodies_of(urdf)
    ordered = tuple(joint_of(joint) for joint in urdf.walk())
    check_ranges(urdf, {joint.name: joint for joint in ordered}, diagnostics)
    return Mechanism(urdf.name, "", root, (bodies[urdf.root], *(bodies[joint.child] for joint in ordered)), ordered)


def _described(urdf: Urdf, description: Description, reporter: YamlReporter, root: Root) -> Mechanism:
    joints = Joints(urdf, reporter, {joint.name: joint_of(joint) for joint in urdf.joints.values()})
    replace_joints(joints, description.joints, _closure_links(description, urdf), version=description.version)
    check_ranges(urdf, joints.by_name, reporter.diagnostics)
    _own_keys(description, urdf, reporter)
    names = FrameNames(joints)
    frames = names.add(description.frames)
    order = depth_first(urdf.root, joints.by_name.values())
    closures = link_closures(description.closures, names, rigid_roots(urdf.root, order), reporter)
    couplings = link_couplings(description.couplings, [entry.name for entry in description.closures], joints)
    # Errors about a joint whose own entry is invalid would only repeat that error.
    entries = [entry for entry in description.actuators if entry.joint not in joints.faulty]
    actuators = link_actuators(entries, joints)
    named = joints.by_name
    if description.root == "floating":
        named = {**named, ROOT_JOINT: root_joint(urdf.root)}
    configurations = link_configurations(description.configurations, named, joints)
    if root == "fixed":  # whatever the description says
        for coordinates in configurations.values():
            coordinates.pop(ROOT_JOINT, None)
    for entry in entries:
        if entry.joint in actuators:
            given = entry.joint in joints.armature_given
            joints.by_name[entry.joint] = with_motor(joints.by_name[entry.joint], entry, armature_given=given)
    ordered = [joints.by_name[joint.name] for joint in order]
    bodies = bodies_of(urdf) | {body.name: body for body in joints.bodies}
    return Mechanism(
        urdf.name,
        description.version,
        root,
        (bodies[urdf.root], *(bodies[joint.child] for joint in ordered)),
        tuple(ordered),
        (*frames, *_vanished(urdf, joints.by_name)),
        closures,
        actuators,
        MappingProxyType({name: MappingProxyType(of) for name, of in configurations.items()}),
        MappingProxyType(dict(description.metadata)),
        MappingProxyType({json_pointer(pointer): value for pointer, value in description.own_data.items()}),
        couplings,
        motors=MappingProxyType(
            {
                entry.joint: Motor(entry.name or entry.joint, entry.control)
                for entry in entries
                if entry.joint in actuators and (entry.name is not None or entry.control is not None)
            }
        ),
    )


def _own_keys(description: Description, urdf: Urdf, reporter: YamlReporter) -> None:
    """EU-EXT-003: where joints are named, a key that begins with ``x-`` does not name one."""
    for pointer in description.own_data:
        among_joints = (pointer[0], len(pointer)) in (("joints", 2), ("configurations", 3))
        coupled = len(pointer) == 4 and pointer[::2] == ("couplings", "joints")
        if (among_joints or coupled) and pointer[-1] in urdf.joints:
            reporter.report(
                "own-key-is-joint",
                f"'{pointer[-1]}' is a joint, but keys that begin with 'x-' are your own data and have no effect",
                pointer,
                "rename the joint in the URDF",
                key=True,
            )


def _vanished(urdf: Urdf, joints: dict[str, Joint]) -> tuple[Frame, ...]:
    """EU-FRM-004: a joint of the URDF that the description split or renamed is still found by name, as a frame."""
    if joints.keys() >= urdf.joints.keys():
        return ()
    return tuple(Frame(joint.name, joint.child, kind="joint") for joint in urdf.walk() if joint.name not in joints)


def _closure_links(description: Description, urdf: Urdf) -> set[str]:
    """Names of the links that the closures' frames are fixed to; names that mean nothing are left to `FrameNames`."""
    frames = {entry.name: entry for entry in description.frames}

    def link_of(reference: FrameReference) -> str | None:
        if isinstance(reference, NamedFrame) and reference.target not in urdf.links:
            reference = frames.get(reference.target, reference)
        name = reference.target
        if name in urdf.links and reference.kind != "joint":
            return name
        return urdf.joints[name].child if name in urdf.joints else None

    sides = (link_of(side) for closure in description.closures for side in closure.frames)
    return {side for side in sides if side is not None}


def _reserve_names(description: Description, reporter: YamlReporter, root: Root) -> None:
    """EU-URD-011: what the description names anew takes no name that the model needs for itself."""
    reserved = ("universe", ROOT_JOINT) if root == "floating" else ("universe",)
    named: list[tuple[str, str, Pointer, bool, Proposals]]
    named = [("joint", entry.name, entry.pointer, True, ()) for entry in description.joints if entry.merges]
    for entry in description.frames:
        fixes = partial(frame_renumbered, reporter.document, entry, [frame.name for frame in description.frames])
        named.append(("frame", entry.name, (*entry.pointer, "name"), False, fixes))
    for kind, name, pointer, key, proposals in named:
        if name in reserved:
            reporter.report(
                "urdf-reserved-name",
                f"'{name}' is reserved for the model, and cannot be the name of a {kind}",
                pointer,
                f"give the {kind} another name",
                proposals,
                key=key,
            )


def _reserve_root_joint(urdf: Urdf, diagnostics: Diagnostics) -> None:
    """EU-URD-011: the joint that a floating root hangs from has a name that no other joint or link has."""
    for kind, item in (("joint", urdf.joints.get(ROOT_JOINT)), ("link", urdf.links.get(ROOT_JOINT))):
        if item is not None:
            diagnostics.report(
                "urdf-reserved-name",
                f"'{ROOT_JOINT}' is the joint of a floating root, and cannot be the name of a {kind}",
                urdf.document.place(item.element, "name"),
                "rename it, or make the root fixed",
            )
